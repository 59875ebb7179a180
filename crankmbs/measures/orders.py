"""Orders: the harmonics of a quantity over one period, taken from the motion by quadrature."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from crankmbs.errors import InputError
from crankmbs.measures.between import Between, refined
from crankmbs.measures.joints import stated
from crankmbs.measures.span import Span, measured_span
from crankmbs.mechanics.knots import repeat
from crankmbs.mechanics.speed import speed_law
from crankmbs.mechanics.train import crank_angle_knots, crank_train
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.roots import invert_monotone
from crankmbs.result import Result
from crankmbs.scene.units import DEGREE

__all__ = ["Harmonics", "Orders", "orders"]

_HIGHEST = 100.0  # beyond it no machine has an order, and panels would be many
_PANEL = 2.0 * DEGREE  # widest panel
_OF_ORDER = 1.0  # rad of the highest order that a panel may hold
_NODES = (5, 6)  # of Gauss on a panel: the difference is the quadrature's error


@dataclass(frozen=True)
class Orders:
    """A quantity as mean + sum of amplitude cos(order angle + phase) over one period.

    order : shape (n,), per revolution of the crank; a four-stroke cycle gives halves, a settled
        period of n of them multiples of 1 / 2n
    amplitude : shape (n,) or (n, cylinders) [unit of the quantity]; phase [rad] alike
    mean : over the angle [unit]; shape () or (cylinders,)
    error : estimate of the error of every amplitude and of the mean [unit]; that of a phase is
        error / amplitude
    """

    order: Array
    amplitude: Array
    phase: Array
    mean: Array
    error: float


def orders(result: Result, name: str, highest: float = 12.0) -> Orders:
    """Split a variable into its orders over the last whole cycle; of a settled motion, its period.

    c_k = (2 / P) int f exp(-i k angle) d(angle) over the period P, of the motion between the
    samples (`crankmbs.measures.between.refined`), by Gauss quadrature on panels that end at the
    knots of the pressure. Exact to rounding where the speed is prescribed. The error is twice the
    variable's own and what coarser quadrature and, where the crank is free, a coarser motion
    between the samples differ by.

    Parameters
    ----------
    name : a variable of the result; per cylinder ones are split over each cylinder's cycle angle,
        all others over the crank angle
    highest : largest order wanted, 100 at most

    Raises
    ------
    InputError : no such variable, no whole cycle in the run, a reversal in it, samples too far
        apart to tell the motion between them, an order too high

    >>> float(orders(simulate(load_scene("propeller")), "crank_torque").order[0])
    0.5
    """
    return Harmonics(result, highest).of(name)


class Harmonics:
    """The last whole cycle of a run, or its settled period, at the nodes of a quadrature, made once
    for many quantities.

    Raises
    ------
    InputError : as `orders`
    """

    def __init__(self, result: Result, highest: float = 12.0) -> None:
        window = measured_span(result)
        if window.kind not in ("last cycle", "settled period"):
            raise InputError("orders need one whole cycle; let the run last longer")
        angle = result.data["crank_angle"].values[window.first :] * math.copysign(1.0, window.angle)
        if np.any(np.diff(angle) <= 0.0):
            raise InputError(
                "orders need a crank that turns one way; it reverses in the last cycle"
            )
        revolutions = round(abs(window.angle) / (2.0 * math.pi))
        if not 1.0 / revolutions <= highest <= _HIGHEST:
            raise InputError(
                f"highest must be an order from {1.0 / revolutions:g} to {_HIGHEST:g}; "
                f"{highest:g} came"
            )
        motions = refined(result, window.first)
        if not motions:
            raise InputError(
                "orders need the motion between the samples, which lie too far apart to tell it; "
                "give a narrower run.every"
            )
        self.window, self._result = window, result
        self.order = np.arange(1, int(highest * revolutions + 1e-9) + 1.0) / revolutions
        edges = _edges(result, window, highest)
        at_edges = [_times(motion, edges) for motion in motions]
        sets = [(m, t, _NODES[1]) for m, t in zip(motions, at_edges, strict=True)]
        sets.append((motions[-1], at_edges[-1], _NODES[0]))
        self._sets = [_Nodes(*one, window) for one in sets]

    def of(self, name: str) -> Orders:
        """The orders of a variable of the result."""
        variables = self._sets[0].variables
        if name not in variables:
            raise InputError(f"{name!r} is no variable with orders: {', '.join(sorted(variables))}")
        return self.split(lambda v: v[name], stated(self._result, name))

    def split(self, quantity: Callable[[Mapping[str, Array]], Array], error: float) -> Orders:
        """The orders of a quantity of the variables at the nodes, itself with an error [unit].

        quantity : from the variables of the result, (m,) or (m, cylinders), to an array alike;
            with cylinders its orders count from each cylinder's cycle angle
        """
        *others, coarse = (one.transform(quantity(one.variables), self.order) for one in self._sets)
        mean, parts = others[-1]
        apart = [
            max(float(np.max(np.abs(m - mean))), float(np.max(np.abs(p - parts))))
            for m, p in (*others[:-1], coarse)
        ]
        phase = np.angle(parts)
        if parts.ndim > 1:
            phase = phase - np.outer(self.order, [c.phase for c in self._result.scene.cylinders])
        return Orders(
            self.order,
            np.abs(parts),
            np.mod(phase + math.pi, 2.0 * math.pi) - math.pi,
            mean,
            2.0 * error + sum(apart),
        )


class _Nodes:
    """Nodes of a quadrature over the crank angle, on panels between times, and all variables."""

    def __init__(self, motion: Between, edges: Array, count: int, window: Span) -> None:
        place, weight = np.polynomial.legendre.leggauss(count)
        half = 0.5 * np.diff(edges)[:, None]
        time = (edges[:-1, None] + half * (1.0 + place)).ravel()
        self.variables = motion.variables(time)
        self._angle = self.variables["crank_angle"]
        self._weight = (half * weight).ravel() * self.variables["crank_speed"] / window.angle

    def transform(self, values: Array, order: Array) -> tuple[Array, Array]:
        """Mean, and amplitude exp(i phase) of every order over the crank angle."""
        waves = np.exp(-1j * np.outer(order, self._angle)) * self._weight
        return np.asarray(self._weight @ values), np.asarray(2.0 * waves @ values)


def _edges(result: Result, window: Span, highest: float) -> Array:
    """Crank angles [rad] between which the motion is smooth and the highest order slow, in the
    order in which they are passed."""
    end = float(result.data["crank_angle"].values[-1])
    low, high = sorted((end - window.angle, end))
    count = math.ceil((high - low) / min(_PANEL, _OF_ORDER / highest))
    train = crank_train(result.scene)
    knots = repeat(crank_angle_knots(train), train.period, low, high)
    parts = [np.linspace(low, high, count + 1), knots]
    if result.scene.motion is not None:
        law, time = speed_law(result.scene.motion), result.data["time"].values
        corners = law.at_time(law.corners(float(time[0]), float(time[-1])))[0]
        parts.append(corners[(corners > low) & (corners < high)])
    merged = np.unique(np.concatenate(parts))
    return merged if window.angle > 0.0 else merged[::-1]


def _times(motion: Between, angles: Array) -> Array:
    """Times [s] at which a motion that does not reverse passes crank angles."""
    data = motion.result.data
    time, passed = data["time"].values, data["crank_angle"].values
    sense = 1.0 if angles[-1] >= angles[0] else -1.0
    k = np.clip(np.searchsorted(sense * passed, sense * angles) - 1, 0, len(time) - 2)

    def angle(t: Array) -> tuple[Array, Array]:
        return motion.state(t)[:2]

    return invert_monotone(angle, angles, time[k], time[k + 1])
