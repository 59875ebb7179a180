"""The work of the gas in whole cycles: it depends on the angle and on the shares alone."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.mechanics.axes import areas
from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots
from crankmbs.numerics.arrays import Array, Index
from crankmbs.scene.units import DEGREE

__all__ = ["GasWork"]

_PANEL = 5.0 * DEGREE  # widest panel of the quadrature
_SAME = 1e-9  # rad


class GasWork:
    """Of each cylinder of a crank train, in cycles that begin at an angle [rad] or whole periods
    from it: -A p(phi) dx/dphi integrated by Gauss's rule between the knots of the pressures."""

    def __init__(self, train: CrankTrain, start: float, points: int) -> None:
        scene = train.scene
        self._period, self._start = scene.period, start
        self._cycles = round(train.period / scene.period)
        self._phases = np.array([c.phase for c in scene.cylinders])
        self._train, self._points = train, points
        ahead = (math.pi - self._phases - start) % self._period
        self._decides = np.where(self._period - ahead < _SAME, 0.0, ahead)
        self._without, self._below, self._above, self._crank_end = self._integrals()

    def pressures(self, work: Array, place: Index, sense: Array) -> dict[str, Array]:
        """Mean effective pressures by name [Pa], shape (n, cylinders), of works of the gas [J] in
        cycles as `works` takes them; of double-acting cylinders those of both ends."""
        scene = self._train.scene
        on_head, on_crank = areas(scene)
        stroke = np.array([gear.stroke for gear in scene.running_gear])
        if self._train.crank_end is None:
            return {"imep": work / (on_head * stroke)}
        below = sense[:, None] * self._crank_end[self._which(place, sense)]
        return {
            "imep": (work - below) / (on_head * stroke),
            "imep_crank_end": below / (on_crank * stroke),
        }

    def works(self, place: Index, sense: Array, before: Array, after: Array) -> Array:
        """Work [J] in cycles, shape (n, cylinders): motored, and by both shares of the combustion.

        place : shape (n,), how many periods from the start the cycle begins; sense : its sign
        before, after : shape (n, cylinders), shares up to the decision in the cycle and from it on
        """
        which = self._which(place, sense)
        work = self._without[which]
        if before.shape[1]:
            rises = sense[:, None] > 0.0
            below, above = np.where(rises, before, after), np.where(rises, after, before)
            work = work + below * self._below[which] + above * self._above[which]
        return np.asarray(sense[:, None] * work)

    def _which(self, place: Index, sense: Array) -> Index:
        """Which cycle of the whole period each is."""
        return np.asarray(np.where(sense > 0.0, place, -place - 1) % self._cycles)

    def shares(self, sense: Array, before: Array, after: Array) -> Array:
        """The share of the firing whose dead centre a cycle holds, shape (n, cylinders)."""
        ahead = (2.0 * math.pi - self._phases - self._start) % self._period
        rising = np.where(self._decides <= ahead + _SAME, after, before)
        falling = np.where(self._decides >= ahead - _SAME, after, before)
        return np.asarray(np.where(sense[:, None] > 0.0, rising, falling))

    def _integrals(self) -> Array:
        """Of the pressure without combustion, of a share of 1 below and above the decision, and of
        the crank ends alone, in each cycle of the whole period, shape (4, cycles, cylinders)."""
        train, whole = self._train, self._period * self._cycles
        count = round(whole / _PANEL)
        knots = (crank_angle_knots(train) - self._start) % whole
        ends = self._period * np.arange(self._cycles + 1)
        decides = np.add.outer(ends[:-1], self._decides).ravel()
        edges = np.unique(
            np.concatenate([np.linspace(0.0, whole, count + 1), knots, ends, decides])
        )
        nodes, weights = np.polynomial.legendre.leggauss(self._points)
        width = np.diff(edges)[:, None]
        ahead = edges[:-1, None] + 0.5 * width * (1.0 + nodes)
        of_panel = np.minimum(ahead[:, 0] // self._period, self._cycles - 1).astype(np.intp)
        found = np.zeros((4, self._cycles, len(self._phases)))
        for k, (phase, gear) in enumerate(zip(self._phases, train.scene.running_gear, strict=True)):
            phi, area = self._start + ahead + phase, gear.piston.gas_area or 0.0
            lever = -area * close_loop(phi, *gear.shape).x_1 * 0.5 * width * weights
            if train.pressure is not None:
                work = (lever * train.pressure[k](phi)).sum(axis=1)
                np.add.at(found[0, :, k], of_panel, work)
            if train.combustion is not None:
                work = (lever * train.combustion[k](phi)).sum(axis=1)
                late = (ahead[:, 0] % self._period > self._decides[k]).astype(np.intp)
                np.add.at(found[1:3, :, k], (late, of_panel), work)
            if train.crank_end is not None:
                share = gear.piston.crank_end_share
                work = -(share * lever * train.crank_end[k](phi)).sum(axis=1)
                np.add.at(found[3, :, k], of_panel, work)
        return found
