"""The command ``sensitivity``: how much measures change with knobs of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import TYPE_CHECKING, Annotated

from typer import Option

from crankmbs.cli.options import SceneName, named_scene
from crankmbs.cli.progress import progress
from crankmbs.cli.sweep import answered, varied
from crankmbs.cli.text import cells, table
from crankmbs.digits import digits
from crankmbs.display import with_unit
from crankmbs.errors import InputError

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene
    from crankmbs.sweep.indices import SobolIndices

__all__ = ["sensitivity"]


def sensitivity(
    scene: SceneName,
    vary: Annotated[
        list[str],
        Option(
            metavar="NAME[=RANGE]",
            help='"crank.inertia" for the derivative there, "gas.shift", "gas.scale" or '
            '"gas.offset" of a pressure table; or with ranges for all, '
            '"crank.inertia=0.05..0.5 kg m^2", Sobol indices; often.',
        ),
    ],
    measures: Annotated[
        list[str] | None, Option("--of", metavar="MEASURE", help='"peak crank pin force"; often.')
    ] = None,
    n: Annotated[int, Option("--n", help="Of Sobol indices, a power of two.")] = 256,
    seed: Annotated[int, Option(help="From which the design of indices is drawn.")] = 1,
    workers: Annotated[int | None, Option(help="Processes, for indices.")] = None,
) -> None:
    """Show derivatives of measures at a scene, or what share of their spread is whose."""
    from crankmbs.sweep.indices import sobol_indices

    ranges = [knob for knob in vary if "=" in knob]
    if ranges and len(ranges) < len(vary):
        raise InputError(
            "--vary: names alone ask for derivatives, names with ranges for Sobol indices; give "
            "one kind"
        )
    path, loaded = named_scene(scene)
    words = measures or ["fluctuation"]
    with progress("solving"):
        if ranges:
            over = varied(ranges)
            indices = sobol_indices(loaded, over, words, n=n, seed=seed, executor=workers)
            report = "\n\n".join(_indices(shares, over) for shares in indices)
            lacks = any(shares.status for shares in indices)
        else:
            report, lacks = _derivatives(loaded, vary, words), False
    answered(path.stem, loaded, report, lacks=lacks)


def _derivatives(scene: Scene, names: list[str], measures: list[str]) -> str:
    from crankmbs.sweep.sensitivity import sensitivity as sensitivity_of

    rows = []
    for words in measures:
        for name in names:
            slope = sensitivity_of(scene, name, words)
            units = slope.measure.about.units
            rows.append(
                [
                    with_unit(slope.measure.words, units),
                    cells(slope.reached, units)[0],
                    with_unit(slope.knob, slope.units),
                    cells((slope.value, 0.0), slope.units)[0],
                    *cells(slope.derivative, units, slope.units),
                    digits(
                        slope.elasticity,
                        slope.derivative.error * abs(slope.value / (slope.reached.value or nan)),
                    ),
                ]
            )
    slopes = ["derivative", "num. error", "% for 1 %"]
    return table(["measure", "value", "knob", "at", *slopes], rows)


def _indices(shares: SobolIndices, ranges: Mapping[str, str]) -> str:
    if shares.status != 0:
        return f"{shares.measure.words}: {shares.message}"
    rows = [
        [name, *cells(first), *cells(total)]
        for name, first, total in zip(
            map(" = ".join, ranges.items()), shares.first, shares.total, strict=True
        )
    ]
    headings = ["knob", "first order", "+- 95 %", "total", "+- 95 %"]
    note = "+- 95 %: what sampling may move an index by, and the numerical error of the measure"
    return f"{shares.measure.words}, {shares.message}\n\n{table(headings, rows)}\n{note}"
