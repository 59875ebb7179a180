"""What ``run`` prints."""

from __future__ import annotations

import math
import sys
import textwrap
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.cli.text import heading, table
from crankmbs.digits import digits, error_digits
from crankmbs.measures import Measures
from crankmbs.measures.plausible import warnings
from crankmbs.report.machine import journal_remarks
from crankmbs.report.rows import cycle_remark, degrees_within, tables, unsteady
from crankmbs.result import Result
from crankmbs.scene.drives import SpeedFile
from crankmbs.scene.units import RPM

if TYPE_CHECKING:
    from crankmbs.compare.confirm import Confirmation

__all__ = ["comparison", "report"]


_FORCES = (
    "joint forces are magnitudes, the main bearing's that of the sum of all main journals; their "
    'components are in motion.csv, at one angle by --at "60 deg". Means of forces are over time, '
    "of torques over the angle"
)


def report(name: str, result: Result, measures: Measures) -> str:
    """The run in words, then its measures, peaks and specific loads as tables."""
    parts = [
        f"{heading(name, result.scene.title)}\n",
        _about(result, measures),
        *(f"{'warning':<12} {remark}" for remark in warnings(result.scene)),
    ]
    for rows in tables(result, measures):
        parts += ["", table(*rows)]
    remarks = [_FORCES, *journal_remarks(result.scene)]
    parts += [textwrap.fill(remark, 100) for remark in remarks]
    return "\n".join(parts)


def comparison(result: Result, confirmation: Confirmation) -> str:
    """What exudyn's rigid bodies say of a run: the answer, and the differences behind it."""
    several = result.data.sizes["cylinder"] > 1
    headings = [
        "over the last cycle",
        "largest",
        "at crank angle [deg]",
        "num. error run",
        "num. error exudyn",
    ]
    lines = []
    for row in confirmation.period:
        largest, sample, column = row.largest
        cylinder = f" {column + 1}" if several and row.size.shape[1] > 1 else ""
        angle = degrees_within(float(row.crank_angle[sample]), result.scene.period)
        numbers = [error_digits(size) for size in (largest, *row.errors)]
        name = f"{row.quantity}{cylinder} [{row.units}]"
        lines.append([name, numbers[0], angle, *numbers[1:]])
    return "\n".join(
        [
            "",
            confirmation.sentence,
            *([] if not lines else ["", table(headings, lines), ""]),
            f"at {len(confirmation.states[0].size)} states of the run accelerations and joint "
            f"forces agree to {confirmation.at_states:.0e} of the peak",
            "errors that build up over the whole run are not seen by this; run with --formulation "
            "minimal to check them",
            *confirmation.missing,
        ]
    )


_FIRST = 5  # events that are printed
_EVENT_HEADINGS = ["event", "time [s]", "crank angle [deg]", "crank speed [rpm]"]


def _about(result: Result, measures: Measures) -> str:
    time, angle, speed = map(result.sampled, ("time", "crank_angle", "crank_speed"))
    turned, cost = (angle[-1] - angle[0]) / (2.0 * math.pi), result.cost
    last = "last period" if measures.window.kind == "last period" else "last cycle"
    extent = "" if result.scene.run.every is not None else f"; only the {last} is kept"
    sense = ", backwards" if turned < 0.0 else ""
    samples = f"{len(time)}, {time[0]:.6g} to {time[-1]:.6g} s, {turned:.6g} rev{sense}{extent}"
    return "\n".join(
        [
            *(
                f"{'formulation' if k == 0 else '':<12} {text}"
                for k, text in enumerate([result.formulation, *result.reasons])
            ),
            f"{'end':<12} {result.message}",
            f"{'samples':<12} {samples}",
            f"{'last sample':<12} {math.degrees(angle[-1]):.6g} deg, {speed[-1] / RPM:.6g} rpm",
            *([f"{'cycle':<12} {remark}"] if (remark := cycle_remark(result.scene)) else []),
            *([f"{'speed':<12} {fault}"] if (fault := unsteady(result, measures)) else []),
            *_events(result),
            _error_line(result),
            f"{'energy':<12} closes to {_closure(measures)}",
            f"{'cost':<12} {digits(cost.wall_time, most=2)} s of computing, "
            f"{cost.evaluations} evaluations, {cost.steps} steps",
        ]
    )


def _events(result: Result) -> list[str]:
    """How many events there are, and the first of them; of decisions on the fuel only the first
    and the last firing, or all where they are all there is."""
    from crankmbs.result.event_words import did_not_fire, marks

    events = result.event_table
    fuel = events.values("kind") == "fuel"
    count, left_out = fuel.size, events.left_out
    if count == 0 and not left_out:
        return []
    decided = f", {np.count_nonzero(fuel)} of them decisions on the fuel" if fuel.any() else ""
    said = [f"{'events':<12} {count}{decided}{'; ' if left_out else ''}{left_out}"]
    columns = ("time", "crank_angle", "crank_speed", "text")
    rows = [(*mark[:3], mark.text) for mark in marks(result)]
    rows = rows or list(zip(*(events.values(name).tolist() for name in columns), strict=True))
    lines = [
        [text, *(f"{x:.6g}" for x in (time, math.degrees(angle), speed / RPM))]
        for time, angle, speed, text in rows[:_FIRST]
    ]
    shown = table(_EVENT_HEADINGS, lines).splitlines() if lines else []
    shown += ["... the others are in events.csv"] if len(rows) > _FIRST else []
    said += [f"{'':<12} {line}" for line in shown]
    if did_not_fire(result):
        why = "the crank reached no firing dead centre with fuel"
        said.append(f"{'fuel':<12} the engine did not fire: {why}")
    return said


def _closure(measures: Measures) -> str:
    share, rounding = measures.energy_closure, sys.float_info.epsilon
    return "rounding" if share < rounding else f"{share:.1e} of the peak kinetic energy"


def _error_line(result: Result) -> str:
    error, (gas, motion) = result.error, (result.scene.gas, result.scene.motion)
    given = [
        *(["pressures"] if gas is not None and gas.tables else []),
        *(["speed"] if motion is not None and isinstance(motion.speed, SpeedFile) else []),
    ]
    alone = f"; errors of the given {' and '.join(given)} are not in it" if given else ""
    return f"{'num. error':<12} {error.estimated:.1e} relative, {error.asked:.0e} asked for{alone}"
