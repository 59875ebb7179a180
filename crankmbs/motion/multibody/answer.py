"""Every variable of a result at states of a motion, from exudyn's equations at each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from crankmbs.mechanics.geometry import top_position
from crankmbs.mechanics.journals import of_journals, rocking_of_throws
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.mode import Mode
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.model import Consistent, Model
from crankmbs.numerics.arrays import Array, Index

__all__ = ["Answers", "solution"]

_ROUNDING = 1e-12

_MOTION = ("time", "crank_angle", "crank_speed", "crank_acceleration")


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
    time, theta, omega, alpha = (values[name] for name in _MOTION)
    computed = {name: each for name, each in values.items() if name not in _MOTION}
    samples = Samples(time, theta, omega, alpha, np.zeros_like(time), computed)
    return Solution(samples, *said, *cost, errors=errors)


class Answers:
    """The variables of a scene."""

    def __init__(self, train: CrankTrain) -> None:
        self.forces, self.model, self._scene = Forces(train), Model(train.scene), train.scene
        self._banks = np.array([cylinder.bank for cylinder in self._scene.cylinders])
        first = 5 * np.arange(len(self._banks))  # of each cylinder, in the coordinates
        self._x = np.sort([0, *(first + 3), *(first + 6)])
        self._turns = np.array([2, *(first + 5)])

    def close(self) -> None:
        """Let go of what exudyn holds."""
        self.model.close()

    def free(
        self, modes: Sequence[Mode], k: Index, after: Index, time: Array, theta: Array, omega: Array
    ) -> dict[str, Array]:
        """Those of a free crank at times [s], crank angles [rad] and speeds [rad/s], shape (m,).

        modes : what acts in each piece of the motion; k, after : in which pieces the samples lie,
            at a cut in that before it, and at one in time in that after it
        """
        forces, at = self.forces, {"time": time, "crank_angle": theta, "crank_speed": omega}
        acts = np.array([forces.acting(mode.loads) for mode in modes])[after]
        at |= {"external_torque": forces.torque(time, theta, omega, acts)}
        if forces.train.law is not None:
            at["fuel"] = np.array([mode.shares for mode in modes])[k]
        if self._scene.force:
            at["applied_force"] = forces.applied(time, theta, omega, _senses(omega), acts)
        return at | self.consistent(at, driven=False)

    def consistent(self, motion: Mapping[str, Array], *, driven: bool) -> dict[str, Array]:
        """Those at given states, under the loads that are given there.

        motion : of shape (m,), "crank_angle", "crank_speed"; of a driven crank its
            "crank_acceleration", else "external_torque"; "fuel" and "applied_force" where there
            are; "friction_force" where a crank at rest is held
        """
        theta, omega = motion["crank_angle"], motion["crank_speed"]
        gas = self.forces.gas(theta, motion.get("fuel"))
        friction = self.forces.friction(theta, omega, gas, _senses(omega))
        rests = omega[:, None] == 0.0
        friction = np.where(rests, motion.get("friction_force", friction), friction)
        applied = motion.get("applied_force", np.zeros_like(gas))
        drive = motion["crank_acceleration" if driven else "external_torque"]
        push = gas + friction + applied
        system = self.model.states(theta, omega, push, drive, free=not driven)
        values = self._of_bodies(system) | self._of_joints(system)
        values |= {"gas_force": gas, **self.forces.pressures(theta, gas)}
        values |= {} if self._scene.friction is None else {"friction_force": friction}
        return values | ({"applied_force": applied} if self._scene.force else {})

    def _of_bodies(self, system: Consistent) -> dict[str, Array]:
        """Motion of all bodies, energy, and what they do to the frame by the balance of momentum.

        force = sum m (g - a)
        moment = torque + sum r x m (g - a) - sum I rate of spin

        Places are complex numbers, of crank, rod 1, piston 1, rod 2, ..., shape (m, 1 + 2 n), and
        angles those of crank and rods, shape (m, 1 + n).
        """
        scene, mass = self._scene, self.model.mass
        balance = self.model.weight - system.acceleration * mass
        (r, phi), (v, rate), (a, spin), (pull, turning) = (
            (each[:, self._x] + 1j * each[:, self._x + 1], each[:, self._turns])
            for each in (*system[:3], balance)
        )
        moment = system.torque + (r.conj() * pull).imag.sum(axis=1) + turning.sum(axis=1)
        turn = np.exp(-1j * self._banks)
        pistons = [(each[:, 2::2] * turn).real for each in (r, v, a)]
        tops = np.array([top_position(*gear.shape) for gear in scene.running_gear])
        values = {
            "crank_angle": phi[:, 0],
            "crank_speed": rate[:, 0],
            "crank_acceleration": spin[:, 0],
            "kinetic_energy": 0.5 * system.velocity**2 @ mass,
            "frame_force_x": pull.real.sum(axis=1),
            "frame_force_y": pull.imag.sum(axis=1),
            "frame_moment": moment,
            "rod_angle": self._banks - phi[:, 1:],
            "rod_angular_speed": -rate[:, 1:],
            "rod_angular_acceleration": -spin[:, 1:],
            "piston_position": pistons[0],
            "piston_displacement": tops - pistons[0],
            "piston_velocity": -pistons[1],
            "piston_acceleration": -pistons[2],
        }
        if scene.levers is not None:
            rocking = (pull[:, 1::2] + pull[:, 2::2]) @ np.array(scene.levers)
            square, alpha = rate[np.newaxis, :, 0] ** 2, spin[np.newaxis, :, 0]
            throws = rocking_of_throws(scene, phi[:, 0], (square, alpha, np.ones_like(alpha)))
            about_x, about_y = (0.0, 0.0) if throws is None else (each[0] for each in throws)
            values |= {
                "rocking_moment_x": about_x - rocking.imag,
                "rocking_moment_y": about_y + rocking.real,
            }
        return values

    def _of_joints(self, system: Consistent) -> dict[str, Array]:
        """Joint forces, each cylinder's in its axes, with their moments on the crank, and what of
        them each journal carries."""
        scene = self._scene
        forces = system.hinges[..., 0] + 1j * system.hinges[..., 1]
        turn = np.exp(-1j * self._banks)
        crank_pin, piston_pin = forces[:, 1::2] * turn, forces[:, 2::2] * turn
        phases = np.array([cylinder.phase for cylinder in scene.cylinders])
        radii = np.array([gear.radius for gear in scene.running_gear])
        lever = radii * np.exp(-1j * (system.position[:, 2:3] + phases))
        torque = -(lever * crank_pin).imag
        theta, omega, alpha = (each[None, :, 2] for each in system[:3])
        rods = crank_pin.real.T[:, None], crank_pin.imag.T[:, None]
        motion = omega**2, alpha, np.ones_like(alpha)
        journals = of_journals(scene, theta[0], motion, rods)
        return {name: each[:, 0].T for name, each in journals.items()} | {
            "external_torque": system.torque,
            "main_bearing_force_x": forces[:, 0].real,
            "main_bearing_force_y": forces[:, 0].imag,
            "side_force": system.walls,
            "piston_pin_force_x": piston_pin.real,
            "piston_pin_force_y": piston_pin.imag,
            "crank_pin_force_x": crank_pin.real,
            "crank_pin_force_y": crank_pin.imag,
            "crank_torque": torque,
            "journal_torque": np.cumsum(torque, axis=1),
            "pin_torque": np.cumsum(torque, axis=1) - 0.5 * torque,
        }


def _senses(omega: Array) -> Array:
    """The sense in which the crank turns; at rest that in which it came, or goes."""
    moving = np.flatnonzero(omega)
    if len(moving) == 0:
        return np.ones_like(omega)
    last = np.searchsorted(moving, np.arange(len(omega)), side="right") - 1
    return np.asarray(np.sign(omega[moving[np.maximum(last, 0)]]))
