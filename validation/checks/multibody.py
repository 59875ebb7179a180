"""exudyn's own coordinates and joint multipliers against the closed form."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from crankmbs.result import Result
from validation.adapter import at_jumps, reference_motion, reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import Array
from validation.plots import Panel, overlay
from validation.runs import run

__all__ = ["closed_form"]

_JOINTS = {
    "main bearing": ("main_bearing_force_x", "main_bearing_force_y"),
    "crank pin": ("crank_pin_force_x", "crank_pin_force_y"),
    "piston pin": ("piston_pin_force_x", "piston_pin_force_y"),
    "side force": ("side_force",),
    "crank torque": ("crank_torque",),
    "displacement": ("piston_displacement",),
    "velocity": ("piston_velocity",),
    "acceleration": ("piston_acceleration",),
}


def closed_form(case: Case) -> Outcome:
    """Motion of crank and pistons and every joint force, each over its own peak.

    The oracle's crank motion, and at its angle, speed and acceleration the Newton-Euler equations.
    """
    result = run(case.ours(), "multibody")
    scene = case.theirs()
    motion = reference_motion(result, scene)
    exact = reference_variables(scene, motion.theta, motion.omega, motion.alpha)
    late = (motion.time - result.data["time"].values).astype(np.float64)
    ahead = (motion.theta - result.data["crank_angle"].values).astype(np.float64)
    slip = np.abs(ahead - result.data["crank_speed"].values * late)
    clear = ~at_jumps(scene, motion.theta)
    turned = float(np.ptp(result.data["crank_angle"].values))
    errors = {
        "crank angle per radian turned": float(np.max(slip)) / max(turned, 1.0),
        "crank speed": float(
            np.max(np.abs(motion.omega - result.data["crank_speed"].values))
            / np.max(np.abs(motion.omega))
        ),
    }
    for joint, names in _JOINTS.items():
        difference = [(result.data[name].values - exact[name])[clear] for name in names]
        size = np.sqrt(sum((part**2 for part in difference), 0.0 * difference[0]))
        peak = np.sqrt(sum((exact[name] ** 2 for name in names), 0.0 * exact[names[0]])).max()
        errors[joint] = float(np.max(size) / peak)
    worst = max(errors, key=lambda name: errors[name])
    detail = f"{worst} {errors[worst]:.1e}; " + ", ".join(
        f"{name} {error:.0e}" for name, error in errors.items() if name != worst
    )
    figures = {case.name: _figure(case, result, exact)} if case.parameters.get("figure") else {}
    return Outcome(errors[worst], detail, figures=figures)


def _figure(case: Case, result: Result, exact: dict[str, Array]) -> Figure:
    degrees = np.degrees(result.data["crank_angle"].values)
    labels = {
        "main_bearing_force_x": "main bearing X [N]",
        "crank_pin_force_x": "crank pin X, cyl. 1 [N]",
        "side_force": "side force, cyl. 1 [N]",
    }
    panels = []
    for name, label in labels.items():
        closed, simulated = (
            values.astype(np.float64).reshape(len(degrees), -1)[:, 0]
            for values in (exact[name], result.data[name].values)
        )
        panels.append(Panel(label, simulated, closed))
    return overlay(
        degrees, panels, f"{case.scene}: {case.claim}", ("closed form", "multibody (exudyn)")
    )
