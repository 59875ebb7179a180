"""The system that exudyn makes of a scene: its equations at given states, and its runs over time.

Absolute coordinates q and multipliers of the joints, with exudyn's mass matrix M, constraints C,
their Jacobian J and generalized forces f:

    M q'' + J^T lambda = f,    C(q) = 0
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import exudyn
import numpy as np

from crankmbs.mechanics.axes import closed_loops, displacements
from crankmbs.mechanics.geometry import top_position
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.forces import Bounds, Forces, Push
from crankmbs.motion.multibody.generalized_alpha import quiet_shifts, settings_of
from crankmbs.motion.multibody.mechanism import build, closed, mechanism_of
from crankmbs.numerics.arrays import Array

__all__ = ["Consistent", "Model", "Row"]

exu: Any = exudyn  # its stubs are narrower than what it takes

# of Newton's method, relative, and absolute as a share of the largest joint force at any start:
# forces may be small beside what they cancel; a relative 1e-8 leaves errors that no halving shows
_RELATIVE, _ABSOLUTE = 1e-10, 1e-12
_BLOCK = 1000  # states that are solved for together
_ON = 1e-11  # rad: of a bound, so near the crank is on it
_BESIDE = 1e-10  # the same of a speed, relative; rad/s near rest
_ROUNDED = float(np.finfo(float).eps)  # rad: of an angle, which a step makes a speed of


Row = tuple[float, float, float, float]
"""Time [s], crank angle [rad], speed [rad/s] and acceleration [rad/s2] of the crank."""


class Consistent(NamedTuple):
    """The system in motion at m states, q coordinates, j hinges, n cylinders.

    position, velocity, acceleration : shape (m, q), in the order of `Mechanism.bodies`
    hinges : shape (m, j, 2), force on the second body of each [N]; walls : shape (m, n), force on
        the pistons along the normals of the guides [N]
    torque : shape (m,), from outside on the crank [N m]
    """

    position: Array
    velocity: Array
    acceleration: Array
    hinges: Array
    walls: Array
    torque: Array


class Model:
    """A crank train in exudyn. Set its forces, then run it from a state, or solve for states.

    forces : of the train
    torque [N m] : on a free crank, of time [s], crank angle [rad] and speed [rad/s]
    driven : whether the crank turns at constant speed instead
    pushes [N] : on each piston towards the crank, of time, crank angle, and of the piston's
        displacement from its top dead centre [m] and velocity in that direction [m/s]
    mass, weight : shape (q,), of each coordinate, as exudyn has it
    tops [m], banks [rad] : of the cylinders
    """

    def __init__(self, train: CrankTrain) -> None:
        scene, self.forces = train.scene, Forces(train)
        self.scene, self.mechanism = scene, mechanism_of(scene)
        self.torque: Callable[[float, float, float], float] = lambda time, theta, omega: 0.0
        self.pushes: Sequence[Push] = ()
        self.driven = False
        self._begin, self._largest = 0.0, 1.0
        pushed = bool(scene.gas or scene.friction or scene.force)
        self._container, self._system = build(
            self.mechanism,
            self._push if pushed else None,
            self._torque if scene.torque else None,
        )
        self._system.Assemble()
        data = self._system.systemData
        self._q, self._v, self._a = (  # exudyn's own memory: always the current state
            data.GetODE2Coordinates(copy=False),
            data.GetODE2Coordinates_t(copy=False),
            data.GetODE2Coordinates_tt(copy=False),
        )
        self.tops = [top_position(*gear.shape) for gear in scene.running_gear]
        self.banks = np.array([cylinder.bank for cylinder in scene.cylinders])
        self._towards = [(-guide.normal[1], guide.normal[0]) for guide in self.mechanism.guides]
        self._read()

    def close(self) -> None:
        """Let go of what exudyn holds: it and this model refer to each other."""
        self._system.Reset()

    # what exudyn asks for at every step

    def _torque(self, time: float) -> float:
        return self.torque(self._begin + time, self._q.item(2), self._v.item(2))

    def _push(self, k: int, time: float) -> list[float]:
        if k == 0:  # exudyn asks for all, one after the other
            q, v, time = self._q.tolist(), self._v.tolist(), self._begin + time
            at, self._now = 6, []
            for push, (x, y), top in zip(self.pushes, self._towards, self.tops, strict=True):
                down, speed = top + x * q[at] + y * q[at + 1], x * v[at] + y * v[at + 1]
                force = push(time, q[2], down, speed)
                self._now.append([force * x, force * y, 0.0])
                at += 5
        return self._now[k]

    # over time

    def start(self, time: Array, theta: Array, omega: Array) -> Consistent:
        """The system in states of shape (m,), under the forces that it was given."""
        loop = closed_loops(self.scene, theta)
        down, speeds = displacements(self.scene, loop), -loop.x_1 * omega
        push, drive = np.zeros_like(down.T), np.zeros_like(theta)
        for k, force in enumerate(self.pushes):
            push[:, k] = np.frompyfunc(force, 4, 1)(time, theta, down[k], speeds[k])
        if not self.driven:
            drive[:] = np.frompyfunc(self.torque, 3, 1)(time, theta, omega)
        return self.states(theta, omega, push, drive, free=not self.driven)

    def quiet_start(self, begin: Row, step: float) -> tuple[float, Consistent]:
        """The speed of the crank in the method's own smooth solution, and the state with position,
        velocity and acceleration from which the multipliers do not ring.

        A run that began with the speed v itself would have between its first two rows an error that
        does not fall as h^2 at a fixed time.
        """
        time, theta, omega, alpha = begin
        t = np.array([0.0, -0.5, 0.5]) * step
        near = self.start(time + t, theta + (omega + 0.5 * alpha * t) * t, omega + alpha * t)
        _, before, after = near.acceleration
        crank, *shifts = quiet_shifts((after - before) / step, step)
        smooth = omega + float(crank[2]) if omega else 0.0  # at rest it is not to turn back
        here = Consistent(*(each[:1] for each in near))
        q, v, a = (row + shift for row, shift in zip(here[:3], shifts, strict=True))
        return smooth, here._replace(position=q, velocity=v, acceleration=a)

    def run(
        self,
        begin: Row,
        step: float,
        most: int,
        bounds: Bounds,
        *,
        stiff: bool,
    ) -> tuple[Array, Ending, int]:
        """Integrate from a row by the generalized-alpha method.

        most : steps; bounds : the step that passes one is the last; stiff : whether Newton's method
            shall know how the loads change; 2.7 times as slow

        Returns
        -------
        rows, shape (m, 4); COMPLETE where a bound was passed, CALLED_OFF after all steps, DIVERGED
        where exudyn failed or a rod turned over; iterations of Newton's method
        """
        rows: list[Row] = []
        rods = [*zip(self._turns.tolist()[1:], self.banks.tolist(), strict=True)]
        (_, end), (low, high), (slow, fast) = bounds
        low, high = low - _ON, high + _ON
        slow -= _BESIDE * max(abs(slow), 1.0) + _ROUNDED / step
        fast += _BESIDE * max(abs(fast), 1.0) + _ROUNDED / step
        outside = False

        def note(_: object, _time: float) -> bool:  # before each step, and not after the last
            nonlocal outside
            q = self._q.tolist()
            for at, bank in rods:
                if rows and abs(q[at] - bank) > 0.5 * math.pi:
                    return False
            time, theta, omega = begin[0] + step * len(rows), q[2], self._v.item(2)
            rows.append((time, theta, omega, self._a.item(2)) if rows else first)
            inside = time < end and low < theta < high and slow <= omega <= fast
            outside = len(rows) > 1 and not inside
            return not outside

        self._begin, (smooth, quiet) = begin[0], self.quiet_start(begin, step)
        first = *begin[:2], smooth, begin[3]
        data, initial = self._system.systemData, exu.ConfigurationType.Initial
        data.SetODE2Coordinates(quiet.position[0], initial)
        data.SetODE2Coordinates_t(quiet.velocity[0], initial)
        data.SetODE2Coordinates_tt(quiet.acceleration[0], initial)
        self._system.SetPreStepUserFunction(note)
        settings = settings_of(step, most, stiff=stiff)
        self._largest = max(self._largest, float(np.abs(quiet.hinges).max()))
        newton = settings.timeIntegration.newton
        newton.relativeTolerance = _RELATIVE
        newton.absoluteTolerance = _ABSOLUTE * self._largest
        with _quiet(), suppress(RuntimeError, ValueError):  # Newton fails, a matrix is singular
            self._system.SolveDynamic(settings)
        iterations = int(self._system.sys["dynamicSolver"].it.newtonStepsCount)
        ending = Ending.CALLED_OFF if len(rows) == most else Ending.DIVERGED
        return np.array(rows), Ending.COMPLETE if outside else ending, iterations

    # at given states

    def states(
        self, theta: Array, omega: Array, push: Array, drive: Array, *, free: bool
    ) -> Consistent:
        """The system at crank angles [rad] and speeds [rad/s] of shape (m,), under given forces.

        By the tangent u of J u = 0, u_theta = 1,

            alpha = u (f - M w) / (u M u),    q'' = u alpha + w,    J w = -J' q',  w_theta = 0

        push : shape (m, n) [N], on each piston towards the crank; drive : shape (m,), the torque on
        a free crank [N m], or the acceleration of a driven one [rad/s2]
        """
        if len(theta) > _BLOCK:
            cut, rows = range(_BLOCK, len(theta), _BLOCK), (theta, omega, push, drive)
            blocks = zip(*(np.split(row, cut) for row in rows), strict=True)
            parts = (self.states(*block, free=free) for block in blocks)
            return Consistent(*map(np.concatenate, zip(*parts, strict=True)))
        q, ahead = closed(self.scene, theta), np.zeros(len(theta))
        jacobian, _, open_by = self._constraints(q)
        q = q - np.linalg.solve(jacobian, np.column_stack([open_by, ahead])[..., None])[..., 0]
        jacobian, bend, _ = self._constraints(q)
        inverse = np.linalg.inv(jacobian)
        u = inverse[..., -1]
        v = u * omega[:, None]
        turning = np.einsum("mcb,mb->mc", bend, v[:, self._turns] ** 2)
        w = -np.einsum("mqc,mc->mq", inverse[..., :-1], turning)
        force, alpha = self.weight + push @ self._pushed, drive
        if free:
            force[:, 2] += drive
            alpha = ((force - w * self.mass) * u).sum(axis=1) / (u**2 @ self.mass)
        a = u * alpha[:, None] + w
        joints = -np.einsum("mqc,mq->mc", inverse, force - a * self.mass)
        count = 2 * len(self.mechanism.hinges)
        hinges = joints[:, :count].reshape(len(theta), -1, 2)
        return Consistent(q, v, a, hinges, joints[:, count:-1], drive if free else joints[:, -1])

    def _constraints(self, q: Array) -> tuple[Array, Array, Array]:
        """The Jacobian with a row for the crank angle, shape (m, q, q); the second derivatives in
        the angles, shape (m, q - 1, turning bodies); and by how much the joints are open.

        In each angle the constraints are a sine and a cosine, in all else linear.
        """
        turns, flat, upright = self._turns, self._flat, self._upright
        cos, sin = np.cos(q[:, None, turns]), np.sin(q[:, None, turns])
        straight = flat.copy()
        straight[:, turns] = 0.0
        jacobian = np.zeros((len(q), q.shape[1], q.shape[1]))
        jacobian[:, :-1] = straight
        jacobian[:, :-1, turns] = flat[:, turns] * cos + upright[:, turns] * sin
        jacobian[:, -1, 2] = 1.0
        bend = upright[:, turns] * cos - flat[:, turns] * sin
        return jacobian, bend, self._offset + q @ straight.T - bend.sum(axis=2)

    def _read(self) -> None:
        """Read mass, constraints and forces from exudyn."""
        solver, system = exu.MainSolverImplicitSecondOrder(), self._system
        with _quiet():
            solver.InitializeSolver(system, settings_of(1.0))
        count, cylinders = len(self._q), len(self.scene.cylinders)
        self._turns = np.array([2, *range(5, count, 5)])

        def at(angle: float) -> tuple[Array, Array]:
            position = np.zeros(count)
            position[self._turns] = angle
            system.systemData.SetODE2Coordinates(position)
            solver.SetSystemJacobian(np.zeros((2 * count - 1, 2 * count - 1)))
            solver.ComputeJacobianAE(system)
            solver.ComputeAlgebraicEquations(system)
            return solver.GetSystemJacobian()[count:, :count], solver.GetSystemResidual()[count:]

        def forces(row: Array) -> Array:
            self.pushes = [lambda *_, force=force: force for force in row.tolist()]
            solver.ComputeODE2RHS(system)
            return np.array(solver.GetSystemResidual()[:count])

        (self._flat, offset), (self._upright, _) = at(0.0), at(0.5 * np.pi)
        self._offset = offset + self._upright[:, self._turns].sum(axis=1)
        self.weight = forces(np.zeros(cylinders))
        self._pushed = np.array([forces(row) - self.weight for row in np.eye(cylinders)])
        self.pushes = ()
        solver.ComputeMassMatrix(system)
        self.mass = np.diag(solver.GetSystemMassMatrix()).copy()


@contextmanager
def _quiet() -> Iterator[None]:
    before = exu.config.printToConsole
    exu.config.printToConsole = False
    try:
        yield
    finally:
        exu.config.printToConsole = before
