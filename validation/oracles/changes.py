"""What a free crank meets on its way, as the oracle `changing` takes it: loads that set in and end,
functions with kinks, forces on pistons, pressures with and without combustion, decisions.

Everything is made of smooth pieces: functions of one float that go on smoothly beyond their ends.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field

from validation.oracles.firings import Governor
from validation.oracles.machine import Machine, PressurePieces, PressureTable
from validation.oracles.pressure import pressure_pieces

__all__ = [
    "Changes",
    "Curve",
    "Firings",
    "Line",
    "Pull",
    "Push",
    "continued",
    "curve_of",
    "line_through",
    "marks",
]

Smooth = Callable[[float], float]


@dataclass(frozen=True)
class Curve:
    """Over an angle [rad], periodic: piece i, a function of the angle behind knot i, from there."""

    knots: tuple[float, ...]
    pieces: tuple[Smooth, ...]
    period: float

    def at(self, angle: float) -> tuple[Smooth, float, float]:
        """The piece at an angle, where it begins and where it ends [rad]."""
        first = self.knots[0]
        turns = math.floor((angle - first) / self.period) * self.period
        k = bisect_right(self.knots, angle - turns) - 1
        high = self.knots[k + 1] if k + 1 < len(self.knots) else first + self.period
        return self.pieces[k], self.knots[k] + turns, high + turns


@dataclass(frozen=True)
class Line:
    """Over time [s], speed [rad/s] or displacement [m]: one piece more than knots, functions of the
    abscissa."""

    knots: tuple[float, ...]
    pieces: tuple[Smooth, ...]


@dataclass(frozen=True)
class Pull:
    """A load [N m]: the product of what it is over time, speed and angle, and of a smooth function
    of all three.

    It acts from when `after` [s] and `from_speed` [rad/s] have both been met, until `until` or,
    after that, `until_speed`.
    """

    over_time: Line | None = None
    over_speed: Line | None = None
    over_angle: Curve | None = None
    smooth: Callable[[float, float, float], float] | None = None
    after: float = 0.0
    until: float = math.inf
    from_speed: float | None = None
    until_speed: float | None = None


@dataclass(frozen=True)
class Push:
    """A force [N] on pistons, towards the crank: the product of what it is over time, cycle angle
    and displacement from the top dead centre, and of a smooth function of all three and velocity
    towards the crank.

    forward, back : over the displacement, where the piston moves towards the crank and where it
    moves back; cylinder : from 0, None for each; window as that of a `Pull`
    """

    cylinder: int | None = None
    forward: Line | None = None
    back: Line | None = None
    over_angle: Curve | None = None
    over_time: Line | None = None
    smooth: Callable[[float, float, float, float], float] | None = None
    after: float = 0.0
    until: float = math.inf
    from_speed: float | None = None
    until_speed: float | None = None


@dataclass(frozen=True)
class Firings:
    """motored : of each cylinder; part : of cylinder and cycle, both from 1, what misfires and
    scatter leave of a share; window as that of a load, judged at decisions."""

    motored: tuple[Curve, ...]
    part: Callable[[int, int], float]
    governor: Governor | None = None
    after: float = 0.0
    until: float = math.inf
    from_speed: float | None = None
    until_speed: float | None = None


@dataclass(frozen=True)
class Changes:
    """A machine, whose own pressures and loads are not looked at, and what it meets.

    fired : pressure over the cycle angle of each cylinder, none without gas; cycle [rad] : after
    which a cylinder decides again; rings : ring force [N], share of the gas force, viscous [N s/m]
    crank_ends : pressure of each crank end alike, none where cylinders are single-acting
    """

    machine: Machine
    pulls: tuple[Pull, ...]
    fired: tuple[Curve, ...] = ()
    firings: Firings | None = None
    cycle: float = 4.0 * math.pi
    rings: tuple[float, float, float] | None = field(default=None)
    crank_ends: tuple[Curve, ...] = ()
    pushes: tuple[Push, ...] = ()


def curve_of(table: PressureTable | PressurePieces) -> Curve:
    """The curve through the rows of a table."""
    found = pressure_pieces(table)
    rows = found.coefficients.astype(float).tolist()
    knots = tuple(found.knots.astype(float).tolist())
    return Curve(knots, tuple(_cubic(row) for row in rows), float(found.period))


def continued(
    machine: Machine, fired: Curve, cycle: float, polytrope: tuple[float, float, float, float]
) -> Curve:
    """A fired pressure, from an angle on to the true bottom dead centre a polytrope in its place,
    in every cycle.

    polytrope : exponent; the angle, before the true firing dead centre negative [rad]; compression
    ratio; the crankcase's pressure [Pa], which the fired one is counted from
    """
    exponent, closes, ratio, ambient = polytrope
    r, l, e = (float(x) for x in (machine.crank_radius, machine.rod_length, machine.offset))
    knots: list[float] = []
    pieces: list[Smooth] = []
    first = 2.0 * math.pi + math.asin(e / (l + r)) + closes
    last = 3.0 * math.pi + math.asin(e / (l - r))  # crank and rod in one line
    for turn in range(round(fired.period / cycle)):
        begin, end = first + turn * cycle, last + turn * cycle
        piece, low, _ = fired.at(begin + 1e-12)
        pressed = piece(begin - low) + ambient
        size = _volume(machine, begin, ratio)

        def expands(x: float, at: float = begin, p: float = pressed, v: float = size) -> float:
            return float(p * (v / _volume(machine, at + x, ratio)) ** exponent - ambient)

        knots.append(begin)
        pieces.append(expands)
        angle = end
        while angle < begin + cycle - 1e-9:
            piece, low, high = fired.at(angle + 1e-10)
            knots.append(angle)
            pieces.append(_later(piece, angle - low))
            angle = high
    return Curve(tuple(knots), tuple(pieces), fired.period)


def marks(angles: list[float], period: float) -> Curve:
    """A curve without value whose knots are these angles, modulo the period."""
    reduced = sorted({round(angle % period, 12) for angle in angles})
    return Curve(tuple(reduced), (lambda x: 0.0,) * len(reduced), period)


def _volume(machine: Machine, angle: float, ratio: float) -> float:
    """Of a cylinder over its piston's area at a cycle angle [m]."""
    r, l, e = float(machine.crank_radius), float(machine.rod_length), float(machine.offset)
    top, bottom = math.sqrt((l + r) ** 2 - e * e), math.sqrt((l - r) ** 2 - e * e)
    x = r * math.cos(angle) + math.sqrt(l * l - (r * math.sin(angle) - e) ** 2)
    return (top - bottom) / (ratio - 1.0) + top - x


def _cubic(row: list[float]) -> Smooth:
    a, b, c, d = row
    return lambda x: ((d * x + c) * x + b) * x + a


def _later(piece: Smooth, by: float) -> Smooth:
    return lambda x: piece(x + by)


def line_through(x: tuple[float, ...], y: tuple[float, ...], *, held: bool) -> Line:
    """Straight lines through rows; a repeated abscissa is a jump; beyond the ends held, or the last
    line."""
    pieces: list[Smooth] = []
    knots: list[float] = []
    for k in range(len(x) - 1):
        if x[k + 1] == x[k]:
            continue
        slope = (y[k + 1] - y[k]) / (x[k + 1] - x[k])
        knots.append(x[k])
        pieces.append(_straight(x[k], y[k], slope))
    first, last = (_straight(0.0, end, 0.0) for end in (y[0], y[-1]))
    ends = (first, last) if held else (pieces[0], pieces[-1])
    return Line((*knots, x[-1]), (ends[0], *pieces, ends[1]))


def _straight(x: float, y: float, slope: float) -> Smooth:
    return lambda at: y + slope * (at - x)
