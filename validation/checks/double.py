"""Double-acting cylinders: random scenes by their seeds, against the oracles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.drives import Motion
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import at_jumps, reference_variables
from validation.adapter_changes import changes_of
from validation.case import Case, shifted
from validation.checks.changing import compared
from validation.judge import Outcome
from validation.oracles.cycle_pressures import cycle_pressures
from validation.random_double import random_double

__all__ = ["every_variable", "mean_pressures", "stated_scenes"]

_TOO_SMALL = 2.0
_MOST_LEFT_OUT = 0.1


def every_variable(case: Case) -> Outcome:
    """At random states of motion: the largest difference of a variable over the largest of its
    unit. Every firing has the share 1 and nothing rubs, as the oracle knows neither."""
    worst, said = 0.0, ""
    for seed in _seeds(case):
        scene = _plain(random_double(seed))
        theta, omega, alpha = (
            np.random.default_rng([47, seed])
            .uniform([-13.0, -300.0, -2e4], [13.0, 300.0, 2e4], (5, 3))
            .T
        )
        clear = ~at_jumps(scene, theta)
        ours = reactions(crank_train(_ours(case, scene)), theta, omega, alpha)
        exact = reference_variables(scene, theta, omega, alpha)
        sizes: dict[str, float] = {}
        for name, values in exact.items():
            unit = EVERY[name].units
            sizes[unit] = max(sizes.get(unit, 0.0), float(np.abs(values).max()))
        for name, values in exact.items():
            if name not in ours:
                continue
            apart = np.abs(ours[name] - values.astype(float))[clear]
            size = sizes[EVERY[name].units]
            found = float(apart.max(initial=0.0)) / size if size else 0.0
            if found > worst:
                worst, said = found, f"seed {seed}, {name}"
    return Outcome(worst, said)


def mean_pressures(case: Case) -> Outcome:
    """Mean effective pressure of either end in every cycle of a prescribed motion, and the powers
    of both over the last period, against the integrals of p dV: the largest difference over the
    largest pressure, or power."""
    worst, said = 0.0, ""
    for seed in _seeds(case):
        scene = _driven(_plain(random_double(seed)))
        theirs = changes_of(scene)
        assert scene.motion is not None
        result = simulate(_ours(case, scene))
        count = result.cycles.sizes["cycle"]
        angle, speed = scene.motion.angle, abs(float(result.data["crank_speed"][0]))
        below = replace(theirs, fired=theirs.crank_ends)
        exact = {
            "imep": cycle_pressures(theirs, angle, speed, count),
            "imep_crank_end": -cycle_pressures(below, angle, speed, count),
        }
        pressures = [result.data[name].values for name in ("gas_pressure", "crank_end_pressure")]
        largest = float(max(np.abs(each).max() for each in pressures))
        apart = {
            name: float(np.abs(result.cycles[name].values - values).max()) / largest
            for name, values in exact.items()
        }
        apart |= _of_measures(scene, result, exact, largest)
        name = max(apart, key=lambda each: apart[each])
        if apart[name] > worst:
            worst, said = apart[name], f"seed {seed}, {name}"
    return Outcome(worst, said)


def stated_scenes(case: Case) -> Outcome:
    """True error over twice the stated one, or stated over 100 times the true one and over what was
    asked for or the run says that it reached: the worst variable of all scenes, each run by one of
    the formulations in turn. The pressures of both ends are held at the run's own angles."""
    formulations, worst, said, judged = case.parameters["formulations"], 0.0, "", 0
    left_out: list[str] = []
    for seed in _seeds(case):
        theirs = random_double(seed)
        formulation = formulations[seed % len(formulations)]
        result = simulate(_ours(case, theirs), formulation=formulation)
        try:
            found = compared(result, theirs)
        except ArithmeticError:
            left_out.append(f"{seed} {formulation}")
            continue
        judged += 1
        reached = max(result.error.asked, result.error.estimated)
        ratios = {n: max(e.low(), e.high(reached) * _TOO_SMALL) for n, e in found.items()}
        ratios["both ends"] = _TOO_SMALL * _ends_apart(result, theirs) / 1e-11
        for name, ratio in ratios.items():
            if not ratio <= worst:
                worst = ratio if math.isfinite(ratio) else math.inf
                said = f"seed {seed}, {formulation}, {name}"
        if case.mutated and worst > _TOO_SMALL:
            break
    if len(left_out) > _MOST_LEFT_OUT * judged:
        raise RuntimeError(f"too many runs cannot be judged: {left_out}")
    also = f"; not judged: {', '.join(left_out)}" if left_out else ""
    return Outcome(
        worst / _TOO_SMALL, f"{judged} runs, at most {worst:.2g} times stated; {said}{also}"
    )


def _seeds(case: Case) -> range:
    first = int(case.parameters["first"])
    return range(first, first + int(case.parameters["count"]))


def _ours(case: Case, scene: Scene) -> Scene:
    """With the piston's area of the case, and with it that of the crank end."""
    found: Scene = shifted(scene, "piston.area", lambda area: area * case.number("area"))
    return found


def _plain(scene: Scene) -> Scene:
    assert scene.gas is not None
    gas = replace(scene.gas, motored=None)
    return replace(scene, fuel=None, friction=None, torque=(), gas=gas)


def _driven(scene: Scene) -> Scene:
    """Three periods of the pressures at a constant speed."""
    assert scene.start is not None
    until = Extent(value=3.0 * crank_train(scene).period, unit="rad")
    run = Run(until=until, every=Extent(value=math.radians(2.0), unit="rad"))
    motion = Motion(speed=150.0, angle=scene.start.angle)
    return replace(scene, start=None, motion=motion, run=run)


def _of_measures(
    scene: Scene, result: Result, exact: dict[str, Array], largest: float
) -> dict[str, float]:
    """By how much the measures over the last period are off: pressures over the largest, powers
    over the speed times area times radius at it."""
    found = result.measures()
    apart, radius = {}, scene.crank.radius
    count = round(abs(found.window.angle) / scene.period)  # cycles, until all comes again
    for end, name, area in (
        ("head_end", "imep", scene.piston.gas_area or 0.0),
        ("crank_end", "imep_crank_end", scene.piston.crank_end_area),
    ):
        ours = getattr(found, name)
        last = exact[name][-count:].mean(axis=0)
        apart[f"measured {name}"] = (
            max(abs(one.value - value) for one, value in zip(ours, last, strict=True)) / largest
        )
        r, l, e = radius, scene.rod.length, scene.piston.offset
        stroke = math.sqrt((l + r) ** 2 - e * e) - math.sqrt((l - r) ** 2 - e * e)
        power = float(last.sum()) * area * stroke / (scene.period / found.mean_speed.value)
        off = abs(getattr(found, f"indicated_power_{end}").value - power)
        apart[f"power of the {end}"] = off / (largest * area * radius * found.mean_speed.value)
    return apart


def _ends_apart(result: Result, scene: Scene) -> float:
    """Of the crank end's pressure and of the force of both at the angles of a run, over the
    largest, beside jumps."""
    theta = result.data["crank_angle"].values
    clear, changes = ~at_jumps(scene, theta), changes_of(scene)
    ours = result.data["crank_end_pressure"].values
    exact = np.empty_like(ours)
    for k, (phase, _) in enumerate(changes.machine.cylinders):
        for n, angle in enumerate((theta + float(phase)).tolist()):
            piece, low, _ = changes.crank_ends[k].at(angle + 1e-11)
            exact[n, k] = piece(angle - low)
    piston = scene.piston
    head, crank = (piston.gas_area or 0.0), piston.crank_end_area
    force = head * result.data["gas_pressure"].values - crank * exact
    off = np.abs(ours - exact)[clear].max(initial=0.0) / (np.abs(exact).max() or 1.0)
    beside = np.abs(result.data["gas_force"].values - force)[clear].max(initial=0.0)
    size = head * np.abs(result.data["gas_pressure"].values).max() + crank * np.abs(exact).max()
    return float(max(off, beside / (size or 1.0)))
