"""What the lectures' formulas are wrong by, cause by cause, against the oracle's own causes."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from crankmbs.compare import CAUSES, Budget, budget
from crankmbs.figures.compare import budget_figure
from crankmbs.scene.scene import Scene
from validation.adapter import reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import Array
from validation.runs import run

__all__ = ["causes"]

_QUANTITIES = {"side thrust": "side_force", "torque": "crank_torque"}


def causes(case: Case) -> Outcome:
    """The two-mass rod's and gravity's share of side thrust and torque, each over its peak.

    The oracle solves Newton-Euler at the run's own angle, speed and acceleration with the inertia
    of two masses and with the rod's own, without gravity and with it; the differences are the two
    causes. All causes together must give formula minus run.
    """
    split = budget(run(case.ours(), "multibody"))
    theirs = case.theirs()
    light = replace(theirs, gravity=None)
    two_mass = replace(light, rod=replace(light.rod, inertia="two-mass"))
    answers = [_oracle(scene, split) for scene in (two_mass, light, theirs)]
    errors = {}
    for quantity, name in _QUANTITIES.items():
        found = split.split(quantity)
        rod, gravity = (a[name] - b[name] for a, b in pairwise(answers))
        added = sum((cause.curve for cause in found.causes), 0.0 * found.total.curve)
        for what, ours, exact in (
            ("two-mass rod", found.cause("two-mass rod").curve, rod),
            ("gravity", found.cause("gravity").curve, gravity),
            ("sum", added, found.values - found.simulated),
        ):
            errors[f"{quantity}, {what}"] = float(np.max(np.abs(ours - exact))) / found.peak
    worst = max(errors, key=lambda name: errors[name])
    sentences = [split.split(quantity).sentence() for quantity in _QUANTITIES]
    figure = budget_figure(split, tuple(_QUANTITIES))
    assert figure is not None
    table = ("| quantity | " + " | ".join(CAUSES) + " |", "|---" * (len(CAUSES) + 1) + "|")
    rows = tuple(_row(split, found.quantity) for found in split.splits)
    detail = f"worst: {worst}. " + "; ".join(sentences)
    return Outcome(errors[worst], detail, (*table, *rows), {case.name: figure})


def _oracle(scene: Scene, split: Budget) -> dict[str, Array]:
    """Variables of the cylinder looked at, by Newton-Euler of the oracle."""
    stretch = split.excerpt
    found = reference_variables(scene, stretch.theta, stretch.omega, stretch.alpha)
    column = stretch.cylinder - 1
    return {name: np.asarray(found[name])[:, column] for name in _QUANTITIES.values()}


def _row(split: Budget, quantity: str) -> str:
    """The peak of every cause in percent of the quantity's."""
    found = split.split(quantity)
    shares = {cause.name: found.share(cause) for cause in found.causes}
    cells = [f"{shares[name]:.3g} %" if shares.get(name) else "-" for name in CAUSES]
    return f"| {quantity} | {' | '.join(cells)} |"
