"""The speed is prescribed: algebra gives every joint force, and the torque the drive must give."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.inertia import inertia_alone, reduce
from crankmbs.mechanics.speed import SpeedLaw, speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.account import Account
from crankmbs.motion.base import Samples, Segment, Solution
from crankmbs.motion.cells import Cells
from crankmbs.motion.driven import Driven, Way, begun_at, driven, monotone_stretches
from crankmbs.motion.ending import Ending
from crankmbs.motion.motion import Motion, Passes
from crankmbs.motion.observer import Followed, account_of
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.motion.states import inner_samples, table_of
from crankmbs.numerics.arrays import Array

__all__ = ["account", "energy_residual", "passes", "run"]

_POINTS = (6, 8)  # of Gauss in a panel, in either look at what happens on the way
_TOGETHER = 2048  # cells whose work is summed at once


def run(train: CrankTrain) -> Solution:
    """Sample the prescribed motion. Exact but for rounding; there is nothing to integrate but the
    time, where the speed is known over the angle.

    Raises
    ------
    InputError : a speed table that ends before the run does
    """
    scene = train.scene
    assert scene.motion is not None
    plan = plan_of(scene)
    law = speed_law(scene.motion)
    stretches, reached = monotone_stretches(plan, law)
    firings = None if train.law is None else _firings(driven(_way(train, law), stretches))
    stretches = _kept(plan, law, stretches)
    bound = plan.angle_bounds[float(law.at_time(stretches[-1][1])[0]) > plan.start]
    final = bound if reached and not plan.until_time else None
    time, theta = plan.samples(stretches, lambda t: law.at_time(t)[0], law.time_at, final)
    _, omega, alpha = law.at_time(time)
    residual = energy_residual(driven(_way(train, law), stretches), train, time)
    computed = {} if firings is None else {"fuel": firings.at(time)}
    computed |= _applied(train, time, theta, omega)
    samples = Samples(time, theta, omega, alpha, residual, computed)
    ending = Ending.COMPLETE if reached else Ending.LAW_RESTS
    if plan.folds_at(float(theta[-1])):
        ending = Ending.FOLD
    by_angle = np.full(len(time), not plan.in_time)
    by_angle[-1] = reached and not plan.until_time
    better = None if law.perturbed is law else _by(train, law.perturbed, samples, by_angle)
    return Solution(samples, *ending.said(float(theta[-1])), len(time), 0, better)


def passes(train: CrankTrain) -> Passes:
    """The law as cells, twice, the second time finer and as far off as law and pressures may be."""
    assert train.scene.motion is not None
    law = speed_law(train.scene.motion)
    stretches, _ = monotone_stretches(plan_of(train.scene), law)
    answer, check = (
        Motion(one, list(driven(_way(one, of, finer=finer), stretches)))
        for one, of, finer in ((train, law, False), (train.perturbed, law.perturbed, True))
    )
    return Passes(answer, (check,))


def account(train: CrankTrain) -> Account:
    """What happens on the way, seen twice: it errs by no more than quadrature and pressures do."""
    assert train.scene.motion is not None
    law = speed_law(train.scene.motion)
    stretches, reached = monotone_stretches(plan_of(train.scene), law)
    followed, ending = [], Ending.COMPLETE if reached else Ending.LAW_RESTS
    for one, finer in ((train, False), (train.perturbed, True)):
        way = _way(one, law, finer=finer)
        followed.append(Followed(one, begun_at(way), driven(way, stretches), ending))
    return account_of(followed, 1.0)


def _way(train: CrankTrain, law: SpeedLaw, *, finer: bool = False) -> Way:
    return Way(train, law, _POINTS[finer])


def _by(train: CrankTrain, law: SpeedLaw, samples: Samples, by_angle: NDArray[np.bool_]) -> Samples:
    """The samples by another law, at the same crank angles where these are chosen, else at the
    same times."""
    passed = law.time_at(samples.theta, 0.0, math.inf)
    time = np.where(by_angle, passed, samples.time)
    theta, omega, alpha = law.at_time(time)
    theta = np.where(by_angle, samples.theta, theta)
    computed = {**samples.computed, **_applied(train, time, theta, omega)}
    return replace(samples, time=time, theta=theta, omega=omega, alpha=alpha, computed=computed)


def _applied(train: CrankTrain, time: Array, theta: Array, omega: Array) -> dict[str, Array]:
    """The forces from outside on the pistons, where there are; at the ends of their windows those
    after."""
    if not train.pushes:
        return {}
    total = np.zeros((len(time), len(train.scene.cylinders)))
    for push in train.pushes:
        begin, end = (
            push.force.after or 0.0,
            math.inf if push.force.until is None else push.force.until,
        )
        acts = (time >= begin) & (time < end)
        motion = time[acts], theta[acts], omega[acts]
        total[acts] += push.forces(*motion, np.sign(motion[2]))
    return {"applied_force": total}


class _Firings(NamedTuple):
    """Times [s] of the decisions on the fuel, shape (n,), and the shares of the cylinders before
    the first and after each, shape (n + 1, cylinders)."""

    times: Array
    shares: Array

    def at(self, t: Array) -> Array:
        """The shares at times of shape (m,); at a decision those before it."""
        return np.asarray(self.shares[np.searchsorted(self.times, t, side="left")])


def _firings(pieces: Iterable[Driven]) -> _Firings:
    """The decisions on the way."""
    pieces = list(pieces)
    states = [state for piece in pieces for state in piece.decisions]
    shares = [pieces[0].begin.mode.shares, *(state.mode.shares for state in states)]
    return _Firings(np.array([state.time for state in states]), np.array(shares))


def _kept(
    plan: Plan, law: SpeedLaw, stretches: list[tuple[float, float]]
) -> list[tuple[float, float]]:
    """The stretches that hold all samples to be kept, and one before them."""
    begin, end = stretches[-1]
    first, last = (float(q) for q in law.at_time([begin, end])[0])
    if not abs(last - first) > plan.last + 2.0 * plan.every:
        return stretches
    since = last - math.copysign(plan.last + 2.0 * plan.every, last - first)
    return [(float(law.time_at(since, begin, end)[0]), end)]


def energy_residual(pieces: Iterable[Segment], train: CrankTrain, time: Array) -> Array:
    """Kinetic energy gained since the first sample minus the work of gas, gravity, friction and
    drive, up to the ends of the cells in which the samples lie, shape (n,) [J]."""
    ends, gains = [time[:1]], [np.zeros(1)]
    for piece in pieces:
        if piece.end.time <= time[0]:
            continue
        cells = piece.cells
        cells = cells.since(int(np.searchsorted(cells.time[:, -1], time[0], side="right")))
        for low in range(0, len(cells.time), _TOGETHER):
            part = cells.first(low + _TOGETHER).since(low)
            ends.append(part.time[:, -1])
            gains.append(_gained(part, train))
    total = np.cumsum(np.concatenate(gains))
    return np.asarray(total[np.searchsorted(np.concatenate(ends), time)])


def _gained(cells: Cells, train: CrankTrain) -> Array:
    """Kinetic energy gained in each cell minus the work done in it, shape (m,) [J]."""
    at = inner_samples(cells, train)
    forces = table_of(train, at).variables
    along = forces["gas_force"] + forces.get("friction_force", 0.0)
    along = along + forces.get("applied_force", 0.0)
    weight = reduce(replace(train, pressure=None), at.theta).torque
    power = (forces["external_torque"] + weight) * at.omega
    power += (along * forces["piston_velocity"]).sum(axis=1)
    work = (power.reshape(cells.time.shape) * cells.spent) @ cells.weights
    inertia = inertia_alone(train.scene, cells.angle[:, [0, -1]])
    kinetic = 0.5 * inertia * cells.speed[:, [0, -1]] ** 2
    return np.asarray(kinetic[:, 1] - kinetic[:, 0] - work)
