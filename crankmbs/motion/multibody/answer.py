"""Every variable of a result at samples of a motion, from exudyn's equations at each of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from crankmbs.mechanics.geometry import top_position
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.speed import SpeedLaw
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.mechanics.windows import Phase
from crankmbs.motion.base import Samples, Solution, State
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.model import Consistent, Model
from crankmbs.motion.plan import Plan
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import NEAR

__all__ = ["Answers", "Course", "rounding", "sample", "solution"]

_ROUNDING = 1e-12

_MOTION = ("time", "crank_angle", "crank_speed", "crank_acceleration", "energy_residual")
_GAUSS = np.polynomial.legendre.leggauss(4)
_NEAR = 1e-9  # of the sample spacing: what is nearer is one


class Course(Protocol):
    """A crank's motion in time.

    stretches : (begin, end) [s] in each of which it turns one way
    """

    @property
    def stretches(self) -> list[tuple[float, float]]:
        """Begins and ends [s] of what turns one way."""

    def at(self, time: Array) -> tuple[Array, Array]:
        """Crank angle [rad] and speed [rad/s]."""

    def times(self, theta: Array, begin: float, end: float) -> Array:
        """When it passes angles [rad] in a stretch [s]."""


def sample(plan: Plan, course: Course, until: float, end: float | None) -> tuple[Array, Array]:
    """Times [s] and crank angles [rad] of the samples of a plan, the last one at a time.

    end [rad] : angle there, where that is known
    """
    times, angles = [np.zeros(1)], [np.array([plan.start])]
    for begin, stop in [*course.stretches[:-1], (course.stretches[-1][0], until)]:
        if plan.in_time:
            times.append(plan.between(begin, stop))
            angles.append(course.at(times[-1])[0])
        else:
            at_begin, at_stop = course.at(np.array([begin, stop]))[0].tolist()
            passed = plan.between(at_begin, at_stop)
            angles.append(passed[np.abs(passed - at_begin) > plan.hair])
            times.append(course.times(angles[-1], begin, stop))
    time, theta = np.concatenate(times), np.concatenate(angles)
    final = float(course.at(np.array([until]))[0][0]) if end is None else end
    near = np.abs(time - until) if plan.in_time else np.abs(theta - final)
    near[:-1] = np.inf
    others = (time < until * (1.0 - 1e-12)) & (near > plan.hair)
    others[0] = True
    time, theta = np.append(time[others], until), np.append(theta[others], final)
    far = np.flatnonzero(np.abs(theta - final) > plan.last * (1.0 + 1e-12))
    first = int(far[-1]) + 1 if len(far) else 0
    return time[first:], theta[first:]


def rounding(values: dict[str, Array]) -> dict[str, float]:
    """What is left of every variable where nothing else errs: 1e-12 of its peak, and of the largest
    of its unit 1e-14, of sums that may cancel 1e-13; of the energy residual 1e-14 of the kinetic
    energy."""
    peaks = {name: peak(each) for name, each in values.items()}
    largest: dict[str, float] = {}
    for name, size in peaks.items():
        unit = EVERY[name].units
        largest[unit] = max(largest.get(unit, 0.0), size)
    least = {}
    for name, size in peaks.items():
        beside = 0.1 if name in SUMS else 0.01 if size else 0.0
        least[name] = _ROUNDING * (size + beside * largest[EVERY[name].units])
    return least | {"energy_residual": 0.01 * least["kinetic_energy"]}


def solution(
    values: dict[str, Array],
    errors: dict[str, float],
    said: tuple[int, str],
    cost: tuple[int, int],
) -> Solution:
    """What a run returns; cost : evaluations and steps."""
    own = {name: each for name, each in values.items() if name not in _MOTION}
    time, theta, omega, alpha, residual = (values[name] for name in _MOTION)
    samples = Samples(time, theta, omega, alpha, residual, own)
    return Solution(samples, *said, *cost, errors=errors)


class Answers:
    """The variables of a scene.

    states : at which stretches of one mode begin, and the last one ends
    """

    def __init__(self, model: Model, forces: Forces, states: Sequence[State]) -> None:
        self._model, self._forces = model, forces
        self._scene, self._states = model.scene, states
        self._edges = np.array([state.time for state in states[1:-1]])
        self._banks = np.array([cylinder.bank for cylinder in self._scene.cylinders])

    def at(
        self, time: Array, theta: Array, omega: Array, alpha: Array | None = None
    ) -> dict[str, Array]:
        """All variables but the energy residual, shape (m,) or (m, n).

        alpha [rad/s2] : of a prescribed motion
        """
        shares = self._shares(time, theta)
        gas = self._forces.gas(theta, shares)
        senses, acts, torque = _senses(theta, omega), self._acts(time), None
        friction = self._forces.friction(theta, omega, gas, senses)
        applied = self._forces.applied(time, theta, omega, senses, acts)
        if alpha is None:
            torque = self._forces.torque(time, theta, omega, acts)
        values = self.under((gas, friction, applied), torque, theta, omega, alpha)
        return values | {"time": time} | ({} if shares is None else {"fuel": shares})

    def under(
        self,
        pushes: tuple[Array, Array, Array],
        torque: Array | None,
        theta: Array,
        omega: Array,
        alpha: Array | None,
    ) -> dict[str, Array]:
        """The same under given forces of gas, friction and from outside [N], and torque [N m]."""
        gas, friction, applied = pushes
        along = gas + friction + applied
        if torque is None:
            assert alpha is not None
            found = self._model.driven(theta, omega, alpha, along)
        else:
            found = self._model.states(theta, omega, along, torque)
        values = {"crank_angle": theta, "crank_speed": omega}
        values |= self._of_bodies(found) | self._of_joints(found)
        values |= {"gas_force": gas, **self._forces.pressures(theta, gas)}
        values |= {} if self._scene.friction is None else {"friction_force": friction}
        return values | ({"applied_force": applied} if self._scene.force else {})

    def work(self, course: Course, edges: Array, law: SpeedLaw | None = None) -> Array:
        """Work of gas, friction and torque [J] up to each of some times [s], from the first on, by
        Gauss's quadrature between them."""
        nodes, weights = _GAUSS
        half = 0.5 * np.diff(edges)[:, None]
        time = (edges[:-1, None] + half * (1.0 + nodes)).ravel()
        theta, omega = course.at(time)
        shares = self._shares(time, theta)
        gas = self._forces.gas(theta, shares)
        senses, acts = _senses(theta, omega), self._acts(time)
        along = gas + self._forces.friction(theta, omega, gas, senses)
        along += self._forces.applied(time, theta, omega, senses, acts)
        if law is not None:
            torque = self._model.driven(theta, omega, law.at_time(time)[2], along).torque
        else:
            torque = self._forces.torque(time, theta, omega, acts)
        power = torque * omega + (along * self._forces.sliding(theta, omega)).sum(axis=1)
        return np.append(0.0, np.cumsum((half * power.reshape(half.size, -1)) @ weights))

    def _acts(self, time: Array) -> Array:
        """Which loads act at times, shape (m, loads); at an end of a window as after it."""
        k = np.searchsorted(self._edges, time * (1.0 + 1e-11), side="right")
        loads = len(self._forces.train.loads)
        rows = [
            [phase is Phase.ACTING for phase in state.mode.loads] or [True] * loads
            for state in self._states
        ]
        return np.array(rows, dtype=bool).reshape(len(rows), loads)[k]

    def _shares(self, time: Array, theta: Array) -> Array | None:
        """The shares of the combustion at samples; at a decision those before it."""
        if self._forces.train.law is None:
            return None
        k = np.searchsorted(self._edges, time, side="right")
        angles = np.array([state.theta for state in self._states])
        for _ in range(2):  # where something else is cut at the same angle, too
            k = np.where((k > 0) & (np.abs(theta - angles[k]) < NEAR), k - 1, k)
        return np.array([state.mode.shares for state in self._states])[k]

    def _of_bodies(self, found: Consistent) -> dict[str, Array]:
        """Motion of all bodies, energy, and what they do to the frame by the balance of momentum.

        force = sum m (g - a)
        moment = torque + sum r x m (g - a) - sum I rate of spin
        """
        scene, bodies = self._scene, self._model.mechanism.bodies
        n = len(self._banks)
        mass = np.array([body.mass for body in bodies])
        spins = np.array([body.inertia for body in bodies if body.inertia is not None])
        (r, phi), (v, rate), (a, spin) = (
            _split(each, n) for each in (found.position, found.velocity, found.acceleration)
        )
        turn = np.exp(-1j * self._banks)
        pistons = [(each[:, 2::2] * turn).real for each in (r, v, a)]
        g = complex(*self._model.mechanism.gravity)
        pull = mass * (g - a)
        moment = found.torque + (r.conj() * pull).imag.sum(axis=1) - spin @ spins
        tops = np.array([top_position(*gear.shape) for gear in scene.running_gear])
        values = {
            "crank_acceleration": spin[:, 0],
            "kinetic_energy": 0.5 * ((np.abs(v) ** 2) @ mass + (rate**2) @ spins),
            "fallen": (r * g.conjugate()).real @ mass,
            "frame_force_x": pull.real.sum(axis=1),
            "frame_force_y": pull.imag.sum(axis=1),
            "frame_moment": moment,
            "rod_angle": self._banks - phi[:, 1:],
            "rod_angular_speed": -rate[:, 1:],
            "rod_angular_acceleration": -spin[:, 1:],
            "piston_position": pistons[0],
            "piston_displacement": tops - pistons[0],
            "piston_velocity": -pistons[1],
            "piston_acceleration": -pistons[2],
        }
        if scene.levers is not None:
            rocking = (pull[:, 1::2] + pull[:, 2::2]) @ np.array(scene.levers)
            values |= {"rocking_moment_x": -rocking.imag, "rocking_moment_y": rocking.real}
        return values

    def _of_joints(self, found: Consistent) -> dict[str, Array]:
        """Joint forces, each cylinder's in its axes, and their moments on the crank."""
        scene = self._scene
        forces = found.hinges[..., 0] + 1j * found.hinges[..., 1]
        turn = np.exp(-1j * self._banks)
        crank_pin, piston_pin = forces[:, 1::2] * turn, forces[:, 2::2] * turn
        phases = np.array([cylinder.phase for cylinder in scene.cylinders])
        radii = np.array([gear.radius for gear in scene.running_gear])
        lever = radii * np.exp(-1j * (found.position[:, 2:3] + phases))
        torque = -(lever * crank_pin).imag
        return self._of_journals(found, forces[:, 1::2]) | {
            "external_torque": found.torque,
            "main_bearing_force_x": forces[:, 0].real,
            "main_bearing_force_y": forces[:, 0].imag,
            "side_force": found.walls,
            "piston_pin_force_x": piston_pin.real,
            "piston_pin_force_y": piston_pin.imag,
            "crank_pin_force_x": crank_pin.real,
            "crank_pin_force_y": crank_pin.imag,
            "crank_torque": torque,
            "journal_torque": np.cumsum(torque, axis=1),
            "pin_torque": np.cumsum(torque, axis=1) - 0.5 * torque,
        }

    def _of_journals(self, found: Consistent, rods: Array) -> dict[str, Array]:
        """What holds each throw as a beam on two supports, from the forces on its rods [N], complex
        in the engine's frame, and the acceleration of its unbalance."""
        throws = self._scene.throws
        if throws is None:
            return {}
        (spin, rate), theta = (each[:, 2:3] for each in found[2:0:-1]), found.position[:, 2:3]
        accelerated = np.array(throws.unbalances) * np.exp(1j * theta) * (1j * spin - rate**2)
        pull = complex(*self._model.mechanism.gravity) * self._scene.crank.mass
        own = accelerated - pull / len(throws.unbalances)
        journals = rods @ np.transpose(throws.rods) + own @ np.transpose(throws.throws)
        values = {"main_journal_force_x": journals.real, "main_journal_force_y": journals.imag}
        if throws.shared:
            which = np.array(throws.numbers)
            pins = np.stack([rods[:, which == k].sum(axis=1) for k in range(own.shape[1])], axis=1)
            values |= {"pin_force_x": pins.real, "pin_force_y": pins.imag}
        return values


def _senses(theta: Array, omega: Array) -> Array:
    """The sense in which the crank turns; at rest that in which it came, or goes."""
    signs = np.sign(omega)
    moving = np.flatnonzero(signs)
    if len(moving) == 0:
        return np.ones_like(theta)
    last = np.searchsorted(moving, np.arange(len(signs)), side="right") - 1
    return np.asarray(signs[moving[np.maximum(last, 0)]])


def _split(rows: Array, n: int) -> tuple[Array, Array]:
    """Of crank, rod 1, piston 1, rod 2, ...: places as complex numbers, shape (m, 1 + 2 n), and
    angles of crank and rods, shape (m, 1 + n)."""
    each = rows[:, 3:].reshape(len(rows), n, 5)
    places = np.empty((len(rows), 1 + 2 * n), dtype=complex)
    places[:, 0] = rows[:, 0] + 1j * rows[:, 1]
    places[:, 1::2] = each[..., 0] + 1j * each[..., 1]
    places[:, 2::2] = each[..., 3] + 1j * each[..., 4]
    return places, np.column_stack([rows[:, 2], each[..., 2]])
