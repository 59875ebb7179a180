"""The measures of a run as tables of words and numbers, each with its error.

One rule for all of them: over a window in which the speed is periodic stand measures and peaks of
that window. Where it is not, what needs a periodic speed is left out, and peaks are those of the
whole run, with their time.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import NamedTuple

from crankmbs.digits import digits, error_digits
from crankmbs.display import displayed, with_unit
from crankmbs.measures import Estimate, Measures
from crankmbs.measures.names import Named, names_of, signless, values_of
from crankmbs.measures.peaks import Peak, run_peaks
from crankmbs.measures.span import TURNS_BACK
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = [
    "FORCE_HEADINGS",
    "Table",
    "cycle_remark",
    "degrees_within",
    "labelled",
    "meaningless",
    "measure_rows",
    "measure_tables",
    "not_periodic",
    "peak_rows",
    "tables",
    "unsteady",
]

_ERROR = "num. error"
FORCE_HEADINGS = [
    "peak",
    _ERROR,
    "crank angle [deg]",
    "cycle angle [deg]",
    "mean",
    _ERROR,
]
_WHOLE_RUN = [
    "largest",
    _ERROR,
    "at time [s]",
    "crank angle [deg]",
    "cycle angle [deg]",
    "cycle",
]
_NO_TIME = 1e-6  # of the latest peak: the begin of the run
_SAME = 1e-9  # of a piston speed: no more than rounding
_IMEP = "imep", "imep_crank_end"
_FEWEST_CYCLES = 4  # two or three stand in cycles.csv
_CLEARLY = 0.01  # of the largest mean speed or pressure


class Table(NamedTuple):
    """Headings and rows of words."""

    headings: list[str]
    rows: list[list[str]]


def tables(result: Result, measures: Measures) -> list[Table]:
    """The tables of a run: measures, peaks, and specific loads of bearings with shells.

    >>> result = simulate(load_scene("torque_driven"))
    >>> [table.headings[0] for table in tables(result, result.measures())]
    ['over the last cycle', 'over the whole run, 0 to 1 s']
    """
    if measures.steady:
        return [*measure_tables(measures), *_over_cycles(result)]
    parts = measure_tables(measures)[:1] if measures.window.kind != TURNS_BACK else []
    motion = result.passes.answer
    name = f"over {_part(result)}, {motion.begin:.6g} to {motion.end:.6g} s"
    peaks = Table([name, *_WHOLE_RUN], _of_run(run_peaks(result), result.scene))
    return [*parts, peaks, *_over_cycles(result)]


def _over_cycles(result: Result) -> list[Table]:
    """What differs clearly from cycle to cycle: the least and the largest, and in which they are;
    beside them the extremes of the speed."""
    if result.keep is None or result.cycle_table.length < _FEWEST_CYCLES:
        return []
    cycles, names = result.cycle_table, names_of(result.scene)
    number, rows = cycles.values("cycle"), []
    for words, units, least, largest in (
        ("mean speed", "rad/s", "mean_speed", "mean_speed"),
        *((names[name].words, "Pa", name, name) for name in _IMEP if name in cycles.variables),
        ("crank speed", "rad/s", "least_speed", "largest_speed"),
    ):
        error = float(cycles.variables[largest][2]["error_estimate"])
        low, high = (cycles.values(name).reshape(len(number), -1).T for name in (least, largest))
        for k, pair in enumerate(zip(low, high, strict=True), start=1):
            ends = int(pair[0].argmin()), int(pair[1].argmax())
            bounds = [float(one[end]) for one, end in zip(pair, ends, strict=True)]
            if least == largest and bounds[1] - bounds[0] <= _CLEARLY * max(map(abs, bounds)):
                continue
            name = with_unit(f"{words}, cylinder {k}" if len(low) > 1 else words, units)
            ((lowest, apart), (highest, _)) = (_cells(units, Estimate(x, error)) for x in bounds)
            places = [str(number[end]) for end in ends]
            rows.append([name, lowest, places[0], highest, places[1], apart])
    name = f"over cycles {number[0]} to {number[-1]}"
    headings = [name, "least", "in cycle", "largest", "in cycle", _ERROR]
    return [Table(headings, rows)] if len(rows) > 1 else []


def measure_tables(measures: Measures) -> list[Table]:
    """Measures, peaks and specific loads over the window, steady or not.

    >>> tables = measure_tables(simulate(load_scene("torque_driven")).measures())
    >>> [table.headings[0] for table in tables]
    ['over the last cycle', 'over the last cycle']
    """
    window = f"over the {measures.window.kind}"
    # over cycles that differ there stands in which each is, before its mean
    headings = FORCE_HEADINGS[:4] + ["cycle"] * _differ(measures) + FORCE_HEADINGS[4:]
    parts = [
        Table([window, "value, to 6 digits", _ERROR], measure_rows(measures)),
        Table([window, *headings], peak_rows(measures)),
    ]
    if specific := _specific(measures):
        name = f"specific load {window} [N/mm^2]"
        parts.append(Table([name, "peak", _ERROR, "mean", _ERROR], specific))
    return parts


def _differ(measures: Measures) -> bool:
    """Whether a window holds several cycles, which differ."""
    return measures.window.kind == "last period"


def _part(result: Result) -> str:
    """Of what peaks are where the motion is not periodic."""
    kept = result.passes.answer.begin == 0.0
    return "the whole run" if kept else "what is kept of the run"


def unsteady(result: Result, measures: Measures) -> str:
    """Why peaks are not those of the window, in a sentence; nothing where they are.

    >>> result = simulate(load_scene("propeller"))
    >>> unsteady(result, result.measures())
    ''
    """
    why = not_periodic(measures)
    return f"{why}; peaks are of {_part(result)}" if why else ""


def cycle_remark(scene: Scene) -> str:
    """What a cycle is in a machine without gas, in words; nothing with gas.

    >>> cycle_remark(load_scene("propeller"))
    ''
    """
    if scene.gas is not None:
        return ""
    return (
        'two turns, 720 deg, in a machine without gas; an end such as "10 rev" counts single turns'
    )


def not_periodic(measures: Measures) -> str:
    """Why a window does not stand for the cycles after it; nothing where it does.

    >>> not_periodic(simulate(load_scene("torque_driven")).measures())
    'not periodic: the speed changes by +131 rpm over the last cycle'
    """
    if measures.steady:
        return ""
    if not measures.moves_on:
        return "not periodic: the crank rests or turns back"
    scale, unit = displayed("rad/s")
    drift = measures.speed_gain.value / scale
    return f"not periodic: the speed changes by {drift:+.3g} {unit} over the {measures.window.kind}"


def meaningless(measures: Measures) -> set[str]:
    """Names of measures that mean nothing over a window, where the speed is not periodic.

    >>> meaningless(simulate(load_scene("propeller")).measures())
    set()
    """
    return set() if measures.steady else {"fluctuation", "mechanical_efficiency"}


def measure_rows(measures: Measures) -> list[list[str]]:
    """Name with unit, value, error, of each measure over the window but peaks; what means nothing
    where the speed is not periodic is left out.

    >>> measure_rows(simulate(load_scene("yi_diesel")).measures())[0][:2]
    ['mean speed [rpm]', '3200.00']
    """
    names, rows = names_of(measures.scene), []
    left_out = meaningless(measures)
    for name, estimates in values_of(measures).items():
        if name == "main_bearing_peak":  # the first of the peaks
            break
        if name not in left_out:
            rows += _rows(measures, name, names[name], estimates)
    return rows


def _rows(
    measures: Measures, name: str, about: Named, estimates: tuple[Estimate, ...]
) -> list[list[str]]:
    """One measure: of cylinders that all have the same piston speed it stands once."""
    words = about.words
    if name == "speed_gain":
        words += f" over the {measures.window.kind}"
    if name == "brake_power":
        ((power, error),) = estimates
        words = "brake power" if power > 0.0 else "drive power"
        estimates = (Estimate(abs(power), error),)
    if name == "kinetic_power" and abs(estimates[0].value) <= estimates[0].error:
        return []
    if name == "piston_speed":
        low, high = min(estimates).value, max(estimates).value
        estimates = estimates[:1] if high - low <= _SAME * high else estimates
    many = len(estimates) > 1
    return [
        [
            with_unit(f"{words}, cylinder {number}" if many else words, about.units),
            *_cells(about.units, estimate),
        ]
        for number, estimate in enumerate(estimates, start=1)
    ]


def peak_rows(measures: Measures) -> list[list[str]]:
    """Name and the cells under the headings of each joint's force, then of torque, pressures and
    speed."""
    scene, differ = measures.scene, _differ(measures)
    joints = Counter(joint.joint for joint in measures.joints)
    peaks = Counter(peak.name for peak in measures.peaks)
    rows = [
        [
            labelled(signless(joint.joint), joint.number, joints[joint.joint], "N"),
            *_cells("N", joint.peak),
            *_angles(joint.crank_angle, joint.cycle_angle, scene.period),
            *[_cycle(joint.crank_angle, scene)] * differ,
            *_cells("N", joint.mean),
        ]
        for joint in measures.joints
    ]
    for top in measures.peaks:
        name = labelled(signless(top.name), top.number, peaks[top.name], top.units)
        angles = _angles(top.crank_angle, top.cycle_angle, scene.period)
        angles += [_cycle(top.crank_angle, scene)] * differ
        rows.append([name, *_cells(top.units, top.value), *angles, "", ""])
    return rows


def degrees_within(angle: float, period: float) -> str:
    """An angle within one period, in degrees."""
    return f"{round(math.degrees(angle), 3) % round(math.degrees(period)):.6g}"


def _of_run(peaks: tuple[Peak, ...], scene: Scene) -> list[list[str]]:
    """The cells under `_WHOLE_RUN`."""
    counts = Counter(peak.name for peak in peaks)
    least = _NO_TIME * max(peak.time for peak in peaks)
    return [
        [
            labelled(signless(top.name), top.number, counts[top.name], top.units),
            *_cells(top.units, top.value),
            f"{top.time:.6g}" if top.time > least else "0",
            *_angles(top.crank_angle, top.cycle_angle, scene.period),
            _cycle(top.crank_angle, scene),
        ]
        for top in peaks
    ]


def _cycle(crank_angle: float, scene: Scene) -> str:
    """The number of a cycle, from 1 at the start, in either sense."""
    start = scene.start or scene.motion
    assert start is not None
    return str(int(abs(crank_angle - start.angle) / scene.period) + 1)


def _specific(measures: Measures) -> list[list[str]]:
    """Of each joint with a shell: name, peak and mean with their errors."""
    counts = Counter(joint.joint for joint in measures.joints)
    return [
        [
            labelled(joint.joint, joint.number, counts[joint.joint], "1"),
            *(
                cell
                for estimate in (joint.specific_peak, joint.specific_mean)
                if estimate is not None
                for cell in _cells("N/m^2", estimate)
            ),
        ]
        for joint in measures.joints
        if joint.area is not None
    ]


def labelled(name: str, number: int | None, count: int, units: str) -> str:
    """A name, its number where there are many, and the unit that people read.

    >>> labelled("crank pin", 2, 4, "Pa")
    'crank pin 2 [bar]'
    """
    numbered = number is not None and count > 1
    return with_unit(f"{name} {number}" if numbered else name, units)


def _cells(units: str, estimate: Estimate) -> list[str]:
    scale = displayed(units)[0]
    value, error = estimate.value / scale, estimate.error / scale
    value = value if abs(value) > error or math.isinf(error) else 0.0
    return [digits(value, error), error_digits(error)]


def _angles(crank: float, cycle: float | None, period: float) -> list[str]:
    return [degrees_within(crank, period), "" if cycle is None else degrees_within(cycle, period)]
