"""The energy over the crank angle where a load is a function of Python.

Newton's method on all cells at once, as functions are evaluated at many points in one call; time,
by quadrature, follows behind.
"""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.crank_angle.grid import Grid, Strip
from crankmbs.motion.crank_angle.solvers import Begin, Cells
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import chain

__all__ = ["solve_functions"]

_NEWTON = 20  # steps, as in `loops`
_SETTLED, _GOOD = 1e-14, 1e-11  # relative change of the energy in Newton's last step


def solve_functions(grid: Grid, strip: Strip, loads: Branch | Course, begin: Begin) -> Cells:
    """The cells of a strip; from one on that Newton's method does not solve they hold NaN."""
    sense, start, t0, _, angle = begin
    rule, theta = grid.rule, strip.angles(angle, sense, grid.rule)
    energy = np.full(strip.inertia.shape, start)
    t = np.full(strip.inertia.shape, t0)
    slowness = np.sqrt(0.5 * strip.inertia / energy)
    for _ in range(_NEWTON):
        omega = sense / slowness
        slope = loads.slope(omega) - strip.drag if strip.drags else loads.slope(omega)
        for function in loads.functions:
            slope = slope + function.slope(t, theta, omega)
        torque, rate = _torque(strip, loads, t, theta, omega), slope / (strip.inertia * omega)
        maps = rule.maps(sense * strip.width[:, None], torque - rate * energy, rate)
        edges = chain(maps.growth, maps.rise, start)
        new = maps.gain * edges[:-1, None] + maps.shift
        change = np.abs(new / energy - 1.0).max(axis=1)
        energy = new
        slowness = np.sqrt(0.5 * strip.inertia / energy)
        time = _clock(t0, strip.width * (slowness @ rule.weights))
        t = time[:-1, None] + strip.width[:, None] * (slowness @ rule.matrix.T)
        if (change < _SETTLED).all():
            break
    slowness[~np.logical_and.accumulate(change < _GOOD)] = np.nan
    return Cells(edges, time, _torque(strip, loads, t, theta, sense / slowness), slowness)


def _torque(strip: Strip, loads: Branch | Course, t: Array, theta: Array, omega: Array) -> Array:
    """Torque of all at the nodes [N m]."""
    torque = strip.torque + loads(t, omega)
    if strip.drags:
        torque = torque - strip.drag * omega
    for function in loads.functions:
        torque = torque + function(t, theta, omega)
    return torque


def _clock(t0: float, spent: Array) -> Array:
    """Time at the edges from the times spent in the cells; summed in more bits where there are:
    passes over the same cells would round alike, and not see it in their difference."""
    return np.asarray(t0 + np.append(0.0, np.cumsum(spent, dtype=np.longdouble)), dtype=np.float64)
