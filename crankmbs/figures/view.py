"""What the figures draw: the last cycle of a result, its angles in degrees."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.measures import Span, last_span
from crankmbs.mechanics.geometry import dead_centres
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["View", "last_view"]


_SAME = 0.5  # deg: dead centres closer than this share one line


@dataclass(frozen=True)
class View:
    """The last cycle of a result.

    data : its samples; degrees : shape (n,), crank angle less whole periods
    low, high [deg] : the stretch of crank angle shown
    """

    result: Result
    window: Span
    data: xr.Dataset
    degrees: Array
    low: float
    high: float

    @property
    def scene(self) -> Scene:
        """The scene of the result."""
        return self.result.scene

    def values(self, name: str) -> Array:
        """A variable over the cycle, shape (n,) or (n, cylinders)."""
        values: Array = self.data[name].values
        return values

    def cycle_degrees(self, cylinder: int) -> Array:
        """Cycle angle of a cylinder, counted from 0, at the samples [deg]."""
        return self.degrees + math.degrees(self.scene.cylinders[cylinder].phase)

    def dead_centre_labels(self) -> dict[float, str]:
        """Crank angles [deg] of the dead centres that are shown, and what they are.

        A single cylinder shows both; several show the top ones, named by cylinder number, and which
        of a four-stroke's fires; one that misfires, or gets no fuel, does not.
        """
        crank, rod, piston = self.scene.crank, self.scene.rod, self.scene.piston
        top, bottom = dead_centres(crank.radius, rod.length, piston.offset)
        cylinders = self.scene.cylinders
        if len(cylinders) == 1:
            phase = cylinders[0].phase
            labels = dict.fromkeys(self._passes(bottom - phase), "BDC")
            for at in self._passes(top - phase):
                labels[at] = "firing TDC" if self._fires(at, 0) else "TDC"
            return labels
        passes = sorted(
            (at, number, self._fires(at, number - 1))
            for number, cylinder in enumerate(cylinders, start=1)
            for at in self._passes(top - cylinder.phase)
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
        if "fuel" not in self.data:
            return True
        nearest = int(np.argmin(np.abs(self.degrees - at)))
        return float(self.values("fuel")[nearest, cylinder]) > 0.0


def _top_centres(fires: dict[int, bool]) -> str:
    """What stands over a top dead centre of several cylinders, by number whether it fires."""
    firing = ", ".join(str(number) for number in sorted(fires) if fires[number])
    numbers = "TDC " + ", ".join(map(str, sorted(fires)))
    return f"{numbers}\n{firing} fires" if firing else numbers


def last_view(result: Result) -> View:
    """The view of a result's last cycle, or of what there is."""
    window = last_span(result)
    data = result.data.isel(time=slice(window.first, None))
    angle = data["crank_angle"].values
    end = float(angle[-1])
    low, high = sorted((end - window.angle, end))
    if window.kind == "whole run":
        low, high = float(angle.min()), float(angle.max())
    period = result.scene.period
    shift = math.floor(low / period + 1e-9) * period
    if low == high:  # the crank stands still
        low, high = low - DEGREE, high + DEGREE
    return View(
        result=result,
        window=window,
        data=data,
        degrees=np.degrees(angle - shift),
        low=math.degrees(low - shift),
        high=math.degrees(high - shift),
    )
