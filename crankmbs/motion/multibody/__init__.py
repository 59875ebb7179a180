"""Crank, rods and pistons as rigid bodies on joints, in exudyn: the independent check."""

from __future__ import annotations

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Solution
from crankmbs.motion.multibody import driven, free

__all__ = ["run"]


def run(train: CrankTrain, rtol: float, cost_cap: float) -> Solution:
    """Run the multibody model.

    Raises
    ------
    FormulationError : exudyn cannot take a single step of this scene
    InputError : a speed table that ends before the run does
    """
    if train.scene.motion is not None:
        return driven.run(train)
    return free.run(train, rtol, cost_cap)
