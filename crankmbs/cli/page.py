"""The commands ``demo`` and ``page``: the mechanism in the browser, from one file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Option, echo, launch

from crankmbs.cli.options import SceneName, named_scene
from crankmbs.storage.files import text_in_one_move

__all__ = ["demo", "page"]


def demo(
    scene: SceneName = "propeller",
    no_browser: Annotated[
        bool, Option("--no-browser", help="Write the file only, open no browser.")
    ] = False,
) -> None:
    """Open a page that shows the mechanism moving, and what each knob changes."""
    name = Path(scene).stem
    target = Path("results", f"{name}.html").absolute()  # where a browser in a sandbox may read it
    _write(scene, target)
    echo(f"{name}: {target}")
    if not no_browser:
        launch(target.as_uri())


def page(
    scene: SceneName,
    out: Annotated[Path | None, Option("-o", "--out", help="The file; default NAME.html.")] = None,
) -> None:
    """Write the page as one file: no server, no network."""
    target = out or Path(f"{Path(scene).stem}.html")
    _write(scene, target)
    echo(f"wrote {target}; open it in a browser")


def _write(scene: str, target: Path) -> None:
    from crankmbs.page import page_of

    path, loaded = named_scene(scene)
    text_in_one_move(target, page_of(loaded, path.stem))
