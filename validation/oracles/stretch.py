"""A free crank between two events: smooth formulas for all that acts on it."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from validation.oracles.changes import Changes, Line, Pull, Push, Smooth
from validation.oracles.pythagoras import Place, cylinder_at, inertia_and_torque
from validation.oracles.travel import displacement_at

__all__ = ["NEAR", "Acting", "GasPiece", "Pushing", "Stretch", "meets", "piece_at", "press"]

Floats = NDArray[np.float64]

NEAR = 1e-11
"""A knot so near [rad] is here."""


class Acting(NamedTuple):
    """A load's pieces amid their knots; origin [rad] : what that over the angle counts from."""

    pull: Pull
    over_time: Smooth | None
    over_speed: Smooth | None
    over_angle: Smooth | None
    origin: float

    def at(self, t: float, theta: float, omega: float) -> float:
        """The torque [N m]."""
        value = 1.0
        if self.over_time is not None:
            value *= self.over_time(t)
        if self.over_speed is not None:
            value *= self.over_speed(omega)
        if self.over_angle is not None:
            value *= self.over_angle(theta - self.origin)
        if self.pull.smooth is not None:
            value *= self.pull.smooth(t, theta, omega)
        return value


class Pushing(NamedTuple):
    """A force's pieces on the piston of the cylinder k amid their knots; phase [rad] : of the
    cylinder; origin [rad] : cycle angle that what is over it counts from."""

    push: Push
    k: int
    phase: float
    over_time: Smooth | None
    over_travel: Smooth | None
    over_angle: Smooth | None
    origin: float

    def at(self, t: float, theta: float, displacement: float, velocity: float) -> float:
        """The force [N], towards the crank."""
        value, angle = 1.0, theta + self.phase
        if self.over_time is not None:
            value *= self.over_time(t)
        if self.over_travel is not None:
            value *= self.over_travel(displacement)
        if self.over_angle is not None:
            value *= self.over_angle(angle - self.origin)
        if self.push.smooth is not None:
            value *= self.push.smooth(t, angle, displacement, velocity)
        return value


class GasPiece(NamedTuple):
    """Of a cylinder, fired and motored, and the crank angles [rad] that they count from; below :
    of its crank end, alike."""

    fired: Smooth
    low: float
    motored: Smooth | None
    since: float
    below: Smooth | None = None
    under: float = 0.0


@dataclass
class Stretch:
    """Between knots of the angle [rad], of the speed [rad/s] and up to one of the time [s].

    shares : of the combustion; slides, pressed : the signs of every piston's velocity, towards the
    crank, and of its gas force
    """

    changes: Changes
    shares: tuple[float, ...]
    low: float
    high: float
    slow: float
    fast: float
    end: float
    gas: list[GasPiece]
    loads: list[Acting]
    slides: list[float]
    pressed: list[float]
    pushed: list[Pushing]

    def may_touch(self, t: Floats, y: Floats) -> bool:
        """Whether in a step of a solution, states of shape (2, n) at times (n,), the speed turns so
        near to a bound that it may have met it twice."""
        rate = np.array([self.alpha(*state) for state in zip(t.tolist(), *y.tolist(), strict=True)])
        turns = rate[1:] * rate[:-1] < 0.0
        reach = np.maximum(np.abs(rate[1:]), np.abs(rate[:-1])) * np.diff(t)
        near = np.minimum(y[1] - self.slow, self.fast - y[1])
        return bool(np.any(turns & (np.minimum(near[1:], near[:-1]) < reach)))

    def places(self, theta: float) -> list[Place]:
        """Of every cylinder."""
        machine = self.changes.machine
        return [cylinder_at(machine, theta, j) for j in range(len(machine.cylinders))]

    def forces(self, theta: float) -> list[float]:
        """Of the gas on every piston [N], towards the crank."""
        machine, forces = self.changes.machine, []
        for j, (piece, share) in enumerate(zip(self.gas, self.shares, strict=True)):
            own = machine.of(j)
            pressure = piece.fired(theta - piece.low)
            if piece.motored is not None:
                without = piece.motored(theta - piece.since)
                pressure = without + share * (pressure - without)
            force = float(own.piston_area) * pressure
            if piece.below is not None:
                force -= float(own.crank_end_area) * piece.below(theta - piece.under)
            forces.append(force)
        return forces or [0.0] * len(self.changes.machine.cylinders)

    def friction(self, theta: float, omega: float) -> list[float]:
        """On every piston [N], towards the crank."""
        if self.changes.rings is None:
            return [0.0] * len(self.slides)
        return self._rubbed(omega, self.places(theta), self.forces(theta))

    def _rubbed(self, omega: float, places: list[Place], forces: list[float]) -> list[float]:
        assert self.changes.rings is not None
        ring, pressed, viscous = self.changes.rings
        signs = self.pressed or [0.0] * len(places)
        of_each = zip(self.slides, signs, forces, places, strict=True)
        return [
            -slides * (ring + pressed * sign * force) + viscous * place.x_1 * omega
            for slides, sign, force, place in of_each
        ]

    def external(self, t: float, theta: float, omega: float) -> float:
        """The torque of the loads [N m]."""
        return sum(load.at(t, theta, omega) for load in self.loads)

    def applied(self, t: float, theta: float, omega: float) -> list[float]:
        """From outside on every piston [N], towards the crank."""
        return self._applied(t, theta, omega, self.places(theta))

    def _applied(self, t: float, theta: float, omega: float, places: list[Place]) -> list[float]:
        found = [0.0] * len(places)
        for one in self.pushed:
            displacement = displacement_at(self.changes.machine.of(one.k), theta + one.phase)
            found[one.k] += one.at(t, theta, displacement, -places[one.k].x_1 * omega)
        return found

    def on_pistons(self, t: float, theta: float, omega: float, places: list[Place]) -> list[float]:
        """All forces along the cylinder on every piston [N], towards the crank, but the rod's."""
        both = self.forces(theta)
        if self.pushed:
            applied = self._applied(t, theta, omega, places)
            both = [a + b for a, b in zip(both, applied, strict=True)]
        if self.changes.rings is not None:
            rubbed = self._rubbed(omega, places, self.forces(theta))
            both = [a + b for a, b in zip(both, rubbed, strict=True)]
        return both

    def alpha(self, t: float, theta: float, omega: float) -> float:
        """The acceleration [rad/s2]."""
        places = self.places(theta)
        both = self.on_pistons(t, theta, omega, places)
        inertia, slope, torque = inertia_and_torque(self.changes.machine, theta, places, both)
        return (torque + self.external(t, theta, omega) - 0.5 * slope * omega * omega) / inertia


def press(at: Stretch, ahead: float, sense: float) -> None:
    """The signs of the gas forces, and the end of the stretch where the next one changes."""
    bound = at.high if sense > 0.0 else at.low
    grid = np.linspace(ahead, bound - sense * NEAR, 99)
    of_each = np.array([at.forces(x) for x in grid]).T.tolist()
    for j, values in enumerate(of_each[: len(at.gas)]):
        at.pressed[j] = math.copysign(1.0, values[0])
        for a, b, x, y in zip(values, values[1:], grid, grid[1:], strict=False):
            if a * b < 0.0:
                root = float(brentq(lambda z, j=j: at.forces(z)[j], x, y, xtol=1e-15))
                bound = min(bound, root) if sense > 0.0 else max(bound, root)
                break
    if sense > 0.0:
        at.high = bound
    else:
        at.low = bound


def piece_at(line: Line | None, x: float, side: float) -> Smooth | None:
    """The piece of a load where the abscissa stands, on a knot that on its side."""
    if line is None:
        return None
    find = bisect_right if side > 0.0 else bisect_left
    return line.pieces[find(line.knots, x)]


def meets(speed: float, way: float) -> Any:
    """An event where the speed comes to a bound, growing or falling."""

    def event(_: float, y: Floats) -> float:
        return float(y[1] - speed) if math.isfinite(speed) else -way

    event.terminal, event.direction = True, way  # type: ignore[attr-defined]
    return event
