"""Crank angles that must be edges of cells, so that everything inside a cell is smooth."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.mechanics.train import CrankTrain, crank_angle_knots, friction_knots, knots_over_angle
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import DEGREE

__all__ = ["WIDEST", "edges_of"]

WIDEST = 6.0 * DEGREE  # rad: of a cell


def edges_of(train: CrankTrain) -> Array:
    """Crank angles [rad] in one period, in any order: the knots of pressure, loads and friction,
    the decisions on the fuel, and those around folds that a rod just escapes."""
    knots = [crank_angle_knots(train), knots_over_angle(train), friction_knots(train)]
    return np.concatenate([*knots, _near_folds(train), _decisions(train)])


def _decisions(train: CrankTrain) -> Array:
    """Crank angles [rad] in one period at which the fuel is decided."""
    if train.law is None:
        return np.empty(0)
    own = train.scene.period
    turns = own * np.arange(round(train.period / own))
    return np.asarray(np.add.outer(turns, train.law.angles).ravel())


def _near_folds(train: CrankTrain) -> Array:
    """Crank angles [rad] around those where a rod is hardly longer than it must be, ever farther.

    The rod swings over within ``width`` of there, where its formulas have their singularity beside
    the real angles: in wider cells two rules err alike, if they see it at all.
    """
    period, marks = train.period, [np.empty(0)]
    turns = 2.0 * math.pi * np.arange(round(period / (2.0 * math.pi)))
    own = zip(train.scene.cylinders, train.scene.running_gear, strict=True)
    for cylinder, (radius, length, offset) in ((c, gear.shape) for c, gear in own):
        for fold, gap in ((0.5, length - radius + offset), (-0.5, length - radius - offset)):
            width = math.sqrt(2.0 * max(gap, 0.0) / radius)
            if 0.0 < width < WIDEST:
                beside = width * 2.0 ** np.arange(math.ceil(math.log2(WIDEST / width)))
                around = fold * math.pi + np.concatenate([-beside, [0.0], beside])
                marks.append(np.add.outer(turns - cylinder.phase, around).ravel())
    return np.asarray(np.mod(np.concatenate(marks), period))
