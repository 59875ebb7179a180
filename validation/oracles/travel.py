"""Where a piston is, and at which cycle angles it is at a place: Pythagoras and the law of cosines.

The piston's pin is at (x, e), the crank's at r from the axis, the rod's length l between them.
"""

import math

from validation.oracles.machine import Machine

__all__ = ["angles_at", "dead_centres", "displacement_at"]


def displacement_at(machine: Machine, angle: float) -> float:
    """From the top dead centre towards the crank [m], at a cycle angle [rad]."""
    r, l, e = float(machine.crank_radius), float(machine.rod_length), float(machine.offset)
    x = r * math.cos(angle) + math.sqrt(l * l - (r * math.sin(angle) - e) ** 2)
    return math.sqrt((l + r) ** 2 - e * e) - x


def angles_at(machine: Machine, displacement: float) -> list[float]:
    """The cycle angles [rad] of both strokes at a displacement [m]; none where it is not passed.

    With R from the axis to the piston's pin, l^2 = r^2 + R^2 - 2 r R cos(angle between r and R).
    """
    r, l, e = float(machine.crank_radius), float(machine.rod_length), float(machine.offset)
    x = math.sqrt((l + r) ** 2 - e * e) - displacement
    far = math.hypot(x, e)
    cosine = (r * r + far * far - l * l) / (2.0 * r * far)
    if not (displacement > 0.0 and abs(cosine) < 1.0):
        return []
    return [math.atan2(e, x) - math.acos(cosine), math.atan2(e, x) + math.acos(cosine)]


def dead_centres(machine: Machine) -> tuple[float, float]:
    """The cycle angles [rad] at which crank and rod are in line."""
    r, l, e = float(machine.crank_radius), float(machine.rod_length), float(machine.offset)
    return math.asin(e / (l + r)), math.pi + math.asin(e / (l - r))
