"""What motions of one machine share, tabulated over the crank angle at the nodes of Gauss rules:
everything but the crank's inertia, the loads and the speed at the start."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from crankmbs.batch.curves import WIDEST
from crankmbs.batch.tables import Pass, Period, tabulated
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.newton_euler import Powers, of_cylinder
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["OWN", "Machine", "ahead_of", "key_of", "machine_of"]

_NARROW = 4.0 * DEGREE  # of a cell, on average
_FEW, _MANY = (6, 5), (10, 8)  # stages of the answer's rule and of its check's
_SLIVER = 1e-9  # rad: a start so near an edge is on it
_SAME = 1e-12  # rad: of phases, no more than rounding
_UNITS = Powers(*np.eye(3)[:, :, np.newaxis])
_FOLDED = 0.05  # cosine of the rod angle

OWN = 11
"""Columns of a case before those of its joints, as `crankmbs.batch.walk.walk` fills them."""


@dataclass(frozen=True)
class Machine:
    """What motions of a machine share.

    sense : of rotation; answer, check : tables of either pass; finest : whether by the finest rules
    begin : crank angle at which the tables begin [rad]; first : number of the cell at whose
        beginning a motion starts; inertias : J there and where the tables begin, without the
        crank's [kg m2]
    alike : of every cylinder the first one that has the same forces at the same cycle angles; those
        of the others are not tabulated
    displaced : of one cylinder [m3]; folds : whether a rod nearly folds onto the crank
    """

    sense: float
    answer: Pass
    check: Pass
    finest: bool
    begin: float
    first: int
    inertias: tuple[float, float]
    alike: tuple[int, ...]
    displaced: float
    folds: bool

    @property
    def joints(self) -> int:
        """How many are tabulated: the main bearing and three of each cylinder."""
        return 1 + 3 * len(set(self.alike))


def key_of(scene: Scene) -> Hashable:
    """What two scenes have in common that share a machine; scenes that start and turn."""
    assert scene.start is not None
    crank = scene.crank
    return (
        (crank.radius, crank.mass, crank.center_of_mass, scene.rod, scene.piston),
        (scene.cylinders, scene.gas, scene.gravity, scene.friction),
        (scene.start.angle, scene.start.speed > 0.0),
        (scene.settles, scene.end[1], ahead_of(scene)),
    )


def ahead_of(scene: Scene) -> float:
    """The angle [rad] from the start of a scene to where its last period begins, less whole ones;
    0 where it ends at a time.

    >>> ahead_of(load_scene("yi_diesel_free"))
    0.0
    """
    end, in_time = scene.end
    rest = 0.0 if in_time else end % scene.period
    return 0.0 if min(rest, scene.period - rest) < _SLIVER else rest


def machine_of(scene: Scene, *, finest: bool = False) -> Machine:
    """The tables of a scene's machine, over a period from where the last one begins on, by rules
    with few nodes where its cells are narrow; or by the finest.

    >>> machine_of(load_scene("yi_diesel_free").with_(run__until="settled")).alike
    (0, 0, 0, 0)
    """
    assert scene.start is not None
    sense, start, ahead = math.copysign(1.0, scene.start.speed), scene.start.angle, ahead_of(scene)
    train, begin = crank_train(scene), start + sense * ahead
    starts = (train.period - ahead) % train.period
    alike = _alike(train) if scene.settles else tuple(range(len(scene.cylinders)))
    period = Period(begin, sense, _edges(train, begin, sense, alike, starts), alike)
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
    first = int(np.argmin(np.abs(period.edges[:-1] - starts)))
    at_start, at_begin = _inertia(train, np.array([start, begin])).tolist()
    about = not narrow, begin, first, (at_start, at_begin)
    return Machine(sense, answer, check, *about, alike, displaced, folds)


def _inertia(train: CrankTrain, theta: Array) -> Array:
    """J without the crank's [kg m2] at crank angles of shape (n,)."""
    count = len(train.scene.cylinders)
    twice = [of_cylinder(train, theta, _UNITS, k).kinetic_energy[0] for k in range(count)]
    return np.asarray(2.0 * np.sum(twice, axis=0))


def _edges(
    train: CrankTrain, begin: float, sense: float, alike: tuple[int, ...], more: float
) -> Array:
    """Of the cells, angles turned [rad] from 0 to a period, so that no knot of the pressure lies in
    one, and ``more`` is one of them; the same in every firing's share of the period where all
    cylinders are alike."""
    shares = len(alike) if len(set(alike)) == 1 else 1
    share = train.period / shares
    edges = np.mod(sense * (grid_of(train, gauss(1), WIDEST).edges[:-1] - begin), share)
    edges = np.unique(np.concatenate([[0.0, more], edges, [share]]))
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
