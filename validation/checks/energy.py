"""The energy that a run gains against the work of all that it reports, by an own quadrature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import simpson

from crankmbs.simulate import simulate
from validation.case import Case
from validation.judge import Outcome

__all__ = ["closes"]

_LEAST = 3  # samples that Simpson's rule takes


def closes(case: Case) -> Outcome:
    """Kinetic energy gained less the work of gas, friction and all outside, over the works.

    By Simpson's rule over the reported forces, velocities and torques between the events, where
    they may jump, dead centres and changes of sign of a gas force, where the power of friction
    bends: the sum of what is missing in all stretches, over the integral of the powers' magnitudes.
    """
    result, work = simulate(case.ours(), formulation=case.word("formulation")), case.number("work")
    if result.scene.gravity is not None:
        raise ValueError("weights are not reported, and do their work too")
    data, velocity = result.data, result.data["piston_velocity"].values
    time, kinetic = data["time"].values, data["kinetic_energy"].values
    gas = data["gas_force"].values
    along = gas + (data["friction_force"].values if "friction_force" in data else 0.0)
    powers = {
        "pistons": np.sum(along * velocity, axis=1),
        "outside": (data["external_torque"] * data["crank_speed"]).values,
    }
    turns = 1 + np.flatnonzero(_changes_sign(velocity) | _changes_sign(gas))
    cuts = np.unique([*np.searchsorted(time, result.events["time"].values), *turns])
    missing, done, judged = 0.0, dict.fromkeys(powers, 0.0), 0.0
    for begin, end in zip([0, *cuts], [*cuts, len(time)], strict=True):
        if end - begin < _LEAST:
            continue
        here, gained = slice(begin, end), kinetic[end - 1] - kinetic[begin]
        for name, power in powers.items():
            gained -= work * float(simpson(power[here], x=time[here]))
            done[name] += float(simpson(np.abs(power[here]), x=time[here]))
        missing, judged = missing + abs(gained), judged + time[end - 1] - time[begin]
    said = ", ".join(f"{name} {joule:.4g} J" for name, joule in done.items())
    return Outcome(
        missing / sum(done.values()),
        f"{missing:.1e} J missing; {said}; {judged / (time[-1] - time[0]):.1%} of the run",
    )


def _changes_sign(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Between which neighbouring samples a cylinder's value does."""
    one, other = values[1:], values[:-1]
    changes: NDArray[np.bool_] = ((one * other <= 0.0) & (one != other)).any(axis=1)
    return changes
