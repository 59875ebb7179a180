"""The program: its commands, each from the module that has its options.

What a command needs is imported when it runs, so that ``--help`` is there at once.
"""

from __future__ import annotations

import gc
import sys
from io import TextIOWrapper
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from crankmbs.cli.animate import animate
from crankmbs.cli.balance import balance
from crankmbs.cli.ending import ending, listen
from crankmbs.cli.export import export
from crankmbs.cli.flywheel import flywheel
from crankmbs.cli.lesson import lesson, lessons
from crankmbs.cli.page import demo, page
from crankmbs.cli.plot import plot
from crankmbs.cli.pressure import pressure
from crankmbs.cli.run import run
from crankmbs.cli.scenes import check, new, scenes
from crankmbs.cli.sensitivity import sensitivity
from crankmbs.cli.solve import solve
from crankmbs.cli.speed import speed
from crankmbs.cli.sweep import sweep
from crankmbs.cli.validate import validate
from crankmbs.cli.work_precision import work_precision

__all__ = ["app", "main"]

# made until garbage is looked for, which then takes no time: a command makes few cycles of objects
_OBJECTS = 100_000


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


for command in (
    run,
    validate,
    balance,
    flywheel,
    work_precision,
    demo,
    page,
    pressure,
    speed,
    sweep,
    plot,
    solve,
    sensitivity,
    check,
    scenes,
    new,
    export,
    animate,
    lesson,
    lessons,
):
    app.command()(command)


def main() -> None:
    """Entry point of the command ``crankmbs``."""
    gc.set_threshold(_OBJECTS)
    listen()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a title the terminal cannot show is no crash
    app()
