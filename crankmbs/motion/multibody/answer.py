"""Every variable of a result at states of a motion, from exudyn's equations at each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from crankmbs.mechanics.axes import axes_of
from crankmbs.mechanics.journals import of_journals, rocking_of_throws
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.variables import EVERY
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.mode import Mode
from crankmbs.motion.multibody.model import Consistent, Model
from crankmbs.numerics.arrays import Array, Index

__all__ = ["MOTION", "free", "solution", "values_at"]

MOTION = ("time", "crank_angle", "crank_speed", "crank_acceleration")
"""The variables of a motion itself."""

_ROUNDING = 1e-12


def solution(
    values: dict[str, Array],
    errors: dict[str, float],
    said: tuple[int, str],
    cost: tuple[int, int],
) -> Solution:
    """What a run returns; cost : evaluations and steps.

    Beside what errs otherwise, of every variable 1e-12 of its peak and 1e-13 of the largest of its
    unit is left to rounding.
    """
    peaks, largest = {name: peak(each) for name, each in values.items()}, dict[str, float]()
    for name, size in peaks.items():
        largest[EVERY[name].units] = max(largest.get(EVERY[name].units, 0.0), size)
    errors = {
        name: errors[name] + _ROUNDING * (size + 0.1 * largest[EVERY[name].units]) * bool(size)
        for name, size in peaks.items()
    }
    time, theta, omega, alpha = (values.pop(name) for name in MOTION)
    samples = Samples(time, theta, omega, alpha, np.zeros_like(time), values)
    return Solution(samples, *said, *cost, errors=errors)


def free(
    model: Model, modes: Sequence[Mode], k: Index, after: Index, motion: Array
) -> dict[str, Array]:
    """The variables of a free crank at times [s], crank angles [rad] and speeds [rad/s], shape
    (3, m).

    modes : what acts in each piece of the motion; k, after : in which pieces the samples lie,
        at a cut in that before it, and at one in time in that after it
    """
    torque, pushes = np.empty(len(k)), np.empty((len(k), len(model.banks)))
    sense = _senses(motion[2])
    for piece in np.unique(after):
        here = after == piece
        acting = model.forces.outside(modes[piece], motion[:, here], sense[here])
        torque[here], pushes[here] = acting
    at = dict(zip(MOTION, motion, strict=False)) | {"external_torque": torque}
    if model.forces.train.law is not None:
        at["fuel"] = np.array([mode.shares for mode in modes])[k]
    if model.scene.force:
        at["applied_force"] = pushes
    return at | values_at(model, at, driven=False)


def values_at(model: Model, motion: Mapping[str, Array], *, driven: bool) -> dict[str, Array]:
    """The variables at given states, under the loads that are given there.

    motion : of shape (m,), "crank_angle", "crank_speed"; of a driven crank its
        "crank_acceleration", else "external_torque"; "fuel" and "applied_force" where there
        are; "friction_force" where a crank at rest is held
    """
    theta, omega = motion["crank_angle"], motion["crank_speed"]
    values = model.forces.gas(theta, motion.get("fuel"))
    gas = push = values["gas_force"]
    if model.scene.friction is not None:
        friction = model.forces.friction(theta, omega, gas, _senses(omega))
        rests = omega[:, None] == 0.0
        friction = np.where(rests, motion.get("friction_force", friction), friction)
        values["friction_force"], push = friction, push + friction
    if model.scene.force:
        values["applied_force"] = motion["applied_force"]
        push = push + motion["applied_force"]
    drive = motion["crank_acceleration" if driven else "external_torque"]
    system = model.states(theta, omega, push, drive, free=not driven)
    return values | _of_bodies(model, system) | _of_joints(model, system, push)


def _of_bodies(model: Model, system: Consistent) -> dict[str, Array]:
    """The motion of all bodies, and their energy."""
    q, v, a = system[:3]
    turn = np.exp(-1j * model.banks)
    along = [((each[:, 6::5] + 1j * each[:, 7::5]) * turn).real for each in (q, v, a)]
    return {
        "crank_angle": q[:, 2],
        "crank_speed": v[:, 2],
        "crank_acceleration": a[:, 2],
        "kinetic_energy": 0.5 * v**2 @ model.mass,
        "rod_angle": model.banks - q[:, 5::5],
        "rod_angular_speed": -v[:, 5::5],
        "rod_angular_acceleration": -a[:, 5::5],
        "piston_position": along[0],
        "piston_displacement": np.array(model.tops) - along[0],
        "piston_velocity": -along[1],
        "piston_acceleration": -along[2],
    }


def _of_joints(model: Model, system: Consistent, push: Array) -> dict[str, Array]:
    """The forces of the joints, each cylinder's in its axes, with their moments on the crank,
    what of them each journal carries, and what all do to the frame.

    Forces are complex numbers; push : shape (m, n), on the pistons towards the crank.
    """
    scene, turn = model.scene, np.exp(1j * model.banks)
    forces = system.hinges[..., 0] + 1j * system.hinges[..., 1]
    crank_pin, piston_pin = forces[:, 1::2] / turn, forces[:, 2::2] / turn
    on_piston = 1j * system.walls - push  # by the frame
    piston = (system.position[:, 6::5] + 1j * system.position[:, 7::5]) / turn
    on_frame = -forces[:, 0] - on_piston @ turn
    radii = np.array([gear.radius for gear in scene.running_gear])
    lever = radii * np.exp(-1j * (system.position[:, 2:3] + axes_of(scene).phases))
    torque = -(lever * crank_pin).imag
    theta, omega, alpha = (each[None, :, 2] for each in system[:3])
    motion = omega**2, alpha, np.ones_like(alpha)
    rods = crank_pin.real.T[:, None], crank_pin.imag.T[:, None]
    journals = of_journals(scene, theta[0], motion, rods)
    values = {name: each[:, 0].T for name, each in journals.items()} | {
        "external_torque": system.torque,
        "main_bearing_force_x": forces[:, 0].real,
        "main_bearing_force_y": forces[:, 0].imag,
        "frame_force_x": on_frame.real,
        "frame_force_y": on_frame.imag,
        "frame_moment": -(piston.conj() * on_piston).imag.sum(axis=1),
        "side_force": system.walls,
        "piston_pin_force_x": piston_pin.real,
        "piston_pin_force_y": piston_pin.imag,
        "crank_pin_force_x": crank_pin.real,
        "crank_pin_force_y": crank_pin.imag,
        "crank_torque": torque,
        "journal_torque": np.cumsum(torque, axis=1),
        "pin_torque": np.cumsum(torque, axis=1) - 0.5 * torque,
    }
    if scene.levers is not None:
        rocking = -((crank_pin + on_piston) * turn) @ np.array(scene.levers)
        throws = rocking_of_throws(scene, theta[0], motion)
        about_x, about_y = (0.0, 0.0) if throws is None else (each[0] for each in throws)
        values["rocking_moment_x"] = about_x - rocking.imag
        values["rocking_moment_y"] = about_y + rocking.real
    return values


def _senses(omega: Array) -> Array:
    """The sense in which the crank turns; at rest that in which it came, or goes."""
    moving = np.flatnonzero(omega)
    if len(moving) == 0:
        return np.ones_like(omega)
    last = np.searchsorted(moving, np.arange(len(omega)), side="right") - 1
    return np.asarray(np.sign(omega[moving[np.maximum(last, 0)]]))
