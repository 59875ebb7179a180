"""The command ``solve``: what a knob has to be so that a measure is what is wanted, or least."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from typer import Option

from crankmbs.cli.options import SceneName, named_scene
from crankmbs.cli.progress import progress
from crankmbs.cli.sweep import answered, varied
from crankmbs.cli.text import cells, table
from crankmbs.display import displayed, with_unit
from crankmbs.errors import InputError

if TYPE_CHECKING:
    from crankmbs.sweep.minimize import Minimum
    from crankmbs.sweep.reading import Reading
    from crankmbs.sweep.solve import Solved

__all__ = ["solve"]


def solve(
    scene: SceneName,
    vary: Annotated[
        list[str], Option(metavar="NAME=RANGE", help='Such as "crank.inertia=0.05..0.5 kg m^2".')
    ],
    condition: Annotated[
        str | None, Option("--for", metavar="CONDITION", help='"fluctuation = 1 %".')
    ] = None,
    least: Annotated[
        str | None, Option("--minimize", metavar="MEASURE", help='"peak crank pin force".')
    ] = None,
    subject_to: Annotated[
        list[str] | None,
        Option(metavar="CONDITION", help='With --minimize, "fluctuation <= 2 %"; often.'),
    ] = None,
) -> None:
    """Find the value with which a measure is what is wanted, or values with which it is least."""
    from crankmbs.sweep.minimize import minimize
    from crankmbs.sweep.solve import solve as solved

    if (condition is None) == (least is None) or (subject_to and least is None):
        raise InputError(
            'give --for "fluctuation = 1 %" or --minimize "peak crank pin force", the latter '
            'perhaps with --subject-to "fluctuation <= 2 %"'
        )
    path, loaded = named_scene(scene)
    ranges = varied(vary)
    with progress("solving"):
        if condition is not None:
            answer = solved(loaded, ranges, condition)
            status, report = answer.status, _roots(answer)
        else:
            lowest = minimize(loaded, ranges, str(least), subject_to or [])
            status, report = lowest.status, _minimum(lowest)
    answered(path.stem, loaded, report, lacks=status != 0)


def _roots(answer: Solved) -> str:
    measure = _named(answer.measure)
    headings = [with_unit(answer.knob, answer.units), "num. error", measure, "num. error"]
    roots = answer.roots or ((answer.nearest,) if answer.nearest else ())
    of = answer.measure.about.units
    rows = [[*cells(root.value, answer.units), *cells(root.reached, of)] for root in roots]
    message = answer.message if answer.roots else f"{answer.message}; the nearest of those tried:"
    return f"{message}\n\n{table(headings, rows)}" if rows else answer.message


def _minimum(answer: Minimum) -> str:
    rows = [
        [with_unit(name, of), cells((value, 0.0), of)[0], "", ""]
        for name, value in answer.values.items()
        for of in (answer.units[name],)
    ]
    rows.append([_named(answer.measure), *cells(answer.reached, answer.measure.about.units), ""])
    rows += [
        [
            _named(condition.measure),
            *cells(condition.reached, of),
            f"{condition.sign} {condition.bound / displayed(of)[0]:.6g}",
        ]
        for condition in answer.conditions
        for of in (condition.measure.about.units,)
    ]
    message = f"{answer.message}; {answer.evaluations} runs"
    headings = [f"minimum of {answer.measure.words}", "value", "num. error", ""]
    return f"{message}\n\n{table(headings, rows)}"


def _named(reading: Reading) -> str:
    return with_unit(reading.words, reading.about.units)
