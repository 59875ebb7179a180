"""One stretch of a run after the other, each beginning where the last one ended.

A stretch ends at a time given for it, or at a crank angle where the gas force of a cylinder jumps
or the run ends. Each begins on the closed loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from crankmbs.formulations.base import Array
from crankmbs.formulations.multibody.gas import GasStretch
from crankmbs.formulations.multibody.loads import torque_function
from crankmbs.formulations.multibody.model import Model, Record
from crankmbs.formulations.multibody.problem import Problem
from crankmbs.formulations.multibody.run_up import run_free, run_prescribed
from crankmbs.formulations.multibody.start import coordinates
from crankmbs.formulations.multibody.table import ROWS, Table, table_of
from crankmbs.geometry import close_loop
from crankmbs.roots import invert_monotone

__all__ = ["LEAST_STEPS", "Walk", "initial_acceleration"]

LEAST_STEPS = ROWS + 2
_PASSED = 1e-8  # rad
_OPEN = 1e-3  # of the rod's length: how far a piston may be off the closed loop


class Walk:
    """The stretches so far, and the time and state at which the next begins.

    tables : one per stretch
    time [s] : where the last one ended
    steps, iterations : what they cost
    """

    def __init__(self, problem: Problem, model: Model, go_on: Callable[[], bool]) -> None:
        self.tables: list[Table] = []
        self.time, self._state = 0.0, problem.start
        self._problem, self._model, self._go_on = problem, model, go_on
        self._residual = 0.0
        self.steps = self.iterations = 0

    def is_at_gas_jump(self) -> bool:
        """Whether the gas force of a cylinder jumps where the last stretch ended."""
        theta, gas = self._state[0], self.tables[-1].gas
        ends = [end for end in (gas.low, gas.high) if abs(end - theta) < _PASSED]
        self._state = (ends[0] if ends else theta, self._state[1])
        return bool(ends) and self.time > self.tables[-1].after

    def stretch(
        self,
        end: float,
        step: float,
        steps: int,
        bounds: tuple[float, float],
        *,
        with_run_up: bool,
    ) -> tuple[float | None, str]:
        """Run one more, to time ``end`` [s] if no crank angle ends it before.

        Returns
        -------
        the crank angle that ended it, if one did, and how it ended, as in `Path`
        """
        problem, model, time = self._problem, self._model, self.time
        gas = _enter(problem, model, (time, end), self._state)
        low, high = max(bounds[0], gas.low), min(bounds[1], gas.high)
        watch = _Watch(low, high, self._go_on)
        if problem.law is None:
            record, lead = run_free(
                problem.scene, model, time, self._state, step, steps, watch, with_run_up
            )
        else:
            record, lead = run_prescribed(
                problem.scene, model, problem.law, time, step, steps, watch
            )
        record = _on_one_loop(problem, record)
        self.steps += len(record.time) - 1
        self.iterations += record.iterations
        if len(record.time) < lead + LEAST_STEPS:
            return None, "failed"
        torque = record.drive
        if problem.law is None:
            speeds = record.velocity[:, 2].tolist()
            torque = np.array(list(map(model.torque, record.time.tolist(), speeds)))
        table = table_of(problem.scene, gas, torque, record, time, self._residual)
        bound = _bound(record, low, high)
        if bound is not None:
            table = _cut(table, bound)
        elif record.complete and not watch.called_off:
            table = table._replace(until=end)
        self.tables.append(table)
        self.time = table.until
        last = {
            name: float(values.flat[0]) for name, values in table.at(np.array([self.time])).items()
        }
        self._residual = last["energy_residual"]
        self._state = (last["crank_angle"] if bound is None else bound), last["crank_speed"]
        if watch.called_off:
            return bound, "called off"
        return bound, "complete" if record.complete else "failed"


class _Watch:
    """Ends a stretch a little beyond the crank angles ``low`` or ``high``, or calls it off."""

    def __init__(self, low: float, high: float, go_on: Callable[[], bool]) -> None:
        self._low, self._high, self._go_on = low - _PASSED, high + _PASSED, go_on
        self._count = self._beyond = 0
        self.called_off = False

    def __call__(self, theta: float) -> bool:
        self._count += 1
        if self._low < theta < self._high:
            self._beyond = 0
            if self._count % 64 == 0 and not self._go_on():
                self.called_off = True
            return not self.called_off
        self._beyond += 1
        return self._beyond <= ROWS // 2 or self._count <= LEAST_STEPS


def _enter(
    problem: Problem, model: Model, times: tuple[float, float], state: tuple[float, float]
) -> GasStretch:
    """Give the model the loads of the stretch that begins and ends at two times, from a state."""
    theta, omega = state
    model.torque = torque_function(problem.scene.torque, *times)
    for sense in (omega,) if omega != 0.0 else (1.0, -1.0):
        gas = problem.gas.stretch(theta, sense)
        model.gas = gas.functions() if problem.scene.gas is not None else ()
        if omega != 0.0 or problem.law is not None:
            break
        if sense * _acceleration(problem, model, times[0], state) >= 0.0:
            break
    return gas


def initial_acceleration(problem: Problem, model: Model) -> float:
    """Crank acceleration [rad/s2] of a free crank at its start."""
    _enter(problem, model, (0.0, 0.0), problem.start)
    return _acceleration(problem, model, 0.0, problem.start)


def _acceleration(problem: Problem, model: Model, time: float, state: tuple[float, float]) -> float:
    start = coordinates(problem.scene, *state)
    return float(model.consistent(start, time).acceleration[0, 2])


def _on_one_loop(problem: Problem, record: Record) -> Record:
    """The record up to where a rod turns over at a fold, into the other way to close the loop."""
    scene, n = problem.scene, len(problem.scene.cylinders)
    pistons = record.position[:, 3:].reshape(-1, n, 5)[..., 3:]
    along = np.array([[math.cos(c.bank), math.sin(c.bank)] for c in scene.cylinders])
    phi = record.position[:, 2:3] + problem.gas.phases
    exact = close_loop(phi, scene.crank.radius, scene.rod.length, scene.piston.offset).x
    closed = np.abs((pistons * along).sum(axis=-1) - exact) < _OPEN * scene.rod.length
    over = np.flatnonzero(~closed.all(axis=1))
    if len(over) == 0:
        return record
    kept: dict[str, Any] = {name: rows[: over[0]] for name, rows in record.rows().items()}
    return record._replace(**kept, complete=False)


def _bound(record: Record, low: float, high: float) -> float | None:
    """The crank angle at which a stretch ended, if it was one."""
    theta = float(record.position[-1, 2])
    return low if theta <= low else high if theta >= high else None


def _cut(table: Table, bound: float) -> Table:
    """End a table where its crank angle last comes to a bound."""
    theta, times = table.column("crank_angle"), table.times
    sense = math.copysign(1.0, theta[-1] - theta[-ROWS])
    k = int(np.flatnonzero(sense * (theta - bound) < 0.0)[-1])
    low, high = times[k : k + 1], times[k + 1 : k + 2]

    def angle(time: Array) -> tuple[Array, Array]:
        return table.one_at("crank_angle", time), table.one_at("crank_speed", time)

    until = float(invert_monotone(angle, np.array([bound]), low, high)[0])
    return table._replace(until=max(until, table.after))
