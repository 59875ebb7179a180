"""The value of a knob with which a measure is what is wanted: scanned, then polished."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from crankmbs.errors import InputError, at_place, shown
from crankmbs.measures import Estimate
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.block import Job, solved
from crankmbs.sweep.knobs import Interval, interval_of
from crankmbs.sweep.reading import Reading, amount_of, free_reading_of

__all__ = ["Asked", "Root", "Solved", "asked_of", "solve"]

_POINTS = 17  # of the scan
_CLOSE = 1e-9  # of the interval: as near as a root is polished
_TURN = 1e-6  # of the interval: as near as a turn is, where the measure is flat or bends
_EQUATION = re.compile(r"(.*?)\s*(<=|>=|=|<|>)\s*(.*)")


@dataclass(frozen=True)
class Root:
    """A value with which the measure is what is wanted, in SI units.

    value : its error is what that of the measure is worth there
    reached : the measure with it
    """

    value: Estimate
    reached: Estimate


@dataclass(frozen=True)
class Solved:
    """Where a measure is what is wanted.

    knob, units : what was varied; measure : what was wanted, in words; wanted : how much of it
    roots : every crossing between the points of the scan, in their order
    nearest : where there is none, the point of the scan whose measure is nearest, else None
    scanned : shape (2, n), values and measures; NaN where a case has none. Where the measure turns
        towards what is wanted the turn is a point of the scan, too
    status, message : 0 and how many; 1 where there is none
    """

    knob: str
    units: str
    measure: Reading
    wanted: float
    roots: tuple[Root, ...]
    nearest: Root | None
    scanned: Array
    status: int
    message: str


class Asked:
    """What is read of single cases of a scene, each computed once.

    known : shares of the ranges of the knobs -> what was read
    """

    def __init__(
        self, scene: Scene, knobs: tuple[Interval, ...], readings: tuple[Reading, ...]
    ) -> None:
        self._scene, self._knobs, self._readings = scene, knobs, readings
        self.known: dict[tuple[float, ...], tuple[Estimate, ...]] = {}

    def at(self, *shares: float) -> tuple[Estimate, ...]:
        """What is read of a case; NaN where it does not reach its end."""
        if shares not in self.known:
            values = tuple(float(knob.at(x)) for knob, x in zip(self._knobs, shares, strict=True))
            block = solved(Job(self._scene, tuple(knob.name for knob in self._knobs), [values]))
            pairs = [reading.of(block) for reading in self._readings]
            if block["status"][0] != 0:
                pairs = [([math.nan], [math.nan])] * len(pairs)
            self.known[shares] = tuple(Estimate(float(x[0]), float(dx[0])) for x, dx in pairs)
        return self.known[shares]


def asked_of(
    scene: Scene, names: Sequence[str], text: str, signs: str
) -> tuple[Reading, str, float]:
    """A condition such as "fluctuation = 1 %": what is read, the sign, and how much, in SI units.

    names : of what is varied
    signs : those that may stand there

    Raises
    ------
    InputError : no such condition

    >>> asked_of(load_scene("propeller"), ["rod.length"], "fluctuation <= 1 %", "<= >=")[1:]
    ('<=', 0.01)
    """
    match = _EQUATION.fullmatch(text.strip()) if isinstance(text, str) else None
    if match is None or match[2] not in signs.split():
        raise InputError(
            f'{shown(text)} is no condition: write one such as "fluctuation {signs.split()[0]} 1 %"'
        )
    reading = free_reading_of(scene, match[1], names)
    with at_place(match[1]):
        return reading, match[2], amount_of(match[3], reading)


def solve(scene: Scene, vary: dict[str, str], wanted: str) -> Solved:
    """Find the values of a knob with which a measure is what is wanted.

    The range is scanned at 17 points, and wherever the measure turns towards what is wanted without
    reaching it there, the turn is looked for between them; wherever it crosses between two points
    the crossing is polished by Brent's method. Wiggles narrower than the points lie apart are not
    seen: narrow the range for those.

    Parameters
    ----------
    vary : one knob and its range, {"crank.inertia": "0.05..0.5 kg m^2:log"}
    wanted : "fluctuation = 1 %", "peak crank pin force = 20 kN", "side thrust by Grega = 5 %"

    Returns
    -------
    Solved : every root, or the nearest that can be reached

    Raises
    ------
    InputError : no scene, not one range, or no such measure

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> answer = solve(scene, {"crank.inertia": "0.2..0.4 kg m^2"}, "fluctuation = 1 %")
    >>> print(f"{answer.roots[0].value.value:.4f} {answer.units}")
    0.2994 kg m^2
    """
    check_scene(scene)
    if not isinstance(vary, dict) or len(vary) != 1:
        raise InputError(
            'vary must be one name and its range, such as {"crank.inertia": "0.05..0.5 kg m^2"}; '
            f"{shown(vary)} came"
        )
    ((name, text),) = vary.items()
    knob = interval_of(scene, name, text)
    if knob.whole:
        raise InputError(f"{knob.name}: is a whole number, and sweep finds the best of those")
    reading, _, amount = asked_of(scene, [knob.name], wanted, "=")
    return _Search(Asked(scene, (knob,), (reading,)), knob, amount).solved(reading)


class _Search:
    """Where a measure of one knob is what is wanted; shares of the way stand for its values."""

    def __init__(self, asked: Asked, knob: Interval, wanted: float) -> None:
        self._asked, self._knob, self._wanted = asked, knob, wanted

    def solved(self, reading: Reading) -> Solved:
        shares = self._points()
        off = np.array([self._off(share) for share in shares.tolist()])
        roots = [self._root(share) for share in shares[off == 0.0].tolist()]
        for k in np.flatnonzero(off[:-1] * off[1:] < 0.0).tolist():
            root = self._polished(float(shares[k]), float(shares[k + 1]))
            roots += [] if root is None else [root]
        nearest, message = None, f"{len(roots)} found"
        if not roots:
            message = "no case in the range has the measure"
            if np.isfinite(off).any():
                share = float(shares[np.nanargmin(np.abs(off))])
                nearest = Root(Estimate(float(self._knob.at(share)), 0.0), self._reached(share))
                message = "no value in the range gives this"
        return Solved(
            knob=self._knob.name,
            units=self._knob.units,
            measure=reading,
            wanted=self._wanted,
            roots=tuple(sorted(roots, key=lambda root: root.value.value)),
            nearest=nearest,
            scanned=np.array([self._knob.at(shares), off + self._wanted]),
            status=0 if roots else 1,
            message=message,
        )

    def _points(self) -> Array:
        """Evenly spaced shares, and those where the measure turns towards what is wanted."""
        shares = np.linspace(0.0, 1.0, _POINTS)
        off = np.array([self._off(share) for share in shares.tolist()])
        inner, before, after = off[1:-1], off[:-2], off[2:]
        nearest = np.abs(inner) < np.minimum(np.abs(before), np.abs(after))
        turns = 1 + np.flatnonzero(nearest & (inner * before > 0.0) & (inner * after > 0.0))
        more = [self._turn(shares[k - 1], shares[k + 1], np.sign(off[k])) for k in turns.tolist()]
        return np.unique([*shares, *more])

    def _turn(self, low: float, high: float, side: float) -> float:
        """Where between two shares the measure, on one side of what is wanted, is nearest to it or
        farthest beyond it."""
        turn = minimize_scalar(
            lambda share: np.nan_to_num(side * self._off(share), nan=math.inf),
            bounds=(low, high),
            method="bounded",
            options={"xatol": _TURN},
        )
        return float(turn.x)

    def _polished(self, low: float, high: float) -> Root | None:
        """The crossing between two shares; none where a case in between has no measure, or where
        the measure jumps across what is wanted."""
        try:
            share = float(brentq(self._off, low, high, xtol=_CLOSE, rtol=1e-14))
        except ValueError:  # of a NaN
            return None
        root = self._root(share)
        rise = abs(self._off(high) - self._off(low)) / (high - low)
        jumps = abs(self._off(share)) > 1e3 * (_CLOSE * rise + root.reached.error)
        return None if jumps else root

    def _root(self, share: float) -> Root:
        beside = share + (1e-4 if share < 0.5 else -1e-4)
        value, near = float(self._knob.at(share)), float(self._knob.at(beside))
        slope = abs(self._off(beside) - self._off(share)) / abs(near - value)
        span, reached = _CLOSE * abs(self._knob.high - self._knob.low), self._reached(share)
        error = reached.error / slope + span if slope > 0.0 else math.inf
        return Root(Estimate(value, error), reached)

    def _off(self, share: float) -> float:
        return self._reached(share).value - self._wanted

    def _reached(self, share: float) -> Estimate:
        return self._asked.at(share)[0]
