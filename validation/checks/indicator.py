"""The cubic pieces of an indicator diagram against its polytropes."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.pressure import pressures_of
from validation.adapter import diagram_of
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import LONG
from validation.oracles.indicator import absolute_pressure, dead_centres

__all__ = ["pieces"]

_SAMPLES = 20011
_BESIDE = 1e-8  # rad: at a dead centre the diagram jumps


def pieces(case: Case) -> Outcome:
    """Largest difference over the absolute pressure, one period, dead centres left out."""
    scene = case.theirs()
    assert scene.gas is not None
    diagram = diagram_of(scene)
    pressures = pressures_of(case.ours())
    assert pressures is not None
    ours = pressures[0]
    angle = np.linspace(0.0, scene.period, _SAMPLES)
    beside = [(angle - float(at)) % (2.0 * np.pi) for at in dead_centres(diagram)]
    smooth = [(x > _BESIDE) & (x < 2.0 * np.pi - _BESIDE) for x in beside]
    angle = angle[smooth[0] & smooth[1]]
    exact = absolute_pressure(diagram, angle)
    error = np.abs(ours(angle) + LONG.number(scene.gas.ambient or 0.0) - exact) / exact
    worst = int(np.argmax(error))
    return Outcome(float(error[worst]), f"worst at {np.degrees(angle[worst]):.1f} deg")
