"""Where a motion fires: the dead centres that it passes with fuel in the cylinder."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.motion.motion import Motion
from crankmbs.motion.states import samples_in
from crankmbs.numerics.arrays import Array

__all__ = ["Firings", "firings"]

_SAME = 1e-9  # of a period: a dead centre so near behind the end of a cell is reached in it


class Firings(NamedTuple):
    """Times [s], crank angles [rad] and crank speeds [rad/s], shape (n,) each, in their order."""

    time: Array
    crank_angle: Array
    crank_speed: Array


def firings(motion: Motion) -> Firings:
    """Where the crank passes the firing dead centre of a cylinder, its cycle angle of 360 degrees,
    while the share of its combustion is above 0.

    Only where it passes for the first time: a crank that swings about a dead centre fires there
    once. A share that is decided half a turn before fires nothing where the crank turns back first.

    >>> result = simulate(load_scene("run_up").with_(run__until="0.2 s"))
    >>> firings(result.passes.answer).time.round(3).tolist()
    [0.131, 0.182]
    """
    train = motion.train
    period, begin = train.scene.period, float(motion.cells[0].angle[0, 0])
    farthest = {sense: sense * begin for sense in (1.0, -1.0)}
    rows = [np.empty((3, 0))]
    for cells in motion.cells:
        sense = cells.acting.sense
        if sense == 0.0 or not cells.shares.shape[1]:
            continue
        ahead = sense * cells.angle  # grows
        before, after = np.maximum(ahead[:, 0], farthest[sense]), ahead[:, -1]
        farthest[sense] = max(farthest[sense], float(after[-1]))
        for number, cylinder in enumerate(train.scene.cylinders):
            centre = sense * (2.0 * math.pi - cylinder.phase)
            passed, reached = (np.floor((at - centre) / period + _SAME) for at in (before, after))
            k = np.flatnonzero((reached > passed) & (cells.shares[:, number] > 0.0))
            if len(k):
                at = sense * (centre + (passed[k] + 1.0) * period)
                there = samples_in(cells, train, k, cells.place(k, at, in_time=False))
                rows.append(np.array([there.time, at, there.omega]))
    joined = np.concatenate(rows, axis=1)
    return Firings(*joined[:, np.argsort(joined[0], kind="stable")])
