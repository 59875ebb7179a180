"""The command ``sensitivity``: how much measures change with knobs of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from crankmbs.cli.options import SceneName
from crankmbs.cli.progress import progress
from crankmbs.cli.sweep import varied
from crankmbs.cli.text import cells, table, with_unit
from crankmbs.digits import digits
from crankmbs.errors import InputError

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene
    from crankmbs.sweep.indices import SobolIndices

__all__ = ["sensitivity"]


def sensitivity(
    scene: SceneName,
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="NAME[=RANGE]",
            help='"crank.inertia" for the derivative there, "gas.shift", "gas.scale" or '
            '"gas.offset" of a pressure table; or with ranges for all, '
            '"crank.inertia=0.05..0.5 kg m^2", Sobol indices; often.',
        ),
    ],
    measures: Annotated[
        list[str] | None,
        typer.Option("--of", metavar="MEASURE", help='"peak crank pin force"; often.'),
    ] = None,
    n: Annotated[int, typer.Option("--n", help="Of Sobol indices, a power of two.")] = 256,
    seed: Annotated[int, typer.Option(help="From which the design of indices is drawn.")] = 1,
    workers: Annotated[int | None, typer.Option(help="Processes, for indices.")] = None,
) -> None:
    """Show derivatives of measures at a scene, or what share of their spread is whose."""
    from crankmbs.scene.read import load_scene, scene_path
    from crankmbs.sweep.indices import sobol_indices

    ranges = [one for one in vary if "=" in one]
    if ranges and len(ranges) < len(vary):
        raise InputError(
            "--vary: names alone ask for derivatives, names with ranges for Sobol indices; give "
            "one kind"
        )
    path = scene_path(scene)
    loaded, wanted = load_scene(path), measures or ["fluctuation"]
    title = f"{path.stem}: {loaded.title}" if loaded.title else path.stem
    with progress("solving"):
        if ranges:
            found = sobol_indices(loaded, varied(ranges), wanted, n=n, seed=seed, executor=workers)
            said = "\n\n".join(_indices(one) for one in found)
            lacks = any(one.status for one in found)
        else:
            said, lacks = _derivatives(loaded, vary, wanted), False
    typer.echo(f"{title}\n\n{said}")
    if lacks:
        raise typer.Exit(3)


def _derivatives(scene: Scene, names: list[str], measures: list[str]) -> str:
    from crankmbs.sweep.sensitivity import sensitivity as sensitivity_of

    rows = []
    for words in measures:
        for name in names:
            one = sensitivity_of(scene, name, words)
            rows.append(
                [
                    with_unit(one.measure.words, one.measure.about.units),
                    with_unit(one.knob, one.units),
                    *cells(one.derivative, one.measure.about.units, one.units),
                    digits(
                        one.elasticity, one.derivative.error * abs(one.value / one.reached.value)
                    ),
                ]
            )
    return table(["measure", "knob", "derivative", "num. error", "% for 1 %"], rows)


def _indices(found: SobolIndices) -> str:
    if found.status != 0:
        return f"{found.measure.words}: {found.message}"
    rows = [
        [name, *cells(first), *cells(total)]
        for name, first, total in zip(found.knobs, found.first, found.total, strict=True)
    ]
    heading = ["knob", "first order", "num. error", "total", "num. error"]
    return f"{found.measure.words}, {found.message}\n\n{table(heading, rows)}"
