"""Means over a stretch of crank angle of a crank that turns on, by Gauss's rule between the knots.

Over time dt = dtheta / omega: the magnitude of every joint's force. Over the angle: the moment of
the rods and the torque from outside. Panels end at every knot of the pressures and dead centre,
and are halved until both halves agree with the whole, so that a magnitude that passes zero is
resolved too, unless it does so just beside a knot, where no node of a wide panel sees it. The speed
is constant, or that of a free crank with the loads c0 - c omega^2, whose energy obeys
dE/dtheta = T + c0 - 2 c E / J.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from validation.oracles.arithmetic import DOUBLE, LONG, Array, Number
from validation.oracles.machine import Machine
from validation.oracles.many_turns import NODES, Turning, antiderivatives
from validation.oracles.newton_euler import Reactions, newton_euler
from validation.oracles.rubbing import Rings

__all__ = ["Means", "Stretch", "means"]

_CLOSE = 1e-14  # of the whole integral of its kind: so far a panel and its halves agree
_HALVINGS = 40
_NO_WIDTH = 1e-12  # rad: what rounding leaves between two cylinders' knots at one angle


@dataclass(frozen=True)
class Stretch:
    """From a crank angle [rad] on, through a positive angle [rad], at a speed [rad/s] that is
    positive and, of a free crank, the one at the beginning. Rings rub at constant speed alone."""

    start: Number
    angle: Number
    speed: Number
    free: bool
    rings: Rings | None = None


class Means(NamedTuple):
    """duration [s]; forces [N] over time, those of the cylinders shape (n,); torques [N m] over the
    angle: of all rods on the crank, and from outside."""

    duration: float
    main_bearing: float
    crank_pin: Array
    piston_pin: Array
    side_force: Array
    crank_torque: float
    external_torque: float


class _States(NamedTuple):
    """At the nodes of panels, shape (panels * NODES,): [rad], [rad/s], [rad/s2]; energy [J] at
    their ends, shape (panels,)."""

    theta: Array
    omega: Array
    alpha: Array
    energy: Array


class _Loss(NamedTuple):
    """Of panels with a load c omega^2: J at the nodes [kg m2], shape (panels * NODES,); A, the
    integral of 2 c / J, up to every node, shape (panels, NODES), and to the end, shape (panels,);
    what exp(A) E gains at every node [J], weights left out."""

    inertia: Array
    inner: Array
    whole: Array
    gained: Array


def means(machine: Machine, stretch: Stretch) -> Means:
    """The means over a stretch, to some 1e-12 of each. The torques leave out what rings take."""
    loads, n = machine.loads, len(machine.cylinders)
    assert not loads.viscous
    assert not (*loads.time_tables, *loads.speed_tables, *loads.angle_tables)
    assert stretch.rings is None or not stretch.free
    walk = _Walk(machine, stretch)
    first = LONG.array([stretch.start])
    energy = walk.turning.inertia(first) * LONG.number(stretch.speed) ** 2 / 2
    edges = walk.edges()
    total = walk.integrals(edges[:-1], edges[1:], energy[0])
    joints = (total[1 : 2 + 3 * n] / total[0]).astype(float)
    torques = (total[-2:] / LONG.number(stretch.angle)).astype(float)
    pins = joints[1:].reshape(3, n)
    return Means(
        float(total[0]),
        float(joints[0]),
        pins[0],
        pins[1],
        pins[2],
        float(torques[0]),
        float(torques[1]),
    )


class _Walk:
    def __init__(self, machine: Machine, stretch: Stretch) -> None:
        self.machine, self.stretch = machine, stretch
        self.turning, self.alone = Turning(machine), _one_by_one(machine)
        self.nodes, self.weights = (LONG.array(x) for x in legendre.leggauss(NODES))
        self.inside = LONG.array(antiderivatives().ravel()).reshape(NODES, NODES)

    def edges(self) -> Array:
        """Knots of the pressures, dead centres, and no panel too wide."""
        m, start, angle = self.machine, LONG.number(self.stretch.start), self.stretch.angle
        r, l, e = (float(q) for q in (m.crank_radius, m.rod_length, m.offset))
        centres = (math.asin(e / (l + r)), math.pi + math.asin(e / (l - r)))
        turns = 2 * LONG.pi * np.arange(math.ceil(float(angle) / (2.0 * math.pi)))
        offsets = [
            (LONG.number(centre) - LONG.number(phase) - start) % (2 * LONG.pi) + turns
            for phase, _ in m.cylinders
            for centre in centres
        ]
        wanted = np.concatenate(offsets)
        wanted = wanted[wanted < LONG.number(angle)]
        edges = self.turning.edges(start, wanted, LONG.number(angle))
        return np.asarray(edges[np.append(True, np.diff(edges) > _NO_WIDTH)])

    def integrals(self, begin: Array, end: Array, energy: Number) -> Array:
        """Over all panels, from the first one's energy [J] on; each is halved until it agrees."""
        energies = begin * 0 + energy
        if self.stretch.free:
            lost = self._loss(begin, end)
            decay = np.exp(-lost.whole)
            for k in range(1, len(begin)):
                energies[k] = decay[k - 1] * (energies[k - 1] + lost.gained[k - 1] @ self.weights)
        values, _, _ = self._values(begin, end, energies)
        largest, total = np.abs(values).sum(axis=0), values.sum(axis=0) * 0
        largest[-2:] = largest[-2:].max()  # without a load the torque from outside is rounding
        for _ in range(_HALVINGS):
            middle = (begin + end) / 2
            low, at_middle, beyond_low = self._values(begin, middle, energies)
            high, _, beyond_high = self._values(middle, end, at_middle)
            apart = np.abs(low + high - values)
            apart[:, -2 - beyond_low.shape[1] : -2] += beyond_low + beyond_high
            done = (apart <= _CLOSE * largest).all(axis=1)
            total = total + (low + high)[done].sum(axis=0)
            if done.all():
                return np.asarray(total)
            begin, end, energies, values = (
                np.concatenate([first[~done], second[~done]])
                for first, second in (
                    (begin, middle),
                    (middle, end),
                    (energies, at_middle),
                    (low, high),
                )
            )
        raise RuntimeError(f"{len(begin)} panels do not agree with their halves")

    def _states(self, begin: Array, end: Array, energy: Array) -> _States:
        """The motion at the nodes of panels, from the energies [J] where they begin."""
        half = (end - begin)[:, None] / 2
        theta = (begin[:, None] + half * (1 + self.nodes)).ravel()
        still = theta * 0
        if not self.stretch.free:
            return _States(theta, still + LONG.number(self.stretch.speed), still, energy)
        quadratic = LONG.number(self.machine.loads.quadratic)
        inertia, inner, whole, gained = self._loss(begin, end)
        inside = np.exp(-inner) * (energy[:, None] + gained @ self.inside.T)
        omega = np.sqrt(2 * inside.ravel() / inertia)
        push = LONG.number(self.machine.loads.constant) - self._outside(theta, omega)
        alpha = (push - quadratic * omega * omega) / inertia
        at_end = np.exp(-whole) * (energy + gained @ self.weights)
        return _States(theta, omega, alpha, at_end)

    def _loss(self, begin: Array, end: Array) -> _Loss:
        half = (end - begin)[:, None] / 2
        theta = (begin[:, None] + half * (1 + self.nodes)).ravel()
        inertia = self.turning.inertia(theta)
        push = LONG.number(self.machine.loads.constant) - self._outside(theta, theta * 0)
        rate = 2 * LONG.number(self.machine.loads.quadratic) / inertia
        shaped = half * rate.reshape(len(begin), NODES)
        inner = shaped @ self.inside.T
        gained = half * np.exp(inner) * push.reshape(shaped.shape)
        return _Loss(inertia, inner, shaped @ self.weights, gained)

    def _outside(self, theta: Array, omega: Array) -> Array:
        """The torque that all cylinders need from outside at constant speed [N m]."""
        each = [newton_euler(one, theta, omega, theta * 0, DOUBLE) for one in self.alone]
        return np.asarray(sum(one.external_torque for one in each))

    def _values(self, begin: Array, end: Array, energy: Array) -> tuple[Array, Array, Array]:
        """Integrals over panels, shape (panels, 4 + 3 n), and the energy at their ends: the time,
        forces over time, torques over angle; and what side forces that pass zero between an end and
        the node beside it may add, shape (panels, n), which no node sees."""
        half = (end - begin)[:, None] / 2
        states = self._states(begin, end, energy)
        theta, omega, alpha, at_end = states
        each = [newton_euler(one, theta, omega, alpha, DOUBLE) for one in self.alone]
        forces = self._forces(each, theta)
        torques = [
            sum(one.crank_torque[:, 0] for one in each),
            sum(one.external_torque for one in each),
        ]
        rows = np.stack([1 / omega, *(force / omega for force in forces), *torques])
        shaped = rows.reshape(len(rows), len(begin), NODES) * half
        sides = [self._across(one, theta, k) / omega for k, one in enumerate(each)]
        beyond = self._beyond(np.stack(sides, axis=1).reshape(len(begin), NODES, -1), half)
        return np.asarray((shaped @ self.weights).T), at_end, beyond

    def _beyond(self, rows: Array, half: Array) -> Array:
        """Of panels' values at the nodes, shape (panels, NODES, n): those at the ends times the
        width, where their signs differ from those beside them."""
        found = np.zeros((len(rows), rows.shape[2]))
        for side, at in ((-1.0, 0), (1.0, -1)):
            there = np.tensordot(self._to_end(side), rows, (0, 1))
            found += np.where(there * rows[:, at] < 0, np.abs(there) * 2 * half, 0)
        return found

    def _to_end(self, side: float) -> Array:
        """What the value at each node adds at an end of the panel, by the polynomial of all."""
        apart = self.nodes[:, None] - self.nodes
        np.fill_diagonal(apart, 1)
        away = np.where(np.eye(NODES, dtype=bool), 1, side - self.nodes[None, :])
        return np.asarray((away / apart).prod(axis=1))

    def _forces(self, each: list[Reactions], theta: Array) -> list[Array]:
        """Magnitude of the force in every joint [N], shape (samples,): the main bearing, crank
        pins, piston pins, side forces."""
        bearing_x, bearing_y = theta * 0, theta * 0
        of_joint: list[list[Array]] = [[], [], []]
        for found, (phase, bank) in zip(each, self.machine.cylinders, strict=True):
            push = self._rubbed(found)
            across = push * self._slope(found, theta + LONG.number(phase))
            c, s = LONG.cos(LONG.number(bank)), LONG.sin(LONG.number(bank))
            bearing_x = bearing_x + found.main_bearing_force_x + c * push - s * across
            bearing_y = bearing_y + found.main_bearing_force_y + s * push + c * across
            pin = found.crank_pin_force_x[:, 0] + push, found.crank_pin_force_y[:, 0] + across
            piston = found.piston_pin_force_x[:, 0] + push, found.piston_pin_force_y[:, 0] + across
            of_joint[0].append(np.hypot(*pin))
            of_joint[1].append(np.hypot(*piston))
            of_joint[2].append(np.abs(found.side_force[:, 0] - across))
        return [np.hypot(bearing_x, bearing_y), *of_joint[0], *of_joint[1], *of_joint[2]]

    def _across(self, found: Reactions, theta: Array, k: int) -> Array:
        """The side force of cylinder k [N], with what friction adds, and its sign."""
        throw = theta + LONG.number(self.machine.cylinders[k][0])
        return np.asarray(found.side_force[:, 0] - self._rubbed(found) * self._slope(found, throw))

    def _rubbed(self, found: Reactions) -> Array:
        """Friction on a piston [N], towards the crank."""
        rings = self.stretch.rings or Rings(0.0, 0.0, 0.0)
        towards = -found.piston_velocity[:, 0]  # the oracle's points away from the crank
        pressed = LONG.number(rings.ring_pressure) * np.abs(found.gas_force[:, 0])
        limit = LONG.number(rings.ring_force) + pressed
        push: Array = -np.sign(towards) * limit - LONG.number(rings.viscous) * towards
        return push

    def _slope(self, found: Reactions, throw: Array) -> Array:
        """Of a rod: so much of a push along the cylinder it carries across."""
        r, e = LONG.number(self.machine.crank_radius), LONG.number(self.machine.offset)
        slope: Array = (e - r * np.sin(throw)) / (found.piston_position[:, 0] - r * np.cos(throw))
        return slope


def _one_by_one(machine: Machine) -> list[Machine]:
    """Machines of one cylinder each, the crank's own mass with the first: at a given motion their
    forces on bearing and crank add up."""
    light = replace(machine, crank_inertia=0.0, crank_mass=0.0, levers=())
    pressures = machine.pressures or (None,) * len(machine.cylinders)
    first = replace(machine, levers=())
    return [
        replace(light if k else first, cylinders=(cylinder,), pressure=pressure)
        for k, (cylinder, pressure) in enumerate(zip(machine.cylinders, pressures, strict=True))
    ]
