"""The command ``speed``: times of a wheel's teeth in, the speed over the crank angle out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from crankmbs.cli.folder import writable
from crankmbs.cli.pressure import as_options
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError
from crankmbs.storage.files import together

__all__ = ["speed"]


def speed(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Times of teeth, or a wheel's signal over time.")
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Default results/FILE/speed.csv.")
    ] = None,
    wheel: Annotated[
        str | None, typer.Option(help='"60-2", teeth less missing; "60-2 falling".')
    ] = None,
    stroke: Annotated[
        int, typer.Option(help="4: the speed comes again after two revolutions; 2: after one.")
    ] = 4,
    firing_tdc: Annotated[
        str | None, typer.Option(help="Crank angle 0, after the first edge after the first gap.")
    ] = None,
    columns: Annotated[str | None, typer.Option(help="The column of the wheel.")] = None,
    index: Annotated[
        str | None, typer.Option(help="The column of an encoder's mark; its pulses: --wheel 360.")
    ] = None,
    separator: Annotated[
        str | None, typer.Option(help='";", ",", "|", tab or blank; else it is found.')
    ] = None,
    decimal: Annotated[str | None, typer.Option(help='"." or ","; else it is found.')] = None,
    skip: Annotated[int, typer.Option(help="Lines at the beginning to leave out.")] = 0,
) -> None:
    """Read the speed over the crank angle from a wheel's teeth, for [motion] of a scene."""
    from crankmbs.indicated import read_speed
    from crankmbs.indicated.speed import motion_line

    target = Path("results", file.stem, "speed.csv") if out is None else out
    if target.resolve() == file.resolve():
        raise InputError(f"-o: {target} is the file that is read; choose another name")
    options = {
        "wheel": wheel,
        "firing_tdc": firing_tdc,
        "columns": columns,
        "index": index,
        "separator": separator,
        "decimal": decimal,
    }
    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    folder = writable(target.parent)
    try:
        with progress("reading"):
            measured = read_speed(file, **given, stroke=stroke, skip=skip)
        with together(folder) as part:
            measured.save(part / target.name)
    except InputError as error:
        raise InputError(as_options(str(error))) from None
    lines = [as_options(sentence) for sentence in measured.sentences]
    lines += ["", f"wrote {folder}: {target.name}", "as [motion] of a scene:"]
    typer.echo("\n".join([*lines, f"  {motion_line(target.name)}"]))
