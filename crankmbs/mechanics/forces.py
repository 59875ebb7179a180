"""Forces from outside on the pistons, and what the crank feels of them.

A force F on a piston, positive towards the crank, has the power F v = -F x_1 omega, so that the
crank feels the torque -x_1 F. To whatever solves the motion it is one more load (`OnCrank`): of the
crank angle, as far as it depends on the cycle angle alone, or of time, angle and speed. In the
joints it is what friction is, a push along the axis between piston and frame
(`crankmbs.mechanics.newton_euler.pushed`).

Over the travel it may be another on the way back,

    F = (F_forward + F_back) / 2 - sign(v) (F_back - F_forward) / 2,

whose second part is that of a ring, which jumps at the dead centres and where the crank turns back,
as a damper is viscous friction: both resist as these do (`crankmbs.mechanics.friction`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.axes import axes_of, closed_loops, displacements, slides
from crankmbs.mechanics.geometry import (
    Loop,
    dead_centres,
    lengths_of,
    loop_at,
    throw_angles,
    top_position,
)
from crankmbs.mechanics.knots import KNOT, apart
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import tiled
from crankmbs.numerics.function import Function, named
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.force import PistonForce, PythonLaw
from crankmbs.scene.scene import Scene
from crankmbs.scene.torque import Parts

__all__ = ["OnCrank"]

_TURN = 2.0 * math.pi


@dataclass(frozen=True, eq=False)
class OnCrank:
    """A force on pistons as a load on the crank of a scene; it acts when the force does."""

    scene: Scene
    force: PistonForce

    @property
    def given(self) -> PistonForce:
        """As the scene gives it."""
        return self.force

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of angle and speed."""
        return self.force.is_steady

    def __call__(self, t: ArrayLike, theta: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s], crank angles [rad] and speeds [rad/s] of one shape."""
        every = np.broadcast_arrays(*map(np.asarray, (t, theta, omega)))
        t, theta, omega = (one.ravel().astype(np.float64) for one in every)
        arms = -closed_loops(self.scene, theta).x_1.T
        torque = (self.forces(t, theta, omega, np.sign(omega)) * arms).sum(axis=1)
        return np.asarray(torque.reshape(every[0].shape))

    @cached_property
    def pistons(self) -> Array:
        """1 for each cylinder on whose piston it acts, else 0, shape (cylinders, 1)."""
        number, count = self.force.cylinder, len(self.scene.cylinders)
        mask = np.ones(count) if number is None else np.arange(1, count + 1) == number
        return np.asarray(mask, dtype=np.float64)[:, np.newaxis]

    @cached_property
    def parts(self) -> Parts[_OverAngle]:
        """What the crank feels, but for what `resisting` does."""
        law = self.force.law
        by_angle = law.forward is not None or law.over_angle is not None
        more = law.over_time is not None or law.python is not None
        return Parts(
            over_angle=_OverAngle(self) if by_angle else None,
            function=_OfTime(self) if more else None,
        )

    def resisting(self, theta: Array, loop: Loop) -> tuple[Array, Array]:
        """Torque against either sense of rotation [N m], and torque per speed [N m s/rad], at crank
        angles of shape (n,)."""
        jumping = (np.abs(loop.x_1) * self.jumping(theta, loop)).sum(axis=0)
        return jumping, self.force.law.viscous * (self.pistons * loop.x_1**2).sum(axis=0)

    def forces(self, t: Array, theta: Array, omega: Array, share: Array) -> Array:
        """Forces on the pistons [N], shape (n, cylinders), at times, crank angles and speeds of
        shape (n,).

        share : shape (n,), the sense of rotation that sets that of the pistons; between -1 and 1
            it is, at rest, the share of `jumping` that holds
        """
        law, loop = self.force.law, closed_loops(self.scene, theta)
        total = self.by_angle(theta, loop)
        if law.over_time is not None or law.python is not None:
            total += self.by_time(t, theta, omega, loop)
        if law.switches:
            total -= np.abs(share) * self._sign(theta, share) * self.jumping(theta, loop)
        if law.viscous:
            total += self.pistons * (law.viscous * loop.x_1 * omega)
        return np.asarray(total.T)

    def by_angle(self, theta: Array, loop: Loop) -> Array:
        """What depends on the cycle angle alone [N], shape (cylinders, n), without `jumping`."""
        law, total = self.force.law, np.zeros_like(loop.x)
        if law.forward is not None and law.back is not None:
            total += 0.5 * self._over_travel(law.forward, theta, loop)
            total += 0.5 * self._over_travel(law.back, theta, loop)
        if law.over_angle is not None:
            total += law.over_angle(self._cycle_angles(theta))
        return self.pistons * total

    def by_time(self, t: Array, theta: Array, omega: Array, loop: Loop) -> Array:
        """What depends on time, or is a function of Python [N], shape (cylinders, n)."""
        law, total = self.force.law, np.zeros_like(loop.x)
        if law.over_time is not None:
            total += law.over_time(t)
        if law.python is not None:
            velocity = -loop.x_1 * omega
            at = t, self._cycle_angles(theta), displacements(self.scene, loop), velocity
            which = np.flatnonzero(self.pistons)
            each = (np.broadcast_to(one, loop.x.shape)[which] for one in at)
            total[which] += _each(law.python.function, *each)
        return self.pistons * total

    def jumping(self, theta: Array, loop: Loop) -> Array:
        """Half of what the force is more on the way back than forwards [N], (cylinders, n)."""
        law = self.force.law
        if not law.switches or law.forward is None or law.back is None:
            return np.zeros_like(loop.x)
        ways = (self._over_travel(way, theta, loop) for way in (law.back, law.forward))
        more = np.subtract(*ways)
        return np.asarray(self.pistons * (0.5 * more))

    def _sign(self, theta: Array, sense: Array) -> Array:
        """Of the pistons' velocities in a sense of rotation."""
        return np.where(sense >= 0.0, *(slides(self.scene, theta, one) for one in (1.0, -1.0)))

    def _cycle_angles(self, theta: Array) -> Array:
        return np.add.outer(axes_of(self.scene).phases, theta)

    def _over_travel(self, way: Piecewise, theta: Array, loop: Loop) -> Array:
        """A function of the displacement; on a jump that at a larger crank angle."""
        at = displacements(self.scene, loop)
        if not way.jumps:
            return way(at)
        beyond = displacements(self.scene, closed_loops(self.scene, theta + KNOT))
        return way.of_piece(beyond, at)

    @cached_property
    def travel_knots(self) -> list[Array]:
        """Cycle angles [rad] in a revolution at which the force over the travel of each piston
        bends or jumps."""
        law = self.force.law
        rows = {k for way in (law.forward, law.back) if way is not None for k in way.knots}
        rows |= set(law.python.displacements if law.python else ())
        knots = []
        for gear in self.scene.running_gear:
            inside = np.array(sorted(row for row in rows if 0.0 < row < gear.stroke))
            knots.append(np.concatenate(throw_angles(inside, gear.stroke - inside, *gear.shape)))
        return knots

    def at_crank(self, cycle_angles: list[Array], period: float) -> Array:
        """The crank angles [rad] in [0, period) at which a piston that it acts on is at one of its
        cycle angles."""
        pistons = zip(cycle_angles, axes_of(self.scene).phases, self.pistons[:, 0], strict=True)
        angles = [angle - phase for angle, phase, acts in pistons if acts]
        return apart(np.mod(np.concatenate(angles), period))


def _each(function: Callable[..., float], *at: Array) -> Array:
    """A function of numbers at each of many."""
    called: Any = np.frompyfunc(lambda *one: float(function(*one)), len(at), 1)
    return np.asarray(called(*at), dtype=np.float64)


class _OverAngle:
    """The torque [N m] of what depends on the cycle angle alone, over the crank angle [rad]."""

    def __init__(self, load: OnCrank) -> None:
        self._load, law = load, load.force.law
        self.period = _TURN if law.over_angle is None else law.over_angle.period
        rows = np.empty(0) if law.over_angle is None else law.over_angle.knots[:-1]
        whole = max(self.period, _TURN)
        over_travel = (tiled(travel, _TURN, whole) for travel in load.travel_knots)
        cycle_angles = [np.concatenate([travel, rows]) for travel in over_travel]
        inside = load.at_crank(cycle_angles, self.period)
        inside = inside[(inside > KNOT) & (inside < self.period - KNOT)]
        self.knots = np.concatenate([[0.0], inside, [self.period]])

    def __call__(self, angle: ArrayLike) -> Array:
        theta = np.asarray(angle, dtype=np.float64)
        loop = closed_loops(self._load.scene, theta.ravel())
        torque = -(loop.x_1 * self._load.by_angle(theta.ravel(), loop)).sum(axis=0)
        return np.asarray(torque.reshape(theta.shape))

    @cached_property
    def largest(self) -> float:
        """About its largest value, without its sign."""
        return float(np.max(np.abs(self(np.linspace(0.0, self.period, 721)))))


class _OfTime(Function):
    """The torque [N m] of what depends on time, or is a function of Python."""

    def __init__(self, load: OnCrank) -> None:
        self._load, law = load, load.force.law
        python = law.python or PythonLaw(_nothing)
        period = python.period or _TURN
        knots = []
        for travel, gear in zip(load.travel_knots, load.scene.running_gear, strict=True):
            centres = dead_centres(*gear.shape) if law.python is not None else ()
            # at a dead centre it may jump with the sense of the velocity
            every = tiled(np.concatenate([travel, centres]), _TURN, 2.0 * period)
            knots.append(np.concatenate([every, python.angles]))
        angles = load.at_crank(knots, period).tolist()
        times = (*python.times, *(law.over_time.knots if law.over_time else ()))
        speeds = () if law.python is None else (0.0,)

        pistons = [
            (cylinder.phase, top_position(*gear.shape), lengths_of(*gear.shape))
            for cylinder, gear in zip(load.scene.cylinders, load.scene.running_gear, strict=True)
        ]
        acts_on = [pistons[k] for k in np.flatnonzero(load.pistons)]
        over_time = None if law.over_time is None else law.over_time.by_number()

        def one(t: float, theta: float, omega: float) -> float:
            torque = 0.0
            for phase, top, lengths in acts_on:
                x, x_1 = loop_at(theta + phase, lengths)
                force = 0.0 if over_time is None else over_time(t)
                force += float(python.function(t, theta + phase, top - x, -x_1 * omega))
                torque -= x_1 * force
            return torque

        one.__name__ = named(python.function)
        super().__init__(one, times, tuple(angles), speeds, python.period)
        self.declared = law.python is None

    def _values(self, at: list[Array]) -> Array:
        t, theta, omega = at
        loop = closed_loops(self._load.scene, theta)
        return np.asarray(-(loop.x_1 * self._load.by_time(t, theta, omega, loop)).sum(axis=0))


def _nothing(*_: float) -> float:
    return 0.0
