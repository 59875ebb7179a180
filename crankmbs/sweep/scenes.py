"""The scene of one case: numbers set, and what has to follow them so that it keeps its sense."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from crankmbs.batch.solve import mean_speed_together
from crankmbs.design.rebalance import rebalanced
from crankmbs.errors import InputError, shown
from crankmbs.mechanics.carried import carried_over
from crankmbs.scene.change import changed
from crankmbs.scene.parts import Rod
from crankmbs.scene.scene import Scene
from crankmbs.sweep.knobs import DERIVED
from crankmbs.sweep.pressure_table import TABLE_KNOBS, corrected

__all__ = ["scene_of"]


def scene_of(scene: Scene, names: Sequence[str], values: Sequence[object]) -> Scene:
    """The scene with other values, all at once.

    With another crank radius, rod length or offset the gas is carried over the volume: within each
    stroke the pressure stays a function of the swept fraction (`crankmbs.mechanics.carried`).
    "rod_ratio" gives the rod the length r / ratio, at the same stroke; it keeps its mass, the place
    of its centre of mass and its shape, so that its inertia goes with the length squared.
    "settled_speed" scales the loads so that the motion settles to it. "gas.shift", "gas.scale" and
    "gas.offset" correct the pressure table as it is given (`crankmbs.sweep.pressure_table`).

    Raises
    ------
    InputError : a scene that cannot be

    >>> scene_of(load_scene("propeller"), ["rod_ratio"], [0.25]).rod.length
    0.184
    """
    knobs = dict(zip(names, values, strict=True))
    plain = {name: value for name, value in knobs.items() if name not in DERIVED}
    new = changed(scene, plain)
    derived = {name: _number(name, knobs[name]) for name in DERIVED if name in knobs}
    if "rod_ratio" in derived:
        new = dataclasses.replace(new, rod=_stretched(new, derived["rod_ratio"]))
    if table := {name: derived[name] for name in TABLE_KNOBS if name in derived}:
        new = corrected(new, table)
    new = carried_over(new, scene)
    if len(new.cylinders) != len(scene.cylinders):
        raise InputError(
            f"layout: a sweep keeps the number of cylinders, {len(scene.cylinders)}; "
            f"{len(new.cylinders)} came"
        )
    if "settled_speed" not in derived:
        return new
    return rebalanced(new, derived["settled_speed"], mean_speed_together)


def _stretched(scene: Scene, ratio: float) -> Rod:
    if not 0.0 < ratio <= 1.0:
        raise InputError(f"rod_ratio: must be above 0 and at most 1; {ratio:g} came")
    if scene.unlike:
        raise InputError("rod_ratio: the cylinders are unlike; vary each rod's length in its place")
    rod, length = scene.rod, scene.crank.radius / ratio
    stretch = length / rod.length
    inertia = rod.inertia if rod.inertia == "two-mass" else rod.inertia * stretch**2
    center = rod.center_of_mass * stretch
    return dataclasses.replace(rod, length=length, center_of_mass=center, inertia=inertia)


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{name}: must be a number in SI units; {shown(value)} came")
    return float(value)
