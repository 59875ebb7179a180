"""The motion between the samples of a result: at any time, and many times more finely sampled."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from crankmbs.mechanics.friction import friction_forces, friction_torque
from crankmbs.mechanics.inertia import inertia_alone, reduce
from crankmbs.mechanics.knots import KNOT
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.speed import speed_law
from crankmbs.mechanics.torque import torque_at
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots, crank_train
from crankmbs.mechanics.windows import span
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Between", "refined", "sampled"]

State = tuple[Array, Array, Array]

_MOTION = ("crank_angle", "crank_speed", "crank_acceleration")
_SPACING = 0.2 * DEGREE  # of the coarser motion: where samples are no farther apart sums and
# peaks hardly change
_SMOOTH = 1e-9  # of the largest value at a knot: where cubics meet no farther apart is no jump
_FEWEST, _MOST = 2, 512  # parts of one interval in the coarser motion
_PASSES = 6  # the speed hardly changes what drives it: each leaves a small part of the error
_ENOUGH = 1e-14  # of the speed: a change so small is rounding
_SETTLED = 0.1  # of the speed: where the last pass changes it more they lead nowhere
_NARROW = 1 / 16  # of an interval: what changes in less is as good as a jump
_JUMPED = 4.0  # a jump by J of the acceleration within a part h of an interval in two: the speed
# amid it differs by J h (1/8 - 1/24) or more from that in parts of h / 2, which errs by up to J h
# 13/48 at them and J h / 16 more between


@dataclass(frozen=True)
class Between:
    """The motion of a result between its samples.

    result : finely sampled
    train : its crank train
    state : crank angle, speed and acceleration, each of shape (n,), at times of shape (n,) [s]
    unsure : how many times as much it may err as it differs from one half as finely sampled
    """

    result: Result
    train: CrankTrain
    state: Callable[[Array], State]
    unsure: float = 1.0

    def variables(self, time: Array) -> dict[str, Array]:
        """Every variable but the energy residual at times of shape (n,) [s]."""
        theta, omega, alpha = self.state(time)
        theta, fuel = _on_knots(self.train, theta), _fuel_at(self.result.data, time)
        found = reactions(self.train, theta, omega, alpha, fuel)
        return found | {"crank_angle": theta, "crank_speed": omega, "crank_acceleration": alpha}


def refined(result: Result, first: int) -> tuple[Between, ...]:
    """The motion from sample ``first`` on, with every interval cut into equal parts of time.

    A prescribed motion is taken from its law. That of a free crank is the equation of motion
    integrated across each interval and bent to meet the samples at both ends, so that it feels gas
    and loads between them; twice, in so many and in twice as many parts and passes, to tell its
    error. Where loads settle the speed faster than the samples follow their torque is linear
    between them. Joint forces are those of `crankmbs.mechanics.reactions.reactions`.

    Returns
    -------
    the law's motion alone; that of a free crank, coarser and finer; nothing where a free crank
    turns or swings so far from one sample to the next that they do not tell how

    >>> finest = refined(simulate(load_scene("propeller")), 0)[-1]
    >>> print(finest.result.data.sizes["time"] > 50_000)
    True
    """
    data, train = result.data.isel(time=slice(first, None)), crank_train(result.scene)
    if data.sizes["time"] < 2:
        return (Between(replace(result, data=data), train, _alone(data)),)
    spacing = float(np.mean(np.abs(np.diff(data["crank_angle"].values))))
    parts = min(max(math.ceil(spacing / _SPACING), _FEWEST), _MOST)
    if result.scene.motion is not None:
        law = speed_law(result.scene.motion)
        time = _joined(_cut(data["time"].values, 2 * parts))
        even = sampled(result, train, data, time, law.at_time(time))
        return (Between(even, train, law.at_time),)
    free = _Free(train, data)
    coarse, fine = (free.motion(parts * k, _PASSES * k) for k in (1, 2))
    if coarse is None or fine is None:
        return ()
    unsure = _JUMPED if _jumps(train) else 1.0
    return tuple(
        Between(sampled(result, train, data, one[0], one[1:]), train, free.between(*one), unsure)
        for one in (coarse, fine)
    )


def _jumps(train: CrankTrain) -> bool:
    """Whether a torque over the crank angle jumps, or changes in next to no angle."""
    cubics = [(each.knots, each.coefficients) for each in train.pressure or ()]
    loads = [load.parts.over_angle for load in train.scene.torque]
    cubics += [(each.knots, each.coefficients) for each in loads if each is not None]
    for knots, (a, b, c, d) in cubics:
        width = np.diff(knots)
        before = ((a * width + b) * width + c) * width + d
        least, sudden = _SMOOTH * np.max(np.abs(d)), width < _NARROW * _SPACING
        if np.any(np.abs(np.roll(d, -1) - np.where(sudden, d, before)) > least):
            return True
    return False


def _alone(data: xr.Dataset) -> Callable[[Array], State]:
    """The state of the one sample there is, at any time."""
    theta, omega, alpha = (float(data[name].values[0]) for name in _MOTION)
    return lambda t: (np.full_like(t, theta), np.full_like(t, omega), np.full_like(t, alpha))


class _Free:
    """The equation of motion of a free crank between its samples."""

    def __init__(self, train: CrankTrain, data: xr.Dataset) -> None:
        scene = train.scene
        self._time, self._outside = (data[name].values for name in ("time", "external_torque"))
        self._theta, self._omega = (data[name].values for name in _MOTION[:2])
        late, ahead = (float(data[n].attrs["error_estimate"]) for n in ("time", "crank_angle"))
        self._unsure = 2.0 * (ahead + late * float(np.max(np.abs(self._omega))))  # angle [rad]
        self._scene, self._train, self._data = scene, train, data
        self._spans = [span(load, self._time, self._omega) for load in scene.torque]
        self._beside = self._outside - torque_at(
            scene.torque, self._time, self._theta, self._omega, self._spans
        )
        # where the speed follows its loads faster than samples follow one another passes diverge
        rate = _steepness(scene, self._time, self._theta, self._omega) / inertia_alone(
            scene, self._theta
        )
        self._rests = (self._omega[:-1] == 0.0) & (self._omega[1:] == 0.0)
        self._stiff = np.maximum(rate[:-1], rate[1:]) * np.diff(self._time) > 1.0

    def motion(self, parts: int, passes: int) -> tuple[Array, Array, Array, Array] | None:
        """Time, angle, speed and acceleration in so many parts of each interval, if they can be
        told in so many passes."""
        theta, omega = self._theta, self._omega
        width, s = np.diff(self._time)[:, None], np.linspace(0.0, 1.0, parts + 1)
        t = _cut(self._time, parts)

        def bent(speed: Array) -> tuple[Array, Array]:
            """Angle and speed that meet the angles of the samples, the speeds at both ends kept.
            What the samples' own errors explain of an angle that is missing is no speed."""
            angle = theta[:-1, None] + _running(speed, width)
            missing = (theta[1:] - angle[:, -1])[:, None]
            angle = angle + missing * s**2 * (3.0 - 2.0 * s)
            faster = np.sign(missing) * np.maximum(np.abs(missing) - self._unsure, 0.0)
            return angle, speed + faster * 6.0 * s * (1.0 - s) / width

        angle, speed = bent(_cut(omega, parts))
        for _ in range(passes):
            gained = omega[:-1, None] + _running(self._acceleration(t, angle, speed), width)
            before, (angle, speed) = speed, bent(gained + s * (omega[1:] - gained[:, -1])[:, None])
            change, size = (np.max(np.abs(q), axis=1) for q in (speed - before, speed))
            if np.all(change <= _ENOUGH * size):
                break
        if not np.all(change <= _SETTLED * size):
            return None
        alpha = self._acceleration(t, angle, speed)
        return _joined(t), _joined(angle), _joined(speed), _joined(alpha)

    def between(
        self, time: Array, theta: Array, omega: Array, alpha: Array
    ) -> Callable[[Array], State]:
        """The state at any time, by cubics between those of a motion."""
        angle, speed = (
            CubicHermiteSpline(time, theta, omega),
            CubicHermiteSpline(time, omega, alpha),
        )

        def state(t: Array) -> State:
            there = angle(t), speed(t)
            return *there, self._acceleration(t, *there)

        return state

    def _acceleration(self, t: Array, angle: Array, speed: Array) -> Array:
        angle, shares = _on_knots(self._train, angle), _fuel_at(self._data, t)
        inertia, slope, given = reduce(self._train, angle, shares)
        outside, beside = (np.interp(t, self._time, q) for q in (self._outside, self._beside))
        interval = np.searchsorted(self._time[1:-1], t, side="right")
        torque = torque_at(self._scene.torque, t, angle, speed, self._spans) + beside
        torque = np.where(self._stiff[interval], outside, torque)
        given = given + friction_torque(self._train, angle, speed, np.sign(speed), shares)
        alpha = (given + torque - 0.5 * slope * speed**2) / inertia
        return np.where(self._rests[interval], 0.0, alpha)


def _fuel_at(data: xr.Dataset, t: Array) -> Array | None:
    """The shares of the combustion at times of any shape, those of the sample that follows; None
    without fuel. A decision between two samples so comes early by less than their distance, where
    the combustion has not begun."""
    if "fuel" not in data:
        return None
    last = data.sizes["time"] - 1
    which = np.minimum(np.searchsorted(data["time"].values, t, side="left"), last)
    return np.asarray(data["fuel"].values[which])


def _on_knots(train: CrankTrain, theta: Array) -> Array:
    """Crank angles [rad] with those on a knot of the pressure that what is taken as one lies below:
    a piece that begins there would be continued to before its beginning, and be far off if
    steep."""
    knots, period = crank_angle_knots(train), train.period
    if len(knots) == 0:
        return theta
    within = np.mod(theta, period)
    ahead = np.append(knots, knots[0] + period)[np.searchsorted(knots, within)] - within
    return np.where(ahead <= KNOT, theta + ahead, theta)


def _steepness(scene: Scene, t: Array, theta: Array, omega: Array) -> Array:
    """How fast the torque of all loads changes with the speed [N m s]."""
    nudge = 1e-6 * float(np.max(np.abs(omega))) + 1e-12
    above, below = (torque_at(scene.torque, t, theta, omega + sign * nudge) for sign in (1.0, -1.0))
    return np.asarray(np.abs(above - below) / (2.0 * nudge))


def _cut(values: Array, parts: int) -> Array:
    """Values on the straight lines between neighbours, shape (n - 1, parts + 1)."""
    s = np.linspace(0.0, 1.0, parts + 1)
    return np.asarray(values[:-1, None] + s * np.diff(values)[:, None])


def _joined(rows: Array) -> Array:
    """One row after the other; of the two values where they meet the later one counts."""
    return np.append(rows[:, :-1], rows[-1, -1])


def _running(values: Array, width: Array) -> Array:
    """Integral from the beginning of each interval of this width on, by the trapezoid rule less
    what the slopes at the ends of each part show it to miss."""
    slope = np.gradient(values, axis=1, edge_order=2)
    each = 0.5 * (values[:, 1:] + values[:, :-1]) - np.diff(slope, axis=1) / 12.0
    gained = np.cumsum(each * width / (values.shape[1] - 1), axis=1)
    return np.concatenate([np.zeros((len(values), 1)), gained], axis=1)


def sampled(
    result: Result, train: CrankTrain, data: xr.Dataset, time: Array, state: State
) -> Result:
    """The result at these samples: every variable but the energy residual. Where one is larger than
    at the samples of ``data`` its error grows by as much, relatively, as the result states."""
    import xarray as xr

    (theta, omega, alpha), fuel, friction = state, _fuel_at(data, time), None
    if result.scene.friction is not None:
        friction = friction_forces(train, theta, omega, fuel)
        rests = omega == 0.0  # where it is what holds the crank
        for k, held in enumerate(data["friction_force"].values.T):
            friction[rests, k] = np.interp(time[rests], data["time"].values, held)
    found = reactions(train, theta, omega, alpha, fuel, friction)
    found |= {} if fuel is None else {"fuel": fuel}
    found |= {"time": time, "crank_angle": theta, "crank_speed": omega, "crank_acceleration": alpha}

    def stated(name: str) -> dict[str, object]:
        attrs = dict(data[name].attrs)
        higher = float(np.max(np.abs(found[name])) - np.max(np.abs(data[name].values)))
        if higher > 0.0:
            attrs["error_estimate"] += result.error.estimated * higher
        return attrs

    rows = {name: (data[name].dims, v, stated(name)) for name, v in found.items()}
    coordinates = {name: rows.pop(name) for name in ("time", "crank_angle")}
    return replace(result, data=xr.Dataset(rows, {**coordinates, "cylinder": data["cylinder"]}))
