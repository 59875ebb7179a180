"""The value of a knob with which a measure is what is wanted: scanned, then polished."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from crankmbs.errors import InputError, shown
from crankmbs.measures import Estimate
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.block import Job, solved
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.knobs import Interval, interval_of
from crankmbs.sweep.reading import Reading, amount_of, check_free, reading_of

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


@dataclass(frozen=True)
class Asked:
    """One number of each case of a scene, asked for value by value."""

    scene: Scene
    names: tuple[str, ...]

    def at(self, values: tuple[float, ...], readings: tuple[Reading, ...]) -> tuple[Estimate, ...]:
        """What is read of a case; NaN where it does not reach its end."""
        block = solved(Job(self.scene, self.names, (values,), False))
        if block.status[0] != 0:
            return (Estimate(math.nan, math.nan),) * len(readings)
        row = {name: column[0] for name, column in block.rows.items()}
        return tuple(reading.of_row(row) for reading in readings)


def asked_of(scene: Scene, text: str, signs: str) -> tuple[Reading, str, float]:
    """A condition such as "fluctuation = 1 %": what is read, the sign, and how much, in SI units.

    signs : those that may stand there

    Raises
    ------
    InputError : no such condition

    >>> asked_of(load_scene("propeller"), "fluctuation <= 1 %", "<= >=")[1:]
    ('<=', 0.01)
    """
    match = _EQUATION.fullmatch(text.strip()) if isinstance(text, str) else None
    if match is None or match[2] not in signs.split():
        raise InputError(
            f'{shown(text)} is no condition: write one such as "fluctuation {signs.split()[0]} 1 %"'
        )
    reading = reading_of(match[1], columns_of(scene, series=False))
    try:
        return reading, match[2], amount_of(match[3], reading)
    except InputError as error:
        raise InputError(f"{match[1]}: {error}") from None


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
    reading, _, amount = asked_of(scene, wanted, "=")
    check_free(scene, reading, [knob.name])
    return _Search(Asked(scene, (knob.name,)), knob, reading, amount).solved()


class _Search:
    """Where a measure of one knob is what is wanted; shares of the way stand for its values."""

    def __init__(self, asked: Asked, knob: Interval, reading: Reading, wanted: float) -> None:
        self._asked, self._knob = asked, knob
        self._reading, self._wanted = reading, wanted
        self._known: dict[float, Estimate] = {}

    def solved(self) -> Solved:
        shares = self._points()
        estimates = [self._estimate(share) for share in shares.tolist()]
        off = np.array([estimate.value for estimate in estimates]) - self._wanted
        roots = [self._root(share) for share in shares[off == 0.0].tolist()]
        for k in np.flatnonzero(off[:-1] * off[1:] < 0.0).tolist():
            root = self._polished(float(shares[k]), float(shares[k + 1]))
            roots += [] if root is None else [root]
        roots.sort(key=lambda root: root.value.value)
        status, message, nearest = 0, f"{len(roots)} found", None
        if not roots:
            status, message = 1, "no value in the range gives this"
            if np.isfinite(off).any():
                k = int(np.nanargmin(np.abs(off)))
                value = Estimate(self._value(float(shares[k])), 0.0)
                nearest = Root(value, estimates[k])
            else:
                message = "no case in the range has the measure"
        scanned = np.array([self._knob.at(shares), off + self._wanted])
        knob = self._knob
        return Solved(
            knob=knob.name,
            units=knob.units,
            measure=self._reading,
            wanted=self._wanted,
            roots=tuple(roots),
            nearest=nearest,
            scanned=scanned,
            status=status,
            message=message,
        )

    def _points(self) -> Array:
        """Evenly spaced shares, and those where the measure turns towards what is wanted."""
        shares = np.linspace(0.0, 1.0, _POINTS)
        off = np.array([self._estimate(share).value for share in shares.tolist()]) - self._wanted
        inner, before, after = off[1:-1], off[:-2], off[2:]
        nearest = np.abs(inner) < np.minimum(np.abs(before), np.abs(after))
        turns = 1 + np.flatnonzero(nearest & (inner * before > 0.0) & (inner * after > 0.0))
        more = [
            self._turn(float(shares[k - 1]), float(shares[k + 1]), float(np.sign(off[k])))
            for k in turns.tolist()
        ]
        return np.unique([*shares, *more])

    def _turn(self, low: float, high: float, side: float) -> float:
        """Where between two shares the measure, on one side of what is wanted, is nearest to it or
        farthest beyond it."""
        turn = minimize_scalar(
            lambda share: np.nan_to_num(side * self._estimate(share).value, nan=math.inf),
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
        except _Missing:
            return None
        root = self._root(share)
        rise = abs(self._off(high) - self._off(low)) / (high - low)
        jumps = abs(root.reached.value - self._wanted) > 1e3 * (_CLOSE * rise + root.reached.error)
        return None if jumps else root

    def _root(self, share: float) -> Root:
        step = 1e-4 if share < 0.5 else -1e-4
        here, near = self._estimate(share), self._estimate(share + step)
        slope = abs(near.value - here.value) / abs(self._value(share + step) - self._value(share))
        span = _CLOSE * abs(self._knob.high - self._knob.low)
        error = here.error / slope + span if slope > 0.0 else math.inf
        return Root(Estimate(self._value(share), error), here)

    def _off(self, share: float) -> float:
        off = self._estimate(share).value - self._wanted
        if math.isnan(off):
            raise _Missing
        return off

    def _estimate(self, share: float) -> Estimate:
        if share not in self._known:
            (self._known[share],) = self._asked.at((self._value(share),), (self._reading,))
        return self._known[share]

    def _value(self, share: float) -> float:
        return float(self._knob.at(np.array(share)))


class _Missing(Exception):
    """A case that has no measure."""
