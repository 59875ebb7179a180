"""The commands ``demo`` and ``page``: the mechanism in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from crankmbs.cli.progress import progress
from crankmbs.scene.read import load_scene, scene_path

if TYPE_CHECKING:
    from bokeh.server.server import Server

__all__ = ["demonstrate", "write_page"]


def demonstrate(name: str, *, port: int, browser: bool) -> None:
    """Serve the live page of a scene until interrupted.

    Raises
    ------
    CrankmbsError : bad scene or port
    """
    path = scene_path(name)
    scene = load_scene(path)
    from crankmbs.demo.serve import serve  # bokeh is imported only when it is used

    def ready(address: str, server: Server) -> None:
        typer.echo(f"{path.stem}: {address} (end with Ctrl+C)")
        if browser:
            server.io_loop.add_callback(typer.launch, address)

    serve(scene, path.stem, port, ready)


def write_page(name: str, *, varied: list[str], out: Path | None) -> None:
    """Write the page of a scene as one file.

    Raises
    ------
    CrankmbsError : bad scene, knob or file
    """
    path = scene_path(name)
    scene = load_scene(path)
    from crankmbs.demo.file import save_page  # bokeh is imported only when it is used

    target = out or Path(f"{path.stem}.html")
    with progress("computing the states"):
        states = save_page(scene, path.stem, varied, target)
    typer.echo(f"wrote {target}: {states} states; open it in a browser")
