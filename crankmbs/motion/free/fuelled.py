"""What a run with fuel settles to, found by Newton's method on all that a period hands to the next.

At the angle of its start the state of an engine is its energy, and with a governor also the
integral, the time since the last decision and the shares that still act. The run itself is followed
until the fixed point of a period that Newton's method finds from there is the one it comes to.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.integrate import Setup, integrate
from crankmbs.motion.free.settling import STEP, LostError, Settling, largest, newton_step, slope_of
from crankmbs.motion.mode import Mode, begun, decided
from crankmbs.motion.plan import plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["Fuelled"]

_LOCAL = 1e-11  # tolerance of the periods of the search
_NEWTON, _CLOSE = 12, 1e-8  # steps, and the last one's size
_FIRST, _MOST = 4, 512  # periods followed before each search, doubled from one to the next
_NEAR = 0.02  # of its size: so near the fixed point the run is as good as there
_LAST = 64  # periods in which a governor that hunts goes to both ends


class _Point(NamedTuple):
    """A fixed point: what a period hands on, its derivative, and its largest factor."""

    at: Array
    slope: Array
    factor: float


class Fuelled:
    """A settled motion with fuel, on the grids of the passes.

    by_angle : the crank angle is the variable wherever it can be; allowed : evaluations over time
    """

    def __init__(self, train: CrankTrain, grid: Grid, allowed: int, *, by_angle: bool) -> None:
        scene = train.scene
        assert scene.start is not None
        self._train, self._grid, self._angle = train, grid, scene.start.angle
        self._period, self._start = scene.settled_period, scene.start
        self._inertia = float(reduce(train, self._angle).inertia)
        self._plan = replace(plan_of(scene), every=self._period, in_time=False, last=math.inf)
        self._allowed, self._by_angle = allowed, by_angle
        begin = State(0.0, self._angle, self._start.speed, 0.0, begun(train))
        self._model = self._after(grid, _LOCAL, begin, 1)

    def settling(self) -> Settling:
        """Where the settled motion begins.

        Raises
        ------
        LostError : it does not settle
        """
        point = self._point()
        return Settling(point.at, point.slope, self._image, self._state, self._sizes)

    def _point(self) -> _Point:
        """The fixed point that the run comes to."""
        state, count, point, before = self._model, _FIRST, None, math.inf
        while count <= _MOST:
            state = self._after(self._grid, _LOCAL, state, count)
            self._model = state
            point = self._newton(self._numbers(state))
            off = math.inf
            if point is not None:
                off = float(np.max(np.abs(self._numbers(state) - point.at) / self._sizes(point.at)))
            if point is not None and point.factor < 1.0:
                expected = point.factor**count
                if off <= _NEAR or off <= 0.5 * (1.0 + expected) * before:
                    return point
            before, count = off, 2 * count
        fuel = self._train.scene.fuel
        if fuel and fuel.governor is None:
            raise LostError(self._drift(state))
        if point is None:
            raise LostError(Ending.SWINGS if self._swings(state) else Ending.WANDERS)
        raise LostError(Ending.HUNTS, factor=point.factor)

    def _drift(self, state: State) -> Ending:
        """What becomes of an energy that no fixed point attracts."""
        energy = self._numbers(state)
        gained = float((self._image(self._grid, _LOCAL, energy) - energy)[0])
        if abs(gained) <= _CLOSE * energy[0]:
            return Ending.BALANCED
        return Ending.RUNS_AWAY if gained > 0.0 else Ending.WANDERS

    def _swings(self, state: State) -> bool:
        """Whether a governor goes on from its least share to its greatest and back."""
        fuel, shares = self._train.scene.fuel, []
        governor = fuel.governor if fuel else None
        for _ in range(_LAST if governor else 0):
            state = self._after(self._grid, _LOCAL, state, 1)
            shares += list(state.mode.shares)
        return governor is not None and {governor.min, governor.max} <= set(shares)

    def _newton(self, at: Array) -> _Point | None:
        """The fixed point near some numbers; None where none is found."""
        for _ in range(_NEWTON):
            try:
                image = partial(self._image, self._grid, _LOCAL)
                slope = slope_of(image, at, self._sizes(at), STEP)
                step = newton_step(at, image(at), slope)
            except LostError:
                return None
            at = at + step
            if not at[0] > 0.0:
                return None
            if np.max(np.abs(step) / self._sizes(at)) <= _CLOSE:
                return _Point(at, slope, largest(slope))
        return None

    def _image(self, grid: Grid, local: float, at: Array) -> Array:
        return self._numbers(self._after(grid, local, self._state(at), 1))

    def _sizes(self, at: Array) -> Array:
        """What each of the numbers is measured by."""
        law = self._train.law
        assert law is not None
        sizes = np.full(len(at), max(law.most, 1e-3))
        sizes[0] = at[0]
        if len(at) > 2 and not self._decides_here:
            sizes[2] = abs(at[2])
        return sizes

    @property
    def _decides_here(self) -> bool:
        """Whether a decision falls on the angle of the start."""
        firing = self._model.mode.firing
        assert firing is not None
        return abs(firing.theta - self._angle) < 1e-7

    def _numbers(self, state: State) -> Array:
        """What a period hands to the next: the energy [J], and with a governor its integral, the
        time since the last decision [s], unless that falls here, and the shares."""
        energy, firing = 0.5 * self._inertia * state.omega**2, state.mode.firing
        fuel = self._train.scene.fuel
        assert firing is not None
        assert fuel is not None
        if fuel.governor is None:
            return np.array([energy])
        spent = [] if self._decides_here else [-firing.time]
        return np.array([energy, firing.integral, *spent, *firing.shares])

    def _state(self, at: Array) -> State:
        """The state that begins a period with these numbers."""
        model, firing = self._model, self._model.mode.firing
        assert firing is not None
        omega = math.copysign(math.sqrt(2.0 * max(at[0], 0.0) / self._inertia), model.omega)
        if len(at) > 1:
            spent = 0.0 if self._decides_here else float(at[2])
            shares = at[-len(firing.shares) :].tolist()
            firing = firing._replace(shares=tuple(shares), time=-spent, integral=float(at[1]))
        return State(0.0, self._angle, omega, 0.0, model.mode._replace(firing=firing))

    def _after(self, grid: Grid, local: float, state: State, count: int) -> State:
        """The state after so many periods, its angle and time counted from the last one's end.

        Raises
        ------
        LostError : the crank does not turn through them
        """
        plan = replace(self._plan, until=count * self._period)
        setup = Setup(lambda *_: state, plan, self._allowed)
        one = integrate(grid, setup, local, by_angle=self._by_angle)
        end = one.path.state
        if one.ending is not Ending.COMPLETE or end is None:
            raise LostError(one.ending)
        return self._back(end, math.copysign(count * self._period, end.theta - self._angle))

    def _back(self, end: State, turned: float) -> State:
        """A state at the end of periods turned back by their angle [rad] and time."""
        train, mode, law = self._train, end.mode, self._train.law
        beyond = mode.high if turned > 0.0 else mode.low
        if abs(beyond - end.theta) < 1e-7:  # a decision that falls here is made
            mode = decided(train, mode, end.time, beyond, end.omega)
        firing = mode.firing
        assert firing is not None
        assert law is not None
        angles = {name: getattr(firing, name) - turned for name in ("theta", "low", "high")}
        firing = firing._replace(time=firing.time - end.time, **angles)
        low, high = law.next(firing)
        return State(0.0, self._angle, end.omega, 0.0, Mode(mode.loads, low, high, firing))
