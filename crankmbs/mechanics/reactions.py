"""Newton-Euler: every joint force from crank angle, speed and acceleration. Exact.

Body by body from the piston down, in each cylinder's frame: the piston's X balance gives the rod
on piston along the axis, the rod's moment about the crank pin gives it across, the piston's Y
balance the wall, the rod's balance the crank pin, and the crank's balance the main bearing and
the torque from outside. Gas pushes the piston towards the crank, -X. The frame, on mounts, feels
m (g - a) of every moving part and, about the crank axis, the walls and the gas on the heads.

Every balance is linear in omega^2, alpha, 1, the shares of the combustion and the friction on the
pistons, which pushes them as gas does. So where the angles
of the samples repeat it is made for these alone, once for every angle of a period, and put together
for each sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crankmbs.mechanics.fired import Parts, fired_parts, pushed_parts
from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.geometry import close_loop, top_position
from crankmbs.mechanics.inertia import gravity_vector, rod_centre
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import one_period
from crankmbs.scene.scene import Scene

__all__ = ["deviations", "reactions"]


class _Powers(NamedTuple):
    """omega^2, alpha and 1 at the samples, shape (n,); or three units of them, shape (3, 1)."""

    square: Array
    alpha: Array
    one: Array


_PER_SPEED = ("piston_velocity", "rod_angular_speed")
_OFTEN = 3  # so often an angle must come back for its parts to pay
_UNITS = _Powers(*np.eye(3)[:, :, np.newaxis])


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
    rows = {name: len(columns) for name, columns in found.columns.items()}
    # one piece of memory, so large that the system is not asked for every run's anew
    room = np.empty((sum(rows.values()), len(found.omega)))
    ends = zip(rows.items(), accumulate(rows.values()), strict=True)
    variables = {name: room[end - count : end] for (name, count), end in ends}
    for name, variable in variables.items():
        for k, (row, values) in enumerate(zip(variable, found.columns[name], strict=True)):
            found.put(name, values, row)
            found.add_more(name, k, row)
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
    largest = {}
    for name, columns in found.columns.items():
        rows = np.atleast_2d(variables[name].T)
        pairs = enumerate(zip(columns, rows, strict=True))
        apart = [found.apart(name, k, *pair) for k, pair in pairs]
        largest[name] = float(np.max(apart))
    return largest


class _Found(NamedTuple):
    """Every variable at the samples, not yet put together.

    columns : for the crank or for each cylinder, shape (n,) what depends on the angle alone, for
        velocities per speed; shape (3, n) what belongs to omega^2, alpha and 1
    which : shape (samples,), which of the n angles a sample is at; None where n are the samples
    more : of the combustion and the friction, each: what a share of 1, or 1 N, on each cylinder
        adds at the n angles; and the shares, or forces, shape (samples, cylinders)
    """

    columns: dict[str, list[Array]]
    which: NDArray[np.intp] | None
    at: _Powers
    omega: Array
    more: tuple[tuple[Parts, Array], ...]

    def put(self, name: str, values: Array, variable: Array) -> None:
        """A variable at the samples into its place."""
        if self.which is not None and values.ndim > 1:
            from crankmbs.mechanics import combined  # numba is loaded only where angles repeat

            combined.together(values, self.which, self.at.square, self.at.alpha, variable)
        else:
            variable[:] = self._all(name, values)

    def add_more(self, name: str, row: int, variable: Array) -> None:
        """Add to a variable, in its place, what firings and friction do."""
        for parts, size in self.more:
            for k, part in parts[name][row].items() if name in parts else ():
                variable += size[:, k] * (part if self.which is None else part[self.which])

    def apart(self, name: str, row: int, values: Array, variable: Array) -> float:
        """Largest difference of a variable from this one at the samples."""
        if any(name in parts for parts, _ in self.more):
            own = self._all(name, values) + np.zeros(len(self.omega))
            self.add_more(name, row, own)
            return float(np.max(np.abs(own - variable), initial=0.0))
        if self.which is not None and values.ndim > 1:
            from crankmbs.mechanics import combined

            return combined.apart(values, self.which, self.at.square, self.at.alpha, variable)
        return float(np.max(np.abs(self._all(name, values) - variable), initial=0.0))

    def _all(self, name: str, values: Array) -> Array:
        if self.which is not None:
            values = values.take(self.which, axis=-1)
        if values.ndim > 1:
            return np.asarray(values[0] * self.at.square + values[1] * self.at.alpha + values[2])
        return values * self.omega if name in _PER_SPEED else values


def _found(
    train: CrankTrain,
    given: tuple[ArrayLike, ArrayLike, ArrayLike],
    fuel: Array | None,
    friction: Array | None,
) -> _Found:
    scene = train.scene
    theta, omega, alpha = (np.asarray(q, dtype=np.float64) for q in given)
    samples = _Powers(omega**2, alpha, np.ones(1))
    once, which = one_period(theta, train.period)
    by_parts = len(theta) > _OFTEN * len(once)
    once, motion = (once, _UNITS) if by_parts else (theta, samples)
    cylinders = [_cylinder(train, once, motion, k) for k in range(len(scene.cylinders))]
    columns = {name: [part] for name, part in _crank(scene, once, motion, cylinders).items()}
    for name in cylinders[0].variables:
        columns[name] = [c.variables[name] for c in cylinders]
    torque = columns["crank_torque"]
    columns["journal_torque"] = list(accumulate(torque))
    pairs = zip(columns["journal_torque"], torque, strict=True)
    columns["pin_torque"] = [journal - 0.5 * own for journal, own in pairs]
    more = [] if fuel is None else [(fired_parts(train, once), fuel)]
    if scene.friction is not None:
        if friction is None:
            friction = friction_forces(train, theta, omega, fuel)
        columns["friction_force"] = [np.zeros_like(once) for _ in cylinders]
        more.append((_rubbed_parts(scene, once), friction))
    return _Found(columns, which if by_parts else None, samples, omega, tuple(more))


def _rubbed_parts(scene: Scene, theta: Array) -> Parts:
    """What 1 N of friction on each piston adds."""
    ones = [np.ones_like(theta) for _ in scene.cylinders]
    parts = pushed_parts(scene, theta, ones)
    parts["friction_force"] = [{k: one} for k, one in enumerate(ones)]
    return parts


class _Cylinder(NamedTuple):
    """The variables of one cylinder by name, for velocities those per speed; what it adds to the
    balance of the crank and of the frame, in the engine's frame."""

    variables: dict[str, Array]
    pull_x: Array
    pull_y: Array
    kinetic_energy: Array
    shake_x: Array
    shake_y: Array
    moment: Array


def _cylinder(
    train: CrankTrain,
    theta: Array,
    motion: _Powers,
    number: int,
) -> _Cylinder:
    scene, cylinder = train.scene, train.scene.cylinders[number]
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    area = piston.gas_area or 0.0
    r, l, a = crank.radius, rod.length, rod.center_of_mass
    square, alpha, one = motion
    gx, gy = gravity_vector(scene, cylinder.bank)
    phi = theta + cylinder.phase
    loop = close_loop(phi, r, l, piston.offset)
    g = rod_centre(loop, r, a)
    sin_b, cos_b = loop.sin_beta, loop.cos_beta
    gas = np.zeros_like(phi) if train.pressure is None else train.pressure[number](phi)

    x_tt = loop.x_2 * square + loop.x_1 * alpha
    beta_tt = loop.beta_2 * square + loop.beta_1 * alpha
    felt_x = g.x_2 * square + g.x_1 * alpha - gx * one  # the rod's acceleration minus gravity
    felt_y = g.y_2 * square + g.y_1 * alpha - gy * one
    felt = x_tt - gx * one  # the piston's, along the cylinder
    pin_x = piston.mass * felt + gas * area * one
    weight = rod.mass * (cos_b * felt_y + sin_b * felt_x)
    pin_y = ((rod.moment_of_inertia * beta_tt - a * weight) / l - pin_x * sin_b) / cos_b
    throw_x = rod.mass * felt_x + pin_x
    throw_y = rod.mass * felt_y + pin_y
    side = -pin_y - piston.mass * gy * one
    shake_x = -rod.mass * felt_x - piston.mass * felt
    shake_y = -rod.mass * felt_y + piston.mass * gy * one
    cos_bank, sin_bank = np.cos(cylinder.bank), np.sin(cylinder.bank)
    inertia = (
        piston.mass * loop.x_1**2
        + rod.mass * (g.x_1**2 + g.y_1**2)
        + rod.moment_of_inertia * loop.beta_1**2
    )
    variables = {
        "rod_angle": loop.beta,
        "rod_angular_speed": loop.beta_1,
        "rod_angular_acceleration": beta_tt,
        "piston_position": loop.x,
        "piston_displacement": top_position(r, l, piston.offset) - loop.x,
        "piston_velocity": -loop.x_1,
        "piston_acceleration": -x_tt,
        "gas_pressure": gas,
        "gas_force": gas * area,
        "side_force": side,
        "piston_pin_force_x": pin_x,
        "piston_pin_force_y": pin_y,
        "crank_pin_force_x": throw_x,
        "crank_pin_force_y": throw_y,
        "crank_torque": r * (loop.sin_phi * throw_x - loop.cos_phi * throw_y),
    }
    return _Cylinder(
        variables,
        cos_bank * throw_x - sin_bank * throw_y,
        sin_bank * throw_x + cos_bank * throw_y,
        0.5 * inertia * square,
        cos_bank * shake_x - sin_bank * shake_y,
        sin_bank * shake_x + cos_bank * shake_y,
        -loop.x * side - piston.offset * gas * area * one,
    )


def _crank(
    scene: Scene, theta: Array, motion: _Powers, cylinders: list[_Cylinder]
) -> dict[str, Array]:
    crank, (square, alpha, one) = scene.crank, motion
    first_moment = crank.mass * crank.center_of_mass
    sin_theta, cos_theta = np.sin(theta), np.cos(theta)
    gx, gy = gravity_vector(scene)
    x_tt = -cos_theta * square - sin_theta * alpha
    y_tt = -sin_theta * square + cos_theta * alpha
    weight = first_moment * (cos_theta * gy - sin_theta * gx)
    return _rocking(scene, cylinders) | {
        "external_torque": crank.moment_of_inertia * alpha
        - weight * one
        - sum(c.variables["crank_torque"] for c in cylinders),
        "main_bearing_force_x": first_moment * x_tt
        - crank.mass * gx * one
        + sum(c.pull_x for c in cylinders),
        "main_bearing_force_y": first_moment * y_tt
        - crank.mass * gy * one
        + sum(c.pull_y for c in cylinders),
        "frame_force_x": crank.mass * gx * one
        - first_moment * x_tt
        + sum(c.shake_x for c in cylinders),
        "frame_force_y": crank.mass * gy * one
        - first_moment * y_tt
        + sum(c.shake_y for c in cylinders),
        "frame_moment": np.asarray(sum(c.moment for c in cylinders)),
        "kinetic_energy": 0.5 * crank.moment_of_inertia * square
        + sum(c.kinetic_energy for c in cylinders),
    }


def _rocking(scene: Scene, cylinders: list[_Cylinder]) -> dict[str, Array]:
    """Moments about the middle of the crank, where every cylinder has its place along it."""
    if scene.levers is None:
        return {}
    levers = np.array(scene.levers)
    return {
        "rocking_moment_x": -np.tensordot(levers, [c.shake_y for c in cylinders], 1),
        "rocking_moment_y": np.tensordot(levers, [c.shake_x for c in cylinders], 1),
    }
