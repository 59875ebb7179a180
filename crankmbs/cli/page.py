"""The commands ``demo`` and ``page``: the mechanism in the browser, from one file."""

from __future__ import annotations

from pathlib import Path

import typer

from crankmbs.page import page_of
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.storage.files import text_in_one_move

__all__ = ["demonstrate", "write_page"]


def demonstrate(name: str, *, browser: bool) -> None:
    """Write the page of a scene to results/NAME.html, where a browser in a sandbox may read it, and
    open it.

    Raises
    ------
    CrankmbsError : a bad scene, one that the page cannot show, or a file that cannot be written
    """
    path = scene_path(name)
    target = Path("results", f"{path.stem}.html").absolute()
    _write(path, target)
    typer.echo(f"{path.stem}: {target}")
    if browser:
        typer.launch(target.as_uri())


def write_page(name: str, *, out: Path | None) -> None:
    """Write the page of a scene as one file.

    Raises
    ------
    CrankmbsError : a bad scene, one that the page cannot show, or a file that cannot be written
    """
    path = scene_path(name)
    target = out or Path(f"{path.stem}.html")
    _write(path, target)
    typer.echo(f"wrote {target}; open it in a browser")


def _write(path: Path, target: Path) -> None:
    text_in_one_move(target, page_of(load_scene(path), path.stem))
