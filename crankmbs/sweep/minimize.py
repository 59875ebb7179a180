"""The values of knobs with which a measure is least: a scan, then a polish without derivatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import NonlinearConstraint
from scipy.optimize import minimize as polished

from crankmbs.errors import InputError
from crankmbs.measures import Estimate
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.knobs import interval_of
from crankmbs.sweep.reading import Reading, free_reading_of
from crankmbs.sweep.sample import Sample
from crankmbs.sweep.solve import Asked, asked_of

__all__ = ["Condition", "Minimum", "minimize"]

_POINTS = 16  # of the scan for each knob
_MOST = 60  # evaluations of the polish for each knob
_AGAIN, _CLEARLY = 4, 1e-5  # simplexes at most; of the measure: one that gained less is the last
_FIRST, _LAST = 0.05, 1e-6  # steps of the polish, shares of a range
_AT = 1e-5  # of a range: so near its end a knob has ended there
_SLACK = 1e-6  # of a bound: so far a condition may be missed

Point = Sequence[float]


@dataclass(frozen=True)
class Condition:
    """measure : what is bounded; sign : "<=" or ">="; bound : in SI units; reached : there."""

    measure: Reading
    sign: str
    bound: float
    reached: Estimate


@dataclass(frozen=True)
class Minimum:
    """Where a measure is least.

    values, units : knob -> value in SI units, and its unit; known to 1e-6 of the range where the
        measure is not flat
    measure, reached : what is least, and how much it is
    conditions : what had to hold
    evaluations : runs
    status, message : 0 found, and whether a knob ended at a bound of its range; 1 where nothing
        fulfils the conditions
    """

    values: dict[str, float]
    units: dict[str, str]
    measure: Reading
    reached: Estimate
    conditions: tuple[Condition, ...]
    evaluations: int
    status: int
    message: str


def minimize(
    scene: Scene, vary: dict[str, str], measure: str, subject_to: Sequence[str] = ()
) -> Minimum:
    """Find the values of some knobs with which a measure is least.

    16 points a knob of a Sobol sequence are looked at, and the best of them that fulfils the
    conditions is polished, without derivatives as peaks are not smooth: by COBYQA, whose steps are
    those of quadratic models, and then by the simplex of Nelder and Mead, which goes on where two
    peaks are alike. The answer is the least value near there.

    Parameters
    ----------
    vary : knobs and their ranges, {"crank.center_of_mass": "-30..0 mm"}
    measure : "peak main bearing force", "fluctuation"
    subject_to : conditions that must hold, "fluctuation <= 2 %"

    Returns
    -------
    Minimum : status 1 with the point nearest to the conditions where none fulfils them

    Raises
    ------
    InputError : no scene, no range, no such measure

    >>> scene = load_scene("yi_diesel").with_(run__until="1 cycles", gas=None, gravity=None)
    >>> minimum = minimize(scene, {"piston.offset": "-8..5 mm"}, "peak side force")
    >>> print(abs(minimum.values["piston.offset"]) < 1e-5)
    True
    """
    check_scene(scene)
    knobs = tuple(interval_of(scene, *item) for item in vary.items())
    if not knobs or any(knob.whole for knob in knobs):
        raise InputError("vary: needs ranges of numbers that are not whole; sweep compares others")
    names = [knob.name for knob in knobs]
    reading = free_reading_of(scene, measure, names)
    conditions = [asked_of(scene, names, text, "<= >= < >") for text in subject_to]
    asked = Asked(scene, knobs, (reading, *(condition[0] for condition in conditions)))
    bounds = [(sign, bound) for _, sign, bound in conditions]
    best, status, message = _Descent(asked, names, bounds).ended()
    reached, *others = asked.at(*best)
    pairs = zip(conditions, others, strict=True)
    return Minimum(
        values={knob.name: float(knob.at(x)) for knob, x in zip(knobs, best, strict=True)},
        units={knob.name: knob.units for knob in knobs},
        measure=reading,
        reached=reached,
        conditions=tuple(Condition(*wanted, estimate) for wanted, estimate in pairs),
        evaluations=len(asked.known),
        status=status,
        message=message,
    )


class _Descent:
    """A measure and its conditions, each a sign and a bound, over shares of the ranges."""

    def __init__(self, asked: Asked, names: list[str], bounds: list[tuple[str, float]]) -> None:
        self._asked, self._names, self._bounds = asked, names, bounds

    def ended(self) -> tuple[Point, int, str]:
        """The best point, status and message."""
        count = len(self._names)
        drawn = 2 ** math.ceil(math.log2(_POINTS * count))
        points = Sample(dict.fromkeys(self._names, ""), drawn).points().tolist()
        best = min(points, key=self._rank)
        if self._rank(best)[1] == math.inf:
            return best, 1, "no case in the ranges has the measure"
        scale = max(abs(x) for _, x in map(self._rank, points) if x < math.inf) or 1.0
        constraint = NonlinearConstraint(self._excess, -np.inf, 0.0)
        options: Any = {"initial_tr_radius": _FIRST, "final_tr_radius": _LAST}
        polished(  # type: ignore[call-overload]
            lambda point: self._estimates(point)[0].value / scale,
            best,
            method="COBYQA",
            bounds=[(0.0, 1.0)] * count,
            constraints=[constraint] if self._bounds else [],
            options=options | {"maxfev": _MOST * count},
        )
        best = self._best()
        if self._rank(best)[0] > 0.0:
            return best, 1, "nothing in the ranges fulfils the conditions"
        for _ in range(_AGAIN):
            before, best = best, self._down_kinks(np.array(best))
            if self._rank(before)[1] - self._rank(best)[1] <= _CLEARLY * scale:
                break
        ends = [n for n, x in zip(self._names, best, strict=True) if min(x, 1.0 - x) <= _AT]
        bound = f", at a bound of {' and '.join(ends)}: beyond it there may be less"
        return best, 0, f"found{bound if ends else ''}"

    def _down_kinks(self, start: Array) -> Point:
        """The best point known after Nelder and Mead's simplex went on from one, within the
        conditions: a peak that is now one, now another has a valley whose floor is a kink, in which
        a quadratic model stops."""
        inward = np.where(start < 0.5, _FIRST, -_FIRST)

        def walled(point: Array) -> float:
            excess, least = self._rank(point)
            return math.inf if excess > 0.0 else least

        polished(
            walled,
            start,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * len(start),
            options={
                "initial_simplex": np.vstack([start, start + np.diag(inward)]),
                "maxfev": _MOST * len(start),
                "xatol": _LAST,
                "fatol": math.inf,
            },
        )
        return self._best()

    def _best(self) -> Point:
        return min(self._asked.known, key=self._rank)

    def _rank(self, point: ArrayLike) -> tuple[float, float]:
        """By how much the conditions are missed, then the measure; infinite where it has none."""
        excess = float(self._excess(point).max(initial=0.0))
        least = self._estimates(point)[0].value
        if math.isnan(excess + least):
            return math.inf, math.inf
        return excess if excess > _SLACK else 0.0, least

    def _excess(self, point: ArrayLike) -> Array:
        """How far each condition is from being fulfilled, over its bound; at most 0 where it is."""
        excess = []
        for (sign, bound), estimate in zip(self._bounds, self._estimates(point)[1:], strict=True):
            beyond = (estimate.value - bound) / (abs(bound) or 1.0)
            excess.append(beyond if sign.startswith("<") else -beyond)
        return np.array(excess)

    def _estimates(self, point: ArrayLike) -> tuple[Estimate, ...]:
        return self._asked.at(*np.clip(point, 0.0, 1.0).tolist())
