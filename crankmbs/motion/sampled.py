"""A motion from samples alone, where a formulation gives no more: polynomials between them."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.train import crank_train
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.motion import Motion, Passes
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["through_samples"]

_STAGES = 4  # with both ends enough for polynomials of degree 5
_SHARE = 2.0  # two causes, each of which is stated as the largest difference that it makes


def through_samples(data: xr.Dataset, scene: Scene) -> Passes:
    """The motion through the samples of a result.

    Between two samples the crank angle is the polynomial of degree 5 with their angles, speeds and
    accelerations. It is checked by those of degree 3 with the angles and speeds alone, and by a
    motion that is off by all errors that are stated at the samples.
    """
    names = ("crank_angle", "crank_speed", "crank_acceleration")
    time, rows = data["time"].values, [data[name].values for name in names]
    errors = [float(data[name].attrs["error_estimate"]) for name in names]
    shares = data["fuel"].values if "fuel" in data else np.empty((len(time), 0))
    train = crank_train(scene)
    off = [row + error for row, error in zip(rows, errors, strict=True)]
    known = bool(np.all(np.isfinite(errors)))
    if len(time) == 1:
        instants = [Motion(train, [_instant([time, *of], shares)]) for of in (rows, off)]
        return Passes(instants[0], tuple(instants[1:]) if known else ())
    answer, coarse = (Motion(train, _stretches(time, rows[:n], shares)) for n in (3, 2))
    if not known:
        return Passes(answer, ())
    return Passes(answer, (coarse, Motion(train, _stretches(time, off, shares))), _SHARE)


def _instant(rows: list[Array], shares: Array) -> Cells:
    """A cell of no duration, from time, angle, speed and acceleration of one sample."""
    stages = len(ends_and_nodes(_STAGES).places)
    time, angle, speed, rate = (np.repeat(row[:, None], stages, axis=1) for row in rows)
    return Cells(time, angle, speed, Acting(0.0), shares, acceleration=rate)


def _stretches(time: Array, rows: list[Array], shares: Array) -> list[Cells]:
    """The cells between samples, in stretches of one sense of rotation."""
    places = ends_and_nodes(_STAGES).places
    width = np.diff(time)
    angle, speed, rate = _polynomials(rows, width, places)
    at = time[:-1, None] + width[:, None] * places
    cells = Cells(at, angle, speed, Acting(0.0), shares[1:], acceleration=rate)
    cells = cells.cut_where_it_turns()
    senses = np.sign(cells.angle[:, -1] - cells.angle[:, 0])
    ends = [0, *(1 + np.flatnonzero(np.diff(senses))).tolist(), len(senses)]
    parts = []
    for low, high in pairwise(ends):
        acting = Acting(float(senses[low]), bool(senses[low] == 0.0))
        parts.append(replace(cells.first(high).since(low), acting=acting))
    return parts


def _polynomials(rows: list[Array], width: Array, places: Array) -> Array:
    """Values, slopes and second slopes in time, shape (3, m, n), of the polynomials whose values
    and first derivatives at both ends of cells are given."""
    degree = np.arange(2 * len(rows))
    steps = [_derivative(degree, np.array([0.0, 1.0]), k) for k in range(len(rows))]
    ends = [side * width**k for k, row in enumerate(rows) for side in (row[:-1], row[1:])]
    coefficients = np.linalg.solve(np.concatenate(steps), np.array(ends))
    h = width[:, None]
    return np.array([(_derivative(degree, places, k) @ coefficients).T / h**k for k in range(3)])


def _derivative(degree: NDArray[np.intp], x: Array, order: int) -> Array:
    """Of every power of x the derivative of an order, shape (n, powers)."""
    factor = np.prod([degree - k for k in range(order)], axis=0)
    return np.asarray(factor * x[:, None] ** np.maximum(degree - order, 0))
