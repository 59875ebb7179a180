"""Motion of every part and force in every joint from crank angle, speed and acceleration. Exact.

Every balance (`crankmbs.mechanics.newton_euler`) is linear in omega^2, alpha, 1, the shares of the
combustion and the friction on the pistons, which pushes them as gas does. So where the angles of
the samples repeat it is made for these alone, once for every angle of a period, and put together
for each sample.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crankmbs.mechanics.fired import Parts, fired_parts, pushed_parts
from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.newton_euler import Powers, of_crank, of_cylinder
from crankmbs.mechanics.tabulated import balanced, rows_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import one_period
from crankmbs.scene.scene import Scene

__all__ = ["Balances", "Table", "balances", "reactions"]


_PER_SPEED = ("piston_velocity", "rod_angular_speed")
_OFTEN = 3  # so often an angle must come back for its parts to pay
_UNITS = Powers(*np.eye(3)[:, :, np.newaxis])


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
        ends = accumulate(self.rows.values())
        pairs = zip(self.rows.items(), ends, strict=True)
        return {name: slice(end - count, end) for (name, count), end in pairs}

    @property
    def variables(self) -> dict[str, Array]:
        """By name, shape (samples,) those of the crank, (samples, cylinders) of a cylinder."""
        found = ((name, self.values[rows]) for name, rows in self.places.items())
        return {n: rows.T if EVERY[n].per_cylinder else rows[0] for n, rows in found}

    def largest(self, of_rows: Array) -> Array:
        """Of each variable, from something of its rows."""
        if len(of_rows) == len(self.rows):
            return of_rows
        counts = np.array(list(self.rows.values()))
        return np.asarray(np.maximum.reduceat(of_rows, np.cumsum(counts) - counts))


def reactions(
    train: CrankTrain,
    theta: ArrayLike,
    omega: ArrayLike,
    alpha: ArrayLike,
    fuel: Array | None = None,
    friction: Array | None = None,
) -> dict[str, Array]:
    """Motion of every part and force in every joint.

    Parameters
    ----------
    theta, omega, alpha : shape (n,) [rad, rad/s, rad/s2]; any motion, prescribed or free
    fuel : shape (n, cylinders), shares of the combustion; None leaves it out
    friction : shape (n, cylinders) [N], towards the crank; by default what the speeds make of it,
        `crankmbs.mechanics.friction.friction_forces`

    Returns
    -------
    dict of the variables of a result by name, in SI units: shape (n,) those of the crank,
    (n, cylinders) those of a cylinder; signs and frames as in `crankmbs.result.VARIABLES`

    >>> train = crank_train(load_scene("torque_driven"))
    >>> float(reactions(train, [0.0], [10.0], [0.0])["rod_angle"][0, 0])
    0.0
    """
    found = balances(train, theta, omega, alpha, fuel, friction)
    # one piece of memory, so large that the system is not asked for every run's anew
    table = Table(found.rows, np.empty((len(found.parts), len(found.omega))))
    found.fill(table.values)
    return table.variables


class Balances(NamedTuple):
    """Every variable at the samples, not yet put together.

    angles : shape (n,) [rad], at which the parts are
    rows : how many of each variable; swift : shape (rows,), which are velocities
    parts : shape (rows, 1, samples), velocities per speed; or (rows, 3, n), what belongs to
        omega^2, alpha and 1 at the angles of one period
    which : shape (samples,), which of the n angles a sample is at; None where n are the samples
    more : of the combustion and the friction, each: what a share of 1, or 1 N, on each cylinder
        adds at the n angles; and the shares, or forces, shape (samples, cylinders)
    """

    angles: Array
    rows: dict[str, int]
    swift: NDArray[np.bool_]
    parts: Array
    which: NDArray[np.intp] | None
    at: Powers
    omega: Array
    more: tuple[tuple[Parts, Array], ...]

    def fill(self, room: Array) -> None:
        """All variables at the samples in their places, shape (rows, samples)."""
        self._put(slice(None), room)
        for row, added in self._added():
            added(room[row])

    def apart(self, values: Array) -> Array:
        """Largest absolute difference of each row from one of another motion, NaN where one is:
        values as `fill` gives them; these here are not kept."""
        if self.which is None:
            own = np.empty_like(values)
            self.fill(own)
            return np.asarray(np.abs(own - values).max(axis=1, initial=0.0))
        from crankmbs.mechanics import combined

        largest, motion = np.empty(len(values)), (self.at.square, self.at.alpha, self.omega)
        combined.apart(self.parts, self.swift, self.which, motion, (values, largest))
        own = np.empty((1, len(self.omega)))
        for row, added in self._added():
            self._put(slice(row, row + 1), own)
            added(own[0])
            largest[row] = np.abs(own[0] - values[row]).max(initial=0.0)
        return largest

    def row(self, number: int) -> Array:
        """One row at the samples."""
        room = np.empty((1, len(self.omega)))
        self._put(slice(number, number + 1), room)
        for row, added in self._added():
            if row == number:
                added(room[0])
        return np.asarray(room[0])

    def _put(self, rows: slice, room: Array) -> None:
        """Rows at the samples from their parts alone."""
        if self.which is None:
            room[:] = self.parts[rows, 0]
            room[self.swift[rows]] *= self.omega
        else:
            from crankmbs.mechanics import combined  # numba is loaded only where angles repeat

            motion = self.at.square, self.at.alpha, self.omega
            combined.together(self.parts[rows], self.swift[rows], self.which, motion, room)

    def _added(self) -> Iterator[tuple[int, Callable[[Array], None]]]:
        """The rows that combustion and friction add to, each with what adds it."""
        if not self.more:
            return
        places = ((name, k) for name, count in self.rows.items() for k in range(count))
        for row, (name, k) in enumerate(places):
            given = [(others[name][k], size) for others, size in self.more if name in others]
            if any(of_row for of_row, _ in given):
                yield row, partial(self._add, given)

    def _add(self, given: list[tuple[dict[int, Array], Array]], variable: Array) -> None:
        for of_row, size in given:
            for k, part in of_row.items():
                variable += size[:, k] * (part if self.which is None else part[self.which])


def balances(
    train: CrankTrain,
    theta: ArrayLike,
    omega: ArrayLike,
    alpha: ArrayLike,
    fuel: Array | None = None,
    friction: Array | None = None,
) -> Balances:
    """What `reactions` puts together, before it does.

    >>> train = crank_train(load_scene("torque_driven"))
    >>> len(balances(train, [0.0], [10.0], [0.0]).parts)
    24
    """
    scene = train.scene
    # copies: a compiled loop is made for every kind of array, read-only or with gaps, that it meets
    theta, omega, alpha = (np.array(q, dtype=np.float64, order="C") for q in (theta, omega, alpha))
    samples = Powers(omega**2, alpha, np.ones(1))
    once, which = one_period(theta, train.repeats)
    by_parts = len(theta) > _OFTEN * len(once)
    once, motion = (once, _UNITS) if by_parts else (theta, Powers(*map(np.atleast_2d, samples)))
    # numba is loaded only where angles repeat, or the motion has taken it already
    balances = balanced if by_parts or scene.motion is None else balanced_by_arrays
    rows, parts = rows_of(scene), balances(train, once, motion)
    more = [] if fuel is None else [(fired_parts(train, once), fuel)]
    if scene.friction is not None:
        if friction is None:
            friction = friction_forces(train, theta, omega, fuel)
        rows["friction_force"] = len(scene.cylinders)
        parts = np.pad(parts, ((0, len(scene.cylinders)), (0, 0), (0, 0)))
        more.append((_rubbed_parts(scene, once), friction))
    swift = np.repeat([name in _PER_SPEED for name in rows], list(rows.values()))
    return Balances(
        once, rows, swift, parts, which if by_parts else None, samples, omega, tuple(more)
    )


def balanced_by_arrays(train: CrankTrain, theta: Array, motion: Powers) -> Array:
    """The same as `crankmbs.mechanics.tabulated.balanced`, by NumPy."""
    scene = train.scene
    cylinders = [of_cylinder(train, theta, motion, k) for k in range(len(scene.cylinders))]
    columns = {name: [part] for name, part in of_crank(scene, theta, motion, cylinders).items()}
    for name in cylinders[0].variables:
        columns[name] = [c.variables[name] for c in cylinders]
    torque = columns["crank_torque"]
    columns["journal_torque"] = list(accumulate(torque))
    pairs = zip(columns["journal_torque"], torque, strict=True)
    columns["pin_torque"] = [journal - 0.5 * own for journal, own in pairs]
    shape = (len(motion.one), len(theta))
    # what depends on the angle alone belongs to 1
    every = [
        part if part.ndim > 1 else part * motion.one for n in rows_of(scene) for part in columns[n]
    ]
    return np.array([np.broadcast_to(part, shape) for part in every])


def _rubbed_parts(scene: Scene, theta: Array) -> Parts:
    """What 1 N of friction on each piston adds."""
    ones = [np.ones_like(theta) for _ in scene.cylinders]
    parts = pushed_parts(scene, theta, ones)
    parts["friction_force"] = [{k: one} for k, one in enumerate(ones)]
    return parts
