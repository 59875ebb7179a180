"""From runs at step sizes h, h/2, h/4 to one answer and its error."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from crankmbs.formulations.base import Array
from crankmbs.result import VARIABLES

__all__ = ["best_answer", "relative_error"]

_SAFETY = 1.5
_ROUNDING = 5e-13  # of a variable's peak: what Newton's method and the interpolation leave
_INTERPOLATED = 1e-7  # of a variable's peak: what interpolation between steps errs, at most
_NOTHING = 1e-10  # of the largest value of its unit


def best_answer(runs: Sequence[Mapping[str, Array]]) -> tuple[dict[str, Array], dict[str, float]]:
    """The variables, extrapolated where that is sound, and an absolute error for each.

    The method is of order 2: with the differences D1, D2 of runs at h, h/2, h/4 the finest errs by
    D2/3 when D1 = 4 D2. Where the slopes agree to that, |D1 - 4 D2| <= |D2| in the largest over
    the run, the answer is f + D2/3, and its error is about the change that the last halving made
    to such an answer, |D1 - 4 D2|/3. Elsewhere (a kink in the pressure at every step) the answer
    is the finest run, with an error of about |D2|, or |D1|/4 where D2 is smaller by chance. Where a
    halving gained more than 32-fold and next to nothing is left (an exact motion, of which only the
    interpolation between steps errs) the next would gain as much, and 4 |D2|^2/|D1| is stated. All
    are stated half as large again: rounding, and what is left of the start of a stretch, shrink
    otherwise than the step would have it. A variable that is but rounding beside the others of its
    unit is zero.

    runs : the last three at most, coarsest first, at the same samples; of one alone the error is
        unknown, infinite. "ahead", the crank angle at the same times, gives the crank angle's
        error and is left out
    """
    answer = dict(runs[-1])
    errors = dict.fromkeys(answer, math.inf)
    for name, value in runs[-1].items() if len(runs) > 1 else ():
        change = value - runs[-2][name]
        error = _peak(change)
        if len(runs) > 2:
            before = runs[-2][name] - runs[-3][name]
            disagreement = _peak(before - 4.0 * change)
            if disagreement <= error:
                answer[name], error = value + change / 3.0, disagreement / 3.0
            elif 32.0 * error < _peak(before) and error < _INTERPOLATED * _peak(value):
                error *= 4.0 * error / _peak(before)
            else:
                error = max(error, 0.25 * _peak(before))
        errors[name] = _SAFETY * error + _ROUNDING * _peak(value)
    _silence(answer)
    del answer["ahead"]
    errors["crank_angle"] = errors.pop("ahead")
    return answer, errors


def relative_error(variables: Mapping[str, Array], errors: Mapping[str, float]) -> float:
    """The worst of all: the crank angle's per radian turned, others relative to their peak."""
    angle = variables["crank_angle"]
    turned = float(np.max(np.abs(angle - angle[0])))
    worst = 0.0
    for name, error in errors.items():
        scale = turned if name == "crank_angle" else _peak(variables[name])
        if name != "energy_residual" and scale > 0.0:
            worst = max(worst, error / scale)
    return worst


def _silence(answer: dict[str, Array]) -> None:
    """Make zero what is but rounding beside the others of its unit, or beside speed squared."""
    largest = {VARIABLES["crank_acceleration"].units: _peak(answer["crank_speed"]) ** 2}
    units = {name: VARIABLES[name].units for name in answer if name in VARIABLES}
    for name, unit in units.items():
        largest[unit] = max(largest.get(unit, 0.0), _peak(answer[name]))
    for name, unit in units.items():
        if _peak(answer[name]) < _NOTHING * largest[unit]:
            answer[name] = np.zeros_like(answer[name])


def _peak(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))
