"""The cells of the crank angle alone: without samples, forces, check and error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.grid import Grid, grid_of
from crankmbs.motion.crank_angle.segment import AngleSegment
from crankmbs.motion.crank_angle.solvers import Begin, solve
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE
from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.reference import Reference
from crankmbs.work_precision.trace import Trace

__all__ = ["kernels_of"]

_STAGES = 5
_WIDEST = (90.0, 45.0, 22.5, 12.0, 6.0, 3.0)  # deg
_MOST_CELLS = 1e5  # what memory holds


def kernels_of(scene: Scene, reference: Reference) -> tuple[Contender, ...]:
    """The affine maps of one period and the chain of all cells, with the tables at hand.

    None where one such chain does not solve the scene: it starts from rest or turns back, its loads
    depend on time or on the speed otherwise than by its square, it ends early or is very long.
    """
    start, end = scene.start, reference.trace.end()
    if start is None or start.speed == 0.0 or reference.result.status != 0:
        return ()
    branch = branch_of(scene.torque, 0.0, start.speed, rising=True)
    one = branch.is_affine_in_energy and math.isinf(branch.t_end)
    omega = reference.trace.omega
    one = one and bool(np.all(omega * math.copysign(1.0, start.speed) > 0.0))
    one = one and branch.omega_low <= omega.min() and omega.max() <= branch.omega_high
    turned = abs(float(end.theta[0]) - start.angle)
    finest = len(_grid(scene, _WIDEST[-1]).edges)
    if not (one and turned / scene.period * finest < _MOST_CELLS):
        return ()
    loop = cache(lambda widest: _loop(scene, _grid(scene, widest), reference))
    return (
        Contender(
            name="crank_angle, kernel",
            knob="deg",
            settings=_WIDEST,
            run=lambda widest: loop(widest)(),
            reference=reference.trace.end(),
        ),
    )


def _grid(scene: Scene, widest: float) -> Grid:
    """Cells that nothing checks."""
    return replace(grid_of(crank_train(scene), gauss(_STAGES), widest * DEGREE), checks=True)


def _loop(scene: Scene, grid: Grid, reference: Reference) -> Callable[[], Answer]:
    """The chain of cells, and the state at its end."""
    assert scene.start is not None
    theta, omega = scene.start.angle, scene.start.speed
    sense = math.copysign(1.0, omega)
    branch = branch_of(scene.torque, 0.0, omega, rising=True)
    until, until_time = scene.end
    bound = float(reference.trace.end().theta[0])
    # of an end in time the last cell goes beyond it
    far = bound + until_time * sense * float(np.max(np.diff(grid.edges)))
    count = int(abs(far - theta) / float(grid.edges[-1]) * len(grid.edges)) + 2
    terms = grid.terms(theta, sense, count, far)
    energy = 0.5 * float(inertia_alone(scene, theta)) * omega**2
    t_end = until if until_time else math.inf
    begin, state = Begin(sense, energy, 0.0, t_end, theta), State(0.0, theta, omega, 0.0)

    def run() -> Answer:
        cells = solve(grid, terms, branch, begin)
        m = len(cells.torque)
        window = AngleSegment(grid, terms.first(m), branch, sense, state, *cells, (m - 1, 1.0))
        time, at, speed, *_ = window.cut(t_end, bound).end
        trace = Trace(np.array([time]), np.array([at]), np.array([speed]))
        return Answer(trace, cells.torque.size)

    return run
