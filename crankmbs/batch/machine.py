"""What settled motions of one machine share, tabulated over the crank angle at the nodes of Gauss
rules: everything but the crank's inertia and the loads."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from crankmbs.batch.tables import Pass, Period, tabulated
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["OWN", "Machine", "key_of", "machine_of"]

_WIDEST, _NARROW = 12.0 * DEGREE, 4.0 * DEGREE  # of a cell, and on average
_FEW, _MANY = (6, 5), (10, 8)  # stages of the answer's rule and of its check's
_SLIVER = 1e-9  # rad: a start so near an edge is on it
_SAME = 1e-12  # rad: of phases, no more than rounding
_FOLDED = 0.05  # cosine of the rod angle

OWN = 11
"""Columns of a case before those of its joints, as `crankmbs.batch.loops.sum_up` fills them."""


@dataclass(frozen=True)
class Machine:
    """What settled motions of a machine share.

    sense : of rotation; answer, check : tables of either pass; finest : whether by the finest rules
    alike : of every cylinder the first one that has the same forces at the same cycle angles; those
        of the others are not tabulated
    displaced : of one cylinder [m3]; folds : whether a rod nearly folds onto the crank
    """

    sense: float
    answer: Pass
    check: Pass
    finest: bool
    alike: tuple[int, ...]
    displaced: float
    folds: bool

    @property
    def joints(self) -> int:
        """How many are tabulated: the main bearing and three of each cylinder."""
        return 1 + 3 * len(set(self.alike))


def key_of(scene: Scene) -> Hashable:
    """What two scenes have in common that share a machine; a scene that settles and starts."""
    assert scene.start is not None
    crank = scene.crank
    return (
        (crank.radius, crank.mass, crank.center_of_mass, scene.rod, scene.piston),
        (scene.cylinders, scene.gas, scene.gravity, scene.friction),
        (scene.start.angle, scene.start.speed > 0.0),
    )


def machine_of(scene: Scene, *, finest: bool = False) -> Machine:
    """The tables of a scene's machine, over a period from its start on, by rules with few nodes
    where its cells are narrow; or by the finest.

    >>> machine_of(load_scene("yi_diesel_free")).alike
    (0, 0, 0, 0)
    """
    assert scene.start is not None
    sense, start = math.copysign(1.0, scene.start.speed), scene.start.angle
    train = crank_train(scene)
    alike = _alike(train)
    period = Period(start, sense, _edges(train, start, sense, alike), alike)
    shape = scene.crank.radius, scene.rod.length, scene.piston.offset
    top, bottom = close_loop(dead_centres(*shape), *shape).x
    narrow = float(np.mean(np.diff(period.edges))) < _NARROW and not finest
    answer, check = (
        tabulated(one, period, gauss(stages))
        for one, stages in zip((train, train.off), _FEW if narrow else _MANY, strict=True)
    )
    angles = np.linspace(0.0, 2.0 * math.pi, 361)
    folds = bool(np.min(close_loop(angles, *shape).cos_beta) < _FOLDED)
    displaced = (scene.piston.gas_area or 0.0) * float(top - bottom)
    return Machine(sense, answer, check, not narrow, alike, displaced, folds)


def _edges(train: CrankTrain, start: float, sense: float, alike: tuple[int, ...]) -> Array:
    """Of the cells, angles turned [rad] from 0 to a period, so that no knot of the pressure lies in
    one; the same in every firing's share of the period where all cylinders are alike."""
    shares = len(alike) if len(set(alike)) == 1 else 1
    share = train.period / shares
    edges = np.mod(sense * (grid_of(train, gauss(1), _WIDEST).edges[:-1] - start), share)
    edges = np.unique(np.concatenate([[0.0], edges, [share]]))
    edges = edges[np.append(np.diff(edges) > _SLIVER, True)]
    edges[0] = 0.0
    firings = share * np.arange(shares)
    return np.append(np.add.outer(firings, edges[:-1]).ravel(), train.period)


def _alike(train: CrankTrain) -> tuple[int, ...]:
    """Where cylinders of one pressure are spread evenly over the period, and nothing has weight,
    the speed is the same whenever one of them is where another was."""
    scene, count = train.scene, len(train.scene.cylinders)
    one = train.pressure is None or len({id(each) for each in train.pressure}) == 1
    phases = np.sort([np.mod(c.phase + _SLIVER, train.period) for c in scene.cylinders])
    even = np.all(np.abs(np.diff(phases) - train.period / count) < _SAME)
    same = one and even and scene.gravity is None
    return (0,) * count if same else tuple(range(count))
