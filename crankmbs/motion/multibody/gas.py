"""Gas forces over the crank angle, smooth between the angles at which one of them jumps.

A step of the pressure would ring in the solver. So a run is cut where a cylinder's pressure jumps,
and on a stretch between two jumps the forces go on without them. Rings on the wall jump where a
piston turns: at dead centres, which cut a run as well, and where the crank reverses.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.firing import Firing
from crankmbs.mechanics.geometry import dead_centres
from crankmbs.mechanics.pressure import PeriodicPressure
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import NEAR, Cycle

__all__ = ["GasForces", "GasStretch"]

Force = Callable[[float], float]

_JUMP = 1e-9  # of the highest pressure or slope: less is rounding
_MOST_JUMPS = 60  # in a period; a table of more steps is run over as it is


class GasForces:
    """The gas forces of a crank train; without gas all zero."""

    def __init__(self, train: CrankTrain) -> None:
        scene = train.scene
        self.phases = np.array([cylinder.phase for cylinder in scene.cylinders])
        self._pressures, self._period = train.pressure or (), train.period
        self._combustion, self.law = train.combustion or (), train.law
        self._area = scene.piston.gas_area or 0.0
        self.friction = scene.friction
        shape = (scene.crank.radius, scene.rod.length, scene.piston.offset)
        self._centres = np.array(dead_centres(*shape))
        self._angles, self._rises, self._fired = self._jumps()

    @property
    def jumps(self) -> bool:
        """Whether a force jumps anywhere."""
        return any(len(_knots(each)[0]) > 0 for each in (*self._pressures, *self._combustion))

    @property
    def order(self) -> int:
        """1 where forces jump within a stretch, 2 where they bend there, else 3."""
        if self.jumps and len(self._angles) == 0:
            return 1
        if self.friction is not None and self.friction.ring_pressure > 0.0:
            return 2
        bend = any(len(_knots(each)[1]) > 0 for each in (*self._pressures, *self._combustion))
        return 2 if bend else 3

    def force(self, theta: Array, shares: Sequence[float] = ()) -> Array:
        """Gas forces [N] towards the crank, shape (m, n), at crank angles of shape (m,).

        shares : of the combustion of each cylinder; none leave it out
        """
        forces = np.zeros((len(theta), len(self.phases)))
        for k, pressure in enumerate(self._pressures):
            forces[:, k] = self._area * pressure(theta + self.phases[k])
        for k, share in enumerate(shares):
            forces[:, k] += share * self._area * self._combustion[k](theta + self.phases[k])
        return forces

    def scalar(self, k: int, shares: Sequence[float] = ()) -> Force:
        """The force [N] of cylinder k over its cycle angle [rad], from number to number.

        A bisection and a cubic in plain Python take 0.7 us; a symbolic tree of branches in
        exudyn's generic object, the only other way, costs 9 us a step.
        """
        if not self._pressures:
            return lambda angle: 0.0
        pressure = self._pressures[k]
        cubics = pressure.coefficients
        if shares:
            cubics = cubics + shares[k] * self._combustion[k].coefficients
        return Cycle(pressure.knots, self._area * cubics).by_number()

    def stretch(self, theta: float, sense: float, firing: Firing | None = None) -> GasStretch:
        """The stretch that a motion of this sense (its sign) enters at a crank angle [rad].

        firing : with fuel, what has been decided; the stretch ends where the next decision falls
        """
        shares = firing.shares if firing else ()
        low, high, rises = self._between_jumps(theta, sense, shares)
        if firing and self.law:
            before, after = self.law.next(firing)
            rises = rises * np.array([[low >= before], [high <= after]])
            low, high = max(low, before), min(high, after)
        if self.friction is None:
            return GasStretch(self, low, high, rises, shares)
        before, after = self._between_centres(theta + math.copysign(NEAR, sense))
        rises = rises * np.array([[low >= before], [high <= after]])
        low, high = max(low, before), min(high, after)
        behind = np.mod(0.5 * (before + after) + self.phases - self._centres[0], 2.0 * math.pi)
        outwards = np.where(behind < np.diff(self._centres), 1.0, -1.0)
        return GasStretch(self, low, high, rises, shares, math.copysign(1.0, sense) * outwards)

    def _between_centres(self, theta: float) -> tuple[float, float]:
        """The dead centres of any piston beside a crank angle [rad]."""
        angles = np.subtract.outer(self._centres, self.phases).ravel()
        ahead = np.mod(angles - theta, 2.0 * math.pi)
        return theta + float(ahead.max()) - 2.0 * math.pi, theta + float(ahead.min())

    def _between_jumps(
        self, theta: float, sense: float, shares: Sequence[float]
    ) -> tuple[float, float, Array]:
        """The jumps beside a crank angle, and what the forces rise by at either, shape (2, n)."""
        if len(self._angles) == 0:
            return -math.inf, math.inf, np.zeros((2, len(self.phases)))
        at = theta + math.copysign(NEAR, sense)
        turns = np.floor(at / self._period) + np.array([-1.0, 0.0, 1.0])
        angles = (self._angles + self._period * turns[:, None]).ravel()
        k = int(np.searchsorted(angles, at, side="right"))
        ends = np.array([k - 1, k])
        low, high = angles[ends]
        beside = ends % len(self._angles)
        rises = self._rises[beside] + (self._fired[beside] * np.array(shares) if shares else 0.0)
        return float(low), float(high), rises

    def _jumps(self) -> tuple[Array, Array, Array]:
        """Crank angles in a period at which a force jumps; what each cylinder's rises by there
        without combustion, and with a share of 1 more."""
        none = np.empty((0, len(self.phases)))
        places, changes = [np.empty(0)], [np.empty((2, 0, len(self.phases)))]
        for k, pressure in enumerate(self._pressures):
            both = [pressure, *self._combustion[k : k + 1]]
            found = np.unique(np.concatenate([_knots(each)[0] for each in both]))
            turns = pressure.period * np.arange(round(self._period / pressure.period))[:, None]
            here = np.mod(turns + pressure.knots[found] - self.phases[k], self._period)
            rise = np.zeros((2, len(turns), len(found), len(self.phases)))
            for row, each in zip(rise, both, strict=False):
                row[..., k] = self._area * _rises(each)[0][found]
            places.append(here.ravel())
            changes.append(rise.reshape(2, -1, len(self.phases)))
        angles, rises = np.concatenate(places), np.concatenate(changes, axis=1)
        if not 0 < len(angles) <= _MOST_JUMPS:
            return np.empty(0), none, none
        order = np.argsort(angles)
        angles, rises = angles[order], rises[:, order]
        apart = np.flatnonzero(np.diff(angles, prepend=-1.0) > NEAR)
        rises, fired = np.add.reduceat(rises, apart, axis=1)
        return angles[apart], rises, fired


@dataclass(frozen=True)
class GasStretch:
    """Gas forces between the crank angles ``low`` and ``high`` [rad], and smoothly beyond.

    rises : shape (2, n) [N], what each cylinder's force rises by at low and at high
    shares : of the combustion of each cylinder; none without fuel
    slides : shape (n,), the sign of each piston's velocity, by which its rings rub; without
        friction none
    """

    gas: GasForces
    low: float
    high: float
    rises: Array
    shares: tuple[float, ...] = ()
    slides: Array | None = None

    def rubbed(self, forces: Array) -> Array:
        """Friction of the rings [N] towards the crank, shape (m, n), under gas forces alike."""
        friction = self.gas.friction
        if friction is None or self.slides is None:
            return np.zeros_like(forces)
        limit = friction.ring_force + friction.ring_pressure * np.abs(forces)
        return np.asarray(-self.slides * limit)

    def along(self, theta: Array) -> Array:
        """Forces of gas and rings [N] towards the crank, shape (m, n), at crank angles (m,)."""
        forces = self.force(theta)
        return forces + self.rubbed(forces)

    def force(self, theta: Array) -> Array:
        """Gas forces [N] towards the crank, shape (m, n), at crank angles of shape (m,)."""
        below, above = theta < self.low - NEAR, theta >= self.high - NEAR
        lifted = below[:, None] * self.rises[0] - above[:, None] * self.rises[1]
        return np.asarray(self.gas.force(theta, self.shares) + lifted)

    def functions(self) -> list[Force]:
        """Forces of gas and rings cylinder by cylinder, from crank angle to force."""
        numbers = range(len(self.gas.phases))
        forces = [self._function(k, self.gas.scalar(k, self.shares)) for k in numbers]
        friction, slides = self.gas.friction, self.slides
        if friction is None or slides is None:
            return forces
        ring, pressed = friction.ring_force, friction.ring_pressure
        return [
            _with_rings(f, side * ring, side * pressed)
            for f, side in zip(forces, slides.tolist(), strict=True)
        ]

    def _function(self, k: int, force: Force) -> Force:
        phase = float(self.gas.phases[k])
        low, high = self.low - NEAR, self.high - NEAR
        at_low, at_high = (float(rise) for rise in self.rises[:, k])
        if at_low == 0.0 and at_high == 0.0:
            return lambda theta: force(theta + phase)

        def without_jumps(theta: float) -> float:
            lifted = at_low if theta < low else -at_high if theta >= high else 0.0
            return force(theta + phase) + lifted

        return without_jumps


def _with_rings(force: Force, ring: float, pressed: float) -> Force:
    """A gas force and what its rings rub, of the signs of the piston's velocity."""

    def along(theta: float) -> float:
        gas = force(theta)
        return gas - ring - pressed * abs(gas)

    return along


def _knots(pressure: PeriodicPressure) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers of the knots at which the pressure jumps, and of those at which it bends."""
    _, _, slopes, values = pressure.coefficients
    value, slope = _rises(pressure)
    jumps = np.abs(value) > _JUMP * np.max(np.abs(values))
    bends = np.abs(slope) > _JUMP * np.max(np.abs(slopes))
    return np.flatnonzero(jumps), np.flatnonzero(bends)


def _rises(pressure: PeriodicPressure) -> Array:
    """What pressure [Pa] and slope [Pa/rad] rise by at each knot but the last, shape (2, n)."""
    a, b, c, d = pressure.coefficients
    x = np.diff(pressure.knots)
    ends = np.array([((a * x + b) * x + c) * x + d, (3.0 * a * x + 2.0 * b) * x + c])
    return np.asarray(np.array([d, c]) - np.roll(ends, 1, axis=1))
