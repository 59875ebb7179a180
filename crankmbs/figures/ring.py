"""A ring that turns at the mean speed around a crank, the crank's lead magnified."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Arc

from crankmbs.numerics.arrays import Array

__all__ = ["RADIUS", "Ring"]

RADIUS = 1.45  # of the crank radius
_TICKS = 24
_BOW = 40  # points of the bow
_COLOUR, _TRACK = "0.1", "0.75"
_LONG, _SHORT = 0.84, 0.94  # of the radius: where the pointer and the other ticks begin


class Ring:
    """Ticks at the mean speed, a pointer where the throw would be, a bow from there to the throw.

    Parameters
    ----------
    radius : of the ring, in the axes' unit; throw : shape (n,) [rad], counter-clockwise from
    upwards; shown : shape (n,) [rad], its lead as it is drawn
    """

    def __init__(self, ax: Axes, radius: float, throw: Array, shown: Array) -> None:
        self._radius, self._throw, self._shown = radius, throw, shown
        track: Any = {"fill": False, "color": _TRACK, "linewidth": 1.0, "zorder": 0}
        ax.add_patch(Arc((0.0, 0.0), 2.0 * radius, 2.0 * radius, **track))
        widths = [4.5, *[1.2] * (_TICKS - 1)]
        self._ticks = LineCollection([], colors=_COLOUR, linewidths=widths, zorder=21)
        ax.add_collection(self._ticks, autolim=False)
        bow: Any = {"color": _COLOUR, "linewidth": 6.0, "zorder": 22}
        (self._bow,) = ax.plot([], [], solid_capstyle="butt", **bow)
        (self._mark,) = ax.plot([], [], "o", color=_COLOUR, markersize=9, zorder=23)

    def move(self, sample: int) -> None:
        """Turn it to where it is at a sample."""
        throw = float(self._throw[sample])
        even = throw - float(self._shown[sample])
        angles = even + np.linspace(0.0, 2.0 * math.pi, _TICKS, endpoint=False, dtype=np.float64)
        inner = np.full((_TICKS, 1), _SHORT)
        inner[0] = _LONG
        outer = self._points(angles)
        self._ticks.set_segments(list(np.stack([inner * outer, outer], axis=1)))
        self._bow.set_data(*self._points(np.linspace(even, throw, _BOW)).T)
        self._mark.set_data(*self._points(np.array([throw])).T)

    def _points(self, angle: Array) -> Array:
        """Points of the ring on paper, shape (n, 2)."""
        return self._radius * np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
