"""Newton-Euler: every joint force, body by body from the piston down, in each cylinder's frame.

The piston's X balance gives the rod on piston along the axis, the rod's moment about the crank pin
gives it across, the piston's Y balance the wall, the rod's balance the crank pin, and the crank's
balance the main bearing and the torque from outside. Gas pushes the piston towards the crank, -X.
The frame, on mounts, feels m (g - a) of every moving part and, about the crank axis, the walls and
the gas on the heads.

Every balance is linear in omega^2, alpha and 1. All cylinders are an axis in front: shape
(cylinders, u, n) for u motions at n angles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.axes import Gears, axes_of, closed_loops, gears_of, gravity_vector
from crankmbs.mechanics.geometry import Loop
from crankmbs.mechanics.inertia import crank_weight, ends_at, gas_at, moving_inertias, rod_centre
from crankmbs.mechanics.journals import journal_rows, of_journals, of_rods, rocking_of_throws
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import Period
from crankmbs.scene.scene import Scene

__all__ = [
    "UNITS",
    "Cylinders",
    "Place",
    "Powers",
    "balanced",
    "of_crank",
    "of_cylinders",
    "place_of",
    "powers_of",
    "pushed",
    "rows_of",
]


class Powers(NamedTuple):
    """omega^2, alpha and 1, shape (u, n) or (u, 1) each."""

    square: Array
    alpha: Array
    one: Array


UNITS = Powers(*np.eye(3)[:, :, np.newaxis])
"""Three motions, each of one of them alone: what each balance has of it."""

_OF_CRANK = (
    "kinetic_energy",
    "external_torque",
    "main_bearing_force_x",
    "main_bearing_force_y",
    "frame_force_x",
    "frame_force_y",
    "frame_moment",
)
_ROCKING = ("rocking_moment_x", "rocking_moment_y")
_OF_JOINTS = (
    "side_force",
    "piston_pin_force_x",
    "piston_pin_force_y",
    "crank_pin_force_x",
    "crank_pin_force_y",
    "crank_torque",
    "journal_torque",
    "pin_torque",
)
_ACCELERATIONS = ("rod_angular_acceleration", "piston_acceleration")
_VELOCITIES = ("rod_angular_speed", "piston_velocity")
_OF_PLACE = ("rod_angle", "piston_position", "piston_displacement", "gas_pressure", "gas_force")
_OF_CRANK_END = "crank_end_pressure"
_OF_ANGLE = (*_VELOCITIES, *_OF_PLACE, _OF_CRANK_END)
_OF_CYLINDER = (*_OF_JOINTS, *_ACCELERATIONS, *_VELOCITIES, *_OF_PLACE)


def rows_of(scene: Scene) -> dict[str, int]:
    """How many rows `balanced` has of each variable, in its order: one, or one for each journal,
    shared pin or cylinder.

    >>> sum(rows_of(load_scene("v_twin")).values())
    41
    """
    count = len(scene.cylinders)
    rocking = () if scene.levers is None else _ROCKING
    of_crank = dict.fromkeys((*_OF_CRANK, *rocking), 1) | journal_rows(scene)
    ends = (_OF_CRANK_END,) if scene.double_acting else ()
    return of_crank | dict.fromkeys((*_OF_CYLINDER, *ends), count)


def powers_of(name: str) -> tuple[int, ...]:
    """Which of omega^2, alpha and 1, from 0, a variable has a part of.

    >>> powers_of("kinetic_energy")
    (0,)
    """
    if name in _OF_ANGLE:
        return (2,)
    if name == "kinetic_energy":
        return (0,)
    return (0, 1) if name in _ACCELERATIONS else (0, 1, 2)


def _along_the_crank(torque: Array) -> dict[str, Array]:
    """The torques of the rods on the crank, shape (cylinders, ...): of each, and summed up to the
    journal behind it and to the middle of its pin."""
    journal = np.cumsum(torque, axis=0)
    return {
        "crank_torque": torque,
        "journal_torque": journal,
        "pin_torque": journal - 0.5 * torque,
    }


class Place(NamedTuple):
    """What moves in the cylinders, and their loops at n crank angles, shape (cylinders, n)."""

    gears: Gears
    loop: Loop


def place_of(scene: Scene, theta: Array) -> Place:
    """That of a scene at crank angles of shape (n,) [rad].

    >>> place_of(load_scene("v_twin"), np.zeros(3)).loop.x.shape
    (2, 3)
    """
    return Place(gears_of(scene), closed_loops(scene, theta))


class Cylinders(NamedTuple):
    """The variables of the cylinders by name, shape (cylinders, u, n), for velocities those per
    speed, shape (cylinders, 1, n) of what depends on the angle alone; what each adds to the
    balance of the frame, in its own axes, and to J [kg m2], shape (cylinders, 1, n)."""

    variables: dict[str, Array]
    shake_x: Array
    shake_y: Array
    moment: Array
    inertia: Array


def of_cylinders(scene: Scene, at: Place, pressure: Array, motion: Powers) -> Cylinders:
    """The variables of every cylinder but those of both its ends; balance after balance, in the
    order in which each needs the one before.

    pressure : of the gas, shape (cylinders, n) [Pa]
    """
    gears, gas = at.gears.over_motions, pressure[:, np.newaxis]
    r, l, a = gears.radius, gears.length, gears.rod_centre
    square, alpha, one = motion
    gx, gy = axes_of(scene).gravity[..., np.newaxis]
    loop = Loop(*(part[:, np.newaxis] for part in at.loop))
    g = rod_centre(loop, r, a / l)
    sin_b, cos_b = loop.sin_beta, loop.cos_beta

    x_tt = loop.x_2 * square + loop.x_1 * alpha
    beta_tt = loop.beta_2 * square + loop.beta_1 * alpha
    felt_x = g.x_2 * square + g.x_1 * alpha - gx * one  # the rod's acceleration minus gravity
    felt_y = g.y_2 * square + g.y_1 * alpha - gy * one
    felt = x_tt - gx * one  # the piston's, along the cylinder
    force = gas * gears.area
    push = force * one
    inertial_x, inertial_y = gears.rod_mass * felt_x, gears.rod_mass * felt_y
    carried = gears.piston_mass * felt
    pin_x = carried + push
    weight = cos_b * inertial_y + sin_b * inertial_x
    pin_y = ((gears.rod_inertia * beta_tt - a * weight) / l - pin_x * sin_b) / cos_b
    throw_x, throw_y = inertial_x + pin_x, inertial_y + pin_y
    leaning = gears.piston_mass * gy * one
    side = -pin_y - leaning
    torque = r * (loop.sin_phi * throw_x - loop.cos_phi * throw_y)
    variables = {
        "rod_angle": loop.beta,
        "rod_angular_speed": loop.beta_1,
        "rod_angular_acceleration": beta_tt,
        "piston_position": loop.x,
        "piston_displacement": gears.top - loop.x,
        "piston_velocity": -loop.x_1,
        "piston_acceleration": -x_tt,
        "gas_pressure": gas,
        "gas_force": force,
        "side_force": side,
        "piston_pin_force_x": pin_x,
        "piston_pin_force_y": pin_y,
        "crank_pin_force_x": throw_x,
        "crank_pin_force_y": throw_y,
    } | _along_the_crank(torque)
    shake_x, shake_y = -inertial_x - carried, leaning - inertial_y
    moment = -loop.x * side - gears.offset * push
    return Cylinders(variables, shake_x, shake_y, moment, moving_inertias(gears, loop, g))


def of_crank(scene: Scene, theta: Array, motion: Powers, cylinders: Cylinders) -> dict[str, Array]:
    """The variables of the crank and of the frame, shape (u, n), at crank angles of shape (n,)
    [rad]."""
    crank, (square, alpha, one) = scene.crank, motion
    first_moment = crank.mass * crank.center_of_mass
    sin_theta, cos_theta = np.sin(theta), np.cos(theta)
    gx, gy = gravity_vector(scene)
    pull_x = first_moment * (-cos_theta * square - sin_theta * alpha) - crank.mass * gx * one
    pull_y = first_moment * (-sin_theta * square + cos_theta * alpha) - crank.mass * gy * one
    throw_x, throw_y = (cylinders.variables[f"crank_pin_force_{axis}"] for axis in "xy")
    shake, ones = (cylinders.shake_x, cylinders.shake_y), np.ones(len(throw_x))
    bearing, frame = (_in_the_engine(scene, ones, *each) for each in ((throw_x, throw_y), shake))
    torque = crank.moment_of_inertia * alpha - crank_weight(scene, theta) * one
    sums = {
        "external_torque": torque - cylinders.variables["journal_torque"][-1],
        "main_bearing_force_x": pull_x + bearing[0],
        "main_bearing_force_y": pull_y + bearing[1],
        "frame_force_x": frame[0] - pull_x,
        "frame_force_y": frame[1] - pull_y,
        "frame_moment": cylinders.moment.sum(axis=0),
        "kinetic_energy": 0.5 * (crank.moment_of_inertia + cylinders.inertia.sum(axis=0)) * square,
    }
    if scene.levers is not None:
        along_x, along_y = _in_the_engine(scene, np.array(scene.levers), *shake)
        sums |= {"rocking_moment_x": -along_y, "rocking_moment_y": along_x}
        for name, part in zip(
            _ROCKING, rocking_of_throws(scene, theta, motion) or (), strict=False
        ):
            sums[name] = sums[name] + part
    return sums


def _in_the_engine(scene: Scene, weights: Array, x: Array, y: Array) -> tuple[Array, Array]:
    """Weighted sums over the cylinders of forces in their own axes, shape (cylinders, u, n); along
    the engine's axes, shape (u, n)."""
    axes = axes_of(scene)
    cos, sin = weights * axes.cos, weights * axes.sin
    turned = np.array([[*cos, *-sin], [*sin, *cos]])
    along_x, along_y = turned @ np.concatenate([x, y]).reshape(2 * len(x), -1)
    return along_x.reshape(x.shape[1:]), along_y.reshape(x.shape[1:])


def balanced(train: CrankTrain, theta: Array, motion: Powers) -> dict[str, Array]:
    """What the balances say of every variable but friction, velocities per speed, in SI units, in
    the order of `rows_of`.

    theta : shape (n,) [rad]

    Returns
    -------
    shape (1, u, n) of the crank, (cylinders, u, n) of each cylinder, as of each journal; u is 1 of
    what depends on the angle alone, which belongs to 1

    >>> train = crank_train(load_scene("torque_driven"))
    >>> balanced(train, np.zeros(2), UNITS)["side_force"].shape
    (1, 3, 2)
    """
    at, gas = place_of(train.scene, theta), gas_at(train, theta)
    gas = np.zeros_like(at.loop.x) if gas is None else gas
    cylinders = of_cylinders(train.scene, at, gas, motion)
    for name, pressures in ends_at(train, theta, gas).items():
        cylinders.variables[name] = pressures[:, np.newaxis]
    crank = of_crank(train.scene, theta, motion, cylinders)
    of_one = {name: values[np.newaxis] for name, values in crank.items()}
    rods = cylinders.variables["crank_pin_force_x"], cylinders.variables["crank_pin_force_y"]
    every = of_one | of_journals(train.scene, theta, motion, rods) | cylinders.variables
    return {name: every[name] for name in rows_of(train.scene)}


def pushed(scene: Scene, at: Place, period: Period, forces: Array) -> dict[str, Array]:
    """What forces on the pistons towards the crank add: the rods push along themselves.

    at : the angles of the period; forces : shape (cylinders, samples) [N]

    Returns
    -------
    by variable of the result, in its unit: shape (1, samples) of the crank, (cylinders, samples) of
    each cylinder, as of each journal

    >>> from crankmbs.numerics.periodic import single
    >>> scene, angles = load_scene("coasting"), np.zeros(1)
    >>> at = place_of(scene, angles)
    >>> pushed(scene, at, single(angles), np.ones((1, 1)))["piston_pin_force_x"]
    array([[1.]])
    """
    gears, loop = at
    tangent = loop.sin_beta / loop.cos_beta
    lever = gears.radius * (loop.sin_phi + loop.cos_phi * tangent)
    across = period.times(-tangent, forces)
    torque = period.times(lever, forces)
    moment = period.times(-loop.x * tangent - gears.offset, forces)
    torques = _along_the_crank(torque)
    bearing = _in_the_engine(scene, np.ones(len(forces)), forces[:, None], across[:, None])
    of_joints = of_rods(scene, forces, across) | torques
    return of_joints | {
        "external_torque": -torques["journal_torque"][-1:],
        "main_bearing_force_x": bearing[0],
        "main_bearing_force_y": bearing[1],
        "frame_moment": moment.sum(axis=0, keepdims=True),
        "side_force": -across,
        "piston_pin_force_x": forces,
        "piston_pin_force_y": across,
        "crank_pin_force_x": forces,
        "crank_pin_force_y": across,
    }
