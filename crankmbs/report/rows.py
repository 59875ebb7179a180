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
from crankmbs.display import displayed
from crankmbs.measures import Estimate, JointForce, Measures
from crankmbs.measures.peaks import Peak, run_peaks, torque_of_rods
from crankmbs.measures.span import TURNS_BACK
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = [
    "FORCE_HEADINGS",
    "Table",
    "degrees_within",
    "measure_rows",
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
_MPA = 1e6  # Pa in N/mm2
_SAME = 1e-9  # of the stroke: no more than rounding


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
    window, scene, parts = measures.window.kind, result.scene, []
    if window != TURNS_BACK:
        rows = measure_rows(measures, scene)
        parts.append(Table([f"over the {window}", "value, to 6 digits", _ERROR], rows))
    if not measures.steady:
        motion = result.passes.answer
        name = f"over {_part(result)}, {motion.begin:.6g} to {motion.end:.6g} s"
        return [*parts, Table([name, *_WHOLE_RUN], _of_run(run_peaks(result), scene))]
    parts.append(Table([f"over the {window}", *FORCE_HEADINGS], peak_rows(measures, scene.period)))
    specific = _specific(measures)
    if specific:
        name = f"specific load over the {window} [N/mm2]"
        parts.append(Table([name, "peak", _ERROR, "mean", _ERROR], specific))
    return parts


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
    if measures.steady:
        return ""
    peaks = f"peaks are of {_part(result)}"
    if measures.window.kind == TURNS_BACK:
        return f"not periodic: the crank rests or turns back; {peaks}"
    scale, unit = displayed("rad/s")
    drift = measures.speed_gain.value / scale
    return (
        f"not periodic: the speed changes by {drift:+.3g} {unit} over the {measures.window.kind}; "
        f"{peaks}"
    )


def measure_rows(measures: Measures, scene: Scene) -> list[list[str]]:
    """Name with unit, value, error, of each measure over the window but peaks; what means nothing
    where the speed is not periodic is left out.

    >>> scene = load_scene("yi_diesel")
    >>> measure_rows(simulate(scene).measures(), scene)[0][:2]
    ['mean speed [rpm]', '3200.00']
    """
    rows = [
        _row("mean speed", "rad/s", measures.mean_speed),
        *_piston_speeds(measures.mean_speed, scene),
    ]
    if measures.steady:
        rows.append(_row("coefficient of fluctuation, (max - min)/mean", "1", measures.fluctuation))
    rows += [
        _row(f"drift of the speed over the {measures.window.kind}", "rad/s", measures.speed_gain),
        _row(f"mean {torque_of_rods(scene)}", "N m", measures.crank_torque),
        _row("mean load torque (drive, where positive)", "N m", measures.external_torque),
    ]
    if measures.indicated_power is not None:
        rows.append(_row("indicated power", "W", measures.indicated_power))
    if measures.friction_power is not None:
        rows.append(_row("mechanical losses, friction of pistons", "W", measures.friction_power))
    if measures.force_power is not None:
        rows.append(_row("power of the forces on the pistons", "W", measures.force_power))
    for end in ("head_end", "crank_end"):
        power = getattr(measures, f"indicated_power_{end}")
        if power is not None:
            rows.append(_row(f"indicated power, {end.replace('_', ' ')}", "W", power))
    if scene.gas is not None or measures.friction_power or measures.force_power:
        power = measures.power
        brakes = power.value < 0.0
        name = "brake power" if brakes else "drive power"
        rows.append(_row(name, "W", Estimate(abs(power.value), power.error)))
    if measures.mechanical_efficiency is not None and measures.steady:
        rows.append(_row("mechanical efficiency", "1", measures.mechanical_efficiency))
    double = measures.imep_crank_end is not None
    return [
        *rows,
        *_pressures(measures.imep or (), ", head end" if double else ""),
        *_pressures(measures.imep_crank_end or (), ", crank end"),
    ]


def _pressures(pressures: tuple[Estimate, ...], end: str) -> list[list[str]]:
    """The mean effective pressures of the cylinders."""
    name, many = "indicated mean effective pressure", len(pressures) > 1
    return [
        _row(f"{name}{end}{f', cylinder {number}' if many else ''}", "Pa", imep)
        for number, imep in enumerate(pressures, start=1)
    ]


def peak_rows(measures: Measures, period: float) -> list[list[str]]:
    """Name and the cells under `FORCE_HEADINGS` of each joint's force, then of torque and
    pressures; period [rad] : the engine's."""
    joints = Counter(joint.joint for joint in measures.joints)
    peaks = Counter(peak.name for peak in measures.peaks)
    rows = [
        [
            _named(_words(joint), joint.number, joints[joint.joint], "N"),
            *_cells("N", joint.peak),
            *_angles(joint.crank_angle, joint.cycle_angle, period),
            *_cells("N", joint.mean),
        ]
        for joint in measures.joints
    ]
    for top in measures.peaks:
        name = _named(top.name, top.number, peaks[top.name], top.units)
        angles = _angles(top.crank_angle, top.cycle_angle, period)
        rows.append([name, *_cells(top.units, top.value), *angles, "", ""])
    return rows


def degrees_within(angle: float, period: float) -> str:
    """An angle within one period, in degrees."""
    return f"{round(math.degrees(angle), 3) % round(math.degrees(period)):.6g}"


def _of_run(peaks: tuple[Peak, ...], scene: Scene) -> list[list[str]]:
    """The cells under `_WHOLE_RUN`; cycles count from 1 at the start, in either sense."""
    counts = Counter(peak.name for peak in peaks)
    start = scene.start or scene.motion
    assert start is not None
    return [
        [
            _named(_words(top), top.number, counts[top.name], top.units),
            *_cells(top.units, top.value),
            f"{top.time:.6g}",
            *_angles(top.crank_angle, top.cycle_angle, scene.period),
            str(int(abs(top.crank_angle - start.angle) / scene.period) + 1),
        ]
        for top in peaks
    ]


def _specific(measures: Measures) -> list[list[str]]:
    """Of each joint with a shell: name, peak and mean with their errors."""
    counts = Counter(joint.joint for joint in measures.joints)
    return [
        [
            _named(joint.joint, joint.number, counts[joint.joint], "1"),
            *(
                cell
                for estimate in (joint.specific_peak, joint.specific_mean)
                if estimate is not None
                for cell in _both(estimate, _MPA)
            ),
        ]
        for joint in measures.joints
        if joint.area is not None
    ]


def _piston_speeds(speed: Estimate, scene: Scene) -> list[list[str]]:
    """Twice the stroke a revolution, of cylinders of unlike strokes each [m/s]."""
    strokes = [gear.stroke for gear in scene.running_gear]
    alike = max(strokes) - min(strokes) <= _SAME * max(strokes)
    rows = []
    for number, stroke in enumerate(strokes[:1] if alike else strokes, start=1):
        per_radian = stroke / math.pi
        mean = Estimate(abs(speed.value) * per_radian, speed.error * per_radian)
        name = "mean piston speed" + ("" if alike else f", cylinder {number}")
        rows.append(_row(name, "m/s", mean))
    return rows


def _words(load: JointForce | Peak) -> str:
    name = load.joint if isinstance(load, JointForce) else load.name
    return "|side force|" if name == "side force" else name


def _named(name: str, number: int | None, count: int, units: str) -> str:
    number_of = f" {number}" if number is not None and count > 1 else ""
    unit = f" [{displayed(units)[1]}]" if units != "1" else ""
    return f"{name}{number_of}{unit}"


def _row(name: str, units: str, estimate: Estimate) -> list[str]:
    return [_named(name, None, 1, units), *_cells(units, estimate)]


def _cells(units: str, estimate: Estimate) -> list[str]:
    return _both(estimate, displayed(units)[0])


def _both(estimate: Estimate, scale: float) -> list[str]:
    value, error = estimate.value / scale, estimate.error / scale
    return [digits(value, error), error_digits(error)]


def _angles(crank: float, cycle: float | None, period: float) -> list[str]:
    return [degrees_within(crank, period), "" if cycle is None else degrees_within(cycle, period)]
