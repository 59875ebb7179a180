"""The largest pressures of cylinders, which are alike in all motions of a machine."""

from __future__ import annotations

import numpy as np

from crankmbs.measures.estimate import ROUNDING
from crankmbs.mechanics.pressure import PeriodicPressure, pressures_of
from crankmbs.mechanics.train import crank_train
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["highest_pressures"]


def highest_pressures(scene: Scene) -> dict[str, Array]:
    """The peak of each pressure and its error [Pa], by the name of the measure, shape (2,
    cylinders).

    >>> highest_pressures(load_scene("propeller"))["gauge_pressure"].shape
    (2, 1)
    """
    train = crank_train(scene)
    ends = {"gauge_pressure": train.pressure} if train.pressure else {}
    if train.crank_end is not None:
        ends = {"gauge_pressure_head_end": pressures_of(scene) or ()}
        ends["gauge_pressure_crank_end"] = train.crank_end
    once = {each: _peak_of(each) for each in dict.fromkeys(sum(ends.values(), ()))}
    return {
        name: np.array([once[each] for each in pressures]).T for name, pressures in ends.items()
    }


def _peak_of(pressure: PeriodicPressure) -> tuple[float, float]:
    """The highest pressure and its error."""
    (_, value), (_, perturbed) = pressure.peak, pressure.perturbed.peak
    return value, abs(perturbed - value) + ROUNDING * abs(value)
