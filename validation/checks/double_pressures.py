"""Double-acting cylinders: mean effective pressures and powers at a constant speed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs.mechanics.train import crank_train
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.drives import Motion
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter_changes import changes_of
from validation.case import Case, shifted
from validation.judge import Outcome
from validation.oracles.cycle_pressures import cycle_pressures
from validation.random_double import random_double

__all__ = ["mean_pressures"]


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
