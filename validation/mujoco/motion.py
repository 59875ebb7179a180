"""A free crank from event to event as `validation.oracles.changing` goes, turned by MuJoCo."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from importlib.metadata import version

import numpy as np
from numpy.typing import NDArray

from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter_changes import changes_of
from validation.mujoco.bodies import Bodies, Turned
from validation.mujoco.stored import Stored
from validation.oracles.changing import changing_motion
from validation.oracles.pythagoras import Place
from validation.oracles.stretch import Stretch

__all__ = ["motion_of", "stored_motion"]

Floats = NDArray[np.float64]

_PARTS = (8, 5)  # of the time between samples, in each of which the integrator begins anew


@dataclass
class _ByBodies(Stretch):
    """Between two events, with the pistons' velocities and the crank's acceleration by MuJoCo."""

    bodies: Bodies = field(kw_only=True)

    def places(self, theta: float) -> list[Place]:
        """Of every cylinder, with nothing but the velocity of its piston."""
        rest = (math.nan,) * 4
        velocities = self.bodies.velocities(theta).tolist()
        return [Place(x_1, math.nan, rest, math.nan, math.nan) for x_1 in velocities]

    def alpha(self, t: float, theta: float, omega: float) -> float:
        """The acceleration [rad/s2]."""
        forces = self.on_pistons(t, theta, omega, self.places(theta))
        return self.bodies.alpha(theta, omega, forces, self.external(t, theta, omega))


def stored_motion(scene: Scene, most: int) -> Stored:
    """What is kept of a free scene whose samples lie on times.

    most : of how many samples, evenly chosen of those that are clear of knots

    Raises
    ------
    ArithmeticError : as `motion_of`, or no sample is clear
    """
    times = _times(scene)
    (numbers, clear), (again, also_clear) = (motion_of(scene, times, parts) for parts in _PARTS)
    both = np.flatnonzero(clear & also_clear)
    if len(both) == 0:
        raise ArithmeticError("no sample is clear of knots")
    chosen = np.unique(both[np.linspace(0, len(both) - 1, most + 1).round().astype(int)[1:]])
    return Stored(
        version("mujoco"),
        tuple(chosen.tolist()),
        {name: values[chosen] for name, values in numbers.items()},
        {
            name: float(np.max(np.abs(values - again[name])[chosen]))
            for name, values in numbers.items()
        },
    )


def _times(scene: Scene) -> Floats:
    """Of the samples of a run that are determined: without the end of one that was stopped."""
    result = simulate(scene)
    holds = scene.friction is not None or any(force.law.switches for force in scene.force)
    held = result.status == 1 and holds
    kept = result.data.sizes["time"] - (result.status != 0 and not held)
    if kept < 2:
        raise ArithmeticError(f"nothing to compute: {result.message}")
    times: Floats = result.data["time"].values[:kept]
    return times


def motion_of(
    scene: Scene, times: Floats, parts: int
) -> tuple[dict[str, Floats], NDArray[np.bool_]]:
    """Motion and forces of a free scene at times [s], by the names of a result, and which samples
    are clear of knots.

    parts : of the time between two samples, in each of which the integration begins anew

    Raises
    ------
    ArithmeticError : as `changing_motion`
    """
    assert scene.start is not None
    changes, start = changes_of(scene), scene.start
    bodies = Bodies(changes.machine)
    fine = np.interp(np.arange(parts * (len(times) - 1) + 1) / parts, range(len(times)), times)
    stretch = partial(_ByBodies, bodies=bodies)
    found = changing_motion(changes, start.angle, start.speed, fine, stretch)
    at = slice(None, None, parts)
    theta, omega, external = found.theta[at], found.omega[at], found.external[at]
    forces = (found.gas + found.friction + found.applied)[at]
    states = zip(theta.tolist(), omega.tolist(), forces.tolist(), external.tolist(), strict=True)
    each = [bodies.turned(*state) for state in states]
    turned = {name: np.array([getattr(one, name) for one in each]) for name in Turned._fields}
    numbers = {
        "crank_angle": theta,
        "crank_speed": omega,
        "crank_acceleration": turned["alpha"],
        "external_torque": external,
        "piston_position": turned["position"],
        "piston_velocity": -turned["velocity"],
        "piston_acceleration": -turned["acceleration"],
        "rod_angular_acceleration": -turned["rod_acceleration"],
        "applied_force": found.applied[at],
        "side_force": turned["side"],
    }
    for name in ("main_bearing", "crank_pin", "piston_pin"):
        for k, axis in enumerate("xy"):
            numbers[f"{name}_force_{axis}"] = turned[name][..., k]
    return numbers, found.clear[at]
