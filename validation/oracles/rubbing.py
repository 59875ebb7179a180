"""A free crank whose pistons rub, over time, by SciPy: the kinematics of Pythagoras, Lagrange's
equation, an event at every angle where friction jumps or bends and at every rest.

    friction = -sign(v) (ring_force + ring_pressure |gas force|) - viscous v

Between two such angles the signs are those amid them, so that every step has smooth formulas. Its
error is that of DOP853 at 1e-13, some 1e-11 of what is reached in a few turns.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from validation.oracles.machine import Machine
from validation.oracles.pressure import Pieces, pressure_pieces

__all__ = ["Rings", "Rubbed", "rubbed_motion"]

Floats = NDArray[np.float64]

_RTOL = 1e-13
_NEAR = 1e-12  # rad: a bound so near ahead is here


@dataclass(frozen=True)
class Rings:
    """ring_force [N], share of the gas force, viscous [N s/m]."""

    ring_force: float
    ring_pressure: float
    viscous: float


@dataclass(frozen=True)
class Rubbed:
    """Samples: shape (n,) [rad], [rad/s], [rad/s2]; friction : shape (n, cylinders) [N], towards
    the crank; knots : crank angles in a period at which it jumps or bends or the gas does [rad]."""

    theta: Floats
    omega: Floats
    alpha: Floats
    friction: Floats
    knots: Floats


class _Cylinder(NamedTuple):
    """At a crank angle: velocity and acceleration of the pin per angle, and the same of the rod's
    centre and of its angle."""

    x_1: float
    x_2: float
    rod: tuple[float, float, float, float]
    b_1: float
    b_2: float


class _Stretch(NamedTuple):
    """Between two angles: the cubics of the gas (origin and ascending coefficients), the signs of
    every piston's velocity and gas force."""

    low: float
    high: float
    gas: list[tuple[float, Floats]]
    slides: list[float]
    pressed: list[float]


def rubbed_motion(
    machine: Machine, rings: Rings, theta: float, omega: float, times: Floats
) -> Rubbed:
    """The motion from a crank angle and speed, at increasing times [s].

    Loads: constant, viscous and quadratic.
    """
    return _Walk(machine, rings).samples(theta, omega, times)


class _Walk:
    def __init__(self, machine: Machine, rings: Rings) -> None:
        loads = machine.loads
        assert not loads.time_tables
        assert not loads.speed_tables
        self.machine, self.rings = machine, rings
        self.pieces: list[Pieces] = [pressure_pieces(p) for p in machine.pressures]
        self.period = float(machine.period)
        self.knots = self._knots()

    def samples(self, theta: float, omega: float, times: Floats) -> Rubbed:
        y, t = np.array([theta, omega]), 0.0
        rows = []
        for time in times:
            sense = self._sense(y)
            while t < time and sense:
                y, t = self._until(y, t, float(time), sense)
                sense = self._sense(y)
            t = float(time)
            rows.append(self._row(y, sense))
        angle, speed, rate, friction = (np.array(part) for part in zip(*rows, strict=True))
        return Rubbed(angle, speed, rate, friction, self.knots)

    def _knots(self) -> Floats:
        """Dead centres, knots of the gas and roots of its cubics, in [0, period)."""
        m = self.machine
        r, l, e = (float(q) for q in (m.crank_radius, m.rod_length, m.offset))
        found: list[float] = []
        for k, (phase, _) in enumerate(m.cylinders):
            turns = 2.0 * math.pi * np.arange(round(self.period / (2.0 * math.pi)))
            for centre in (math.asin(e / (l + r)), math.pi + math.asin(e / (l - r))):
                found += (centre + turns - float(phase)).tolist()
            if not self.pieces:
                continue
            own = self.pieces[k]
            knots = np.append(own.knots, own.knots[0] + own.period).astype(float)
            inside = list(knots[:-1])
            for i, row in enumerate(own.coefficients.astype(float)):
                for root in np.roots(np.trim_zeros(row[::-1], "f")):
                    real = abs(root.imag) < 1e-9 and 0.0 < root.real < knots[i + 1] - knots[i]
                    inside += [knots[i] + root.real] if real else []
            for n in range(round(self.period / float(own.period))):
                found += [x + n * float(own.period) - float(phase) for x in inside]
        angles = np.unique(np.mod(found, self.period))
        return np.asarray(angles[np.append(True, np.diff(angles) > 1e-11)])

    def _stretch(self, theta: float, sense: float) -> _Stretch:
        base = math.floor(theta / self.period) * self.period
        around = np.concatenate([self.knots + base + n * self.period for n in (-1, 0, 1)])
        k = int(np.searchsorted(around, theta + sense * _NEAR))
        low, high = float(around[k - 1]), float(around[k])
        middle = 0.5 * (low + high)
        gas, slides, pressed = [], [], []
        for j, (phase, _) in enumerate(self.machine.cylinders):
            origin, cubic = 0.0, np.zeros(4)
            if self.pieces:
                index, local = self.pieces[j].locate(np.array([middle + float(phase)]))
                origin = middle - float(local[0])
                cubic = self.pieces[j].coefficients[index[0]].astype(float)
                cubic = cubic * float(self.machine.piston_area)
            gas.append((origin, cubic))
            slides.append(-sense * math.copysign(1.0, self._cylinder(middle, j).x_1))
            force = float(np.polynomial.polynomial.polyval(middle - origin, cubic))
            pressed.append(math.copysign(1.0, force))
        return _Stretch(low, high, gas, slides, pressed)

    def _cylinder(self, theta: float, j: int) -> _Cylinder:
        """By Pythagoras: the pin at (x, e), l^2 = (x - r cos)^2 + (e - r sin)^2."""
        m = self.machine
        r, l, e = (float(q) for q in (m.crank_radius, m.rod_length, m.offset))
        phi, part = theta + float(m.cylinders[j][0]), float(m.rod_center_of_mass) / l
        c, s = r * math.cos(phi), r * math.sin(phi)
        u, u_1, u_2 = s - e, c, -s
        w = math.sqrt(l * l - u * u)
        w_1 = -u * u_1 / w
        w_2 = -(u_1 * u_1 + u * u_2 + w_1 * w_1) / w
        x_1, x_2 = -s + w_1, -c + w_2
        rod = (-s + part * w_1, c - part * u_1, -c + part * w_2, -s - part * u_2)
        return _Cylinder(x_1, x_2, rod, u_1 / w, (u_2 * w - u_1 * w_1) / (w * w))

    def _friction(self, theta: float, omega: float, at: _Stretch, held: float) -> list[float]:
        """On every piston [N], towards the crank; ``held``: the share of the rings' that acts."""
        forces = []
        for j, (origin, cubic) in enumerate(at.gas):
            force = float(np.polynomial.polynomial.polyval(theta - origin, cubic))
            limit = self.rings.ring_force + self.rings.ring_pressure * at.pressed[j] * force
            velocity = -self._cylinder(theta, j).x_1 * omega
            forces.append(-held * at.slides[j] * limit - self.rings.viscous * velocity)
        return forces

    def _torque(self, theta: float, omega: float, at: _Stretch) -> tuple[float, float, float]:
        """J, dJ/dtheta and the torque of gas, weights and loads on the crank."""
        m, load = self.machine, self.machine.loads
        gx, gy = (float(q) for q in m.gravity)
        unbalanced = float(m.crank_mass) * float(m.crank_center_of_mass)
        inertia, slope = float(m.crank_inertia), 0.0
        torque = unbalanced * (gy * math.cos(theta) - gx * math.sin(theta))
        torque += float(load.constant) - float(load.viscous) * omega
        torque -= float(load.quadratic) * omega * abs(omega)
        mp, mr, ir = (float(q) for q in (m.piston_mass, m.rod_mass, m.rod_inertia))
        for j, (_, bank) in enumerate(m.cylinders):
            c = self._cylinder(theta, j)
            a, b, a_2, b_2 = c.rod
            inertia += mp * c.x_1**2 + mr * (a * a + b * b) + ir * c.b_1**2
            slope += 2.0 * (mp * c.x_1 * c.x_2 + mr * (a * a_2 + b * b_2) + ir * c.b_1 * c.b_2)
            along = gx * math.cos(bank) + gy * math.sin(bank)
            across = gy * math.cos(bank) - gx * math.sin(bank)
            origin, cubic = at.gas[j]
            force = float(np.polynomial.polynomial.polyval(theta - origin, cubic))
            torque += mp * along * c.x_1 + mr * (along * a + across * b) - force * c.x_1
        return inertia, slope, torque

    def _alpha(self, theta: float, omega: float, at: _Stretch, held: float) -> float:
        inertia, slope, torque = self._torque(theta, omega, at)
        for j, force in enumerate(self._friction(theta, omega, at, held)):
            torque -= force * self._cylinder(theta, j).x_1
        return (torque - 0.5 * slope * omega * omega) / inertia

    def _sense(self, y: Floats) -> float:
        """In which the crank turns on; 0 where friction holds it."""
        if y[1] != 0.0:
            return math.copysign(1.0, y[1])
        for sense in (1.0, -1.0):
            if sense * self._alpha(float(y[0]), 0.0, self._stretch(float(y[0]), sense), 1.0) > 0.0:
                return sense
        return 0.0

    def _until(self, y: Floats, t: float, end: float, sense: float) -> tuple[Floats, float]:
        """To a time, or to the first event before it."""
        at = self._stretch(float(y[0]), sense)
        bound = at.high if sense > 0.0 else at.low

        def slopes(_: float, y: Floats) -> list[float]:
            return [float(y[1]), self._alpha(float(y[0]), float(y[1]), at, 1.0)]

        def passes(_: float, y: Floats) -> float:
            return float(sense * (y[0] - bound))

        def rests(_: float, y: Floats) -> float:
            return float(sense * y[1])

        events: list[Any] = [passes, rests]
        for event, direction in zip(events, (1.0, -1.0), strict=True):
            event.terminal, event.direction = True, direction
        speed = abs(float(y[1])) + abs(slopes(t, y)[1]) * (end - t) + 1e-9
        options: dict[str, Any] = {"method": "DOP853", "rtol": _RTOL}
        options["atol"] = [1e-15, 1e-14 * speed]
        found = solve_ivp(slopes, (t, end), y, events=events, **options)
        if found.status != 1:
            return np.asarray(found.y[:, -1]), end
        met = float(found.t[-1])
        last = y
        if met > t:
            last = solve_ivp(slopes, (t, met), y, **options).y[:, -1]
        if found.t_events is not None and len(found.t_events[0]):
            return np.array([bound, last[1]]), met
        return np.array([last[0], 0.0]), met

    def _row(self, y: Floats, sense: float) -> tuple[float, float, float, list[float]]:
        theta, omega = float(y[0]), float(y[1])
        at = self._stretch(theta, sense or 1.0)
        if sense:
            alpha = self._alpha(theta, omega, at, 1.0)
            return theta, omega, alpha, self._friction(theta, omega, at, 1.0)
        inertia, _, _ = self._torque(theta, 0.0, at)
        free, held = (self._alpha(theta, 0.0, at, share) * inertia for share in (0.0, 1.0))
        share = free / (free - held) if free != held else 0.0
        return theta, 0.0, 0.0, self._friction(theta, 0.0, at, share)
