"""The commands and their options.

What a command needs is imported when it runs, so that ``--help`` is there at once.
"""

from __future__ import annotations

import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from crankmbs.cli.ending import ending
from crankmbs.cli.options import (
    CostCap,
    NoFigures,
    Out,
    Rtol,
    SceneName,
    Until,
    WrittenScene,
)
from crankmbs.cli.plot import plot
from crankmbs.cli.pressure import pressure
from crankmbs.cli.sensitivity import sensitivity
from crankmbs.cli.solve import solve
from crankmbs.cli.speed import speed
from crankmbs.cli.sweep import sweep
from crankmbs.cli.validate import validate
from crankmbs.scene.shipped import shipped_scenes

__all__ = ["app", "main"]


class _Commands(TyperGroup):
    """Turns what ends a command early into a message and an exit status."""

    def make_context(self, *args: Any, **options: Any) -> Any:
        with ending():  # --help and --version are printed here
            return super().make_context(*args, **options)

    def invoke(self, ctx: Any) -> Any:
        with ending():
            return super().invoke(ctx)


app = typer.Typer(
    cls=_Commands,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib import metadata

        typer.echo(metadata.version("crankmbs"))
        raise typer.Exit


@app.callback()
def crankmbs(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Time-domain dynamics of the slider-crank and the engine crank train."""


@app.command()
def run(
    scene: SceneName,
    formulation: Annotated[
        str | None,
        typer.Option(help="auto, kinetostatic, crank_angle, minimal or multibody."),
    ] = None,
    rtol: Rtol = None,
    until: Until = None,
    every: Annotated[
        str | None, typer.Option(help='Output spacing: "1 deg", "0.1 ms" or "none".')
    ] = None,
    out: Out = None,
    no_figures: NoFigures = False,
    confirm: Annotated[
        bool,
        typer.Option("--confirm", help="Let exudyn's rigid bodies run the last cycle too."),
    ] = False,
    orders: Annotated[
        bool, typer.Option("--orders", help="Show the orders of torque and frame force.")
    ] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(help='Every quantity at a crank angle, "60 deg"; may be given often.'),
    ] = None,
    cost_cap: CostCap = 10.0,
) -> None:
    """Run a scene: print its measures, write data and figures."""
    from crankmbs.cli.run import Wanted, run_scene

    options = {"formulation": formulation, "rtol": rtol, "until": until, "every": every}
    given = {name: value for name, value in options.items() if value is not None}
    wanted = Wanted(not no_figures, confirm, orders, tuple(at or ()))
    complete = run_scene(scene, given, out=out, wanted=wanted, cost_cap=cost_cap)
    if not complete:
        raise typer.Exit(3)


app.command()(validate)


@app.command()
def balance(
    scene: SceneName,
    share: Annotated[
        str, typer.Option(help="Share of the reciprocating mass that is balanced.")
    ] = "50%",
    cost_cap: CostCap = 10.0,
    write: WrittenScene = None,
    out: Out = None,
    no_figures: NoFigures = False,
) -> None:
    """Find counterweights; show what is left of first and second order, before and after."""
    from crankmbs.cli.balance import Wanted, balance_scene

    wanted = Wanted(share, write, out, not no_figures, cost_cap)
    if not balance_scene(scene, wanted):
        raise typer.Exit(3)


@app.command()
def flywheel(
    scene: SceneName,
    fluctuation: Annotated[
        str, typer.Option(help='Wanted (max - min)/mean of the speed, as "1 %" or 0.01.')
    ] = "1 %",
    write: WrittenScene = None,
    out: Out = None,
    no_figures: NoFigures = False,
) -> None:
    """Find the crank inertia that gives a fluctuation of speed on the settled cycle."""
    from crankmbs.cli.flywheel import size_flywheel

    if not size_flywheel(scene, fluctuation, write, out=out, figures=not no_figures):
        raise typer.Exit(3)


@app.command("work-precision")
def work_precision(
    scene: SceneName,
    out: Out = None,
) -> None:
    """Measure speed against error of every formulation that serves the scene."""
    from crankmbs.cli.work_precision import measure_scene

    if not measure_scene(scene, out=out):
        raise typer.Exit(3)


@app.command()
def demo(
    scene: SceneName = "propeller",
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Write the file only, open no browser.")
    ] = False,
) -> None:
    """Open a page that shows the mechanism moving, and what each knob changes."""
    from crankmbs.cli.page import demonstrate

    demonstrate(scene, browser=not no_browser)


@app.command()
def page(
    scene: SceneName,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="The file; default NAME.html.")
    ] = None,
) -> None:
    """Write the page as one file: no server, no network."""
    from crankmbs.cli.page import write_page

    write_page(scene, out=out)


for command in (pressure, speed, sweep, plot, solve, sensitivity):
    app.command()(command)


@app.command()
def check(scene: SceneName) -> None:
    """Read a scene and say how it would be run; run nothing."""
    from crankmbs.choose import choose
    from crankmbs.report.machine import describe
    from crankmbs.scene.read import load_scene, scene_path

    path = scene_path(scene)
    loaded = load_scene(path)
    typer.echo(describe(str(path), loaded, choose(loaded, loaded.run.formulation)))


@app.command()
def scenes() -> None:
    """List the shipped scenes."""
    import tomllib

    shipped = shipped_scenes()
    width = max(map(len, shipped), default=0)
    for name, path in shipped.items():
        title = tomllib.loads(path.read_text(encoding="utf-8"))["title"]
        typer.echo(f"{name:<{width}}  {title}")


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name or path of the new scene.")],
) -> None:
    """Write a commented scene to start from."""
    from crankmbs.cli.new import new_scene

    new_scene(name)


@app.command()
def export(
    scene: SceneName,
    to: Annotated[str, typer.Option(help="toml, matlab or exudyn.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="Default NAME.toml, NAME.mat or NAME.py."),
    ] = None,
) -> None:
    """Copy a scene as it is, write its result for MATLAB, or its bodies as a script for exudyn."""
    from crankmbs.cli.export import export_scene

    if not export_scene(scene, to, out=out):
        raise typer.Exit(3)


@app.command()
def animate(
    scene: SceneName,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help=".gif or .mp4; default NAME.gif."),
    ] = None,
    length: Annotated[float | None, typer.Option(help="Seconds of a cycle; default 6.")] = None,
    width: Annotated[int | None, typer.Option(help="Pixels, a multiple of 32.")] = None,
    cylinder: Annotated[int | None, typer.Option(help="The one shown alone; default all.")] = None,
    forces: Annotated[
        str | None, typer.Option(help="Arrows of the forces on piston, rod or crank.")
    ] = None,
) -> None:
    """Film the mechanism and its speed over the last cycle, for slides."""
    from crankmbs.cli.animate import animate_scene
    from crankmbs.figures.animation import Filming

    if not animate_scene(scene, out, Filming(length, width, cylinder, forces)):
        raise typer.Exit(3)


@app.command()
def lesson(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME", help="Its name, as lessons lists them; without it all, with an index."
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the page.")
    ] = Path("lessons"),
    scene: Annotated[
        str | None,
        typer.Option("--scene", metavar="SCENE", help="Which it is about; default its own."),
    ] = None,
) -> None:
    """Write a lesson: figures that compute while you drag them, formulas, and questions."""
    from crankmbs.cli.lesson import make_lesson

    make_lesson(name, out, scene)


@app.command()
def lessons() -> None:
    """List the lessons."""
    from crankmbs.cli.lesson import list_lessons

    list_lessons()


def main() -> None:
    """Entry point of the command ``crankmbs``."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a title the terminal cannot show is no crash
    app()
