"""Crank, rods and pistons as rigid bodies on joints, in exudyn: the independent check.

Every body has its own coordinates, every joint its multipliers: motion and reactions are exudyn's.
With the others it shares what is given to it, pressure, loads and prescribed speed, and the loop
closure, from which positions that meet exudyn's constraints are sought.
"""

from __future__ import annotations

from collections.abc import Sequence

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Solution
from crankmbs.motion.multibody import driven, free
from crankmbs.motion.multibody.account import Run

__all__ = ["run"]


def run(train: CrankTrain, rtol: float, cost_cap: float) -> tuple[Solution, Sequence[Run]]:
    """Run the multibody model; a free crank is refined until ``rtol`` is met.

    cost_cap [s] : each second of it stands for 20,000 steps of one cylinder

    Returns
    -------
    the solution, and of its finest runs how they begin, their pieces, how they end

    Raises
    ------
    FormulationError : exudyn cannot take a single step of this scene
    InputError : a speed table that ends before the run does
    """
    if train.scene.motion is not None:
        return driven.run(train)
    return free.run(train, rtol, cost_cap)
