"""Orders: the harmonics of a quantity over one period, taken from the motion by quadrature."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from crankmbs.errors import InputError, shown
from crankmbs.measures.estimate import ROUNDING
from crankmbs.measures.nodes import nodes_of
from crankmbs.measures.span import CYCLES, TURNS_BACK, measured_span, passes_over
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.motion.motion import Motion
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.sentences import there_are
from crankmbs.scene.units import DEGREE

__all__ = ["Harmonics", "Orders", "orders"]

_HIGHEST = 100.0  # beyond it no machine has an order, and panels would be many
_WIDEST = 6.0 * DEGREE  # of a cell
_OF_ORDER = 1.0  # rad of the highest order that a cell may hold


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

    c_k = (2 / P) int f exp(-i k angle) d(angle) over the period P, by the Gauss rule of the cells
    that the motion was solved in; they end at the knots of the pressure. The error is what the
    motion that checks it gives otherwise, and rounding.

    Parameters
    ----------
    name : a variable of the result; per cylinder ones are split over each cylinder's cycle angle,
        all others over the crank angle
    highest : largest order wanted, 100 at most

    Raises
    ------
    InputError : no such variable, no whole cycle in the run, a reversal in it, an order too high

    >>> float(orders(simulate(load_scene("propeller")), "crank_torque").order[0])
    0.5
    """
    return Harmonics(result, highest).of(name)


class Harmonics:
    """The last whole cycle of a run, or the last period, for the orders of many quantities.

    Raises
    ------
    InputError : as `orders`
    """

    def __init__(self, result: Result, highest: float = 12.0) -> None:
        window = measured_span(result)
        reverses = "orders need a crank that turns one way; it reverses in the last cycle"
        if window.kind == TURNS_BACK:
            raise InputError(reverses)
        if window.kind not in CYCLES:
            cycle, turned = (x / math.tau for x in (result.scene.period, abs(window.angle)))
            raise InputError(
                f"run.until: orders need one whole cycle, {cycle:g} rev of this machine; the crank "
                f"turns {turned:.3g} rev; let the run last longer"
            )
        self.passes = passes_over(result, window)
        if not self.passes.answer.turns_one_way:
            raise InputError(reverses)
        revolutions = round(abs(window.angle) / (2.0 * math.pi))
        if not 1.0 / revolutions <= highest <= _HIGHEST:
            raise InputError(
                f"highest must be an order from {1.0 / revolutions:g} to {_HIGHEST:g}; "
                f"{highest:g} came"
            )
        self.window, self._scene = window, result.scene
        self._widest = min(_WIDEST, _OF_ORDER / highest)
        self.order = np.arange(1, int(highest * revolutions + 1e-9) + 1.0) / revolutions

    def of(self, name: str) -> Orders:
        """The orders of a variable of the result."""
        variables = nodes_of(self.passes.answer, self._widest).variables
        if name not in variables:
            raise InputError(
                f"{shown(name)} is no variable with orders{there_are(name, sorted(variables))}"
            )
        alike = (v for k, v in variables.items() if EVERY[k].units == EVERY[name].units)
        terms = max(map(peak, alike)) if name in SUMS else 0.0
        return self.split(lambda v: v[name], terms)

    def split(self, quantity: Callable[[Mapping[str, Array]], Array], terms: float = 0.0) -> Orders:
        """The orders of a quantity of the variables at the nodes.

        quantity : from the variables of the result, (p,) or (p, cylinders), to an array alike;
            with cylinders its orders count from each cylinder's cycle angle
        terms : how large the terms of a sum are that may cancel; their rounding does not
        """
        (mean, parts, size), *others = (
            self._transformed(quantity, motion)
            for motion in (self.passes.answer, *self.passes.checks)
        )
        apart = [
            max(float(np.max(np.abs(m - mean))), float(np.max(np.abs(p - parts))))
            for m, p, _ in others
        ]
        phase = np.angle(parts)
        if parts.ndim > 1:
            phase = phase - np.outer(self.order, [c.phase for c in self._scene.cylinders])
        return Orders(
            self.order,
            np.abs(parts),
            np.mod(phase + math.pi, 2.0 * math.pi) - math.pi,
            mean,
            self.passes.share * max(apart, default=math.inf) + ROUNDING * max(size, terms),
        )

    def _transformed(
        self, quantity: Callable[[Mapping[str, Array]], Array], motion: Motion
    ) -> tuple[Array, Array, float]:
        """Mean, and amplitude exp(i phase) of every order over the crank angle; and the mean size
        of what they are summed from."""
        nodes = nodes_of(motion, self._widest)
        values, weight = quantity(nodes.variables), nodes.turned / motion.turned
        waves = np.exp(-1j * np.outer(self.order, nodes.samples.theta)) * weight
        size = float(np.max(weight @ np.abs(values)))
        return np.asarray(weight @ values), np.asarray(2.0 * waves @ values), size
