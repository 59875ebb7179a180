"""Motion of every part and force in every joint from crank angle, speed and acceleration. Exact.

Every balance (`crankmbs.mechanics.newton_euler`) is linear in omega^2, alpha, 1, the shares of the
combustion, and friction and forces from outside on the pistons, which push them as gas does. So
where the angles of the samples repeat it is made for these alone, once for every angle of a period,
and put together for each sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import accumulate
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.axes import axes_of, gears_of
from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.newton_euler import (
    UNITS,
    Powers,
    balanced,
    place_of,
    powers_of,
    pushed,
    rows_of,
)
from crankmbs.mechanics.pressure import pressures_at
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import Period, period_of, single

__all__ = ["Balances", "Table", "balances", "peaks_of", "reactions"]


_PER_SPEED = ("piston_velocity", "rod_angular_speed")
_RUBBED = "friction_force"
_PUSHES = (_RUBBED, "applied_force")
_NOTHING: Mapping[str, Array] = MappingProxyType({})
_BLOCK = 60_000  # numbers at once: half a megabyte, which stays in the cache
_OFTEN = 3  # so often an angle must come back for its parts to pay


@dataclass(frozen=True)
class Table:
    """Variables at samples, a row for each, of what every cylinder has one for each of them.

    rows : how many of each variable, in their order; values : shape (rows, samples), SI units
    """

    rows: dict[str, int]
    values: Array

    @cached_property
    def places(self) -> dict[str, slice]:
        """The rows of each variable."""
        return places_of(self.rows)

    @property
    def variables(self) -> dict[str, Array]:
        """By name, shape (samples,) those of the crank, (samples, cylinders) of a cylinder, as of
        a journal."""
        pairs = ((name, self.values[rows]) for name, rows in self.places.items())
        return {n: rows.T if EVERY[n].of else rows[0] for n, rows in pairs}

    def largest(self, of_rows: Array) -> Array:
        """Of each variable, from something of its rows."""
        if len(of_rows) == len(self.rows):
            return of_rows
        counts = np.array(list(self.rows.values()))
        return np.asarray(np.maximum.reduceat(of_rows, np.cumsum(counts) - counts))


def places_of(rows: dict[str, int]) -> dict[str, slice]:
    """Where the rows of each variable are, of those one after the other."""
    pairs = zip(rows.items(), accumulate(rows.values()), strict=True)
    return {name: slice(end - count, end) for (name, count), end in pairs}


def reactions(
    train: CrankTrain,
    theta: ArrayLike,
    omega: ArrayLike,
    alpha: ArrayLike,
    known: Mapping[str, Array] = _NOTHING,
) -> dict[str, Array]:
    """Motion of every part and force in every joint.

    Parameters
    ----------
    theta, omega, alpha : shape (n,) [rad, rad/s, rad/s2]; any motion, prescribed or free
    known : what does not follow from these, by its name in a result, shape (n, cylinders) each:
        "fuel", shares of the combustion; "applied_force" [N], from outside on the pistons;
        "friction_force" [N], by default what the speeds make of it,
        `crankmbs.mechanics.friction.friction_forces`

    Returns
    -------
    dict of the variables of a result by name, in SI units: shape (n,) those of the crank,
    (n, cylinders) those of a cylinder; signs and frames as in `crankmbs.result.VARIABLES`

    >>> train = crank_train(load_scene("torque_driven"))
    >>> float(reactions(train, [0.0], [10.0], [0.0])["rod_angle"][0, 0])
    0.0
    """
    balanced = balances(train, theta, omega, alpha, known)
    # one piece of memory, so large that the system is not asked for every run's anew
    table = Table(
        balanced.rows, np.empty((sum(balanced.rows.values()), len(balanced.period.which)))
    )
    balanced.fill(table.values)
    return table.variables


class Balances(NamedTuple):
    """Every variable at the samples, not yet put together.

    period : of the angles at which the parts are
    rows : how many of each variable, in their order
    parts : by name, shape (rows, 1, samples), velocities per speed; or (rows, 3, angles), what
        belongs to omega^2, alpha and 1, of what depends on the angle alone (rows, 1, angles)
    motion : omega^2, alpha and omega at the samples
    added : by name, what combustion and friction add at the samples, shape (rows, samples)
    groups : variables that are put together alike, and their rows
    """

    period: Period
    rows: dict[str, int]
    parts: dict[str, Array]
    motion: tuple[Array, Array, Array]
    added: dict[str, Array]
    by_parts: bool
    groups: tuple[tuple[list[str], slice], ...]

    def fill(self, room: Array) -> None:
        """All variables at the samples in their places, shape (rows, samples)."""
        for names, rows in self.groups:
            self.put(names, room[rows])

    def apart(self, values: Array) -> Array:
        """Largest absolute difference of each row from one of another motion, NaN where one is:
        values as `fill` gives them, the last of them for all samples beyond; these here are not
        kept."""
        largest, count = np.empty(len(values)), values.shape[1]
        for names, rows in self.groups:
            rows_here = np.empty((rows.stop - rows.start, len(self.period.which)))
            self.put(names, rows_here)
            rows_here[:, :count] -= values[rows]
            rows_here[:, count:] -= values[rows, -1:]
            largest[rows] = peaks_of(rows_here)
        return largest

    def row(self, name: str) -> Array:
        """A variable of the crank at the samples."""
        room = np.empty((1, len(self.period.which)))
        self.put([name], room)
        return np.asarray(room[0])

    def put(self, names: list[str], out: Array) -> None:
        """Variables of equal powers, one after the other, at the samples, shape (rows,
        samples)."""
        if self.by_parts and names[0] in self.parts:
            self._join(names, out)
        places = places_of({name: self.rows[name] for name in names})
        for name, rows in places.items():
            if not self.by_parts and name in self.parts:
                out[rows] = self.parts[name][:, 0]
                if name in _PER_SPEED:
                    out[rows] *= self.motion[2]
            if name not in self.parts:
                out[rows] = self.added[name]
            elif name in self.added:
                out[rows] += self.added[name]

    def _join(self, names: list[str], out: Array) -> None:
        """Parts at the angles of one period, together at the samples."""
        parts = [self.parts[name] for name in names]
        stacked = parts[0] if len(parts) == 1 else np.concatenate(parts)
        square, alpha, omega = self.motion
        sizes = square, alpha, omega if names[0] in _PER_SPEED else None
        powers = powers_of(names[0])
        places = range(len(powers)) if stacked.shape[1] == len(powers) else powers
        terms = [(stacked[:, k], sizes[power]) for k, power in zip(places, powers, strict=True)]
        self.period.join(terms, out)


@lru_cache(maxsize=16)
def _groups(rows: tuple[tuple[str, int], ...], samples: int) -> tuple[tuple[list[str], slice], ...]:
    """Variables next to one another that are put together alike, not too many numbers."""
    groups: list[tuple[list[str], slice]] = []
    for name, place in places_of(dict(rows)).items():
        if groups:
            names, before = groups[-1]
            small = (place.stop - before.start) * samples <= _BLOCK
            if small and _kind(name) == _kind(names[0]):
                groups[-1] = [*names, name], slice(before.start, place.stop)
                continue
        groups.append(([name], place))
    return tuple(groups)


def _kind(name: str) -> tuple[object, ...]:
    return name in _PUSHES, name in _PER_SPEED, powers_of(name)


def peaks_of(rows: Array) -> Array:
    """Largest absolute value of each row, 0 of none."""
    low, high = rows.min(axis=1, initial=0.0), rows.max(axis=1, initial=0.0)
    return np.asarray(np.maximum(-low, high))


def balances(
    train: CrankTrain,
    theta: ArrayLike,
    omega: ArrayLike,
    alpha: ArrayLike,
    known: Mapping[str, Array] = _NOTHING,
) -> Balances:
    """What `reactions` puts together, before it does.

    >>> train = crank_train(load_scene("torque_driven"))
    >>> len(balances(train, [0.0], [10.0], [0.0]).parts)
    24
    """
    scene = train.scene
    theta, omega, alpha = (np.asarray(q, dtype=np.float64) for q in (theta, omega, alpha))
    square = omega**2
    period = period_of(theta, train.repeats)
    by_parts = len(theta) > _OFTEN * len(period.angles)
    if not by_parts:
        period = single(theta)
    motion = UNITS if by_parts else Powers(square[None], alpha[None], np.ones((1, 1)))
    rows, parts = rows_of(scene), balanced(train, period.angles, motion)
    fuel, pushes = known.get("fuel"), {n: known[n] for n in _PUSHES if n in known}
    if scene.friction is not None and _RUBBED not in pushes:
        pushes[_RUBBED] = friction_forces(train, theta, omega, fuel)
    rows |= dict.fromkeys(pushes, len(scene.cylinders))
    added = _added(train, period, fuel, pushes)
    groups = _groups(tuple(rows.items()), len(theta))
    return Balances(period, rows, parts, (square, alpha, omega), added, by_parts, groups)


def _added(
    train: CrankTrain, period: Period, fuel: Array | None, pushes: dict[str, Array]
) -> dict[str, Array]:
    """What combustion and given forces on the pistons do at the samples, by variable."""
    forces: list[Array] = []
    variables: dict[str, Array] = {}
    if fuel is not None and train.combustion is not None:
        phi = np.add.outer(axes_of(train.scene).phases, period.angles)
        more = period.times(pressures_at(train.combustion, phi), np.ascontiguousarray(fuel.T))
        forces.append(gears_of(train.scene).area * more)
        variables |= {"gas_pressure": more, "gas_force": forces[0]}
    for name, push in pushes.items():
        forces.append(np.ascontiguousarray(push.T))
        variables[name] = forces[-1]
    if not forces:
        return variables
    at = place_of(train.scene, period.angles)
    return variables | pushed(train.scene, at, period, sum(forces[1:], forces[0]))
