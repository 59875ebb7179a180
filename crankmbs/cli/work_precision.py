"""The command ``work-precision``: speed against error, as tables, a CSV file and a figure."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from typer import Exit, echo

from crankmbs.cli.folder import results_folder, wrote
from crankmbs.cli.options import Out, SceneName, named_scene
from crankmbs.cli.progress import progress
from crankmbs.cli.text import heading, table
from crankmbs.digits import error_digits
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.work_precision import Beside, Row, WorkPrecision

__all__ = ["measure_scene", "work_precision"]


def work_precision(scene: SceneName, out: Out = None) -> None:
    """Measure speed against error of every formulation that serves the scene."""
    if not measure_scene(scene, out=out):
        raise Exit(3)


def measure_scene(name: str, *, out: Path | None, beside: Beside | None = None) -> bool:
    """Compare what can serve a scene, print and write it; return whether the scene reached its end.

    Parameters
    ----------
    out : folder of the results; None: results/NAME
    beside : what else takes its turns, as in `work_precision`

    Raises
    ------
    CrankmbsError : bad scene or folder; before anything runs
    """
    from crankmbs.work_precision import save_work_precision, work_precision

    path, scene = named_scene(name)
    folder = results_folder(path, out)
    with progress("speed against error"):
        outcome = work_precision(scene, beside)
    with together(folder) as part, progress("figure"):  # before anything is printed
        from crankmbs.figures.work_precision import save_figure  # matplotlib only when it is used

        written = [save_work_precision(outcome, part), save_figure(outcome, part)]
    echo(f"{heading(path.stem, scene.title)}\n\n{_errors(outcome)}\n")
    if scene.motion is None:  # a prescribed motion is exact in all of them
        echo(f"{_times(outcome)}\n")
    for sentence in _sentences(outcome):
        echo(textwrap.fill(sentence, 100, subsequent_indent="  "))
    echo(f"\n{wrote(folder, [file.name for file in written])}")
    return outcome.reference.result.status == 0


def _errors(outcome: WorkPrecision) -> str:
    """A line for every contender at every setting."""
    names = outcome.quantities
    headings = ["relative error", "setting", "stated", *names, "time [ms]", "runs", "evaluations"]
    floors = outcome.reference.floors
    rows = [
        [row.contender, f"{row.knob} {row.setting:g}", *_numbers(row, floors)]
        for row in outcome.rows
    ]
    of_reference = [error_digits(floors[name]) for name in names]
    return table(headings, [*rows, ["reference itself", "", "", *of_reference, "", "", ""]])


def _numbers(row: Row, floors: dict[str, float]) -> list[str]:
    errors = [_error(row.errors.get(name), floor) for name, floor in floors.items()]
    costs = [_milliseconds(row.time), str(len(row.times)), str(row.evaluations)]
    return [_error(row.stated), *errors, *costs]


def _times(outcome: WorkPrecision) -> str:
    """Least time of a setting that keeps the state at the end within an error."""
    from crankmbs.work_precision import TARGETS

    headings = ["time [ms] to an end within", *(f"{target:g}" for target in TARGETS)]
    return table(
        headings,
        [
            [name, *(_milliseconds(outcome.time_to(name, target)) for target in TARGETS)]
            for name in outcome.contenders
        ],
    )


def _sentences(outcome: WorkPrecision) -> list[str]:
    return [
        f"reference: {outcome.reference.sentence()}; smaller differences say nothing",
        "motion: crank angle per radian turned and speed over its peak, the worse; reactions: "
        "vectors, over their peak",
        "time: median wall time of rounds in which all take their turns; compilation and "
        "derivation are not in it",
        *outcome.notes,
        *outcome.machine,
    ]


def _error(value: float | None, floor: float = 0.0) -> str:
    """An error; one that the reference's own hides only as less than that."""
    if value is None:
        return ""
    return error_digits(value) if value >= floor else f"<{error_digits(floor)}"


def _milliseconds(time: float | None) -> str:
    return "-" if time is None else f"{time * 1e3:.3g}"
