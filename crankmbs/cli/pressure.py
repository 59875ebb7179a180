"""The command ``pressure``: a measured file in, a table, figures and sentences out."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option, echo

from crankmbs.cli.folder import wrote_into
from crankmbs.cli.measured import as_options, naming_options, table_file
from crankmbs.cli.options import Decimal, Index, NoFigures, Separator, Skip
from crankmbs.cli.progress import progress
from crankmbs.storage.files import together

__all__ = ["pressure"]


def pressure(
    file: Annotated[
        Path, Argument(metavar="FILE", help="Text of an indicating system, or a record over time.")
    ],
    out: Annotated[
        Path | None, Option("-o", "--out", help="The table; default results/FILE/pressure.csv.")
    ] = None,
    scene: Annotated[
        str | None, Option(help="A scene: geometry, stroke and layout of the engine.")
    ] = None,
    columns: Annotated[str | None, Option(help='Pressures by name, "PCYL1..4" or "P1,P3".')] = None,
    angle: Annotated[
        str | None, Option(metavar="COLUMN", help="The crank angle by name, where it is not found.")
    ] = None,
    unit: Annotated[str | None, Option(help="Of pressures that have none.")] = None,
    each: Annotated[
        str | None, Option(help="What numbered columns are: cycle or cylinder.")
    ] = None,
    stroke: Annotated[int | None, Option(help="2 or 4.")] = None,
    reference: Annotated[
        str | None,
        Option(help='"absolute", "gauge", "gauge 1 bar", "inlet 1 bar", "polytrope 1.32".'),
    ] = None,
    firing_tdc: Annotated[
        str | None, Option(help="The file's angle of the firing dead centre.")
    ] = None,
    loss_angle: Annotated[
        str | None, Option(help="By which a motored peak comes before it.")
    ] = None,
    compression_ratio: Annotated[float | None, Option(help="Of the cylinder.")] = None,
    wheel: Annotated[
        str | None,
        Option(help='Of a record over time: "60-2", teeth less missing; "60-2 falling".'),
    ] = None,
    index: Index = None,
    sensor: Annotated[
        str | None, Option(help='"(V/5 - 0.115)/0.00385 bar", or "0.5 V = 0 bar, 4.5 V = 100 bar".')
    ] = None,
    delay: Annotated[
        str | None, Option(help='By which the sensor shows a pressure late, "0.8 ms".')
    ] = None,
    invert: Annotated[bool, Option("--invert", help="Turn the signal over.")] = False,
    smooth: Annotated[str | None, Option(help='Width of a sliding cubic, "3 deg".')] = None,
    cycles: Annotated[str, Option(help='In the table: mean, all, 7 or "1-50".')] = "mean",
    separator: Separator = None,
    decimal: Decimal = None,
    skip: Skip = 0,
    no_figures: NoFigures = False,
) -> None:
    """Read measured cylinder pressures, check them, write the table that a scene uses."""
    _convert(**locals())


def _convert(
    file: Path, out: Path | None, scene: str | None, *, no_figures: bool, **options: Any
) -> None:
    """Read a file, write its table and figures, print what the record shows.

    options : those of `read_pressure`; None: its default

    Raises
    ------
    CrankmbsError : what cannot be read, or is left open, in words of the command line
    """
    from crankmbs.indicated import read_pressure
    from crankmbs.indicated.speed import motion_line
    from crankmbs.indicated.write import gas_lines
    from crankmbs.scene.read import load_scene

    machine = None if scene is None else load_scene(scene)
    target = table_file(file, out, "pressure.csv")
    stated = {name: value for name, value in options.items() if value is not None}
    with naming_options():
        with progress("reading"):
            indicated = read_pressure(file, machine, **stated)
        with together(target.parent) as part:
            indicated.save(part / target.name)
            names = [target.name]
            if indicated.speed is not None:
                names.append(indicated.speed.save(part / f"{target.stem}_speed.csv").name)
            if not no_figures:
                from crankmbs.figures import save_indicated_figures  # matplotlib only here

                files = save_indicated_figures(indicated, part, target.stem)
                names += [file.name for file in files]
    lines = [as_options(sentence) for sentence in indicated.sentences]
    lines += ["", wrote_into(target.parent, names), "as [gas] of a scene:"]
    # a scene's paths are relative to its folder; a new one's stands where the command is given
    beside = Path(scene).parent if scene and Path(scene).is_file() else Path()
    within = Path(os.path.relpath(target.parent, beside))
    lines += [f"  {line}" for line in gas_lines(indicated, (within / names[0]).as_posix())]
    if indicated.speed is not None:
        of_speed = (within / names[1]).as_posix()
        lines += ["as [motion] of a scene:", f"  {motion_line(of_speed)}"]
    echo("\n".join(lines))
