"""The command ``animate``: a run's last cycle as a moving picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Exit, Option, echo

from crankmbs.cli.folder import writable
from crankmbs.cli.options import SceneName, named_scene
from crankmbs.cli.progress import progress

__all__ = ["animate"]


def animate(
    scene: SceneName,
    out: Annotated[
        Path | None, Option("--out", "-o", metavar="FILE", help=".gif or .mp4; default NAME.gif.")
    ] = None,
    length: Annotated[float | None, Option(help="Seconds of a cycle; default 6.")] = None,
    width: Annotated[int | None, Option(help="Pixels, a multiple of 32.")] = None,
    cylinder: Annotated[int | None, Option(help="The one shown alone; default all.")] = None,
    forces: Annotated[
        str | None, Option(help="Arrows of the forces on piston, rod or crank.")
    ] = None,
) -> None:
    """Film the mechanism and its speed over the last cycle, for slides."""
    from crankmbs.figures.animation import Filming, check_filming, check_format, save_animation
    from crankmbs.simulate import simulate

    path, loaded = named_scene(scene)
    filming = Filming(length, width, cylinder, forces)
    file = Path(f"{path.stem}.gif") if out is None else out
    check_format(file)
    check_filming(filming, loaded)
    writable(file.parent)
    with progress("running"):
        result = simulate(loaded)
    with progress("filming"):
        save_animation(result, file, filming)
    echo(f"{result}\n\nwrote {file}, {file.stat().st_size / 1e6:.1f} MB")
    if result.status != 0:
        raise Exit(3)
