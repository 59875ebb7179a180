"""The mechanism of a scene as a system of exudyn, line by line, and its equations of motion.

Absolute coordinates q and multipliers of the joints, with exudyn's mass matrix M, constraints C,
their Jacobian J and generalized forces f:

    M q'' + J^T lambda = f,    C(q) = 0
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface

from crankmbs.mechanics.geometry import top_position
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.applied import Push
from crankmbs.motion.multibody.generalized_alpha import quiet_shifts, settings_of
from crankmbs.motion.multibody.mechanism import Mechanism, closed, mechanism_of
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Consistent", "Model", "build"]

exu: Any = exudyn  # its stubs are narrower than what it takes
eii: Any = itemInterface

# of Newton's method, relative, and absolute as a share of the largest joint force at the start:
# where forces are small beside what they cancel the first may lie below what is rounded; a relative
# 1e-8 leaves errors that no halving shows, and passes near folds
_TOLERANCES = ((1e-10, 1e-16), (1e-9, 1e-11))
_BLOCK = 1000  # states that are solved for together


def build(
    mechanism: Mechanism,
    push: Callable[[int, float], tuple[float, float]] | None,
    torque: Callable[[float], float],
) -> tuple[Any, Any]:
    """exudyn's container and system of a mechanism.

    push : force [N] on a piston, x and y, by its number and the solver's time [s]; None: none is
        pushed. torque [N m] : on the crank, by the time
    """
    container = exu.SystemContainer()
    system = container.AddSystem()
    bodies = {"ground": system.AddObject(eii.ObjectGround())}
    fixed = system.AddNode(eii.NodePointGround())
    nodes = {}
    for body in mechanism.bodies:
        if body.inertia is None:
            node = system.AddNode(eii.NodePoint2D())
            item = eii.ObjectMassPoint2D(nodeNumber=node, mass=body.mass)
        else:
            node = system.AddNode(eii.NodeRigidBody2D())
            item = eii.ObjectRigidBody2D(nodeNumber=node, mass=body.mass, inertia=body.inertia)
        nodes[body.name], bodies[body.name] = node, system.AddObject(item)
        marker = system.AddMarker(eii.MarkerBodyMass(bodyNumber=bodies[body.name]))
        weight = [*mechanism.gravity, 0.0]
        system.AddLoad(eii.Gravity(markerNumber=marker, loadVector=weight))
    for hinge in mechanism.hinges:
        markers = [
            system.AddMarker(
                eii.MarkerBodyPosition(bodyNumber=bodies[name], localPosition=[*point, 0.0])
            )
            for name, point in zip(hinge.bodies, hinge.points, strict=True)
        ]
        system.AddObject(eii.RevoluteJoint2D(markerNumbers=markers))
    for number, guide in enumerate(mechanism.guides):
        markers = [
            system.AddMarker(eii.MarkerNodeCoordinates(nodeNumber=node))
            for node in (fixed, nodes[guide.body])
        ]
        system.AddObject(
            eii.CoordinateVectorConstraint(
                markerNumbers=markers,
                scalingMarker1=np.array([guide.normal]),
                offset=[guide.offset],
            )
        )
        if push is None:
            continue
        marker = system.AddMarker(eii.MarkerBodyPosition(bodyNumber=bodies[guide.body]))
        system.AddLoad(
            eii.LoadForceVector(
                markerNumber=marker,
                loadVectorUserFunction=lambda _, time, load, k=number: [*push(k, time), 0.0],
            )
        )
    marker = system.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=nodes["crank"], coordinate=2))
    system.AddLoad(
        eii.LoadCoordinate(markerNumber=marker, loadUserFunction=lambda _, time, load: torque(time))
    )
    return container, system


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
    """A scene in exudyn. Set its forces, then run it from a state, or solve for states.

    torque [N m] : on a free crank, of time [s], crank angle [rad] and speed [rad/s]
    pushes [N] : on each piston towards the crank, of time, crank angle, and of the piston's
        displacement from its top dead centre [m] and velocity in that direction [m/s]
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, self.mechanism = scene, mechanism_of(scene)
        self.torque: Callable[[float, float, float], float] = lambda time, theta, omega: 0.0
        self.pushes: Sequence[Push] = ()
        self._begin = self._largest = 0.0
        pushed = bool(scene.gas or scene.friction or scene.force)
        self._container, self._system = build(
            self.mechanism, self._push if pushed else None, self._torque
        )
        self._system.Assemble()
        data = self._system.systemData
        self._q, self._v, self._a = (  # exudyn's own memory: always the current state
            data.GetODE2Coordinates(copy=False),
            data.GetODE2Coordinates_t(copy=False),
            data.GetODE2Coordinates_tt(copy=False),
        )
        self._tops = [top_position(*gear.shape) for gear in scene.running_gear]
        self._towards = [(-guide.normal[1], guide.normal[0]) for guide in self.mechanism.guides]
        self._read()

    def close(self) -> None:
        """Let go of what exudyn holds: it and this model refer to each other."""
        self._system.Reset()

    def start(self, time: float, theta: float, omega: float, *, driven: bool = False) -> Consistent:
        """The system in a state, free or at constant speed, under the forces that it was given."""
        at, faster = np.array([theta]), np.array([omega])
        push = np.zeros((1, len(self.scene.cylinders)))
        torque = np.array([self.torque(time, theta, omega)])
        if self.pushes:
            moving = self.states(at, faster, push, torque)
            rows = (row[0, 3:].reshape(-1, 5)[:, 3:] for row in (moving.position, moving.velocity))
            down, speeds = ((row * self._towards).sum(axis=1) for row in rows)
            pairs = zip(self.pushes, (self._tops + down).tolist(), speeds.tolist(), strict=True)
            push = np.array([[each(time, theta, *where) for each, *where in pairs]])
        if driven:
            return self.driven(at, faster, np.zeros(1), push)
        return self.states(at, faster, push, torque)

    def quiet_start(
        self, state: tuple[float, float, float], step: float, *, driven: bool = False
    ) -> tuple[Any, ...]:
        """Speed and acceleration of the crank in the method's own smooth solution, and position,
        velocity and acceleration from which the multipliers do not ring.

        A run that began with the speed v itself would have between its first two rows an error that
        does not fall as h^2 at a fixed time.

        driven : at constant speed
        """
        time, theta, omega = state
        here = self.start(*state, driven=driven)
        self._largest = max(self._largest, float(np.abs(here.hinges).max()))
        alpha = float(here.acceleration[0, 2])
        sides = [
            self.start(
                time + t, theta + (omega + 0.5 * alpha * t) * t, omega + alpha * t, driven=driven
            )
            for t in (-0.5 * step, 0.5 * step)
        ]
        jerk = (sides[1].acceleration[0] - sides[0].acceleration[0]) / step
        own, *shifts = quiet_shifts(jerk, step)
        smooth = omega + float(own[2]) if omega else 0.0  # at rest it is not to turn back
        begin = here.position[0], here.velocity[0], here.acceleration[0]
        return (smooth, alpha), *(x + shift for x, shift in zip(begin, shifts, strict=True))

    def run(
        self,
        state: tuple[float, float, float],
        step: float,
        most: int,
        inside: Callable[[float, float, float], bool],
        *,
        stiff: bool,
    ) -> tuple[Array, Ending, int]:
        """Integrate from a time [s], angle [rad], speed [rad/s] by the generalized-alpha method.

        most : steps; inside(time, crank angle, speed) : asked after every step; where False the run
            ends. stiff : whether Newton's method shall know how the loads change; 2.7 times as slow

        Returns
        -------
        rows of time [s], crank angle [rad], speed [rad/s] and acceleration [rad/s2], shape (m, 4);
        COMPLETE where ``inside`` ended it, CALLED_OFF after all steps, DIVERGED where exudyn failed
        or a rod turned over; Newton's iterations
        """
        rows: list[tuple[float, float, float, float]] = []
        data, initial = self._system.systemData, exu.ConfigurationType.Initial
        rods = [(5 + 5 * k, c.bank) for k, c in enumerate(self.scene.cylinders)]
        outside = False

        def note(_: object, _time: float) -> bool:  # before each step, and not after the last
            nonlocal outside
            if any(abs(self._q.item(at) - bank) > 0.5 * np.pi for at, bank in rods):
                return False
            row = begin + step * len(rows), self._q.item(2), self._v.item(2), self._a.item(2)
            rows.append(row if rows else (*state[:2], *smooth))
            outside = len(rows) > 1 and not inside(*row[:3])
            return not outside

        begin = self._begin = state[0]
        smooth, *start = self.quiet_start(state, step)
        self._system.SetPreStepUserFunction(note)
        settings = settings_of(step, most, stiff=stiff)
        iterations, solved = 0, False
        newton = settings.timeIntegration.newton
        for newton.relativeTolerance, share in _TOLERANCES:
            rows.clear()
            newton.absoluteTolerance = max(share * self._largest, 1e-12)
            data.SetODE2Coordinates(start[0], initial)
            data.SetODE2Coordinates_t(start[1], initial)
            data.SetODE2Coordinates_tt(start[2], initial)
            with _quiet(), suppress(RuntimeError, ValueError):  # Newton fails, a matrix is singular
                solved = self._system.SolveDynamic(settings)
            iterations += int(self._system.sys["dynamicSolver"].it.newtonStepsCount)
            if outside or solved:
                break
        ending = Ending.COMPLETE if outside else Ending.DIVERGED
        if not outside and len(rows) == most:
            ending = Ending.CALLED_OFF
        return np.array(rows), ending, iterations

    def states(self, theta: Array, omega: Array, push: Array, torque: Array) -> Consistent:
        """The system at crank angles [rad] and speeds [rad/s] of shape (m,), under given forces.

        push : shape (m, n) [N], on each piston towards the crank; torque : shape (m,) [N m]
        """
        return _in_blocks(partial(self._block, free=True), theta, omega, push, torque)

    def driven(self, theta: Array, omega: Array, alpha: Array, push: Array) -> Consistent:
        """The same at given accelerations [rad/s2]; the torque is what they take."""
        return _in_blocks(partial(self._block, free=False), theta, omega, push, alpha)

    def _block(
        self, theta: Array, omega: Array, push: Array, given: Array, *, free: bool
    ) -> Consistent:
        """The states of one block, by the tangent u of J u = 0, u_theta = 1.

        alpha = u (f - M w) / (u M u),    q'' = u alpha + w,    J w = -J' q',  w_theta = 0

        given : the torque on a free crank, or the acceleration of a driven one
        """
        q, ahead = closed(self.scene, theta), np.zeros(len(theta))
        jacobian, _, open_by = self._constraints(q)
        q = q - np.linalg.solve(jacobian, np.column_stack([open_by, ahead])[..., None])[..., 0]
        jacobian, bend, _ = self._constraints(q)
        unit = np.zeros_like(q)
        unit[:, -1] = 1.0
        u = np.linalg.solve(jacobian, unit[..., None])[..., 0]
        v = u * omega[:, None]
        turning = np.einsum("mcb,mb->mc", bend, v[:, self._turns] ** 2)
        w = -np.linalg.solve(jacobian, np.column_stack([turning, ahead])[..., None])[..., 0]
        force = self._weight + push @ self._pushed
        alpha = given
        if free:
            force[:, 2] += given
            alpha = ((force - w * self._mass) * u).sum(axis=1) / (u**2 @ self._mass)
        a = u * alpha[:, None] + w
        rest = (force - a * self._mass)[..., None]
        joints = -np.linalg.solve(np.swapaxes(jacobian, 1, 2), rest)[..., 0]
        count = 2 * len(self.mechanism.hinges)
        hinges = joints[:, :count].reshape(len(theta), count // 2, 2)
        return Consistent(q, v, a, hinges, joints[:, count:-1], given if free else joints[:, -1])

    def _read(self) -> None:
        """Read mass, constraints and forces from exudyn: in each angle the constraints are a sine
        and a cosine, in all else linear."""
        solver, system, data = (
            exu.MainSolverImplicitSecondOrder(),
            self._system,
            self._system.systemData,
        )
        with _quiet():
            solver.InitializeSolver(system, settings_of(1.0))
        count = len(self._q)
        rows = slice(count, count + len(self.mechanism.guides) + 2 * len(self.mechanism.hinges))
        names = [body.inertia for body in self.mechanism.bodies]
        ends = np.cumsum([2 if inertia is None else 3 for inertia in names])
        turns = np.array([end - 1 for end, i in zip(ends, names, strict=True) if i is not None])

        def at(angle: float) -> tuple[Array, Array]:
            position = np.zeros(count)
            position[turns] = angle
            data.SetODE2Coordinates(position)
            solver.SetSystemJacobian(np.zeros((rows.stop, rows.stop)))
            solver.ComputeJacobianAE(system)
            solver.ComputeAlgebraicEquations(system)
            return solver.GetSystemJacobian()[rows, :count], solver.GetSystemResidual()[rows]

        def forces(number: int) -> Array:
            self.pushes = [_constant(float(k == number)) for k in range(cylinders)]
            solver.ComputeODE2RHS(system)
            return np.array(solver.GetSystemResidual()[:count])

        self._turns, cylinders = turns, len(self.scene.cylinders)
        (self._flat, offset), (self._upright, _) = at(0.0), at(0.5 * np.pi)
        self._offset = offset + self._upright[:, turns].sum(axis=1)
        self._weight = forces(-1)
        self._pushed = np.array([forces(k) - self._weight for k in range(cylinders)])
        self.pushes = ()
        solver.ComputeMassMatrix(system)
        self._mass = np.diag(solver.GetSystemMassMatrix()).copy()

    def _constraints(self, q: Array) -> tuple[Array, Array, Array]:
        """The Jacobian with a row for the crank angle, shape (m, q, q); the second derivatives in
        the angles, shape (m, q - 1, turning bodies); and by how much the joints are open."""
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

    def _torque(self, time: float) -> float:
        return self.torque(self._begin + time, self._q.item(2), self._v.item(2))

    def _push(self, k: int, time: float) -> tuple[float, float]:
        x, y = self._towards[k]
        at = 6 + 5 * k
        speed = x * self._v.item(at) + y * self._v.item(at + 1)
        down = self._tops[k] + x * self._q.item(at) + y * self._q.item(at + 1)
        force = self.pushes[k](self._begin + time, self._q.item(2), down, speed)
        return force * x, force * y


def _constant(value: float) -> Push:
    return lambda _time, _theta, _displacement, _speed: value


def _in_blocks(solve: Callable[..., Consistent], *rows: Array) -> Consistent:
    """Solve for states so many at a time, which bounds the memory."""
    starts = range(0, max(len(rows[0]), 1), _BLOCK)
    parts = [solve(*(row[k : k + _BLOCK] for row in rows)) for k in starts]
    return Consistent(*map(np.concatenate, zip(*parts, strict=True)))


@contextmanager
def _quiet() -> Iterator[None]:
    before = exu.config.printToConsole
    exu.config.printToConsole = False
    try:
        yield
    finally:
        exu.config.printToConsole = before
