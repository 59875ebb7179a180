"""Tables of a machine at the nodes of a rule: what its energy, its joints and the lectures'
quantities are made of, in parts that belong to omega^2, alpha and 1."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.curves import Curves, Grid, curves_of, cut, grid_of, twins
from crankmbs.compare.lectured import (
    LECTURES,
    Gear,
    Motion,
    RodForces,
    gear_of,
    of_cylinders,
    turning_crank,
)
from crankmbs.compare.quantities import QUANTITIES, observed_cylinders
from crankmbs.errors import InputError
from crankmbs.mechanics.fired import pushed_parts
from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.newton_euler import Powers, of_crank, of_cylinder
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import Rule
from crankmbs.scene.scene import Scene

__all__ = ["LINEAR", "Pass", "Period", "tabulated"]

LINEAR = "piston velocity"
"""The quantity that goes with the speed."""

_UNITS = Powers(*np.eye(3)[:, :, np.newaxis])
_JOINTS = (
    "crank_pin_force_x",
    "crank_pin_force_y",
    "piston_pin_force_x",
    "piston_pin_force_y",
    "side_force",
    "crank_torque",
)
_OF_CYLINDER = (*_JOINTS, "gas_pressure", "gas_force", "piston_velocity")
_BEARING = ("main bearing force x", "main bearing force y")
_OF_ANGLE = ("piston displacement", "gas torque")  # alone
_MOVING = np.array([1.0, 0.0])[:, np.newaxis, np.newaxis]  # omega of what a lecture adds up:
_PRESSED = 1.0 - _MOVING  # inertia at a speed of 1, and gas


Known = tuple[NDArray[np.intp], NDArray[np.bool_]]
"""Of the quantities, which curves are the same, and whether they are of the angle alone."""


class Pass(NamedTuple):
    """Tables at the nodes of one rule, as `crankmbs.batch.walk.walk` takes them.

    works, rubbed : shape (cylinders,) [J], of the gas and of the friction on the pistons in a
        period
    """

    rule: tuple[Array, Array, Array, Array]
    of_angle: tuple[Array, Array, Array, Array]
    parts: tuple[Curves, Array, Curves, Grid, Known]
    works: Array
    rubbed: Array

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
            cut(table.ravel(), shape, cell, parts).reshape(-1, shape[1]) for table in at_nodes
        )
        forces, rods, quantities, _, known = self.parts
        width = np.concatenate(turned)
        grid = grid_of(width, *self.rule[2:])

        def again(curves: Curves) -> Curves:
            of, rest = (cut(table, shape, cell, parts) for table in curves[:2])
            return curves_of(of, rest, grid)

        return self._replace(
            of_angle=(width, inertia, slope, torque),
            parts=(
                again(forces),
                cut(rods, shape, cell, parts),
                again(quantities),
                grid,
                known,
            ),
        )


@dataclass(frozen=True)
class Period:
    """Where tables begin and end.

    start, sense : of rotation; edges : of the cells, angles turned [rad], from 0 to a period
    alike : of every cylinder the first one that does the same at another time; where all do, the
        cells are the same in every firing's share of the period
    """

    start: float
    sense: float
    edges: Array
    alike: tuple[int, ...]

    @property
    def chosen(self) -> tuple[int, ...]:
        """The cylinders that are tabulated."""
        return tuple(dict.fromkeys(self.alike))

    @property
    def copies(self) -> int:
        """In how many parts of it, each some revolutions long, the nodes are the same."""
        shares = len(self.alike) if len(self.chosen) == 1 else 1
        revolutions = round(float(self.edges[-1]) / (2.0 * math.pi))
        return revolutions if shares % revolutions == 0 else 1

    def summed(self, scene: Scene, tables: Array, weights: Array) -> Array:
        """The sum over all cylinders, shape (..., n), of the tables of the chosen ones, shape
        (chosen, ..., n): what one does at a node another does so many nodes later.

        weights : shape (cylinders,)
        """
        count = len(self.alike)
        if len(tables) == count:
            return np.tensordot(weights, tables, 1)
        share, first = float(self.edges[-1]) / count, scene.cylinders[0].phase
        mixed = np.zeros((count, count))
        for weight, cylinder in zip(weights, scene.cylinders, strict=True):
            later = round(self.sense * (cylinder.phase - first) / share)
            mixed += weight * np.roll(np.eye(count), later, axis=1)
        shares = tables[0].reshape(*tables.shape[1:-1], count, -1)
        return np.asarray((mixed @ shares).reshape(tables.shape[1:]))


def tabulated(train: CrankTrain, period: Period, rule: Rule) -> Pass:
    """The tables at the nodes of a rule in every cell, of the joints of the chosen cylinders."""
    scene, width = train.scene, np.diff(period.edges)
    turned = period.edges[:-1, None] + width[:, None] * rule.nodes
    theta = (period.start + period.sense * turned).ravel()
    cylinders = [of_cylinder(train, theta, _UNITS, k) for k in period.chosen]
    own, ones = of_crank(scene, theta, _UNITS, None), np.ones(len(scene.cylinders))
    each = {name: np.array([c.variables[name] for c in cylinders]) for name in _OF_CYLINDER}
    friction = _rubbed(train, period, theta, each)
    throws = each["crank_pin_force_x"], each["crank_pin_force_y"]
    bearing = _in_the_engine(scene, period, *throws)
    bearing[0] += own["main_bearing_force_x"]
    bearing[1] += own["main_bearing_force_y"]
    pairs = (throws, (each["piston_pin_force_x"], each["piston_pin_force_y"]))
    pins = [np.stack(pair, axis=1).reshape(-1, 3, len(theta)) for pair in pairs]
    rods = period.summed(scene, each["crank_torque"], ones)
    energies = np.array([c.kinetic_energy[0] for c in cylinders])
    inertia = 2.0 * period.summed(scene, energies, ones)
    slope, torque = -2.0 * rods[0], rods[2] - own["external_torque"][2]
    share = (width[:, None] * rule.weights).ravel()
    path = period.sense * share * each["piston_velocity"]
    works, rubbed = (np.sum(force * path, axis=1) for force in (each["gas_force"], friction))
    of = [period.chosen.index(k) for k in period.alike]
    seen = cylinders[0].variables | {name: tables[0] for name, tables in each.items()}
    barycentric = rule.to_legendre[-1].copy()
    grid = grid_of(width, rule.nodes, barycentric)
    forces = np.concatenate([bearing, *pins, each["side_force"]])
    none = np.zeros_like(forces[:, 2])
    quantities = _observed(scene, seen, bearing, theta)
    said = _deviating(quantities, _lectured(scene, period, each["gas_pressure"], theta))
    return Pass(
        (rule.matrix, rule.weights, rule.nodes, barycentric),
        (
            width,
            inertia.reshape(turned.shape),
            slope.reshape(turned.shape),
            torque.reshape(turned.shape),
        ),
        (
            curves_of(forces[:, :2].copy(), np.stack([forces[:, 2], none], axis=1)[:, None], grid),
            rods,
            curves_of(quantities[:, :2].copy(), said, grid),
            grid,
            (twins(said), np.asarray(~quantities[:, :2].any(axis=(1, 2)))),
        ),
        works[of],
        rubbed[of],
    )


def _deviating(own: Array, said: Array) -> Array:
    """C and D of every quantity, and of what it is more than each lecture says, shape (quantities,
    1 + lectures, 2, n); own : shape (quantities, 3, n), said : (quantities, lectures, 2, n)."""
    found = np.empty((len(own), 1 + said.shape[1], *said.shape[2:]))
    found[:, 0, 0], found[:, 0, 1] = own[:, 2], 0.0
    np.subtract(own[:, None, 2], said[:, :, 1], out=found[:, 1:, 0])
    np.subtract(own[:, None, 0], said[:, :, 0], out=found[:, 1:, 1])
    return found


def _rubbed(train: CrankTrain, period: Period, theta: Array, each: dict[str, Array]) -> Array:
    """The friction on the pistons of the chosen cylinders that does not depend on the speed, in
    the sense of rotation, shape (chosen, n) [N]; what it does in the joints is put to what belongs
    to 1.

    each : by name, shape (chosen, 3, n), of the joints
    """
    scene = train.scene
    if scene.friction is None:
        return np.zeros((len(period.chosen), len(theta)))
    sense = np.full_like(theta, period.sense)
    forces = friction_forces(train, theta, np.zeros_like(theta), slides=sense)
    parts = pushed_parts(scene, theta, list(forces.T))
    for name in _JOINTS:
        for own, k in zip(each[name], period.chosen, strict=True):
            own[2] += parts[name][k][k]
    return forces.T[list(period.chosen)]


def _in_the_engine(scene: Scene, period: Period, x: Array, y: Array) -> Array:
    """Sum over all cylinders of forces in their own frames, shape (2, ..., n); those of the chosen
    ones, shape (chosen, ..., n)."""
    bank = np.array([cylinder.bank for cylinder in scene.cylinders])
    parts = ((x, np.cos(bank)), (y, -np.sin(bank))), ((x, np.sin(bank)), (y, np.cos(bank)))
    return np.array(
        [sum(period.summed(scene, *part) for part in along if part[1].any()) for along in parts]
    )


def _observed(scene: Scene, first: dict[str, Array], bearing: Array, theta: Array) -> Array:
    """The lectures' quantities of cylinder 1: parts that belong to omega^2, alpha and 1, shape
    (quantities, 3, n); of what is LINEAR the first belongs to omega.

    first : its variables, by name
    """
    found = np.zeros((len(QUANTITIES), 3, len(theta)))
    omega, alpha, _ = _UNITS
    phi = theta + scene.cylinders[0].phase
    answer = observed_cylinders(scene, first, phi, omega, alpha)
    answer |= dict(zip(_BEARING, bearing, strict=True))
    for q, name in enumerate(QUANTITIES):
        if name == LINEAR:
            found[q, 0] = answer[name]
        elif name in _OF_ANGLE:
            found[q, 2] = np.atleast_2d(answer[name])[0]
        else:
            found[q] = answer[name]
    return found


def _lectured(scene: Scene, period: Period, pressure: Array, theta: Array) -> Array:
    """What the lectures say of them at a constant speed: parts that belong to its square and to 1,
    shape (quantities, lectures, 2, n); no numbers where one says nothing.

    pressure : of the chosen cylinders, shape (chosen, n) [Pa]
    """
    phi = np.array([theta + scene.cylinders[k].phase for k in period.chosen])
    at = _by_formulas(gear_of(scene), phi[:, : len(theta) // period.copies], period.copies)
    said = of_cylinders(scene, at, phi, _PRESSED * pressure, (_MOVING, 0.0))
    throws = (np.moveaxis(said[f"crank pin force {axis}"], -2, 0) for axis in "xy")
    bearing = _in_the_engine(scene, period, *throws)
    own = turning_crank(scene, theta, _MOVING[:, 0], 0.0)
    found = np.empty((len(QUANTITIES), len(LECTURES), 2, len(theta)))
    for q, name in enumerate(QUANTITIES):
        if name in _BEARING:
            k = _BEARING.index(name)
            np.add(bearing[k], own[k], out=found[q])
        elif name == "piston displacement":
            found[q, :, 0], found[q, :, 1] = 0.0, said[name][:, 0, 0]
        else:
            found[q] = said[name][..., 0, :]
    return found


def _by_formulas(gear: Gear, phi: Array, copies: int) -> tuple[Motion, RodForces]:
    """What the formulas of every lecture say, shape (lectures, 1, chosen, n), at cycle angles,
    shape (chosen, n / copies) [rad], that come again; no numbers where one says nothing."""

    @cache
    def said(formula: Callable[[Array, Gear], Motion | RodForces]) -> Array:
        try:
            parts = np.array([np.broadcast_to(part, phi.shape) for part in formula(phi, gear)])
        except InputError:
            return np.full((4, 1, len(phi), copies * phi.shape[1]), np.nan)
        return np.tile(parts, copies)[:, None]

    lectures = LECTURES.values()
    return (
        Motion(*np.stack([said(one.motion) for one in lectures], axis=1)),
        RodForces(*np.stack([said(one.forces) for one in lectures], axis=1)),
    )
