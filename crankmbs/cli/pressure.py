"""The command ``pressure``: a measured file in, a table, figures and sentences out."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from crankmbs.cli.folder import writable, wrote_into
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.indicated import Indicated

__all__ = ["as_options", "pressure"]

_NAMES = (
    "columns|reference|unit|each|stroke|firing_tdc|loss_angle|compression_ratio|invert|smooth"
    "|cycles|separator|decimal|skip|scene|wheel|index|sensor|delay"
)
_GIVEN = re.compile(rf'\b({_NAMES})=(True\b|"[^"]*"|\.\.\.|[\w.]+)')
_BARE = re.compile(r"\b(loss_angle|compression_ratio|firing_tdc)\b(?!=)")


def pressure(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Text of an indicating system, or a record over time."),
    ],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="The table; default results/FILE/pressure.csv."),
    ] = None,
    scene: Annotated[
        str | None, typer.Option(help="A scene: geometry, stroke and layout of the engine.")
    ] = None,
    columns: Annotated[
        str | None, typer.Option(help='Pressures by name, "PCYL1..4" or "P1,P3".')
    ] = None,
    unit: Annotated[str | None, typer.Option(help="Of pressures that have none.")] = None,
    each: Annotated[
        str | None, typer.Option(help="What numbered columns are: cycle or cylinder.")
    ] = None,
    stroke: Annotated[int | None, typer.Option(help="2 or 4.")] = None,
    reference: Annotated[
        str | None,
        typer.Option(help='"absolute", "gauge", "gauge 1 bar", "inlet 1 bar", "polytrope 1.32".'),
    ] = None,
    firing_tdc: Annotated[
        str | None, typer.Option(help="The file's angle of the firing dead centre.")
    ] = None,
    loss_angle: Annotated[
        str | None, typer.Option(help="By which a motored peak comes before it.")
    ] = None,
    compression_ratio: Annotated[float | None, typer.Option(help="Of the cylinder.")] = None,
    wheel: Annotated[
        str | None,
        typer.Option(help='Of a record over time: "60-2", teeth less missing; "60-2 falling".'),
    ] = None,
    index: Annotated[
        str | None, typer.Option(help="The column of an encoder's mark; its pulses: --wheel 360.")
    ] = None,
    sensor: Annotated[
        str | None,
        typer.Option(help='"(V/5 - 0.115)/0.00385 bar", or "0.5 V = 0 bar, 4.5 V = 100 bar".'),
    ] = None,
    delay: Annotated[
        str | None, typer.Option(help='By which the sensor shows a pressure late, "0.8 ms".')
    ] = None,
    invert: Annotated[bool, typer.Option("--invert", help="Turn the signal over.")] = False,
    smooth: Annotated[str | None, typer.Option(help='Width of a sliding cubic, "3 deg".')] = None,
    cycles: Annotated[str, typer.Option(help='In the table: mean, all, 7 or "1-50".')] = "mean",
    separator: Annotated[
        str | None, typer.Option(help='";", ",", "|", tab or blank; else it is found.')
    ] = None,
    decimal: Annotated[str | None, typer.Option(help='"." or ","; else it is found.')] = None,
    skip: Annotated[int, typer.Option(help="Lines at the beginning to leave out.")] = 0,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")] = False,
) -> None:
    """Read measured cylinder pressures, check them, write the table that a scene uses."""
    options = {
        "columns": columns,
        "unit": unit,
        "each": each,
        "stroke": stroke,
        "reference": reference,
        "firing_tdc": firing_tdc,
        "loss_angle": loss_angle,
        "compression_ratio": compression_ratio,
        "wheel": wheel,
        "index": index,
        "sensor": sensor,
        "delay": delay,
        "smooth": smooth,
        "separator": separator,
        "decimal": decimal,
    }
    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    given |= {"invert": invert, "cycles": cycles, "skip": skip}
    _measured(file, scene, given, out=out, figures=not no_figures)


def _measured(
    file: Path, scene: str | None, given: Mapping[str, Any], *, out: Path | None, figures: bool
) -> None:
    """Read a file, write its table and figures, print what was found and done.

    given : the options of `read_pressure`; out : the table; None: results/NAME/pressure.csv

    Raises
    ------
    CrankmbsError : what cannot be read, or is left open, in words of the command line
    """
    from crankmbs.indicated import read_pressure
    from crankmbs.indicated.speed import motion_line
    from crankmbs.indicated.write import gas_lines
    from crankmbs.scene.read import load_scene, scene_path

    target = Path("results", file.stem, "pressure.csv") if out is None else out
    if target.resolve() == file.resolve():
        raise InputError(f"-o: {target} is the file that is read; choose another name")
    machine = None if scene is None else load_scene(scene_path(scene))
    folder = writable(target.parent)
    try:
        with progress("reading"):
            indicated = read_pressure(file, machine, **given)
        with together(folder) as part:
            indicated.save(part / target.name)
            names = [target.name]
            if indicated.speed is not None:
                names.append(indicated.speed.save(part / f"{target.stem}_speed.csv").name)
            if figures:
                names += _draw(indicated, part, target.stem)
    except InputError as error:
        raise InputError(as_options(str(error))) from None
    lines = [as_options(sentence) for sentence in indicated.sentences]
    lines += ["", wrote_into(folder, names), "as [gas] of a scene:"]
    lines += [f"  {line}" for line in gas_lines(indicated, target.name)]
    if indicated.speed is not None:
        lines += ["as [motion] of a scene:", f"  {motion_line(names[1])}"]
    typer.echo("\n".join(lines))


def _draw(indicated: Indicated, folder: Path, stem: str) -> list[str]:
    from crankmbs.figures import save_indicated_figures  # matplotlib only here

    return [file.name for file in save_indicated_figures(indicated, folder, stem)]


def as_options(text: str) -> str:
    """A sentence for a caller in Python, in words of the command line.

    >>> as_options('give loss_angle, or invert=True, or reference="inlet 1 bar"')
    'give --loss-angle, or --invert, or --reference "inlet 1 bar"'
    """
    first = re.match(rf"({_NAMES}): ", text)
    if first:
        text = f"--{first[1].replace('_', '-')}{text[first.end(1) :]}"
    text = _BARE.sub(lambda match: _option(match[1]), text)
    return _GIVEN.sub(lambda match: f"{_option(match[1])} {match[2]}".removesuffix(" True"), text)


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"
