"""The gas force as a plain Python function, as fast as Python looks a table up."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable

from validation.speed.job import Cylinder

__all__ = ["gas_function"]


def gas_function(cylinder: Cylinder) -> Callable[[float], float]:
    """Gas force towards the crank [N] over the cylinder's cycle angle [rad]."""
    knots, pieces = cylinder.knots.tolist(), cylinder.force.T.tolist()
    first, period = knots[0], knots[-1] - knots[0]

    def force(phi: float) -> float:
        angle = first + (phi - first) % period
        k = min(bisect_right(knots, angle) - 1, len(pieces) - 1)
        a, b, c, d = pieces[k]
        x = angle - knots[k]
        return float(((a * x + b) * x + c) * x + d)

    return force
