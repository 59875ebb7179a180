"""What motions of a machine share, tabulated over the crank angle at the nodes of Gauss rules:
everything but the crank's inertia, the loads and the speed at the start.

Machines whose tables are of one shape are tabulated together: they are one more axis in front.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.balances import by_powers, without_crank
from crankmbs.batch.lectures import OF_RUN, Deviations
from crankmbs.batch.peaks import sparse_nodes
from crankmbs.measures.joints import joints_of
from crankmbs.measures.summary import Works, works_of
from crankmbs.mechanics.axes import axes_of
from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["Machine", "Pass", "family_of", "forces_of", "key_of", "machine_of", "periods_of"]

_WIDEST = 12.0 * DEGREE  # of a cell
_NARROW = 4.0 * DEGREE  # of a cell, on average
_FEW, _MANY = (6, 5), (10, 8)  # stages of the answer's rule and of its check's
_SLIVER = 1e-9  # rad: an angle so near an edge is on it
_SAME = 1e-12  # rad: of phases, no more than rounding
_FOLDED = 0.05  # cosine of the rod angle
_JUMP = 1e-5  # of a force: more than what its polynomials are apart where it does not jump


class Pass(NamedTuple):
    """Tables at the s nodes of a rule in the m cells of a period, or of a share of it; the first
    axis is of machines.

    width : of the cells [rad], shape (machines, m); at_begin : J without the crank's where they
        begin, shape (machines,)
    inertia, torque : J without the crank's, and the torque, shape (machines, m, s)
    rods : torque of all rods, shape (machines, 3, m, s)
    forces : of the joints, as `crankmbs.measures.joints.joints_of` lists them, shape (machines,
        joints, 2, 3, m, s)
    works : of gas and friction on the pistons there, of each machine
    """

    rule: Rule
    lectures: Deviations
    works: Sequence[Works]
    width: Array
    at_begin: Array
    inertia: Array
    torque: Array
    rods: Array
    forces: Array


@dataclass(frozen=True)
class Machine:
    """What motions share: of one machine, or each of one of its own.

    scenes : one of each machine; sense : of rotation; answer, check : tables of either pass, from
        the crank angle of the start on [rad]; finest : whether by the finest rules
    shares : in how many equal shares of the period all comes again with another cylinder; the
        tables are those of one
    """

    scenes: Sequence[Scene]
    sense: float
    answer: Pass
    check: Pass
    finest: bool
    begin: float
    shares: int

    @property
    def scene(self) -> Scene:
        """One of them."""
        return self.scenes[0]


def key_of(scene: Scene) -> Hashable:
    """What two scenes have in common that share a machine; scenes that start and turn."""
    return _alike(scene), scene.crank.radius, scene.rod, scene.piston, scene.gas


def _alike(scene: Scene) -> Hashable:
    """What machines that are tabulated together have in common, but the shape of their tables."""
    assert scene.start is not None
    in_time = scene.end[1]
    return (
        (scene.crank.mass, scene.crank.center_of_mass, scene.cylinders),
        (scene.gravity, scene.friction, scene.bearings),
        (scene.start.angle, scene.start.speed > 0.0),
        (scene.settles, in_time, in_time or periods_of(scene) % 1.0),
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
    edges, shares = _cells_of(scene)
    return _alike(scene), scene.gas is not None, scene.double_acting, len(edges), shares


def forces_of(scene: Scene) -> int:
    """How many forces of joints the tables of a machine have at nodes."""
    edges, _ = _cells_of(scene)
    return len(joints_of(scene)) * len(edges) * _stages(edges)[0] * 2


def periods_of(scene: Scene) -> float:
    """In how many periods a run ends, of one that ends at an angle.

    >>> periods_of(load_scene("propeller").with_(run__until="1800 deg"))
    2.5
    """
    periods = scene.end[0] / scene.period
    whole = round(periods)
    return whole if abs(periods - whole) * scene.period < _SLIVER else periods


def machine_of(*scenes: Scene, finest: bool = False) -> Machine:
    """The tables of scenes' machines of one family, over a period from their start on, by rules
    with few nodes where cells are narrow; or by the finest.

    >>> machine_of(load_scene("yi_diesel_free").with_(run__until="settled")).shares
    4
    """
    start, trains = scenes[0].start, [crank_train(scene) for scene in scenes]
    assert start is not None
    sense, shares = math.copysign(1.0, start.speed), _cells_of(scenes[0])[1]
    edges = np.array([_cells_of(scene)[0] for scene in scenes])
    stages, of_check = _MANY if finest else _stages(edges), [train.perturbed for train in trains]
    answer, check = (
        _tabulated(of_pass, (start.angle, sense), gauss(count), edges, shares)
        for of_pass, count in zip((trains, of_check), stages, strict=True)
    )
    return Machine(scenes, sense, answer, check, stages == _MANY, start.angle, shares)


def _stages(edges: Array) -> tuple[int, int]:
    """Stages of the rules of answer and check in cells with these edges, shape (..., m + 1)."""
    return _FEW if float(np.mean(np.diff(edges))) < _NARROW else _MANY


@once
def _cells_of(scene: Scene) -> tuple[Array, int]:
    """Edges of the cells of a scene's machine, angles turned [rad] from the start on, of a share of
    the period, and in how many shares all comes again."""
    assert scene.start is not None
    train, sense = crank_train(scene), math.copysign(1.0, scene.start.speed)
    parts, shares = _shares(train) if scene.settles else (1, 1)
    edges = _edges(train, scene.start.angle, sense, parts)
    return edges[: (len(edges) - 1) // shares + 1], shares


def _edges(train: CrankTrain, begin: float, sense: float, parts: int) -> Array:
    """Of the cells, angles turned [rad] from 0 to a period, so that no knot of the pressure lies in
    one; the same in equal parts of the period."""
    part = train.period / parts
    edges = np.mod(sense * (grid_of(train, gauss(1), _WIDEST).edges[:-1] - begin), part)
    edges = np.unique(np.concatenate([[0.0], edges, [part]]))
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


def _tabulated(
    trains: Sequence[CrankTrain],
    start: tuple[float, float],
    rule: Rule,
    edges: Array,
    shares: int,
) -> Pass:
    """The tables at the nodes of a rule in every cell, from an angle on in a sense of rotation;
    edges : of the cells of each machine, shape (machines, m + 1)."""
    (begin, sense), width = start, np.diff(edges)
    theta = begin + sense * (edges[:, :-1, None] + width[..., None] * rule.nodes)
    variables, works, tables = [], [], []
    for train, angles, wide in zip(trains, theta, width[..., None], strict=True):
        of, scene = by_powers(train, angles.ravel(), sense), train.scene
        at_begin = without_crank(scene, np.array([begin]))
        forces = np.array([joint.force(of) for joint in joints_of(scene)])
        of_angle, path = {name: each[0] for name, each in of.items()}, sense * wide * rule.weights
        works.append(works_of(scene, of_angle, partial(_over_period, path.ravel(), shares)))
        rods = of["crank_torque"].sum(axis=-1)
        tables.append((at_begin, -rods[1], -of["external_torque"][2], rods, forces))
        variables.append([of[name] for name in OF_RUN])
    begins, *others = (np.stack(each) for each in zip(*tables, strict=True))
    shaped = [table.reshape(*table.shape[:-1], *theta.shape[1:]) for table in others]
    forces = shaped[-1]
    sparse = sparse_nodes(width.max(axis=0), len(rule.nodes), _jumps(rule, forces[..., 2, :, :]))
    turns = _turns(trains[0], sense, shares)
    joined = (np.concatenate(each, axis=1) for each in zip(*variables, strict=True))
    of_run = dict(zip(OF_RUN, joined, strict=True))
    lectures = Deviations([train.scene for train in trains], theta, of_run, turns, sparse)
    return Pass(rule, lectures, works, width, begins[:, 0], *shaped)


def _jumps(rule: Rule, forces: Array) -> NDArray[np.bool_]:
    """Beside which of the cells some force, polynomials of shape (..., m, s), jumps from one to the
    next; the first and the last count, as cylinders may take turns there."""
    signs = np.ones((2, len(rule.nodes)))
    signs[0, 1::2] = -1.0  # of Legendre polynomials where a cell begins, and where it ends
    ends = forces @ (signs @ rule.to_legendre).T
    apart = np.abs(ends[..., 1:, 0] - ends[..., :-1, 1])
    largest = np.abs(forces).max(axis=(-2, -1))[..., None]
    between = (apart > _JUMP * largest).any(axis=tuple(range(apart.ndim - 1)))
    return np.asarray(np.append(True, between) | np.append(between, True))


def _over_period(path: Array, shares: int, power: Array) -> Array:
    """The integral over the whole period, in cylinders, of what they have in a share of it, shape
    (n, cylinders): what one has there another has in the next one."""
    works = path @ power
    return works if shares == 1 else works.sum(keepdims=True) + 0.0 * works
