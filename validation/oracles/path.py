"""The path of a free crank, step by step, whoever takes the steps.

A step never straddles a knot: its series continues the formulas of its own pieces, and where it
leaves one of them the step is cut to land on the knot. So rest, reversal, kinks and jumps are met
exactly, and the error is that of the steps themselves.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple, Protocol

import numpy as np

from validation.oracles.arithmetic import Array, Number
from validation.oracles.events import root
from validation.oracles.formulas import Formulas, Place
from validation.oracles.taylor import derivative, evaluate

STUCK = 8
"""Steps of no length in a row that are taken before giving up."""


@dataclass(frozen=True)
class Motion:
    """Samples of the motion, each shape (samples,): [s], [rad], [rad/s], [rad/s2]."""

    time: Array
    theta: Array
    omega: Array
    alpha: Array
    steps: int


@dataclass(frozen=True)
class State:
    """An instant, and the pieces of angle and speed that may come next (two on a knot)."""

    time: Number
    theta: Number
    omega: Number
    angle_pieces: list[int]
    speed_pieces: list[int]


class Advance(NamedTuple):
    """theta as a series in the time since the step's start, the step's length [s], its end.

    upper_angle, upper_speed : the end of its piece of angle or speed that it reaches (None: it
    stays inside); at most one of them.
    """

    series: Array
    length: Number
    theta: Number
    omega: Number
    upper_angle: bool | None
    upper_speed: bool | None


class Stepper(Protocol):
    """Takes single steps by the formulas of a place."""

    @property
    def formulas(self) -> Formulas:
        """The equation of motion that is stepped."""

    def alpha(self, state: State, place: Place) -> Number:
        """The acceleration [rad/s2]."""

    def advance(self, state: State, place: Place, most: Number) -> Advance:
        """One step of at most so many seconds."""


class _Step(NamedTuple):
    start: Number
    length: Number
    reached: Number
    series: Array
    place: Place


class Path:
    """The motion from (theta0, omega0) at t = 0: found once, and only as far as it is asked for.

    Raises ArithmeticError where a jump of the torque holds the motion on itself, and ValueError
    for a time table that does not cover what is asked for.
    """

    def __init__(self, stepper: Stepper, theta0: Number, omega0: Number) -> None:
        self._stepper, self._formulas = stepper, stepper.formulas
        self._arithmetic = stepper.formulas.arithmetic
        zero, theta, omega = (self._arithmetic.number(x) for x in (0, theta0, omega0))
        pieces = self._formulas.angles.pieces_at(theta), self._formulas.speeds.pieces_at(omega)
        self._kept: list[_Step] = []
        self._coming = self._walk(State(zero, theta, omega, *pieces))

    def at_times(self, times: Array) -> Motion:
        """At increasing times [s] from 0 or later; the last is above 0.

        At a jump of the torque alpha is the value after it, at the last time the one before.
        """
        if times[-1] <= 0:
            raise ValueError("the last time must be above 0")
        starts = []
        for step in self._steps():
            starts.append(step.start)
            if step.start + step.length >= times[-1]:
                break
        rows = [bisect_right(starts, time) - 1 for time in times[:-1]]
        rows.append(bisect_left(starts, times[-1]) - 1)
        return self._samples(rows, times - np.array(starts)[rows])

    def at_angles(self, angles: Array) -> Motion:
        """At angles [rad] that follow one another in the direction of the rotation, which must
        not reverse before it has passed the last of them."""
        rows: list[int] = []
        since: list[Number] = []
        sign = None
        for row, step in enumerate(self._steps()):
            sign = sign or (1 if angles[-1] > step.series[0] else -1)
            passed = self._arithmetic.number(0)
            while sign * (step.reached - angles[len(rows)]) > 0 or step.reached == angles[-1]:
                shifted = step.series.copy()
                shifted[0] = shifted[0] - angles[len(rows)]
                if shifted[0] != 0:
                    passed = root(shifted, passed, step.length, self._arithmetic)
                rows.append(row)
                since.append(passed)
                if len(rows) == len(angles):
                    return self._samples(rows, np.array(since))
        raise AssertionError("the steps have no end")

    def _samples(self, rows: list[int], since: Array) -> Motion:
        """The motion in the steps `rows`, so long [s] after their starts.

        alpha is that of the equations there: a series derived twice errs by far more at its end.
        """
        time = np.array([self._kept[row].start for row in rows]) + since
        theta = np.stack([self._kept[row].series for row in rows], axis=1)
        omega = evaluate(derivative(theta), since)
        theta = evaluate(theta, since)
        places = [self._kept[row].place for row in rows]
        alpha = [
            self._stepper.alpha(State(t, angle, speed, [place.angle], [place.speed]), place)
            for t, angle, speed, place in zip(time, theta, omega, places, strict=True)
        ]
        return Motion(time, theta, omega, np.array(alpha, dtype=omega.dtype), rows[-1] + 1)

    def _steps(self) -> Iterator[_Step]:
        """All steps from the first on, without end."""
        yield from self._kept
        for step in self._coming:
            self._kept.append(step)
            yield step
        raise ArithmeticError("the path could not be followed any further")

    def _walk(self, state: State) -> Iterator[_Step]:
        formulas, idle = self._formulas, 0
        while True:
            place = self._enter(state)
            next_time = formulas.times.knot(place.time + 1)
            ahead = self._stepper.advance(state, place, next_time - state.time)
            stays = ahead.upper_angle is None and ahead.upper_speed is None
            to_the_knot = stays and ahead.length >= next_time - state.time
            after = State(
                next_time if to_the_knot else state.time + ahead.length,
                ahead.theta,
                ahead.omega,
                [place.angle],
                [place.speed],
            )
            if ahead.upper_angle is not None:
                upper = place.angle + ahead.upper_angle
                on = formulas.angles.knot(upper)
                after = replace(after, theta=on, angle_pieces=[upper, upper - 1])
            if ahead.upper_speed is not None:
                upper = place.speed + ahead.upper_speed
                on = formulas.speeds.knot(upper)
                after = replace(after, omega=on, speed_pieces=[upper, upper - 1])
            idle = idle + 1 if after.time == state.time else 0
            if idle > STUCK:
                raise ArithmeticError(f"no progress at t = {float(state.time)} s")
            yield _Step(state.time, ahead.length, after.theta, ahead.series, place)
            state = after

    def _enter(self, state: State) -> Place:
        """The pieces that the motion enters: on a knot they are told by its direction."""
        time_piece = self._formulas.times.pieces_at(state.time)[0]
        on_angle, on_speed = len(state.angle_pieces) == 2, len(state.speed_pieces) == 2
        for angle_piece, speed_piece in product(state.angle_pieces, state.speed_pieces):
            place = Place(angle_piece, speed_piece, time_piece)
            above = angle_piece == state.angle_pieces[0]
            if on_angle and state.omega != 0 and above != (state.omega > 0):
                continue
            if on_speed or (on_angle and state.omega == 0):
                rising = self._stepper.alpha(state, place) >= 0
                if on_speed and (speed_piece == state.speed_pieces[0]) != rising:
                    continue
                if on_angle and state.omega == 0 and above != rising:
                    continue
            return place
        raise ArithmeticError(
            f"at t = {float(state.time)} s the torque's jump holds the motion on itself"
        )
