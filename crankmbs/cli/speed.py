"""The command ``speed``: times of a wheel's teeth in, the speed over the crank angle out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option, echo

from crankmbs.cli.folder import wrote_into
from crankmbs.cli.measured import as_options, naming_options, table_file
from crankmbs.cli.options import Decimal, Index, Separator, Skip
from crankmbs.cli.progress import progress
from crankmbs.storage.files import together

__all__ = ["speed"]


def speed(
    file: Annotated[
        Path, Argument(metavar="FILE", help="Times of teeth, or a wheel's signal over time.")
    ],
    out: Annotated[
        Path | None, Option("-o", "--out", help="Default results/FILE/speed.csv.")
    ] = None,
    wheel: Annotated[str | None, Option(help='"60-2", teeth less missing; "60-2 falling".')] = None,
    stroke: Annotated[
        int, Option(help="4: the speed comes again after two revolutions; 2: after one.")
    ] = 4,
    firing_tdc: Annotated[
        str | None, Option(help="Firing dead centre, after the first edge after the first gap.")
    ] = None,
    columns: Annotated[str | None, Option(help="The column of the wheel.")] = None,
    index: Index = None,
    separator: Separator = None,
    decimal: Decimal = None,
    skip: Skip = 0,
) -> None:
    """Read the speed over the crank angle from a wheel's teeth, for [motion] of a scene."""
    _convert(**locals())


def _convert(file: Path, out: Path | None, **options: Any) -> None:
    """Read a file, write its table, print what the record shows; options: those of `read_speed`."""
    from crankmbs.indicated import read_speed
    from crankmbs.indicated.speed import motion_line

    target = table_file(file, out, "speed.csv")
    stated = {name: value for name, value in options.items() if value is not None}
    with naming_options():
        with progress("reading"):
            measured = read_speed(file, **stated)
        with together(target.parent) as part:
            measured.save(part / target.name)
    lines = [as_options(sentence) for sentence in measured.sentences]
    lines += ["", wrote_into(target.parent, [target.name]), "as [motion] of a scene:"]
    echo("\n".join([*lines, f"  {motion_line(target.name)}"]))
