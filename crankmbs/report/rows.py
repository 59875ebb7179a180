"""The measures of a run as rows of words and numbers, each with its error."""

from __future__ import annotations

import math

from crankmbs.digits import digits, error_digits
from crankmbs.measures import Estimate, JointForce, Measures
from crankmbs.scene.units import RPM

__all__ = ["FORCE_HEADINGS", "degrees_within", "force_rows", "measure_rows"]

FORCE_HEADINGS = [
    "joint force [N]",
    "peak",
    "error",
    "at crank angle [deg]",
    "cycle angle [deg]",
    "mean",
    "error",
]


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
    pressures = measures.imep or ()
    for number, imep in enumerate(pressures, start=1):
        whose = f", cylinder {number}" if len(pressures) > 1 else ""
        rows.append(_value(f"indicated mean effective pressure{whose} [bar]", imep, 1e-5))
    return rows


def force_rows(measures: Measures, period: float) -> list[list[str]]:
    """The cells under `FORCE_HEADINGS` for each joint; period [rad] : the engine's."""
    several = any((joint.cylinder or 1) > 1 for joint in measures.joints)
    return [_force(joint, period, several) for joint in measures.joints]


def degrees_within(angle: float, period: float) -> str:
    """An angle within one period, in degrees."""
    return f"{round(math.degrees(angle), 3) % round(math.degrees(period)):.6g}"


def _value(name: str, estimate: Estimate, scale: float = 1.0) -> list[str]:
    value, error = estimate.value * scale, estimate.error * scale
    return [name, digits(value, error), error_digits(error)]


def _force(joint: JointForce, period: float, several: bool) -> list[str]:
    name = f"{joint.joint} {joint.cylinder}" if several and joint.cylinder else joint.joint
    cycle = "" if joint.cycle_angle is None else degrees_within(joint.cycle_angle, period)
    return [
        name,
        digits(*joint.peak),
        error_digits(joint.peak.error),
        degrees_within(joint.crank_angle, period),
        cycle,
        digits(*joint.mean),
        error_digits(joint.mean.error),
    ]
