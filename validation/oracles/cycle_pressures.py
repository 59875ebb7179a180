"""Mean effective pressures from first principles: the integral of p dV of a cycle over the swept
volume, by Gauss's rule between the knots of the pressures."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from validation.oracles.changes import Changes
from validation.oracles.pythagoras import cylinder_at

__all__ = ["cycle_pressures"]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_WIDEST = math.pi / 36.0


def cycle_pressures(
    changes: Changes, theta: float, omega: float, count: int
) -> NDArray[np.float64]:
    """Of so many cycles from a crank angle [rad] forwards, shape (count, cylinders) [Pa].

    The shares are those of misfires and scatter; a cylinder decides half a turn past its axis.
    """
    assert omega > 0.0
    m = changes.machine
    r, l, e = float(m.crank_radius), float(m.rod_length), float(m.offset)
    swept = math.sqrt((l + r) ** 2 - e * e) - math.sqrt((l - r) ** 2 - e * e)
    found = np.zeros((count, len(changes.fired)))
    for n in range(count):
        for k in range(len(changes.fired)):
            begin = theta + n * changes.cycle
            found[n, k] = _work(changes, k, begin, begin + changes.cycle, theta) / swept
    return found


def _work(changes: Changes, k: int, angle: float, end: float, start: float) -> float:
    """Of the gas on a piston over its area [J/m2]."""
    phase, work = float(changes.machine.cylinders[k][0]), 0.0
    while angle < end - 1e-9:
        at = angle + 1e-10 + phase
        fired, low, high = changes.fired[k].at(at)
        decides = math.pi + math.floor((at - math.pi) / changes.cycle) * changes.cycle
        stop = min(high - phase, end, angle + _WIDEST, decides + changes.cycle - phase)
        share, motored, since = 1.0, fired, low
        if changes.firings is not None:
            motored, since, bound = changes.firings.motored[k].at(at)
            stop = min(stop, bound - phase)
            # the firing dead centres from the start up to the one that this share is for
            last = round((decides - math.pi) / changes.cycle)
            passed = math.floor((start + phase - 2.0 * math.pi) / changes.cycle + 1e-9)
            share = changes.firings.part(k + 1, max(last - passed, 1))
        half = 0.5 * (stop - angle)
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            x = angle + half * (1.0 + node)
            without = motored(x + phase - since)
            pressure = without + share * (fired(x + phase - low) - without)
            work -= weight * half * pressure * cylinder_at(changes.machine, x, k).x_1
        angle = stop
    return work
