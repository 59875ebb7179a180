"""The speed is prescribed: algebra gives every joint force, and the torque the drive must give."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.friction import friction_knots, sign_changes
from crankmbs.mechanics.inertia import inertia_alone, reduce
from crankmbs.mechanics.knots import repeat
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.speed import SpeedLaw, speed_law
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots
from crankmbs.motion.account import Account
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.driven import Driven, Way, driven, driven_observer
from crankmbs.motion.ending import Ending
from crankmbs.motion.motion import Motion, Passes
from crankmbs.motion.observer import account_of
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.motion.prescribed import monotone_stretches
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import DEGREE

__all__ = ["passes", "run"]

_POINTS = (6, 8)  # of Gauss in a panel, in either look at what happens on the way
_PANEL = 5.0 * DEGREE  # widest panel of the work integral; Gauss with 4 points errs below 1e-12


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
    keep = partial(_account, train, law, tuple(stretches), rests=not reached)
    stretches = _kept(plan, law, stretches)
    time, theta = _sample(plan, law, stretches, reached)
    _, omega, alpha = law.at_time(time)
    edges = _panel_edges(train, law, stretches, time, firings)
    residual = _energy_residual(train, law, time, edges, firings)
    own = {} if firings is None else {"fuel": firings.at(time)}
    samples = Samples(time, theta, omega, alpha, residual, own)
    ending = Ending.COMPLETE if reached else Ending.LAW_RESTS
    if plan.folds_at(float(theta[-1])):
        ending = Ending.FOLD
    by_angle = np.full(len(time), not plan.in_time)
    by_angle[-1] = reached and not plan.until_time
    better = None if law.off is law else _by(law.off, samples, by_angle)
    return Solution(samples, *ending.said(float(theta[-1])), len(time), 0, better, keep=keep)


def passes(train: CrankTrain) -> Passes:
    """The law as cells, twice, the second time finer and as far off as law and pressures may be."""
    assert train.scene.motion is not None
    law = speed_law(train.scene.motion)
    stretches, _ = monotone_stretches(plan_of(train.scene), law)
    answer, check = (
        Motion(one, list(driven(_way(one, of, finer=finer), stretches)))
        for one, of, finer in ((train, law, False), (train.off, law.off, True))
    )
    return Passes(answer, (check,))


def _account(
    train: CrankTrain, law: SpeedLaw, stretches: tuple[tuple[float, float], ...], *, rests: bool
) -> Account:
    """What happens on the way, seen twice: it errs by no more than quadrature and pressures do."""
    seen = []
    for one, finer in ((train, False), (train.off, True)):
        pieces = driven(_way(one, law, finer=finer), stretches)
        seen.append(driven_observer(one, pieces, finer=finer, rests=rests))
    return account_of(seen, 1.0)


def _way(train: CrankTrain, law: SpeedLaw, *, finer: bool = False) -> Way:
    return Way(train, law, partial(_moving, train, law), _POINTS[finer])


def _moving(train: CrankTrain, law: SpeedLaw, time: Array, fuel: Array | None) -> Samples:
    """The motion at times of shape (n,), with its energy and the torque that it needs."""
    theta, omega, alpha = law.at_time(time)
    inertia, slope, torque = reduce(train, theta, fuel)
    own = {
        "kinetic_energy": 0.5 * inertia * omega**2,
        "external_torque": inertia * alpha + 0.5 * slope * omega**2 - torque,
    }
    return Samples(time, theta, omega, alpha, np.zeros_like(time), own)


def _by(law: SpeedLaw, samples: Samples, by_angle: NDArray[np.bool_]) -> Samples:
    """The samples by another law, at the same crank angles where these are chosen, else at the
    same times."""
    passed = law.time_at(samples.theta, 0.0, math.inf)
    time = np.where(by_angle, passed, samples.time)
    theta, omega, alpha = law.at_time(time)
    theta = np.where(by_angle, samples.theta, theta)
    return replace(samples, time=time, theta=theta, omega=omega, alpha=alpha)


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


def _sample(
    plan: Plan, law: SpeedLaw, stretches: list[tuple[float, float]], reached: bool
) -> tuple[Array, Array]:
    times, angles = [np.zeros(1)], [np.array([plan.start])]
    for begin, end in stretches:
        if plan.in_time:
            t = plan.between(begin, end)
            theta = law.at_time(t)[0]
        else:
            turned, bound = (float(q) for q in law.at_time([begin, end])[0])
            theta = plan.between(turned, bound)
            # where a stretch begins on a sample, but for rounding, the one before it ends there
            theta = theta[np.abs(theta - turned) > plan.hair]
            t = law.time_at(theta, begin, end)
        times.append(t)
        angles.append(theta)
    time, theta = np.concatenate(times), np.concatenate(angles)
    end = stretches[-1][1]
    theta_end = float(law.at_time(end)[0])
    if reached and not plan.until_time:
        low, high = plan.angle_bounds
        theta_end = high if theta_end > plan.start else low
    is_end = (time >= end) if plan.in_time else (time >= end * (1.0 - 1e-12))
    near = abs(time[-1] - end) if plan.in_time else abs(theta[-1] - theta_end)
    keep = ~is_end & ~((np.arange(len(time)) == len(time) - 1) & (near <= plan.hair))
    time, theta = np.append(time[keep], end), np.append(theta[keep], theta_end)
    first = np.flatnonzero(np.abs(theta - theta_end) > plan.last * (1.0 + 1e-12))
    begin_at = first[-1] + 1 if len(first) else 0
    return time[begin_at:], theta[begin_at:]


def _panel_edges(
    train: CrankTrain,
    law: SpeedLaw,
    stretches: list[tuple[float, float]],
    time: Array,
    firings: _Firings | None,
) -> Array:
    """Times between which the power is smooth and short: samples, knots, corners, decisions on the
    fuel, panels."""
    knots = np.concatenate([crank_angle_knots(train), friction_knots(train)])
    corners = law.corners(float(time[0]), float(time[-1]))
    edges = [time, corners, np.empty(0) if firings is None else firings.times]
    for begin, end in stretches:
        a, b = (float(q) for q in law.at_time([begin, end])[0])
        low, high = min(a, b), max(a, b)
        count = math.ceil((high - low) / _PANEL)
        inside = np.concatenate(
            [repeat(knots, train.period, low, high), np.linspace(low, high, count + 1)[1:-1]]
        )
        if firings is not None:
            inside = np.append(inside, _sign_changes(train, law, (begin, end), firings))
        edges += [np.array([begin, end]), law.time_at(inside, begin, end)]
    merged = np.unique(np.concatenate(edges))
    return np.asarray(merged[(merged >= time[0]) & (merged <= time[-1])])


def _sign_changes(
    train: CrankTrain, law: SpeedLaw, stretch: tuple[float, float], firings: _Firings
) -> Array:
    """Crank angles [rad] in a stretch of time at which a gas force, with the shares that act there,
    changes its sign under rings that feel it."""
    begin, end = stretch
    inside = firings.times[(firings.times > begin) & (firings.times < end)]
    times = np.concatenate([[begin], inside, [end]])
    angles, found = law.at_time(times)[0], [np.empty(0)]
    for k, shares in enumerate(firings.at(0.5 * (times[:-1] + times[1:]))):
        low, high = sorted(angles[k : k + 2].tolist())
        found.append(repeat(sign_changes(train, tuple(shares.tolist())), train.period, low, high))
    return np.concatenate(found)


def _energy_residual(
    train: CrankTrain, law: SpeedLaw, time: Array, edges: Array, firings: _Firings | None
) -> Array:
    """Kinetic energy gained since the first sample minus the work of gas, gravity, friction and
    drive.

    The work is the integral of power over time by Gauss quadrature between the edges.
    """
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = 0.5 * np.diff(edges)[:, None]
    t = edges[:-1, None] + half * (1.0 + nodes)
    theta, omega, alpha = law.at_time(t.ravel())
    fuel = None if firings is None else firings.at(t.ravel())
    all_of = reactions(train, theta, omega, alpha, fuel)
    along = all_of["gas_force"] + all_of.get("friction_force", 0.0)
    gas = (along * all_of["piston_velocity"]).sum(axis=1)
    weight = reduce(replace(train, pressure=None), theta).torque * omega
    power = (all_of["external_torque"] * omega + gas + weight).reshape(t.shape)
    work = np.concatenate([[0.0], np.cumsum((half * power) @ weights)])
    theta, omega, _ = law.at_time(time)
    kinetic = 0.5 * inertia_alone(train.scene, theta) * omega**2
    return np.asarray(kinetic - kinetic[0] - work[np.searchsorted(edges, time)])
