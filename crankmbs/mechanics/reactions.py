"""Motion of every part and force in every joint from crank angle, speed and acceleration. Exact.

Every balance (`crankmbs.mechanics.newton_euler`) is linear in omega^2, alpha, 1, the shares of the
combustion and the friction on the pistons, which pushes them as gas does. So where the angles of
the samples repeat it is made for these alone, once for every angle of a period, and put together
for each sample.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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

__all__ = ["deviations", "reactions"]


_PER_SPEED = ("piston_velocity", "rod_angular_speed")
_OFTEN = 3  # so often an angle must come back for its parts to pay
_UNITS = Powers(*np.eye(3)[:, :, np.newaxis])


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
    found = _found(train, (theta, omega, alpha), fuel, friction)
    # one piece of memory, so large that the system is not asked for every run's anew
    room = np.empty((len(found.parts), len(found.omega)))
    found.put(found.parts, room)
    for variable, (name, k, _) in zip(room, found.each(), strict=True):
        if name in found.mixed:
            found.mix(name, k, variable)
    ends = zip(found.rows.items(), accumulate(found.rows.values()), strict=True)
    variables = {name: room[end - count : end] for (name, count), end in ends}
    return {n: v.T if EVERY[n].per_cylinder else v[0] for n, v in variables.items()}


def deviations(
    train: CrankTrain,
    theta: Array,
    omega: Array,
    alpha: Array,
    variables: Mapping[str, Array],
    own: Mapping[str, Array] | None = None,
) -> dict[str, float]:
    """Largest absolute difference of each variable, as `reactions` gives them for another motion,
    from those of this motion, which are not kept.

    Parameters are those of `reactions`; variables : by name, with the samples of this motion;
    own : of that other motion "fuel" and "friction_force", where it has its own

    >>> train = crank_train(load_scene("torque_driven"))
    >>> motion = np.zeros((3, 2))
    >>> max(deviations(train, *motion, reactions(train, *motion)).values())
    0.0
    """
    own = own or {}
    given = own.get("fuel"), own.get("friction_force")
    found = _found(train, (theta, omega, alpha), *given)
    largest = dict.fromkeys(found.rows, 0.0)
    for name, k, parts in found.each():
        variable = variables[name]
        apart = found.apart(name, k, parts, variable[:, k] if variable.ndim > 1 else variable)
        largest[name] = apart if apart != apart else max(largest[name], apart)
    return largest


class _Found(NamedTuple):
    """Every variable at the samples, not yet put together.

    rows : how many of each variable; parts : shape (rows, 1, samples), velocities per speed; or
        (rows, 3, n), what belongs to omega^2, alpha and 1 at the angles of one period
    which : shape (samples,), which of the n angles a sample is at; None where n are the samples
    more : of the combustion and the friction, each: what a share of 1, or 1 N, on each cylinder
        adds at the n angles; and the shares, or forces, shape (samples, cylinders)
    mixed : the variables that are not their parts alone
    """

    rows: dict[str, int]
    parts: Array
    which: NDArray[np.intp] | None
    at: Powers
    omega: Array
    more: tuple[tuple[Parts, Array], ...]
    mixed: frozenset[str]

    def each(self) -> Iterator[tuple[str, int, Array]]:
        """Variable, number of its row, and the parts."""
        places = ((name, k) for name, count in self.rows.items() for k in range(count))
        for (name, k), parts in zip(places, self.parts, strict=True):
            yield name, k, parts

    def put(self, parts: Array, room: Array) -> None:
        """Variables at the samples from their parts into their places, shape (rows, samples)."""
        if self.which is None:
            room[:] = parts[:, 0]
        else:
            from crankmbs.mechanics import combined  # numba is loaded only where angles repeat

            combined.together(parts, self.which, self.at.square, self.at.alpha, room)

    def mix(self, name: str, row: int, variable: Array) -> None:
        """Make of what has been put what it is: a velocity, or one with combustion and friction."""
        if name in _PER_SPEED:
            variable *= self.omega
        for others, size in self.more:
            for k, part in others[name][row].items() if name in others else ():
                variable += size[:, k] * (part if self.which is None else part[self.which])

    def apart(self, name: str, row: int, parts: Array, variable: Array) -> float:
        """Largest difference of a variable from this one at the samples."""
        simple, own = name not in self.mixed, parts[0]
        if simple and self.which is not None:
            from crankmbs.mechanics import combined

            return combined.apart(parts, self.which, self.at.square, self.at.alpha, variable)
        if not simple:
            own = np.empty_like(self.omega)
            self.put(parts[np.newaxis], own[np.newaxis])
            self.mix(name, row, own)
        return float(np.abs(own - variable).max(initial=0.0))


def _found(
    train: CrankTrain,
    given: tuple[ArrayLike, ArrayLike, ArrayLike],
    fuel: Array | None,
    friction: Array | None,
) -> _Found:
    scene = train.scene
    # copies: a compiled loop is made for every kind of array, read-only or with gaps, that it meets
    theta, omega, alpha = (np.array(q, dtype=np.float64, order="C") for q in given)
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
    mixed = frozenset(_PER_SPEED).union(*(others for others, _ in more))
    return _Found(rows, parts, which if by_parts else None, samples, omega, tuple(more), mixed)


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
