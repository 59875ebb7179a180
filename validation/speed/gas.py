"""The gas force as a plain Python function, as fast as Python looks a table up."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable

from validation.speed.job import Job

__all__ = ["gas_function"]


def gas_function(job: Job) -> Callable[[float], float]:
    """Gas force towards the crank [N] over the crank angle [rad]."""
    knots, pieces = job.knots.tolist(), job.force.T.tolist()
    first, period = knots[0], knots[-1] - knots[0]

    def force(theta: float) -> float:
        angle = first + (theta - first) % period
        k = min(bisect_right(knots, angle) - 1, len(pieces) - 1)
        a, b, c, d = pieces[k]
        x = angle - knots[k]
        return float(((a * x + b) * x + c) * x + d)

    return force
