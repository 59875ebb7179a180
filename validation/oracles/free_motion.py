"""Free motion of the crank by Taylor series in time, one formula of gas and loads per step.

A step never straddles a knot: its series continues the formulas of its own pieces, and where it
leaves one of them the step is cut to land on the knot. So rest, reversal, kinks and jumps are met
exactly, and the error is that of truncation (below rounding) and of rounding.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from validation.oracles import bodies
from validation.oracles.arithmetic import LONG, Arithmetic, Array, Number
from validation.oracles.events import first_exit, root, step_size
from validation.oracles.gas_pieces import gas_forces
from validation.oracles.loads import load_piece, speed_grid, time_grid
from validation.oracles.machine import Machine
from validation.oracles.taylor import derivative, evaluate, motion_series

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
class _State:
    """An instant, and the pieces of angle and speed that may come next (two on a knot)."""

    time: Number
    theta: Number
    omega: Number
    angle_pieces: list[int]
    speed_pieces: list[int]


@dataclass(frozen=True)
class _Step:
    """theta(t) from `start` for `length` to `reached`, as a series in the time since its start."""

    start: Number
    length: Number
    reached: Number
    theta: Array
    omega: Array
    alpha: Array


class _Run:
    """A machine with all that does not change during a run."""

    def __init__(self, machine: Machine, arithmetic: Arithmetic, order: int) -> None:
        self.machine, self.arithmetic, self.order = machine, arithmetic, order
        self.system = bodies.build(machine, bodies.TORQUE, arithmetic)
        self.gas = gas_forces(machine, arithmetic)
        self.speeds = speed_grid(machine.loads, arithmetic)
        self.times = time_grid(machine.loads, arithmetic)

    def start(self, theta: Number, omega: Number) -> _State:
        angle_pieces = self.gas.grid.pieces_at(theta) if self.gas else [0]
        zero = self.arithmetic.number(0)
        return _State(zero, theta, omega, angle_pieces, self.speeds.pieces_at(omega))

    def series(self, state: _State) -> tuple[Array, int, int]:
        """The series of theta, in the pieces of angle and speed that the motion enters."""
        theta, omega = (self.arithmetic.array([x]) for x in (state.theta, state.omega))
        angle, rate = bodies.pose(self.machine, theta, omega, self.arithmetic)
        time_piece = self.times.pieces_at(state.time)[0]
        for angle_piece, speed_piece in product(state.angle_pieces, state.speed_pieces):
            above = angle_piece == state.angle_pieces[0]
            if len(state.angle_pieces) == 2 and state.omega != 0 and above != (state.omega > 0):
                continue
            load = load_piece(
                self.machine.loads,
                state.time,
                self.times.inside(time_piece),
                self.speeds.inside(speed_piece),
                self.arithmetic,
            )
            gas = self.gas.piece(angle_piece) if self.gas else None
            series = motion_series(
                self.system, angle[0], rate[0], load, gas, self.order, self.arithmetic
            )
            rising = series[2] >= 0
            if len(state.speed_pieces) == 2 and (speed_piece == state.speed_pieces[0]) != rising:
                continue
            if len(state.angle_pieces) == 2 and state.omega == 0 and above != rising:
                continue
            return series, angle_piece, speed_piece
        raise ArithmeticError(
            f"at t = {float(state.time)} s the torque's jump holds the motion on itself"
        )

    def steps(self, state: _State, end: Number) -> Iterator[_Step]:
        """Steps from the state up to the time `end`, or without end."""
        idle = 0
        while state.time < end:
            theta, angle_piece, speed_piece = self.series(state)
            omega = derivative(theta)
            next_time = min(end, self.times.knot(self.times.pieces_at(state.time)[0] + 1))
            size = step_size(omega, self.arithmetic)
            to_the_end = size >= next_time - state.time
            size = next_time - state.time if to_the_end else size
            bounds = self.gas.grid.bounds(angle_piece) if self.gas else _unbounded(self.arithmetic)
            angle_exit = first_exit(theta, bounds, size, self.arithmetic)
            speed_exit = first_exit(omega, self.speeds.bounds(speed_piece), size, self.arithmetic)
            if angle_exit and speed_exit:
                if angle_exit.time <= speed_exit.time:
                    speed_exit = None
                else:
                    angle_exit = None
            event = angle_exit or speed_exit
            size = event.time if event else size
            after = _State(
                next_time if to_the_end and not event else state.time + size,
                evaluate(theta, size),
                evaluate(omega, size),
                [angle_piece],
                [speed_piece],
            )
            if angle_exit:
                upper = angle_piece + angle_exit.upper
                after = replace(after, theta=angle_exit.bound, angle_pieces=[upper, upper - 1])
            if speed_exit:
                upper = speed_piece + speed_exit.upper
                after = replace(after, omega=speed_exit.bound, speed_pieces=[upper, upper - 1])
            idle = idle + 1 if after.time == state.time else 0
            if idle > STUCK:
                raise ArithmeticError(f"no progress at t = {float(state.time)} s")
            yield _Step(state.time, size, after.theta, theta, omega, derivative(omega))
            state = after


def free_motion(
    machine: Machine,
    theta0: Number,
    omega0: Number,
    *,
    times: Sequence[Number] | None = None,
    angles: Sequence[Number] | None = None,
    order: int | None = None,
    arithmetic: Arithmetic = LONG,
) -> Motion:
    """The motion from (theta0, omega0) at t = 0, at increasing times or at angles passed in turn.

    times [s] increase from 0 or later; the last is above 0. angles [rad] follow one another in
    the direction of the rotation, which must not reverse before it has passed the last of them.
    At a jump of the torque alpha is the value after it, at the very end of the run the one before.
    order is that of the Taylor series (default 1.3 times the digits). Raises ArithmeticError
    where a jump of the torque holds the motion on itself, and ValueError for a time table that
    does not cover the run.
    """
    run = _Run(machine, arithmetic, order or round(1.3 * arithmetic.digits))
    start = run.start(arithmetic.number(theta0), arithmetic.number(omega0))
    if times is not None and angles is None:
        return _at_times(run, start, arithmetic.array(times))
    if angles is not None and times is None:
        return _at_angles(run, start, arithmetic.array(angles))
    raise ValueError("give either times or angles")


def _at_times(run: _Run, start: _State, times: Array) -> Motion:
    if times[-1] <= 0:
        raise ValueError("the last time must be above 0")
    samples: list[list[Number]] = []
    count = 0
    for step in run.steps(start, times[-1]):
        count += 1
        after = step.start + step.length
        while len(samples) < len(times) - 1 and times[len(samples)] < after:
            samples.append(_sample(step, times[len(samples)] - step.start))
    samples.append(_sample(step, times[-1] - step.start))
    return _motion(samples, count)


def _at_angles(run: _Run, start: _State, angles: Array) -> Motion:
    samples: list[list[Number]] = []
    sign = 1 if angles[-1] > start.theta else -1
    for count, step in enumerate(run.steps(start, run.arithmetic.number("inf")), 1):
        passed = run.arithmetic.number(0)
        while sign * (step.reached - angles[len(samples)]) > 0 or step.reached == angles[-1]:
            shifted = step.theta.copy()
            shifted[0] = shifted[0] - angles[len(samples)]
            if shifted[0] != 0:
                passed = root(shifted, passed, step.length, run.arithmetic)
            samples.append(_sample(step, passed))
            if len(samples) == len(angles):
                return _motion(samples, count)
    raise AssertionError("the steps have no end")


def _motion(samples: list[list[Number]], steps: int) -> Motion:
    time, theta, omega, alpha = np.array(samples).T
    return Motion(time, theta, omega, alpha, steps)


def _sample(step: _Step, since: Number) -> list[Number]:
    series = (step.theta, step.omega, step.alpha)
    return [step.start + since, *(evaluate(one, since) for one in series)]


def _unbounded(arithmetic: Arithmetic) -> tuple[Number, Number]:
    return arithmetic.number("-inf"), arithmetic.number("inf")
