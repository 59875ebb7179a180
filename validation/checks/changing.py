"""What changes on the way of a free crank, against the oracle that goes from event to event."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter_changes import changes_of
from validation.case import Case, shifted
from validation.judge import Outcome
from validation.oracles.changing import Changed, changing_motion
from validation.oracles.cycle_pressures import cycle_pressures
from validation.oracles.deciding import Decider
from validation.random_changes import random_changes

__all__ = [
    "Found",
    "compared",
    "governed",
    "mean_pressures",
    "stated_scene",
    "stated_scenes",
]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_TOO_LARGE = 100.0  # the stated error may be this many times the true one, or what is asked
_FLOOR = 1e-9  # of the peak: the oracle itself errs by up to 4e-10
_MOST_LEFT_OUT = 0.1  # of the runs
_KINDS = ("fuel", "load on", "load off", "reversal")

Floats = NDArray[np.float64]


class Found(NamedTuple):
    """Of a variable: largest true error, stated one, peak."""

    true: float
    stated: float
    peak: float

    def low(self) -> float:
        """True over stated error."""
        return self.true / max(self.stated, _FLOOR * self.peak, 1e-300)

    def high(self, asked: float) -> float:
        """Stated error over a hundred times the true one, or over what is asked."""
        allowed = max(_TOO_LARGE * self.true, max(asked, _FLOOR) * self.peak, 1e-300)
        return self.stated / allowed


def compared(result: Result, scene: Scene) -> dict[str, Found]:
    """The errors of what the oracle knows of a run, whose samples lie on times, for a scene; those
    of its events where the run comes to its end.

    Raises
    ------
    ArithmeticError : from the oracle, or no two samples
    """
    assert scene.start is not None
    held = result.status == 1 and scene.friction is not None
    kept = result.data.sizes["time"] - (result.status != 0 and not held)
    if kept < 2:
        raise ArithmeticError(f"nothing to judge: {result.message}")
    data = result.data.isel(time=slice(kept))
    begin = scene.start.angle, scene.start.speed
    found = changing_motion(changes_of(scene), *begin, data["time"].values)
    clear = found.clear
    everywhere = np.ones_like(clear)
    columns = {
        "crank_angle": (found.theta, everywhere),
        "crank_speed": (found.omega, everywhere),
        "crank_acceleration": (found.alpha, clear),
        "external_torque": (found.external, clear),
        "gas_force": (found.gas, clear),
        "friction_force": (found.friction, clear),
        "fuel": (found.shares, clear),
    }
    errors = {}
    for name, (exact, where) in columns.items():
        if name not in data:
            continue
        ours = data[name].values
        peak = float(np.max(np.abs(ours)))
        apart = float(np.max(np.abs(ours - exact)[where], initial=0.0))
        errors[name] = Found(apart, float(data[name].attrs["error_estimate"]), peak)
    return errors | (_events(result, found) if result.status == 0 or held else {})


def _events(result: Result, found: Changed) -> dict[str, Found]:
    """Times, crank angles and speeds of the events of a run; infinite where one is missing."""
    events, errors = result.events, {}
    for k, name in enumerate(("time", "crank_angle", "crank_speed")):
        stated, apart = float(events[name].attrs["error_estimate"]), 0.0
        peak = float(np.max(np.abs(result.data[name].values)))
        for kind in _KINDS:
            of_kind = (events["kind"].values == kind) & (events["time"].values > 0.0)
            ours = events[name].values[of_kind]
            if kind == "fuel":  # of every cylinder that decides there
                ours = ours[
                    np.append(True, np.diff(events["time"].values[of_kind]) > 0.0)[: len(ours)]
                ]
            exact = np.array([row[k] for row in found.events if row[3] == kind and row[0] > 0.0])
            if len(ours) != len(exact):
                apart = math.inf
                continue
            apart = max(apart, float(np.max(np.abs(ours - exact), initial=0.0)))
        errors[f"{name} of events"] = Found(apart, stated, peak)
    return errors


def stated_scene(case: Case) -> Outcome:
    """True error over twice the stated one of the case's own scene, worst variable, over the
    largest true error."""
    result = simulate(case.ours(), formulation=case.word("formulation"))
    found = compared(result, case.theirs())
    worst = max(found, key=lambda name: found[name].low())
    true, stated, peak = found[worst]
    largest = max(one.true / one.peak for one in found.values() if one.peak > 0.0)
    return Outcome(
        found[worst].low() / _TOO_SMALL,
        f"{worst}: true {true:.1e}, stated {stated:.1e}, peak {peak:.3g}; largest true error "
        f"{largest:.1e} of a peak; {len(result.events['event'])} events; {result.message}",
    )


def mean_pressures(case: Case) -> Outcome:
    """Indicated mean effective pressure of every cylinder in every cycle of a run against the
    integral of p dV over the oracle's pressures, shares by the letter of the rule; over the
    largest."""
    result, scene = simulate(case.ours()), case.theirs()
    assert scene.start is not None
    exact = cycle_pressures(
        changes_of(scene), scene.start.angle, scene.start.speed, result.cycles.sizes["cycle"]
    )
    ours = result.cycles["imep"].values
    worst = float(np.max(np.abs(ours - exact)) / np.max(np.abs(exact)))
    spread = f"{exact.min() / 1e5:.5g} to {exact.max() / 1e5:.5g} bar"
    return Outcome(worst, f"{ours.shape[0]} cycles of {ours.shape[1]} cylinders, {spread}")


def governed(case: Case) -> Outcome:
    """Shares of the decisions of a whole run against those that the governor's law makes of their
    times and angles, one after the other."""
    result, scene = simulate(case.ours()), case.theirs()
    assert scene.start is not None
    events = result.events
    fuel = (events["kind"].values == "fuel") & (events["time"].values > 0.0)
    decider = Decider(changes_of(scene), scene.start.angle, scene.start.speed)
    apart, clipped = 0.0, 0
    for place in np.flatnonzero(fuel):
        time, theta, omega, share = (
            float(events[name].values[place])
            for name in ("time", "crank_angle", "crank_speed", "share")
        )
        decider.decide(time, theta, omega)
        own = decider.shares[int(events["cylinder"].values[place]) - 1]
        apart, clipped = max(apart, abs(own - share)), clipped + (own in (0.0, 1.2))
    mean = result.cycles["mean_speed"].values[-1]
    assert scene.fuel is not None
    assert scene.fuel.governor is not None
    off = abs(float(mean) / scene.fuel.governor.speed - 1.0)
    said = f"{fuel.sum()} decisions, {clipped} clipped; mean speed of the last cycle {off:.1e} off"
    return Outcome(apart, said)


def stated_scenes(case: Case) -> Outcome:
    """True error over twice the stated one, or stated over 100 times the true one and over what was
    asked for, or what the run says that it reached instead: the worst variable of all scenes, each
    run by one of the formulations in turn."""
    first, count = int(case.parameters["first"]), int(case.parameters["count"])
    formulations = case.parameters["formulations"]
    worst, said, largest, judged = 0.0, "", 0.0, 0
    left_out: list[str] = []
    for seed in range(first, first + count):
        theirs = random_changes(case.word("kind"), seed)
        ours = shifted(theirs, "rod.length", lambda length: length * case.number("rod"))
        formulation = formulations[seed % len(formulations)]
        result = simulate(ours, formulation=formulation)
        try:
            found = compared(result, theirs)
        except ArithmeticError:
            left_out.append(f"{seed} {formulation}")
            continue
        judged += 1
        reached = max(result.error.asked, result.error.estimated)
        for name, one in found.items():
            low, high = one.low(), one.high(reached) * _TOO_SMALL
            largest = max(largest, low)
            if not max(low, high) <= worst:
                worst = max(low, high) if math.isfinite(one.true) else math.inf
                said = (
                    f"seed {seed}, {formulation}, {name}: true {one.true:.1e}, "
                    f"stated {one.stated:.1e}"
                )
        if case.mutated and worst > _TOO_SMALL:
            break
    if len(left_out) > _MOST_LEFT_OUT * count:
        raise RuntimeError(f"too many runs cannot be judged: {left_out}")
    also = f"; not judged: {', '.join(left_out)}" if left_out else ""
    return Outcome(
        worst / _TOO_SMALL, f"{judged} runs, at most {largest:.2g} times stated; {said}{also}"
    )
