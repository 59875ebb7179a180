"""The commands ``demo`` and ``page``: the mechanism in the browser."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from crankmbs.scene_io import load_scene, scene_path

if TYPE_CHECKING:
    from bokeh.server.server import Server

__all__ = ["demonstrate"]


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
