"""End states and states that other programs and textbooks have published."""

from __future__ import annotations

import math

import numpy as np

from validation import reference
from validation.case import Case
from validation.judge import Outcome
from validation.plots import Array
from validation.runs import run

__all__ = ["end_state", "forces_at_end", "largest_speed", "rod_and_slider"]


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
        "largest_piston_speed": float(at - 0.25 * (before - after) * shift),
        "crank_angle_of_it": float(angle[k] + shift * (angle[k] - angle[k - 1])),
    }
    return _against(case, ours)


def forces_at_end(case: Case) -> Outcome:
    """Side thrust [N] and torque [N m] at the last sample."""
    data = run(case.ours()).data
    ours = {
        "side_thrust": float(data["side_force"].values[-1, 0]),
        "crank_torque": float(data["crank_torque"].values[-1, 0]),
    }
    return _against(case, ours)


def _against(case: Case, ours: dict[str, float]) -> Outcome:
    """The worst difference: relative, or in half units of the last printed digit."""
    worst, parts = 0.0, []
    for name, value in ours.items():
        row = reference.one_row("published", machine=case.word("machine"), quantity=name)
        published = float(row["value"])
        scale = abs(published) if case.parameters["relative"] else 0.5 * float(row["last_digit"])
        worst = max(worst, abs(value - published) / scale)
        parts.append(f"{name} {value:.14g} (published {row['value']}) {row['unit']}")
    if math.isnan(worst):
        raise ValueError("no number came")
    return Outcome(worst, ", ".join(parts))
