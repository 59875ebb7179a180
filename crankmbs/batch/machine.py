"""What motions of one machine share, tabulated over the crank angle at the nodes of Gauss rules:
everything but the crank's inertia, the loads and the speed at the start."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from crankmbs.batch.balances import Balances, balances
from crankmbs.batch.lectures import Deviations
from crankmbs.batch.peaks import sparse_nodes
from crankmbs.measures.joints import joints_of
from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["Machine", "Pass", "ahead_of", "key_of", "machine_of"]

_WIDEST = 12.0 * DEGREE  # of a cell
_NARROW = 4.0 * DEGREE  # of a cell, on average
_FEW, _MANY = (6, 5), (10, 8)  # stages of the answer's rule and of its check's
_SLIVER = 1e-9  # rad: a start so near an edge is on it
_SAME = 1e-12  # rad: of phases, no more than rounding
_FOLDED = 0.05  # cosine of the rod angle


@dataclass(frozen=True)
class Pass:
    """Tables at the s nodes of a rule in the m cells of a period, or of a share of it.

    width : of the cells [rad], shape (m,); at_begin : J without the crank's where they begin
    inertia, slope, torque : J without the crank's, dJ/dtheta and the torque, shape (m, s)
    rods : torque of all rods, shape (3, m, s)
    forces : of the joints, as `crankmbs.measures.joints.joints_of` lists them, shape (joints, 2, 3,
        m, s)
    works : of gas and friction on the pistons there, rows of shape (cylinders,) [J]: the gas, the
        friction, and of double-acting cylinders the gas of the head end and of the crank end
    """

    rule: Rule
    width: Array
    at_begin: float
    inertia: Array
    slope: Array
    torque: Array
    rods: Array
    forces: Array
    lectures: Deviations
    works: tuple[Array, ...]


@dataclass(frozen=True)
class Machine:
    """What motions of a machine share.

    scene : one of them; sense : of rotation; answer, check : tables of either pass; finest :
        whether by the finest rules
    begin : crank angle at which the tables begin [rad]; first : number of the cell at whose
        beginning a motion starts; at_start : J there, without the crank's [kg m2]
    shares : in how many equal shares of the period all comes again with another cylinder; the
        tables are those of one
    folds : whether a rod nearly folds onto the crank
    """

    scene: Scene
    sense: float
    answer: Pass
    check: Pass
    finest: bool
    begin: float
    first: int
    at_start: float
    shares: int
    folds: bool

    @property
    def in_time(self) -> bool:
        """Whether motions end at a time."""
        return self.scene.end[1] and not self.scene.settles


def key_of(scene: Scene) -> Hashable:
    """What two scenes have in common that share a machine; scenes that start and turn."""
    assert scene.start is not None
    crank = scene.crank
    return (
        (crank.radius, crank.mass, crank.center_of_mass, scene.rod, scene.piston),
        (scene.cylinders, scene.gas, scene.gravity, scene.friction, scene.bearings),
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

    >>> machine_of(load_scene("yi_diesel_free").with_(run__until="settled")).shares
    4
    """
    assert scene.start is not None
    sense, start, ahead = math.copysign(1.0, scene.start.speed), scene.start.angle, ahead_of(scene)
    train, begin = crank_train(scene), start + sense * ahead
    starts = (train.period - ahead) % train.period
    parts, shares = _shares(train) if scene.settles else (1, 1)
    edges = _edges(train, begin, sense, parts, starts)
    edges = edges[: (len(edges) - 1) // shares + 1]
    shape = scene.crank.radius, scene.rod.length, scene.piston.offset
    narrow = float(np.mean(np.diff(edges))) < _NARROW and not finest
    answer, check = (
        _tabulated(one, begin, sense, gauss(stages), np.diff(edges), shares)
        for one, stages in zip((train, train.perturbed), _FEW if narrow else _MANY, strict=True)
    )
    angles = np.linspace(0.0, 2.0 * math.pi, 361)
    folds = bool(np.min(close_loop(angles, *shape).cos_beta) < _FOLDED)
    first = int(np.argmin(np.abs(edges[:-1] - starts)))
    at_start = _without_crank(train, start, sense)
    about = not narrow, begin, first, at_start, shares, folds
    return Machine(scene, sense, answer, check, *about)


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


def _tabulated(
    train: CrankTrain, begin: float, sense: float, rule: Rule, width: Array, shares: int
) -> Pass:
    """The tables at the nodes of a rule in every cell."""
    whole = np.tile(width, shares)
    turned = np.cumsum(width)[:, None] + width[:, None] * (rule.nodes - 1.0)
    theta = (begin + sense * turned).ravel()
    parts = balances(train, theta, sense)
    crank, cylinders = parts.crank, parts.cylinders
    points: dict[str, Array] = {name: each.ravel() for name, each in crank.items()}
    points |= {name: each.reshape(len(each), -1).T for name, each in cylinders.items()}
    forces = np.array([joint.force(points) for joint in joints_of(train.scene)])
    rods = cylinders["journal_torque"][-1]
    slope, torque = -2.0 * rods[0], -crank["external_torque"][2]
    path = sense * (width[:, None] * rule.weights).ravel() * cylinders["piston_velocity"][:, 0]
    return Pass(
        rule,
        width,
        _without_crank(train, begin, sense),
        parts.inertia.reshape(turned.shape),
        slope.reshape(turned.shape),
        torque.reshape(turned.shape),
        rods.reshape(3, *turned.shape),
        forces.reshape(-1, 2, 3, *turned.shape),
        Deviations(train, begin, sense, rule, whole, sparse_nodes(whole, len(rule.nodes))),
        tuple((force * path).sum(axis=1) for force in _forces(train.scene, parts)),
    )


def _forces(scene: Scene, balances: Balances) -> list[Array]:
    """Of the gas and the friction on the pistons, and of the gas of either end, shape (cylinders,
    n) [N]."""
    forces = [balances.cylinders["gas_force"][:, 0], balances.friction]
    if scene.double_acting:
        head = (scene.piston.gas_area or 0.0) * balances.cylinders["gas_pressure"][:, 0]
        forces += [head, forces[0] - head]
    return forces


def _without_crank(train: CrankTrain, theta: float, sense: float) -> float:
    """J at a crank angle [rad] without the crank's [kg m2]; the same whichever crank it has."""
    return float(balances(train, np.array([theta]), sense).inertia[0])
