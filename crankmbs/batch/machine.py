"""What motions of a machine share, tabulated over the crank angle at the nodes of Gauss rules:
everything but the crank's inertia, the loads and the speed at the start.

Machines whose tables are of one shape are tabulated together: they are one more axis in front.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from itertools import compress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.balances import balances
from crankmbs.batch.lectures import Deviations
from crankmbs.batch.peaks import sparse_nodes
from crankmbs.measures.joints import joints_of
from crankmbs.mechanics.axes import axes_of
from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = [
    "Machine",
    "Pass",
    "ahead_of",
    "at_cell",
    "family_of",
    "forces_of",
    "key_of",
    "machine_of",
]

_WIDEST = 12.0 * DEGREE  # of a cell
_NARROW = 4.0 * DEGREE  # of a cell, on average
_FEW, _MANY = (6, 5), (10, 8)  # stages of the answer's rule and of its check's
_SLIVER = 1e-9  # rad: a start so near an edge is on it
_SAME = 1e-12  # rad: of phases, no more than rounding
_FOLDED = 0.05  # cosine of the rod angle


class Pass(NamedTuple):
    """Tables at the s nodes of a rule in the m cells of a period, or of a share of it; the first
    axis is of machines.

    width : of the cells [rad], shape (machines, m); at_begin : J without the crank's where they
        begin, shape (machines,)
    inertia, slope, torque : J without the crank's, dJ/dtheta and the torque, shape (machines, m, s)
    rods : torque of all rods, shape (machines, 3, m, s)
    forces : of the joints, as `crankmbs.measures.joints.joints_of` lists them, shape (machines,
        joints, 2, 3, m, s)
    works : of gas and friction on the pistons there, shape (machines, rows, cylinders) [J]: the
        gas, the friction, and of double-acting cylinders the gas of the head end and of the crank
        end
    """

    rule: Rule
    lectures: Deviations
    width: Array
    at_begin: Array
    inertia: Array
    slope: Array
    torque: Array
    rods: Array
    forces: Array
    works: Array

    def part(self, which: NDArray[np.bool_]) -> Pass:
        """Those of some machines."""
        lectures = replace(self.lectures, of_case=self.lectures.of_case[which])
        return Pass(self.rule, lectures, *(table[which] for table in self[2:]))


@dataclass(frozen=True)
class Machine:
    """What motions share: of one machine, or each of one of its own.

    scenes : one of each machine; sense : of rotation; answer, check : tables of either pass;
        finest : whether by the finest rules
    begin : crank angle at which the tables begin [rad]; first : number of the cell at whose
        beginning a motion starts; at_start : J there, without the crank's, shape (machines,)
        [kg m2]
    shares : in how many equal shares of the period all comes again with another cylinder; the
        tables are those of one
    """

    scenes: Sequence[Scene]
    sense: float
    answer: Pass
    check: Pass
    finest: bool
    begin: float
    first: int
    at_start: Array
    shares: int

    @property
    def scene(self) -> Scene:
        """One of them."""
        return self.scenes[0]

    @property
    def in_time(self) -> bool:
        """Whether motions end at a time."""
        return self.scene.end[1] and not self.scene.settles

    def part(self, which: NDArray[np.bool_]) -> Machine:
        """What some of the motions share."""
        if len(self.scenes) == 1:
            return self
        return replace(
            self,
            scenes=tuple(compress(self.scenes, which)),
            answer=self.answer.part(which),
            check=self.check.part(which),
            at_start=self.at_start[which],
        )


class _Cells(NamedTuple):
    """Edges, angles turned [rad] from where the tables begin; `shares` and `first` of `Machine`."""

    edges: Array
    shares: int
    first: int


def key_of(scene: Scene) -> Hashable:
    """What two scenes have in common that share a machine; scenes that start and turn."""
    return _alike(scene), scene.crank.radius, scene.rod, scene.piston, scene.gas


def _alike(scene: Scene) -> Hashable:
    """What machines that are tabulated together have in common, but the shape of their tables."""
    assert scene.start is not None
    return (
        (scene.crank.mass, scene.crank.center_of_mass, scene.cylinders),
        (scene.gravity, scene.friction, scene.bearings),
        (scene.start.angle, scene.start.speed > 0.0),
        (scene.settles, scene.end[1], ahead_of(scene)),
    )


def family_of(scene: Scene) -> Hashable:
    """What two scenes have in common whose machines are tabulated together; None of a scene in
    which a rod nearly folds onto the crank.

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> family_of(scene) == family_of(scene.with_(rod__length="160 mm"))
    True
    """
    angles, (gear, *_) = np.linspace(0.0, 2.0 * math.pi, 361), scene.running_gear
    if np.min(close_loop(angles, *gear.shape).cos_beta) < _FOLDED:
        return None
    gas, cells = scene.gas, _cells_of(scene)
    ends = gas is not None, scene.double_acting
    return _alike(scene), ends, len(cells.edges), cells.first, cells.shares


def forces_of(scene: Scene) -> int:
    """How many forces of joints the tables of a machine have at nodes."""
    return len(joints_of(scene)) * len(_cells_of(scene).edges) * _MANY[0] * 2


def ahead_of(scene: Scene) -> float:
    """The angle [rad] from the start of a scene to where its last period begins, less whole ones;
    0 where it ends at a time.

    >>> ahead_of(load_scene("yi_diesel_free"))
    0.0
    """
    end, in_time = scene.end
    rest = 0.0 if in_time else end % scene.period
    return 0.0 if min(rest, scene.period - rest) < _SLIVER else rest


def machine_of(*scenes: Scene, finest: bool = False) -> Machine:
    """The tables of scenes' machines of one family, over a period from where the last one begins
    on, by rules with few nodes where cells are narrow; or by the finest.

    >>> machine_of(load_scene("yi_diesel_free").with_(run__until="settled")).shares
    4
    """
    scene = scenes[0]
    assert scene.start is not None
    sense, start = math.copysign(1.0, scene.start.speed), scene.start.angle
    begin = start + sense * ahead_of(scene)
    trains = [crank_train(each) for each in scenes]
    edges = np.array([_cells_of(each).edges for each in scenes])
    _, shares, first = _cells_of(scene)
    narrow = float(np.mean(np.diff(edges))) < _NARROW and not finest
    answer, check = (
        _tabulated(of_pass, begin, sense, gauss(stages), np.diff(edges), shares)
        for of_pass, stages in zip(
            (trains, [train.perturbed for train in trains]),
            _FEW if narrow else _MANY,
            strict=True,
        )
    )
    at_start = _without_crank(trains, start, sense)
    return Machine(scenes, sense, answer, check, not narrow, begin, first, at_start, shares)


@once
def _cells_of(scene: Scene) -> _Cells:
    """The cells of a scene's machine, of a share of the period."""
    assert scene.start is not None
    train, sense, ahead = crank_train(scene), math.copysign(1.0, scene.start.speed), ahead_of(scene)
    starts = (train.period - ahead) % train.period
    parts, shares = _shares(train) if scene.settles else (1, 1)
    edges = _edges(train, scene.start.angle + sense * ahead, sense, parts, starts)
    edges = edges[: (len(edges) - 1) // shares + 1]
    return _Cells(edges, shares, int(np.argmin(np.abs(edges[:-1] - starts))))


def _edges(train: CrankTrain, begin: float, sense: float, parts: int, more: float) -> Array:
    """Of the cells, angles turned [rad] from 0 to a period, so that no knot of the pressure lies in
    one, and ``more`` is one of them; the same in equal parts of the period."""
    part = train.period / parts
    edges = np.mod(sense * (grid_of(train, gauss(1), _WIDEST).edges[:-1] - begin), part)
    edges = np.unique(np.concatenate([[0.0, more], edges, [part]]))
    edges = edges[np.append(np.diff(edges) > _SLIVER, True)]
    edges[0] = 0.0
    every = np.add.outer(part * np.arange(parts), edges[:-1])
    return np.append(every.ravel(), train.period)


def _shares(train: CrankTrain) -> tuple[int, int]:
    """In how many equal parts of the period the speed comes again, and all forces, too.

    Where cylinders of one pressure are spread evenly over the period, and nothing has weight, the
    speed is the same whenever one of them is where another was; and so is the main bearing's force
    where they stand in line and the crank itself does not pull; but not that of a journal.
    """
    scene, count = train.scene, len(train.scene.cylinders)
    one = train.pressure is None or len({id(each) for each in train.pressure}) == 1
    phases = np.sort([np.mod(c.phase + _SLIVER, train.period) for c in scene.cylinders])
    even = np.all(np.abs(np.diff(phases) - train.period / count) < _SAME)
    if not (one and even and scene.gravity is None):
        return 1, 1
    in_line = len({c.bank for c in scene.cylinders}) == 1
    pulls = scene.crank.mass * scene.crank.center_of_mass != 0.0
    return count, count if in_line and not pulls and scene.throws is None else 1


def _turns(train: CrankTrain, sense: float, shares: int) -> Index:
    """Which cylinder is in the first share where the first one is in each."""
    phases, part = axes_of(train.scene).phases, train.period / shares
    behind = np.subtract.outer(phases[0] + sense * part * np.arange(shares), phases)
    return np.asarray(np.argmax(np.cos(2.0 * math.pi / train.period * behind), axis=1))


def at_cell(table: Array, cell: Index) -> Array:
    """Of k cases what a table of theirs, shape (machines, ..., m, s), has in a cell of each, shape
    (k, ..., s).

    >>> at_cell(np.arange(6.0).reshape(1, 3, 2), np.array([2, 0, 2]))[:, 1].tolist()
    [5.0, 1.0, 5.0]
    """
    return np.asarray(table[np.minimum(np.arange(len(cell)), len(table) - 1), ..., cell, :])


def _tabulated(
    trains: Sequence[CrankTrain], begin: float, sense: float, rule: Rule, width: Array, shares: int
) -> Pass:
    """The tables at the nodes of a rule in every cell."""
    scenes, whole = [train.scene for train in trains], np.tile(width, shares)
    turned = np.cumsum(width, axis=1)[..., None] + width[..., None] * (rule.nodes - 1.0)
    theta, machines = begin + sense * turned, np.arange(len(trains))
    of = np.repeat(machines, theta[0].size)
    inertia, crank, cylinders, pushes = balances(trains, of, theta.ravel(), sense)
    points: dict[str, Array] = {name: each.ravel() for name, each in crank.items()}
    points |= {name: each.reshape(len(each), -1).T for name, each in cylinders.items()}
    forces = np.array([joint.force(points) for joint in joints_of(scenes[0])])

    def by_machine(table: Array) -> Array:
        """The machines in front, and the nodes of each cell apart: of shape (..., n)."""
        shaped = table.reshape(*table.shape[:-1], *theta.shape)
        return np.ascontiguousarray(np.moveaxis(shaped, -3, 0))

    rods = cylinders["journal_torque"][-1]
    slope, torque = -2.0 * rods[0], -crank["external_torque"][2]
    path = sense * (width[..., None] * rule.weights).ravel() * cylinders["piston_velocity"][:, 0]
    turns = _turns(trains[0], sense, shares)
    sparse = sparse_nodes(whole.max(axis=0), len(rule.nodes))
    return Pass(
        rule,
        Deviations(scenes, theta, crank, cylinders, turns, sparse, machines),
        width,
        _without_crank(trains, begin, sense),
        by_machine(inertia),
        by_machine(slope),
        by_machine(torque),
        by_machine(rods),
        by_machine(forces.reshape(-1, 2, 3, theta.size)),
        by_machine(path * pushes).sum(axis=(-2, -1)),
    )


def _without_crank(trains: Sequence[CrankTrain], theta: float, sense: float) -> Array:
    """J at a crank angle [rad] without the crank's [kg m2]; the same whichever crank it has."""
    count = len(trains)
    return balances(trains, np.arange(count), np.full(count, theta), sense).inertia
