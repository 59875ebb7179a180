"""One stretch of a run after the other, each beginning where the last one ended.

A stretch ends at a time given for it; at a crank angle where the gas force of a cylinder jumps or
the run ends; or at a speed where a load bends or jumps. Each begins on the closed loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.windows import acting, first_phases, later_phases, phase_ends
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode
from crankmbs.motion.multibody.gas import GasStretch
from crankmbs.motion.multibody.landing import (
    LEAST_STEPS,
    Bounds,
    Watch,
    angle_passed,
    cut_at_angle,
    cut_at_speed,
)
from crankmbs.motion.multibody.loads import EVERYWHERE, speeds_around, torque_function
from crankmbs.motion.multibody.model import Model, Record
from crankmbs.motion.multibody.problem import Problem
from crankmbs.motion.multibody.run_up import Steps, run_free, run_prescribed
from crankmbs.motion.multibody.start import coordinates
from crankmbs.motion.multibody.step_table import StepTable, table_of
from crankmbs.scene.torque import Torque

__all__ = ["SAME", "Walk", "initial_acceleration"]

SAME = 1e-12  # relative: times nearer than this are one

_OPEN = 1e-3  # of the rod's length: how far a piston may be off the closed loop
_NOTHING = 1e-9  # of a step: a stretch so short has not begun
_MOST_SPEEDS = 100  # landed on in a run; beyond, it runs over the bends of the loads as they are


class Walk:
    """The stretches so far, and the time and state at which the next begins.

    tables : one per stretch
    time [s] : where the last one ended
    bound [rad] : the crank angle that ended it, if one did
    landings : the state at the start and where each stretch of some length ended
    steps, iterations : what they cost
    """

    def __init__(self, problem: Problem, model: Model, go_on: Callable[[], bool] | None) -> None:
        self.tables: list[StepTable] = []
        self.time, self._state = 0.0, problem.start
        self.bound: float | None = None
        self._problem, self._model, self._go_on = problem, model, go_on
        self._residual = 0.0
        self._sense = 0.0  # in which the speed passed a bend of the loads
        free = problem.law is None
        law = problem.gas.law
        self._firing = law.first if law else None
        self._phases = first_phases(problem.scene.torque, problem.start[1]) if free else ()
        self._speeds_left = _MOST_SPEEDS
        self.landings = [self._landing()]
        self.steps = self.iterations = 0

    @property
    def is_blind(self) -> bool:
        """Whether it runs over bends of the loads over speed as they are."""
        return self._speeds_left == 0

    def is_at_gas_jump(self, near: float) -> bool:
        """Whether the gas force of a cylinder jumps here, or so near [rad]; if so, go there."""
        theta, omega = self._state
        gas = self._problem.gas.stretch(theta, 1.0)
        rubs = self._problem.scene.friction is not None  # then it may be a dead centre
        ends = [
            end
            for end, rises in zip((gas.low, gas.high), gas.rises, strict=True)
            if abs(end - theta) < near and (rises.any() or not rubs)
        ]
        self._state = (ends[0] if ends else theta, omega)
        return bool(ends)

    def is_at_dead_centre(self, near: float) -> bool:
        """Whether friction jumps here, or so near [rad], as a piston turns; if so, go there."""
        theta, omega = self._state
        if self._problem.scene.friction is None:
            return False
        gas = self._problem.gas.stretch(theta, -omega or 1.0)
        ends = [end for end in (gas.low, gas.high) if abs(end - theta) < near]
        self._state = (ends[0] if ends else theta, omega)
        return bool(ends)

    @property
    def goes_up(self) -> bool:
        """Whether the crank angle rises."""
        return self._state[1] > 0.0

    def stretch(self, end: float, step: float, steps: int, angles: tuple[float, float]) -> Ending:
        """Run one more, to time ``end`` [s] if no crank angle or speed ends it before.

        Returns
        -------
        how it ended, as in `Stepped`
        """
        entered = self.enter(end)
        if entered is None:
            return Ending.HELD
        gas, speeds = entered
        for _ in range(2):
            bounds = Bounds((max(angles[0], gas.low), min(angles[1], gas.high)), speeds)
            table, ending = self._run(gas, bounds, end, step, steps)
            if table is None:
                return ending
            passed = angle_passed(table, bounds.angles)
            if passed is not None:
                table = cut_at_angle(table, *passed)
                begun = table.until - table.after > _NOTHING * step
                if not begun and passed[0] not in angles:  # it is the gas beyond that it meets
                    gas = self._gas_beside(passed[1])
                    continue
            elif ending is Ending.COMPLETE:
                table = table._replace(until=end)
            self._land(table, bounds, None if passed is None else passed[0])
            return ending
        return Ending.HELD

    def above(self, step: float) -> None:
        """Take a stretch of no length, with what is above a jump of the gas force here, and after
        one of friction.

        None where a jump of the loads over speed stands against it, or where the solver fails.
        """
        end = self.time + LEAST_STEPS * step
        if self.enter(end) is None:
            return
        gas = self._gas_beside(1.0)
        table, _ = self._run(gas, Bounds(EVERYWHERE, EVERYWHERE), end, step, LEAST_STEPS)
        if table is not None:
            self.tables.append(table._replace(until=table.after))

    def _run(
        self, gas: GasStretch, bounds: Bounds, end: float, step: float, steps: int
    ) -> tuple[StepTable | None, Ending]:
        """Run with the loads of the model; the table, if it has its rows, and how it ended."""
        problem, model, time = self._problem, self._model, self.time
        watch = Watch(bounds, self._go_on)
        ahead = Steps(time, step, steps, None if watch.idle else watch)
        if problem.law is None:
            record, lead = run_free(problem.scene, model, self._state, ahead)
        else:
            record, lead = run_prescribed(problem.scene, model, problem.law, ahead)
        record = _on_one_loop(problem, record)
        self.steps += len(record.time) - 1
        self.iterations += record.iterations
        if len(record.time) < lead + LEAST_STEPS:
            return None, Ending.DIVERGED
        torque = record.drive
        if problem.law is None:
            angles, rates = record.position[:, 2].tolist(), record.velocity[:, 2].tolist()
            torque = np.array(list(map(model.torque, record.time.tolist(), angles, rates)))
        over_angle = (load.parts.over_angle for load in self._acting)
        table = table_of(problem.scene, gas, torque, record, time, self._residual)
        table = table.under(tuple(part for part in over_angle if part is not None))
        if watch.called_off:
            return table, Ending.CALLED_OFF
        return table, Ending.COMPLETE if record.complete else Ending.DIVERGED

    def enter(self, end: float) -> tuple[GasStretch, tuple[float, float]] | None:
        """Give the model the loads of the stretch from here to time ``end`` [s].

        Returns
        -------
        what the gas does, and the speeds between which the loads hold; None where a jump of the
        loads drives the speed back from both sides
        """
        omega, model, problem = self._state[1], self._model, self._problem
        torques = self._acting
        senses = (self._sense,) if self._sense else (1.0, -1.0)
        for sense in senses:
            speeds = self._speeds_around(sense)
            model.torque = torque_function(torques, (self.time, end), speeds)
            gas = self._gas_beside(omega or sense)
            beside = omega in speeds
            if problem.law is not None or not (omega == 0.0 or beside):
                return gas, speeds
            if sense * self.acceleration() >= 0.0 or (self._sense and not self._jumps(omega)):
                return gas, speeds
        return None if beside else (gas, speeds)

    def _gas_beside(self, sense: float) -> GasStretch:
        """Give the model the gas that a motion of this sense enters here, and the friction that the
        motion itself does."""
        (theta, omega), gases = self._state, self._problem.gas
        gas = gases.stretch(theta, sense, self._firing)
        if gas.slides is not None and omega * sense < 0.0:
            gas = replace(gas, slides=gases.stretch(theta, omega, self._firing).slides)
        scene = self._problem.scene
        has_gas = scene.gas is not None or scene.friction is not None
        self._model.gas = gas.functions() if has_gas else ()
        return gas

    def acceleration(self) -> float:
        """Crank acceleration [rad/s2] of a free crank here, under the loads of the model."""
        start = coordinates(self._problem.scene, *self._state)
        row = self._model.consistent(start, self.time)
        return float(row.acceleration[0, 2])

    @property
    def _acting(self) -> tuple[Torque, ...]:
        """The loads whose windows are open."""
        return tuple(load for _, load in acting(self._problem.scene.torque, self._phases))

    def _speeds_around(self, sense: float) -> tuple[float, float]:
        """The speeds next to that of here at which a load bends, jumps, sets in or ends; blind,
        those at which one sets in or ends."""
        stops = phase_ends(self._problem.scene.torque, self._phases)[1]
        stops += (0.0,) if self._problem.scene.friction is not None else ()
        return speeds_around(() if self.is_blind else self._acting, self._state[1], sense, stops)

    def _jumps(self, omega: float) -> bool:
        """Whether a load jumps at a speed, or friction, at 0."""
        if omega == 0.0 and self._problem.scene.friction is not None:
            return True
        theta = self._state[0]
        now = self.time, self.time
        sides = (
            torque_function(self._acting, now, self._speeds_around(sense)) for sense in (-1.0, 1.0)
        )
        below, above = (torque(self.time, theta, omega) for torque in sides)
        return abs(above - below) > 1e-9 * max(abs(above), abs(below))

    def _land(self, table: StepTable, bounds: Bounds, bound: float | None) -> None:
        """Cut the table where it leaves its range of speeds; take it, and go to its end.

        bound [rad] : the crank angle that it ends at, if one ends it
        """
        self.bound, self._sense = bound, 0.0
        met = cut_at_speed(table, bounds)
        speed = None
        if met is not None:
            (table, speed), self.bound = met, None
            self._sense = 1.0 if speed == bounds.speeds[1] else -1.0
            self._speeds_left -= 1
        self.tables.append(table)
        self.time = table.until
        last = {
            name: float(values.flat[0]) for name, values in table.at(np.array([self.time])).items()
        }
        self._residual = last["energy_residual"]
        theta, omega = last["crank_angle"], last["crank_speed"]
        self._state = (
            theta if self.bound is None else self.bound,
            omega if speed is None else speed,
        )
        self._decide()
        torques, late = self._problem.scene.torque, self.time * (1.0 + SAME)
        self._phases = later_phases(torques, self._phases, late, self._state[1])
        self.landings.append(self._landing())

    def _landing(self) -> State:
        return State(self.time, *self._state, 0.0, Mode(self._phases, firing=self._firing))

    def _decide(self) -> None:
        """The decision on the fuel, where the last stretch has ended at its angle."""
        law, firing = self._problem.gas.law, self._firing
        if law and firing and self.bound in law.next(firing):
            self._firing = law.decided(firing, self.time, *self._state)


def initial_acceleration(problem: Problem, model: Model) -> float:
    """Crank acceleration [rad/s2] of a free crank at its start."""
    walk = Walk(problem, model, None)
    walk.enter(0.0)
    return walk.acceleration()


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
