"""The command ``animate``: a run's last cycle as a moving picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from crankmbs.cli.folder import writable
from crankmbs.cli.progress import progress
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.simulate import simulate

if TYPE_CHECKING:
    from crankmbs.figures.animation import Filming

__all__ = ["animate_scene"]


def animate_scene(name: str, out: Path | None, filming: Filming) -> bool:
    """Run a scene and film its last cycle; return whether it reached its end.

    Parameters
    ----------
    out : .gif or .mp4 file; None: NAME.gif; filming : length, width and cylinder

    Raises
    ------
    CrankmbsError : bad scene, an ending that cannot be written, a film that cannot be, or folder;
        before anything runs
    """
    path = scene_path(name)
    scene = load_scene(path)
    from crankmbs.figures.animation import check_filming, check_format, save_animation

    file = Path(f"{path.stem}.gif") if out is None else out
    check_format(file)
    check_filming(filming, scene)
    writable(file.parent)
    with progress("running"):
        result = simulate(scene)
    with progress("filming"):
        save_animation(result, file, filming)
    typer.echo(f"{result}\n\nwrote {file}, {file.stat().st_size / 1e6:.1f} MB")
    return result.status == 0
