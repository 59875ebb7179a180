"""What the figures draw: the last cycle of a result, its angles in degrees; curves over time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crankmbs.digits import error_digits
from crankmbs.measures import Span, interp, last_span
from crankmbs.measures.span import TURNS_BACK
from crankmbs.mechanics.geometry import dead_centres
from crankmbs.numerics.arrays import Array, Labelled
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["Plane", "View", "error_words", "exactness", "last_view", "over_time"]

_SAME = 0.5  # deg: dead centres closer than this share one line
_THERE = 1e-6  # deg: a cycle that begins so near to where the axis does is drawn in one piece


Plane = NDArray[np.complex128]
"""Forces in a plane: their parts upwards and to the left are real and imaginary."""

_BETWEEN = 1000  # instants between which curves over time are drawn straight


@dataclass(frozen=True)
class View:
    """The last cycle of a result.

    A whole cycle is shown from the cycle angle 0 of cylinder 1, the gas-exchange dead centre of a
    four-stroke, wherever the run ends. Where the crank turns back, curves are over time, as angles
    come again.

    degrees : shape (n,), at its points: crank angle less whole periods
    along : shape (n,), what curves are drawn over: degrees, or time [s]
    low, high [deg, or s] : the stretch of it shown
    over_time : whether curves are drawn over time
    whole : a last cycle, turned through in one sense
    begun [deg] : where such a cycle begins if it is cut at ``low``; None: nothing is cut
    curves : variables over time, with points between the samples; else none
    """

    result: Result
    window: Span
    degrees: Array
    along: Array
    low: float
    high: float
    over_time: bool
    whole: bool
    begun: float | None
    curves: dict[str, Array]

    @property
    def scene(self) -> Scene:
        """The scene of the result."""
        return self.result.scene

    def values(self, name: str) -> Array:
        """A variable over the cycle, shape (n,) or (n, cylinders)."""
        if self.over_time:
            return self.curves[name]
        return self.result.sampled(name)[self.window.first :]

    def force(self, name: str) -> Plane:
        """Forces of a name as complex numbers X + i Y, shape (n, how many)."""
        force = self.values(f"{name}_x") + 1j * self.values(f"{name}_y")
        return force.reshape(len(force), -1)

    def exactness(self, *names: str) -> str:
        """The numerical error of variables in words, as `exactness` has it."""
        return exactness(self.result.variables, *names, first=self.window.first)

    def drawn(self, degrees: Array, values: Array) -> tuple[Array, Array]:
        """Values over crank angles of the cycle [deg], in its order, as a line shows them.

        What lies before ``low`` comes a period later, behind a gap where the run ends: one cycle
        need not end as it began. Both pieces reach the edges of the axis or a sample beyond.
        """
        if self.begun is None:
            return degrees, values
        if degrees[0] > degrees[-1]:
            degrees, values = degrees[::-1], values[::-1]
        late = int(np.searchsorted(degrees, self.low, side="right"))
        begin, end = max(late - 1, 0), late + 1
        gap = np.full((1, *values.shape[1:]), np.nan)
        later = degrees[:end] + (self.high - self.low)
        return (
            np.concatenate([degrees[begin:], [np.nan], later]),
            np.concatenate([values[begin:], gap, values[:end]]),
        )

    def on_axis(self, degrees: Array) -> Array:
        """Where crank angles of the cycle [deg] lie on the axis."""
        if self.begun is None:
            return degrees
        return self.low + np.mod(degrees - self.low, self.high - self.low)

    @property
    def cycle_degrees(self) -> Array:
        """Cycle angle of every cylinder at the samples [deg], shape (n, cylinders)."""
        phases = [math.degrees(cylinder.phase) for cylinder in self.scene.cylinders]
        return np.add.outer(self.degrees, phases)

    def dead_centre_labels(self) -> dict[float, str]:
        """Crank angles [deg] of the dead centres that are shown, and what they are.

        A single cylinder shows both; several show the top ones, named by cylinder number, and which
        of a four-stroke's fires; one that misfires, or gets no fuel, does not. Over time they are
        left out.
        """
        if self.over_time:
            return {}
        centres = [dead_centres(*gear.shape) for gear in self.scene.running_gear]
        cylinders = self.scene.cylinders
        if len(cylinders) == 1:
            (top, bottom), phase = centres[0], cylinders[0].phase
            labels = dict.fromkeys(self._passes(bottom - phase), "BDC")
            for at in self._passes(top - phase):
                labels[at] = "firing TDC" if self._fires(at, 0) else "TDC"
            return labels
        passes = sorted(
            (at, number, self._fires(at, number - 1))
            for number, cylinder in enumerate(cylinders, start=1)
            for at in self._passes(centres[number - 1][0] - cylinder.phase)
        )
        groups: dict[float, dict[int, bool]] = {}
        for at, number, fires in passes:
            last = next(reversed(groups), -math.inf)
            groups.setdefault(last if at - last < _SAME else at, {})[number] = fires
        return {at: _top_centres(group) for at, group in groups.items()}

    def _passes(self, angle: float) -> list[float]:
        first = math.degrees(angle)
        k = np.arange(
            math.ceil((self.low - first) / 360.0 - 1e-9),
            math.floor((self.high - first) / 360.0 + 1e-9) + 1,
        )
        return [float(at) for at in first + 360.0 * k]

    def _fires(self, at: float, cylinder: int) -> bool:
        """Whether a four-stroke's cylinder has combustion at a top dead centre [deg]."""
        gas, phase = self.scene.gas, math.degrees(self.scene.cylinders[cylinder].phase)
        if gas is None or gas.stroke == 2 or not 180.0 < (at + phase) % 720.0 < 540.0:
            return False
        if "fuel" not in self.result.variables:
            return True
        nearest = int(np.argmin(np.abs(self.on_axis(self.degrees) - at)))
        return float(self.values("fuel")[nearest, cylinder]) > 0.0


def _top_centres(fires: dict[int, bool]) -> str:
    """What stands over a top dead centre of several cylinders, by number whether it fires."""
    firing = ", ".join(str(number) for number in sorted(fires) if fires[number])
    numbers = "TDC " + ", ".join(map(str, sorted(fires)))
    return f"{numbers}\n{firing} fires" if firing else numbers


def last_view(result: Result) -> View:
    """The view of a result's last cycle, or of what there is."""
    window = last_span(result)
    angle = result.sampled("crank_angle")[window.first :]
    end = float(angle[-1])
    low, high = sorted((end - window.angle, end))
    in_one_sense = bool(np.all(np.diff(angle) * window.angle >= 0.0))
    if window.kind == "whole run" or not in_one_sense:
        low, high = float(angle.min()), float(angle.max())
    whole = window.kind == "last cycle" and in_one_sense
    period, begun = result.scene.period, None
    if whole:
        zero = -result.scene.cylinders[0].phase
        begin = zero + math.ceil((low - zero) / period - math.radians(_THERE)) * period
        if begin - low > math.radians(_THERE):
            begun = math.degrees((low if window.angle > 0.0 else high) % period)
            low, high = begin, begin + period
    shift = math.floor(low / period + 1e-9) * period
    if low == high:  # the crank stands still
        low, high = low - DEGREE, high + DEGREE
    in_time = window.kind == TURNS_BACK or not in_one_sense
    curves = over_time(result, window.first) if in_time else {}
    degrees = np.degrees(curves.get("crank_angle", angle) - shift)
    along, (low, high) = degrees, map(math.degrees, (low - shift, high - shift))
    if in_time:
        along = curves["time"]
        low, high = float(along[0]), float(along[-1])
    return View(
        result=result,
        window=window,
        degrees=degrees,
        along=along,
        low=low,
        high=high,
        over_time=in_time,
        whole=whole,
        begun=begun,
        curves=curves,
    )


def exactness(variables: Labelled, *names: str, first: int = 0) -> str:
    """The largest numerical error of variables over the peak of each, in words; of a force named
    without its axis the two components count together.

    first : sample from which on they are drawn
    """
    shares = [0.0]
    for name in names:
        rows = [variables[each] for each in (name, f"{name}_x", f"{name}_y") if each in variables]
        peak = max(float(np.max(np.abs(values[first:]))) for _, values, _ in rows)
        if peak > 0.0:
            shares.append(max(float(about["error_estimate"]) for *_, about in rows) / peak)
    return error_words(float(np.max(shares)))


def error_words(share: float) -> str:
    """A numerical error relative to the peak, in words."""
    if not math.isfinite(share):
        return "numerical error unknown"
    return f"numerical error at most {error_digits(100.0 * share)} % of the peak"


def over_time(result: Result, first: int = 0) -> dict[str, Array]:
    """Time [s], crank angle [rad] and the variables of a result from a sample on, by name.

    Samples at equal angles lie far apart in time where the crank turns back. Between them the
    motion is read as it was solved; without it, as of some loaded results, there are samples alone.
    """
    values = {
        name: values[first:] for name, (of, values, _) in result.variables.items() if "time" in of
    }
    if result.motion is None:
        return values
    time = values["time"]
    begin = max(time[0], result.passes.answer.begin)  # of a long run the end is kept
    between = np.linspace(begin, time[-1], _BETWEEN)[1:-1]
    added = interp(result, time=between)
    places = np.searchsorted(time, between)
    return {
        name: np.insert(v, places, added[name].values, axis=0)
        for name, v in values.items()
        if name in added
    }
