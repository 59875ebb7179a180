"""SciPy's LSODA and DOP853 on the reduced equation, its right-hand side compiled by numba.

The equation is written out as one would by hand: positions of the pins, their first and second
derivatives in the crank angle, Lagrange's equation of the one rotation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.trace import Trace
from validation.speed.job import Job

__all__ = ["LADDER", "integrated", "parameters", "scipy_contenders"]

Array = NDArray[np.float64]

Slope = Callable[[float, Array], tuple[float, float]]
Method = Literal["LSODA", "DOP853"]

LADDER = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13)


def slopes(t: float, y: Array, p: Array, knots: Array, force: Array) -> tuple[float, float]:
    """(omega, alpha) of the state (theta, omega); p as in `parameters`."""
    theta, omega = y[0], y[1]
    r, l, e, a = p[0], p[1], p[2], p[3]
    rod, rod_inertia, piston, crank_inertia = p[4], p[5], p[6], p[7]
    unbalance, gx, gy = p[8], p[9], p[10]
    sine, cosine = math.sin(theta), math.cos(theta)
    sb = (r * sine - e) / l  # rod angle beta
    cb = math.sqrt(1.0 - sb * sb)
    b1 = r * cosine / (l * cb)
    b2 = (sb * b1 * b1 - r * sine / l) / cb
    x1 = -r * sine - l * sb * b1  # piston
    x2 = -r * cosine - l * (cb * b1 * b1 + sb * b2)
    u1, v1 = -r * sine - a * sb * b1, r * cosine - a * cb * b1  # the rod's centre of mass
    u2 = -r * cosine - a * (cb * b1 * b1 + sb * b2)
    v2 = -r * sine - a * (cb * b2 - sb * b1 * b1)
    inertia = crank_inertia + rod * (u1 * u1 + v1 * v1) + rod_inertia * b1 * b1 + piston * x1 * x1
    change = rod * (u1 * u2 + v1 * v2) + rod_inertia * b1 * b2 + piston * x1 * x2
    angle = knots[0] + (theta - knots[0]) % (knots[-1] - knots[0])
    k = min(max(np.searchsorted(knots, angle, side="right") - 1, 0), force.shape[1] - 1)
    x = angle - knots[k]
    gas = ((force[0, k] * x + force[1, k]) * x + force[2, k]) * x + force[3, k]
    torque = p[11] - (p[12] + p[13] * abs(omega)) * omega - gas * x1
    torque += rod * (gx * u1 + gy * v1) + piston * gx * x1
    torque += unbalance * (gy * cosine - gx * sine)
    return omega, (torque - change * omega * omega) / inertia


def parameters(job: Job) -> Array:
    """The numbers of `slopes`, in their order."""
    return np.array(
        [
            *(job.radius, job.rod_length, job.offset, job.rod_center),
            *(job.rod_mass, job.rod_inertia, job.piston_mass, job.crank_inertia),
            *(job.crank_mass * job.crank_center, *job.gravity),
            *(job.constant, job.viscous, job.quadratic),
        ]
    )


def scipy_contenders(job: Job, reference: Trace) -> tuple[Contender, ...]:
    """LSODA and DOP853."""
    import numba

    compiled: Any = numba.njit(slopes)
    numbers, knots, force = parameters(job), job.alone.knots, job.alone.force

    def slope(t: float, y: Array) -> tuple[float, float]:
        return cast(tuple[float, float], compiled(t, y, numbers, knots, force))

    methods: tuple[Method, ...] = ("LSODA", "DOP853")
    return tuple(
        Contender(
            name=f"SciPy {method}",
            knob="rtol",
            settings=LADDER,
            run=partial(integrated, job, slope, method),
            reference=reference,
        )
        for method in methods
    )


def integrated(job: Job, slope: Slope, method: Method, rtol: float) -> Answer:
    """The state at the end, by one of SciPy's integrators."""
    solved = solve_ivp(
        slope,
        (0.0, job.end),
        [job.theta, job.omega],
        method=method,
        rtol=rtol,
        atol=rtol * np.array([1.0, abs(job.omega) or 1.0]),
    )
    if not solved.success:
        raise RuntimeError(solved.message)
    theta, omega = solved.y[:, -1:]
    return Answer(Trace(np.array([job.end]), theta, omega), int(solved.nfev))
