"""What motions of one machine share, tabulated over the crank angle at the nodes of Gauss rules:
everything but the crank's inertia, the loads and the speed at the start."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.compare.quantities import QUANTITIES, observed
from crankmbs.errors import InputError
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.newton_euler import Powers, of_crank, of_cylinder
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["LINEAR", "OWN", "Machine", "Pass", "ahead_of", "key_of", "machine_of"]

_WIDEST, _NARROW = 12.0 * DEGREE, 4.0 * DEGREE  # of a cell, and on average
_FEW, _MANY = (6, 5), (10, 8)  # stages of the answer's rule and of its check's
_SPEED = 300.0  # rad/s: any at which what belongs to its square is no smaller than what does not
_SLIVER = 1e-9  # rad: a start so near an edge is on it
_UNITS = Powers(*np.eye(3)[:, :, np.newaxis])
_OF_ANGLE = ("piston displacement", "gas torque")  # alone
_FOLDED = 0.05  # cosine of the rod angle


LINEAR = "piston velocity"
"""The quantity that goes with the speed."""

OWN = 11
"""Columns of a case before those of its joints, as `crankmbs.batch.walk.walk` fills them."""


Curves = tuple[Array, Array, Array, Array]
"""A and B, C and D, of `crankmbs.batch.walk.walk`, and both in straight lines."""


Known = tuple[NDArray[np.intp], NDArray[np.bool_]]
"""Of the quantities, which curves are the same, and whether they are of the angle alone."""


class Pass(NamedTuple):
    """Tables at the nodes of one rule, as `crankmbs.batch.walk.walk` takes them.

    works : shape (cylinders,) [J], of the gas in a period
    """

    rule: tuple[Array, Array, Array, Array]
    of_angle: tuple[Array, Array, Array, Array]
    parts: tuple[Curves, Array, Curves, NDArray[np.intp], Known]
    works: Array

    def cut(self, cell: int, place: float, parts: Array) -> Pass:
        """The tables over a period that begins in a cell: with what lies behind that place, and
        ends with what lies before it.

        place : in the cell, 0 to 1; parts : shape (2, s, s), what makes of the values at its nodes
        those at the nodes of its parts before and after
        """
        width, *at_nodes = self.of_angle
        shape, before = at_nodes[0].shape, place * width[cell : cell + 1]
        turned = [width[cell : cell + 1] - before, width[cell + 1 :], width[:cell], before]
        inertia, slope, torque = (
            _cut(table.ravel(), shape, cell, parts).reshape(-1, shape[1]) for table in at_nodes
        )
        forces, rods, quantities, _, known = self.parts
        layout = _layout(np.concatenate(turned), self.rule[2])

        def again(curves: Curves) -> Curves:
            of, rest = (_cut(table, shape, cell, parts) for table in curves[:2])
            return _curves(of, rest, layout)

        return self._replace(
            of_angle=(layout.width, inertia, slope, torque),
            parts=(
                again(forces),
                _cut(rods, shape, cell, parts),
                again(quantities),
                layout.starts,
                known,
            ),
        )


def _cut(table: Array, shape: tuple[int, ...], cell: int, parts: Array) -> Array:
    """A table over the n = m s nodes, shape (..., n), cut as `Pass.cut` says."""
    whole = table.reshape(*table.shape[:-1], *shape)
    before, after = (whole[..., cell : cell + 1, :] @ part.T for part in parts)
    pieces = [after, whole[..., cell + 1 :, :], whole[..., :cell, :], before]
    return np.concatenate(pieces, axis=-2).reshape(*table.shape[:-1], -1)


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
        (scene.cylinders, scene.gas, scene.gravity),
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
    edges = np.mod(sense * (grid_of(train, gauss(1), _WIDEST).edges[:-1] - begin), train.period)
    starts = (train.period - ahead) % train.period
    edges = np.unique(np.concatenate([[0.0, starts], edges, [train.period]]))
    edges = edges[np.append(np.diff(edges) > _SLIVER, True)]
    edges[0] = 0.0
    shape = scene.crank.radius, scene.rod.length, scene.piston.offset
    top, bottom = close_loop(dead_centres(*shape), *shape).x
    narrow = float(np.mean(np.diff(edges))) < _NARROW and not finest
    alike = _alike(train) if scene.settles else tuple(range(len(scene.cylinders)))
    chosen = tuple(dict.fromkeys(alike))
    answer, check = (
        _pass(one, (begin, sense), edges, gauss(s), chosen)
        for one, s in zip((train, train.off), _FEW if narrow else _MANY, strict=True)
    )
    angles = np.linspace(0.0, 2.0 * math.pi, 361)
    folds = bool(np.min(close_loop(angles, *shape).cos_beta) < _FOLDED)
    displaced = (scene.piston.gas_area or 0.0) * float(top - bottom)
    first = int(np.argmin(np.abs(edges[:-1] - starts)))
    at_start, at_begin = _inertia(train, np.array([start, begin])).tolist()
    about = not narrow, begin, first, (at_start, at_begin)
    return Machine(sense, answer, check, *about, alike, displaced, folds)


def _inertia(train: CrankTrain, theta: Array) -> Array:
    """J without the crank's [kg m2] at crank angles of shape (n,)."""
    count = len(train.scene.cylinders)
    twice = [of_cylinder(train, theta, _UNITS, k).kinetic_energy[0] for k in range(count)]
    return np.asarray(2.0 * np.sum(twice, axis=0))


def _pass(
    train: CrankTrain,
    begin: tuple[float, float],
    edges: Array,
    rule: Rule,
    chosen: tuple[int, ...],
) -> Pass:
    """The tables at the nodes of a rule, of the joints of some cylinders; begin : angle and sense
    of rotation."""
    scene, width, (start, sense) = train.scene, np.diff(edges), begin
    shape = len(width), len(rule.nodes)
    turned = edges[:-1, None] + width[:, None] * rule.nodes
    theta = (start + sense * turned).ravel()
    count = len(scene.cylinders)
    cylinders = [of_cylinder(train, theta, _UNITS, k) for k in range(count)]
    crank = of_crank(scene, theta, _UNITS, cylinders)
    each = {name: [c.variables[name] for c in cylinders] for name in cylinders[0].variables}
    pins = [
        each[f"{joint}_force_{axis}"][k]
        for joint in ("crank_pin", "piston_pin")
        for k in chosen
        for axis in "xy"
    ]
    bearing = [crank["main_bearing_force_x"], crank["main_bearing_force_y"]]
    half_slope, _, against = crank["external_torque"]
    inertia = 2.0 * sum(c.kinetic_energy[0] for c in cylinders)
    inertia, slope, torque = (
        part.reshape(shape).copy() for part in (np.asarray(inertia), 2.0 * half_slope, -against)
    )
    rods = np.asarray(np.sum(each["crank_torque"], axis=0))
    share = (width[:, None] * rule.weights).ravel()
    works = [
        sense * float(np.sum(share * force * speed))
        for force, speed in zip(each["gas_force"], each["piston_velocity"], strict=True)
    ]
    variables = {name: np.stack(columns, axis=-1) for name, columns in each.items()}
    forces = np.array([*bearing, *pins, *(each["side_force"][k] for k in chosen)])
    own, said = _observed(scene, variables, crank, theta), _lectured(train, theta)
    layout = _layout(width, rule.nodes)
    none = np.zeros_like(forces[:, 2])
    more = np.stack([own[:, None, 2] - said[:, :, 1], own[:, None, 0] - said[:, :, 0]], axis=2)
    of_quantities = np.stack([own[:, 2], np.zeros_like(own[:, 2])], axis=1)[:, None]
    every = np.concatenate([of_quantities, more], axis=1)
    return Pass(
        (rule.matrix, rule.weights, rule.nodes, rule.to_legendre[-1].copy()),
        (width, inertia, slope, torque),
        (
            _curves(forces[:, :2].copy(), np.stack([forces[:, 2], none], axis=1)[:, None], layout),
            rods,
            _curves(own[:, :2].copy(), every, layout),
            layout.starts,
            (_twins(every), np.asarray(~own[:, :2].any(axis=(1, 2)))),
        ),
        np.array(works),
    )


class _Layout(NamedTuple):
    """Where the nodes of a period lie: width of the cells, angle turned to the nodes, the first
    cell of every block; and of cells and of blocks edges and where their nodes begin."""

    width: Array
    turned: Array
    starts: NDArray[np.intp]
    pieces: tuple[tuple[Array, NDArray[np.intp]], tuple[Array, NDArray[np.intp]]]


def _layout(width: Array, nodes: Array) -> _Layout:
    edges, starts = np.append(0.0, np.cumsum(width)), _blocks(width)
    turned = (edges[:-1, None] + width[:, None] * nodes).ravel()
    first = np.arange(0, turned.size + 1, len(nodes))
    return _Layout(width, turned, starts, ((edges, first), (edges[starts], first[starts])))


def _curves(of: Array, rest: Array, layout: _Layout) -> Curves:
    """With their straight lines."""
    return of, rest, _lines(of, layout), _lines(rest, layout)


def _twins(rest: Array) -> NDArray[np.intp]:
    """For every curve of a quantity the number of the first one that is the same: what two lectures
    say in the same way is sought once. rest : their C and D, shape (q, 1 + lectures, 2, n)."""
    found = np.zeros(rest.shape[:2], dtype=np.intp)
    for q, of in enumerate(rest):
        for k in range(1, len(of)):
            found[q, k] = next(j for j in range(1, k + 1) if j == k or np.array_equal(of[j], of[k]))
    return found


def _blocks(width: Array) -> NDArray[np.intp]:
    """The first of the cells that together are no wider than the widest, and how many cells there
    are."""
    starts, begin = [0], 0.0
    for cell, end in enumerate(np.cumsum(width)):
        if end - begin > _WIDEST + _SLIVER and cell > starts[-1]:
            starts, begin = [*starts, cell], end - width[cell]
    return np.array([*starts, len(width)])


def _lines(values: Array, layout: _Layout) -> Array:
    """Straight lines for curves in the cells, then in the blocks of cells: their middle, by how
    much they rise, and by how much they miss a node at most; of two curves each, shape (..., 2, n)
    -> (..., 6, m + b)."""
    found = []
    for edges, nodes in layout.pieces:
        count, begin, end = np.diff(nodes), nodes[:-1], nodes[1:] - 1
        middle, wide = 0.5 * (edges[:-1] + edges[1:]), np.diff(edges)
        x = (layout.turned - np.repeat(middle, count)) / np.repeat(wide, count)
        rise = (values[..., end] - values[..., begin]) / (x[end] - x[begin])
        middle = values[..., begin] - rise * x[begin]
        off = np.abs(
            values - np.repeat(middle, count, axis=-1) - np.repeat(rise, count, axis=-1) * x
        )
        rest = np.maximum.reduceat(off, begin, axis=-1)
        found.append(np.stack([middle, rise, rest], axis=-2))
    lines = np.concatenate(found, axis=-1)
    return lines.reshape(*lines.shape[:-3], 6, -1)


def _alike(train: CrankTrain) -> tuple[int, ...]:
    """Where cylinders of one pressure are spread evenly over the period, and nothing has weight,
    the speed is the same whenever one of them is where another was."""
    scene, count = train.scene, len(train.scene.cylinders)
    one = train.pressure is None or len({id(each) for each in train.pressure}) == 1
    phases = np.sort([np.mod(c.phase + _SLIVER, train.period) for c in scene.cylinders])
    even = np.all(np.abs(np.diff(phases) - train.period / count) < _SLIVER)
    same = one and even and scene.gravity is None
    return (0,) * count if same else tuple(range(count))


def _observed(
    scene: Scene, cylinders: dict[str, Array], crank: dict[str, Array], theta: Array
) -> Array:
    """The lectures' quantities of cylinder 1: parts that belong to omega^2, alpha and 1, shape
    (quantities, 3, n); of what is LINEAR the first belongs to omega."""
    found = np.zeros((len(QUANTITIES), 3, len(theta)))
    for unit, (omega, alpha) in enumerate(((1.0, 0.0), (0.0, 1.0), (0.0, 0.0))):
        at = {name: part[unit] for name, part in crank.items()}
        at |= {name: part[unit] if part.ndim > 2 else part for name, part in cylinders.items()}
        motion = np.full_like(theta, omega), np.full_like(theta, alpha)
        answer = observed(scene, at, theta, *motion)
        for q, (name, about) in enumerate(QUANTITIES.items()):
            values = answer[name][:, 0] if about.per_cylinder else answer[name]
            if name not in _OF_ANGLE and name != LINEAR:
                found[q, unit] = values
            elif unit == 0:
                found[q, 0 if name == LINEAR else 2] = values
    return found


def _lectured(train: CrankTrain, theta: Array) -> Array:
    """What the lectures say of them at a constant speed: parts that belong to its square and to 1,
    shape (quantities, lectures, 2, n); no numbers where one says nothing."""
    found = np.full((len(QUANTITIES), len(LECTURES), 2, len(theta)), np.nan)
    still = np.zeros_like(theta)
    for number, formulas in enumerate(LECTURES.values()):
        try:
            rest, moving = (lectured(formulas, train, theta, still + w, still) for w in (0, _SPEED))
        except InputError:
            continue
        for q, (name, about) in enumerate(QUANTITIES.items()):
            at_rest, at_speed = (
                one[name][:, 0] if about.per_cylinder else one[name] for one in (rest, moving)
            )
            more = (at_speed - at_rest) / (_SPEED if name == LINEAR else _SPEED**2)
            found[q, number] = (0.0 * more, at_speed) if name in _OF_ANGLE else (more, at_rest)
    return found
