"""The crank train of a run: a scene with what its gas pressure became, made once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from crankmbs.mechanics.pressure import KNOT, PeriodicPressure, pressure_of
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["CrankTrain", "crank_angle_knots", "crank_train", "merged_knots"]


@dataclass(frozen=True)
class CrankTrain:
    """The machine of a scene; data alone, so that formulations that share it share no mechanics.

    pressure : difference across every piston over its cycle angle; None without gas
    """

    scene: Scene
    pressure: PeriodicPressure | None

    @property
    def off(self) -> CrankTrain:
        """The same with a pressure as far from this one as the true pressure may be."""
        return replace(self, pressure=self.pressure and self.pressure.off)


def crank_train(scene: Scene) -> CrankTrain:
    """The crank train of a scene.

    >>> crank_train(load_scene("coasting")).pressure is None
    True
    """
    return CrankTrain(scene, pressure_of(scene))


def crank_angle_knots(train: CrankTrain) -> Array:
    """Crank angles in [0, period) at which the pressure of any cylinder changes its piece.

    Returns
    -------
    shape (n,) [rad], increasing, cylinders merged; empty without gas
    """
    pressure = train.pressure
    return np.empty(0) if pressure is None else merged_knots(train.scene, pressure.knots[:-1])


def merged_knots(scene: Scene, knots: Array) -> Array:
    """Crank angles in [0, period) at which any cylinder passes one of these cycle angles [rad]."""
    if len(knots) == 0:
        return knots
    angles = [np.mod(knots - c.phase, scene.period) for c in scene.cylinders]
    merged = np.unique(np.concatenate(angles))
    merged = merged[np.append(True, np.diff(merged) > KNOT)]
    if scene.period - merged[-1] + merged[0] <= KNOT:
        merged = merged[:-1]
    return np.asarray(merged)
