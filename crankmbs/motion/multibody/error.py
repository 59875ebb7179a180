"""From runs at step sizes h, h/2, h/4, ... to one answer and its error."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from crankmbs.mechanics.peaks import negligible, peak
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.numerics.arrays import Array

__all__ = ["SAFETY", "Convergence"]

SAFETY = 1.5  # times what is estimated: an order is never quite the nominal one
_UNPROVEN = 5.0  # instead, where two runs say nothing about an order
_SHARE = 1.0 / 8.0  # of what is usual beside it: what changes less does so by chance
_BENT = 1.0 / 32.0  # of D, what bends within the steps leave in a first correction
_ROUNDING = 5e-13  # of a variable's peak: what Newton's method and the interpolation leave
_OF_ANGLE = ("rod_angle", "piston_position", "piston_displacement")
_WITH_ACCELERATION = {"rad/s^2", "m/s^2", "N", "N m"}  # units of what a bend of a load bends
_AT_AN_ANGLE = ("external_torque", "gas_force")  # but these err as the angle does
_FAST = 32.0  # a halving that gains more: at a given angle these err by their interpolation alone

Runs = Sequence[Mapping[str, Array]]


class Convergence:
    """Answer and error of a sequence of runs, each at half the step of the one before.

    With f, f', f'' of the last runs, coarse to fine, a halving changes a variable by
    D = max |f'' - f'| and its correction, the answer extrapolated at order 2, by
    X = max |f'' + (f'' - f')/3 - f' - (f' - f)/3|. All D and X so far are kept.

    order : power of the step with which the erratic part of an error goes at least: 1 where loads
        jump within a step, 2 where they bend, else 3
    bent : whether loads over the angle bend within the steps: accelerations, and forces with them,
        are then interpolated over the bend, and err by the first power
    """

    def __init__(self, order: int, *, bent: bool = False) -> None:
        self._shrinks, self._bent = 2.0**order, bent
        self._changes: dict[str, list[float]] = {}
        self._corrections: dict[str, list[float]] = {}

    def answer(self, runs: Runs) -> tuple[dict[str, Array], dict[str, float]]:
        """The variables, corrected where that is sound, and an absolute error for each.

        The correction is taken where the slopes agree to it, 3 X <= D, and no jump lies within a
        step; the error is then about X. Elsewhere the answer is the finest run, with an error of
        about D. Of what depends on the angle alone only the interpolation between steps errs, at
        samples in angle; where a halving gained more than 32-fold the next would gain as much, and
        D/8 is stated. All are stated half as large again. A variable that is but rounding beside
        the others of its unit is zero.

        runs : the last three at most, coarsest first, at the same samples; each call adds one. Of
            one alone the error is unknown, infinite. "ahead", the crank angle at the same times,
            gives the crank angle's error and is left out
        """
        answer = dict(runs[-1])
        errors = dict.fromkeys(answer, math.inf)
        if len(runs) > 1:
            self._compare(runs)
            usual = self._usual() if len(runs) > 2 else self._usual_change(runs[-1])
            for name, value in runs[-1].items():
                size, change = peak(value), self._changes[name][-1]
                error = _UNPROVEN * max(change, _SHARE * usual * size) if change else 0.0
                if len(runs) > 2:
                    error = SAFETY * self._uncorrected(name)
                    if self._is_clean(name):
                        answer[name] = value + (value - runs[-2][name]) / 3.0
                        error = SAFETY * self._corrected(name, usual)
                errors[name] = error + _ROUNDING * size
        _silence(answer)
        del answer["ahead"]
        errors["crank_angle"] = errors.pop("ahead")
        return answer, errors

    def _compare(self, runs: Runs) -> None:
        """Note what the last halving changed."""
        for name, value in runs[-1].items():
            change = value - runs[-2][name]
            self._changes.setdefault(name, []).append(peak(change))
            if len(runs) > 2:
                before = runs[-2][name] - runs[-3][name]
                correction = peak(before - 4.0 * change) / 3.0
                self._corrections.setdefault(name, []).append(correction)

    def _is_clean(self, name: str) -> bool:
        agree = 3.0 * self._corrections[name][-1] <= self._changes[name][-1]
        return agree and self._shrinks > 2.0 and not self._bends(name)

    def _bends(self, name: str) -> bool:
        if not self._bent or name not in EVERY or name in _AT_AN_ANGLE:
            return False
        return EVERY[name].units in _WITH_ACCELERATION

    def _usual_change(self, run: Mapping[str, Array]) -> float:
        """D over the peak of the variables, the median: they all come from one motion."""
        sizes = {name: peak(value) for name, value in run.items()}
        changes = {n: self._changes[n][-1] for n, size in sizes.items() if size > 0.0}
        shares = [change / sizes[n] for n, change in changes.items() if n not in SUMS]
        return float(np.median(shares))

    def _usual(self) -> float:
        """The same of X over D."""
        shares = [
            corrections[-1] / self._changes[name][-1]
            for name, corrections in self._corrections.items()
            if self._changes[name][-1] > 0.0 and name not in SUMS
        ]
        return float(np.median(shares)) if shares else 0.0

    def _corrected(self, name: str, usual: float) -> float:
        """X, or what it must be but for chance: by those of the others, or by the one before."""
        corrections = self._corrections[name]
        if len(corrections) == 1:
            least = max(_SHARE * usual, _BENT if self._shrinks < 8.0 else 0.0)
            return max(corrections[-1], least * self._changes[name][-1])
        return _largest(corrections, self._shrinks, 8.0, 2.0)

    def _uncorrected(self, name: str) -> float:
        """D, or what it must be but for chance, at the order of the method or of a jump."""
        changes = self._changes[name]
        before, last = changes[-2:]
        if name in _OF_ANGLE and _FAST * last < before:
            return last / 8.0
        if self._bends(name):  # erratic: what the halvings before leave is as likely as the last
            return max(change / 2.0**k for k, change in enumerate(reversed(changes)))
        shrinks = min(self._shrinks, 4.0)
        return _largest(changes, shrinks, 4.0, 0.55 * shrinks)


def _largest(sizes: Sequence[float], shrinks: float, most: float, stalled: float) -> float:
    """The last size, or what the one before leaves of itself, if that is more with no margin.

    Each shrinks by as much as the one before did, but at least by ``shrinks`` and at most by
    ``most``. Where they shrink by less than ``stalled`` it is rounding that is left, and twice the
    larger is taken.
    """
    last, before = sizes[-1], sizes[-2]
    earlier = sizes[-3] if len(sizes) > 2 else math.inf
    if stalled * last > before or stalled * before > earlier:
        return 2.0 * max(last, before)
    shrunk = earlier / before if before > 0.0 and math.isfinite(earlier) else 0.0
    return max(last, before / min(max(shrinks, shrunk), most) / SAFETY)


def _silence(answer: dict[str, Array]) -> None:
    """Make zero what is but rounding beside the others of its unit, or beside speed squared."""
    peaks = {name: peak(values) for name, values in answer.items() if name in EVERY}
    units = {name: EVERY[name].units for name in peaks}
    peaks["speed squared"] = peaks["crank_speed"] ** 2
    units["speed squared"] = EVERY["crank_acceleration"].units
    for name in negligible(peaks, units) - {"speed squared"}:
        answer[name] = np.zeros_like(answer[name])
