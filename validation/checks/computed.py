"""Runs of machines that others have published, against what is computed here by the oracles."""

from __future__ import annotations

import math

import numpy as np

from validation import reference
from validation.case import Case
from validation.judge import Outcome
from validation.plots import Array
from validation.runs import run

__all__ = ["end_state", "forces_at_end", "largest_speed", "rod_and_slider"]

_FORCES = ("side_force", "crank_pin_force_x", "crank_pin_force_y", "crank_torque")


def end_state(case: Case) -> Outcome:
    """Crank angle and speed at the end of a free run."""
    data = run(case.ours(), case.word("formulation")).data
    ours = {name: float(data[name].values[-1]) for name in ("crank_angle", "crank_speed")}
    return _against(case, ours)


def rod_and_slider(case: Case) -> Outcome:
    """The crank of the IVP test set: its rod angle turns with theta (ours against it), its slider
    coordinate and acceleration point away from the crank (our acceleration towards it)."""
    data = run(case.ours()).data
    ours = {
        "rod_angle": -float(data["rod_angle"].values[-1, 0]),
        "piston_position": float(data["piston_position"].values[-1, 0]),
        "piston_acceleration": -float(data["piston_acceleration"].values[-1, 0]),
    }
    return _against(case, ours)


def largest_speed(case: Case) -> Outcome:
    """The greatest piston speed [m/s] and its crank angle [deg].

    Both from the parabola through the largest sample and its neighbours.
    """
    data = run(case.ours()).data
    velocity: Array = data["piston_velocity"].values[:, 0]
    k = int(np.argmax(velocity))
    before, at, after = velocity[k - 1 : k + 2]
    shift = 0.5 * (before - after) / (before - 2.0 * at + after)
    angle = np.degrees(data["crank_angle"].values)
    ours = {
        "crank_angle_of_largest_speed": float(angle[k] + shift * (angle[k] - angle[k - 1])),
        "largest_piston_speed": float(at - 0.25 * (before - after) * shift),
    }
    return _against(case, ours)


def forces_at_end(case: Case) -> Outcome:
    """Side thrust, thrust in a massless rod, its tangential share [kN] and torque [kN m] at the
    last sample."""
    data, radius = run(case.ours()).data, case.theirs().crank.radius
    end = {name: float(data[name].values[-1].squeeze()) for name in _FORCES}
    ours = {
        "side_thrust": end["side_force"],
        "rod_thrust": math.hypot(end["crank_pin_force_x"], end["crank_pin_force_y"]),
        "tangential_force": end["crank_torque"] / radius,
        "crank_torque": end["crank_torque"],
    }
    return _against(case, {name: force / 1e3 for name, force in ours.items()})


def _against(case: Case, ours: dict[str, float]) -> Outcome:
    """The worst relative difference from what is computed here; beside it what is printed."""
    worst, parts = 0.0, []
    for name, value in ours.items():
        row = reference.one_row("printed", machine=case.word("machine"), quantity=name)
        computed = float(row["computed_here"])
        off = abs(value - computed) / abs(computed)
        worst = off if math.isnan(off) else max(worst, off)
        parts.append(
            f"{name} {value:.14g} {row['unit']} (computed here {row['computed_here']}; printed "
            f"{row['printed']}, {row['why']})"
        )
    return Outcome(worst, "; ".join(parts))
