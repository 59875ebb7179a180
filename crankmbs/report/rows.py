"""The measures of a run as rows of words and numbers, each with its error."""

from __future__ import annotations

import math
from collections import Counter

from crankmbs.digits import digits, error_digits
from crankmbs.measures import Estimate, JointForce, Measures
from crankmbs.scene.units import RPM

__all__ = [
    "FORCE_HEADINGS",
    "SPECIFIC_HEADINGS",
    "degrees_within",
    "force_rows",
    "measure_rows",
    "specific_rows",
]

FORCE_HEADINGS = [
    "joint force [N]",
    "peak",
    "error",
    "at crank angle [deg]",
    "cycle angle [deg]",
    "mean",
    "error",
]
SPECIFIC_HEADINGS = ["specific load [N/mm2]", "peak", "error", "mean", "error"]
_MPA = 1e6  # Pa in N/mm2


def measure_rows(measures: Measures) -> list[list[str]]:
    """Name with unit, value, error, of each measure but the joint forces.

    >>> measure_rows(simulate(load_scene("yi_diesel")).measures())[0][:2]
    ['mean speed [rpm]', '3200.00']
    """
    rows = [
        _value("mean speed [rpm]", measures.mean_speed, 1.0 / RPM),
        _value("coefficient of fluctuation, (max - min)/mean [1]", measures.fluctuation),
        _value("speed at its end less that at its beginning [rpm]", measures.speed_gain, 1.0 / RPM),
        _value("mean torque of the rods on the crank [N m]", measures.crank_torque),
        _value("mean torque from outside [N m]", measures.external_torque),
    ]
    if measures.indicated_power is not None:
        rows.append(_value("indicated power [kW]", measures.indicated_power, 1e-3))
    if measures.friction_power is not None:
        rows.append(_value("power of the pistons' friction [kW]", measures.friction_power, 1e-3))
    if measures.mechanical_efficiency is not None:
        rows.append(_value("mechanical efficiency [1]", measures.mechanical_efficiency))
    if measures.force_power is not None:
        rows.append(_value("power of the forces on the pistons [kW]", measures.force_power, 1e-3))
    for end in ("head_end", "crank_end"):
        power = getattr(measures, f"indicated_power_{end}")
        if power is not None:
            rows.append(_value(f"indicated power, {end.replace('_', ' ')} [kW]", power, 1e-3))
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
        _value(f"{name}{end}{f', cylinder {number}' if many else ''} [bar]", imep, 1e-5)
        for number, imep in enumerate(pressures, start=1)
    ]


def force_rows(measures: Measures, period: float) -> list[list[str]]:
    """The cells under `FORCE_HEADINGS` for each joint; period [rad] : the engine's."""
    counts = Counter(joint.joint for joint in measures.joints)
    return [_force(joint, period, counts[joint.joint] > 1) for joint in measures.joints]


def specific_rows(measures: Measures) -> list[list[str]]:
    """The cells under `SPECIFIC_HEADINGS` for each joint with a shell."""
    counts = Counter(joint.joint for joint in measures.joints)
    return [
        [
            _name(joint, counts[joint.joint] > 1),
            *(
                cell
                for one in (joint.specific_peak, joint.specific_mean)
                if one is not None
                for cell in (
                    digits(one.value / _MPA, one.error / _MPA),
                    error_digits(one.error / _MPA),
                )
            ),
        ]
        for joint in measures.joints
        if joint.area is not None
    ]


def degrees_within(angle: float, period: float) -> str:
    """An angle within one period, in degrees."""
    return f"{round(math.degrees(angle), 3) % round(math.degrees(period)):.6g}"


def _name(joint: JointForce, several: bool) -> str:
    return f"{joint.joint} {joint.number}" if several else joint.joint


def _value(name: str, estimate: Estimate, scale: float = 1.0) -> list[str]:
    value, error = estimate.value * scale, estimate.error * scale
    return [name, digits(value, error), error_digits(error)]


def _force(joint: JointForce, period: float, several: bool) -> list[str]:
    cycle = "" if joint.cycle_angle is None else degrees_within(joint.cycle_angle, period)
    return [
        _name(joint, several),
        digits(*joint.peak),
        error_digits(joint.peak.error),
        degrees_within(joint.crank_angle, period),
        cycle,
        digits(*joint.mean),
        error_digits(joint.mean.error),
    ]
