"""The samples of a plan on a run, and the variables of several runs at the same samples."""

from __future__ import annotations

import itertools
import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.motion.multibody.held import held_by
from crankmbs.motion.multibody.problem import Problem
from crankmbs.motion.multibody.step_table import StepTable
from crankmbs.motion.multibody.stepped import Stepped
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import NEAR
from crankmbs.numerics.roots import invert_monotone

__all__ = ["Sampled", "aligned_variables", "monotone", "reached", "slowed", "times_of"]

_BEYOND = 2.0  # steps that the variables are continued past the end of a run
_AT_END = 1e-3  # of a step: so near the end of a stretch a sample is at it
_NEAR = 1e-9  # of the sample spacing, and rad: what is nearer is one


class _Samples(NamedTuple):
    """Times [s], crank angles [rad], and the number of the stretch each one lies in."""

    time: Array
    theta: Array
    stretch: Array


class Sampled:
    """A run with its samples, and the variables there once they are asked for."""

    def __init__(self, problem: Problem, path: Stepped) -> None:
        self.path, self.samples = path, _samples(problem, path)
        self._problem = problem
        self._at_angles: dict[int, dict[str, Array] | None] = {}  # by the number of samples

    @cached_property
    def at_own(self) -> dict[str, Array]:
        """The variables at the run's own samples, whose crank angles are those of every run."""
        return _variables_at(self._problem, self.path, self.samples, by_angle=True)

    def at_angles(self, finest: _Samples) -> dict[str, Array] | None:
        """The variables at the crank angles of another run; None where one of them reverses.

        A run that ends at a time may pass one angle of the grid more or fewer than the other.
        """
        count = len(finest.time)
        if len(self.samples.time) == count:
            return self.at_own
        if count not in self._at_angles:
            samples = _same_angles(self.path, self.samples, finest)
            self._at_angles[count] = (
                None
                if samples is None
                else _variables_at(self._problem, self.path, samples, by_angle=True)
            )
        return self._at_angles[count]


def aligned_variables(problem: Problem, runs: list[Sampled]) -> list[dict[str, Array]]:
    """The variables of each run at the same samples, at the same crank angles or times.

    At the same angles each run has times of its own. Runs that pass the grid of angles differently
    often, near a reversal, are compared at the times of the finest, and only the last two of them,
    so that nothing is extrapolated. An end at a crank angle each run reaches at a time of its own.
    "ahead" is the crank angle at the finest run's times.
    """
    finest, plan = runs[-1].samples, problem.plan
    if not plan.in_time:
        found = [run.at_angles(finest) for run in runs]
        alike = [dict(variables) for variables in found if variables is not None]
        if len(alike) == len(runs):
            for variables in alike:
                _look_ahead(variables, alike[-1], finest)
            return alike
    runs = runs if plan.in_time else runs[-2:]
    samples = [finest] * len(runs)
    if plan.in_time and not plan.until_time:
        samples = [_ending_as(run.samples, finest) for run in runs]
    paths = [run.path for run in runs]
    aligned = [_variables_at(problem, p, s) for p, s in zip(paths, samples, strict=True)]
    speed = aligned[-1]["crank_speed"]
    for variables, path in zip(aligned, paths, strict=True):
        _look_ahead(variables, aligned[-1], finest)
        if not plan.in_time:  # the time at which it has the sample's angle
            off = variables["crank_angle"] - finest.theta
            early = np.divide(off, speed, out=np.zeros_like(off), where=speed != 0.0)
            variables["time"] = finest.time - early
            # a torque over time errs by being asked for too early, and by nothing else
            there = finest._replace(time=np.clip(variables["time"], 0.0, reached(path)[0]))
            at_angle = _variables_at(problem, path, there)
            variables["external_torque"] = at_angle["external_torque"]
    return aligned


def _look_ahead(variables: dict[str, Array], last: dict[str, Array], finest: _Samples) -> None:
    late = variables["time"] - finest.time
    variables["ahead"] = variables["crank_angle"] - last["crank_speed"] * late


def _ending_as(run: _Samples, finest: _Samples) -> _Samples:
    """The samples of the finest run, the last one where this run ends."""
    joined = (np.append(q[:-1], end[-1]) for q, end in zip(finest, run, strict=True))
    return _Samples(*joined)


def reached(path: Stepped) -> tuple[float, float, float]:
    """Time [s], crank angle [rad] and speed [rad/s] where a run ends."""
    last = path.tables[-1]
    at = np.array([last.until])
    theta, omega = (float(last.one_at(name, at)[0]) for name in ("crank_angle", "crank_speed"))
    return last.until, theta, omega


def slowed(path: Stepped) -> float:
    """The fastest speed in the last tenth of a run, relative to the fastest of all."""
    speeds = np.abs(np.concatenate([table.column("crank_speed") for table in path.tables]))
    return float(np.max(speeds[-(len(speeds) // 10) :]) / np.max(speeds))


def _samples(problem: Problem, path: Stepped) -> _Samples:
    """Where the plan wants samples on this run, the start and the end included."""
    plan = problem.plan
    end, theta_end, _ = reached(path)
    for bound in plan.angle_bounds:
        theta_end = bound if abs(theta_end - bound) < _NEAR else theta_end
    times, angles, stretches = [np.zeros(1)], [np.array([problem.start[0]])], [np.zeros(1, int)]
    moved = False  # what comes first then is the start, which is there
    for k, table in enumerate(path.tables):
        for begin, until in monotone(table):
            theta_begin, theta_until = table.one_at("crank_angle", np.array([begin, until]))
            if plan.in_time:
                t = _grid(0.0, plan.every, begin, until)
                theta = table.one_at("crank_angle", t)
            else:
                theta = _grid(plan.start, plan.every, theta_begin, theta_until)
                t = times_of(table, theta, begin, until)
            new = slice(0 if moved else 1, None)
            moved |= until > 0.0 and (
                plan.in_time or abs(theta_until - plan.start) > _NEAR * plan.every
            )
            times.append(t[new])
            angles.append(theta[new])
            stretches.append(np.full(len(t[new]), k))
    time = np.append(np.concatenate(times), end)
    theta = np.append(np.concatenate(angles), theta_end)
    stretch = np.append(np.concatenate(stretches), len(path.tables) - 1)
    far = np.flatnonzero(np.abs(theta - theta_end) > plan.last * (1.0 + 1e-12))
    first = int(far[-1]) + 1 if len(far) else 0
    stretch = _above_jumps(path, time, theta, stretch)
    return _Samples(time[first:], theta[first:], stretch[first:])


def _above_jumps(path: Stepped, time: Array, theta: Array, stretch: Array) -> Array:
    """The stretches of samples in time and angle, those that one begins with backwards from a jump
    of the gas force in the stretch before: at the jump the value above it counts."""
    tables = path.tables
    for k in range(1, len(tables)):
        table, jump = tables[k], tables[k].gas.high
        rises = table.gas.slides is None or table.gas.rises[1].any()  # else it is friction's
        if abs(tables[k - 1].gas.low - jump) <= NEAR and rises:
            at_once = np.abs(time - table.after) < table.step
            on = at_once & (stretch == k) & (np.abs(theta - jump) <= NEAR)
            stretch = stretch - on
    return stretch


def _same_angles(path: Stepped, own: _Samples, finest: _Samples) -> _Samples | None:
    """The crank angles of a finer run, but for its end, on a run without a reversal."""
    sense = 1.0 if own.theta[-1] >= own.theta[0] else -1.0
    theta = finest.theta[:-1]
    if np.any(sense * np.diff(theta) <= 0.0) or np.any(sense * np.diff(own.theta) <= 0.0):
        return None
    last = path.tables[-1]
    beyond = last._replace(until=last.until + _BEYOND * last.step)
    times, stretches = [], []
    for k, table in enumerate([*path.tables[:-1], beyond]):
        low, high = sense * table.one_at("crank_angle", np.array([table.after, table.until]))
        here = (sense * theta >= low - _NEAR) & (sense * theta < high - _NEAR)
        times.append(times_of(table, theta[here], table.after, table.until))
        stretches.append(np.full(np.count_nonzero(here), k))
    time = np.concatenate(times)
    if len(time) != len(theta):
        return None
    stretch = _above_jumps(path, time, theta, np.concatenate(stretches))
    return _Samples(
        np.append(time, own.time[-1]),
        np.append(theta, own.theta[-1]),
        np.append(stretch, own.stretch[-1]),
    )


def _grid(origin: float, every: float, begin: float, end: float) -> Array:
    """Grid values from ``begin`` on and before ``end``, in the order in which they are passed."""
    sign = 1.0 if end >= begin else -1.0
    first, last = (math.ceil(sign * (x - origin) / every - _NEAR) for x in (begin, end))
    return np.asarray(origin + sign * every * np.arange(first, last))


def monotone(table: StepTable) -> list[tuple[float, float]]:
    """Times between which the crank does not reverse."""
    times, speed = table.times, table.column("crank_speed")
    moving = (times > table.after) & (times < table.until)
    moving &= np.abs(speed) > _NEAR * np.max(np.abs(speed))
    times, speed = times[moving], speed[moving]
    k = np.flatnonzero(speed[:-1] * speed[1:] < 0.0)

    def value(time: Array) -> tuple[Array, Array]:
        return table.with_rate("crank_speed", "crank_acceleration", time)

    turns: list[float] = []
    if len(k) > 0:
        turns = invert_monotone(value, np.zeros(len(k)), times[k], times[k + 1]).tolist()
    return list(itertools.pairwise([table.after, *turns, table.until]))


def times_of(table: StepTable, theta: Array, begin: float, end: float) -> Array:
    """Times at which the crank comes to the angles, where it does not reverse."""
    times = table.times
    between, ends = (times > begin) & (times < end), np.array([begin, end])
    edges = np.concatenate([ends[:1], times[between], ends[1:]])
    at_ends = table.one_at("crank_angle", ends)
    at_rows = table.column("crank_angle")[between]
    reached = np.concatenate([at_ends[:1], at_rows, at_ends[1:]])
    sign = 1.0 if reached[-1] >= reached[0] else -1.0
    k = np.clip(np.searchsorted(sign * reached, sign * theta) - 1, 0, len(edges) - 2)

    def value(time: Array) -> tuple[Array, Array]:
        return table.with_rate("crank_angle", "crank_speed", time)

    low, high, (at_low, at_high) = edges[k], edges[k + 1], (reached[k], reached[k + 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.nan_to_num((theta - at_low) / (at_high - at_low))
    line = low + (high - low) * np.clip(share, 0.0, 1.0)
    time, slow = table.crossing(theta, low, high, line)
    if slow.any():  # next to a reversal
        time[slow] = invert_monotone(value, theta[slow], low[slow], high[slow])
    return np.asarray(time)


def _fuel(path: Stepped, k: int, theta: Array) -> Array:
    """The shares of the combustion at samples of stretch k; at a decision those before it."""
    gas, before = path.tables[k].gas, path.tables[max(k - 1, 0)].gas
    fuel = np.tile(gas.shares, (len(theta), 1))
    if len(theta) > 0 and np.isclose(theta[0], [before.low, before.high], 0.0, _NEAR).any():
        fuel[0] = before.shares
    return fuel


def _turn(table: StepTable, after: StepTable, part: dict[str, Array]) -> None:
    """Where a sample ends a stretch at a dead centre, as gas above a jump is asked for, friction
    is still that after it: it has no lever there, and changes the joint forces alone."""
    at_end = np.abs(part["time"] - table.until) < _AT_END * table.step
    if at_end.any():
        gas, theta = part["gas_force"], part["crank_angle"]
        change = (after.gas.rubbed(gas) - table.gas.rubbed(gas)) * at_end[:, None]
        part["rings"] = table.gas.rubbed(gas) + change
        for name, force in held_by(table.scene, change, theta).items():
            part[name] = part[name] + force


def _variables_at(
    problem: Problem, path: Stepped, samples: _Samples, *, by_angle: bool = False
) -> dict[str, Array]:
    parts = []
    stretch = np.minimum(samples.stretch, len(path.tables) - 1)  # a coarser run may have fewer
    for k, table in enumerate(path.tables):
        here = stretch == k
        time, theta = samples.time[here], samples.theta[here]
        part = {"time": time, **table.at(time)}
        if problem.law is not None:
            part["crank_speed"], part["crank_acceleration"] = problem.law.at_time(time)[1:]
        if by_angle:
            part["crank_angle"] = theta
        if table.gas.shares:
            part["fuel"] = _fuel(path, k, part["crank_angle"])
        part["gas_force"] = table.gas.force(part["crank_angle"])
        if problem.scene.friction is not None:
            if k + 1 < len(path.tables):
                _turn(table, path.tables[k + 1], part)
            rings = part.pop("rings", table.gas.rubbed(part["gas_force"]))
            part["friction_force"] = (
                rings - problem.scene.friction.viscous * part["piston_velocity"]
            )
        part["gas_pressure"] = part["gas_force"] / (problem.scene.piston.gas_area or 1.0)
        parts.append(part)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
