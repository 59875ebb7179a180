"""A cut of the machine that moves: mechanism, ring at mean speed, forces on a body."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Arc

from crankmbs.figures.arrows import Arrows, Force, draw_bar, forces_on, largest
from crankmbs.figures.frames import Frames
from crankmbs.figures.mechanism import Drawing
from crankmbs.figures.outline import Mechanism
from crankmbs.figures.view import View
from crankmbs.numerics.arrays import Array

__all__ = ["Machine", "Ring", "at_frames", "shown_forces"]

RADIUS = 1.45  # of the crank radius
_TICKS = 24
_BOW = 40  # points of the bow
_COLOUR, _TRACK = "0.1", "0.75"
_LONG, _SHORT = 0.84, 0.94  # of the radius: where the pointer and the other ticks begin
_RIM = 0.1  # of the crank radius: room around the ring
_ABOVE = 0.7  # of the crank radius: room above the heads for the gas's arrow


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


class Machine:
    """Some cylinders, movable from frame to frame.

    Parameters
    ----------
    parts : of the whole machine at every frame; cylinders : those drawn, counted from 0
    heat : as of `Drawing`; forces : on the bodies of all drawings, that share one scale
    """

    def __init__(
        self,
        ax: Axes,
        parts: Mechanism,
        cylinders: list[int],
        heat: Array | None,
        frames: Frames,
        forces: list[Force],
    ) -> None:
        pin = parts.crank_pin[:, cylinders[0]]
        radius = float(np.hypot(*pin[0])) * 1e3  # mm, as it is drawn
        newtons = largest(forces)
        acts = newtons > 0.0
        throw = np.arctan2(pin[:, 1], pin[:, 0])
        self._moving: list[Drawing | Ring | Arrows] = [
            Drawing(ax, parts, cylinders, heat, around=RADIUS + _RIM, above=_ABOVE * acts),
            Ring(ax, RADIUS * radius, throw, frames.magnified * frames.leads),
        ]
        if acts:
            acting = [force for force in forces if force.cylinder in (None, *cylinders)]
            self._moving.append(Arrows(ax, acting, radius, newtons))
            if forces[0].cylinder in cylinders:  # once for all drawings
                draw_bar(ax, radius, newtons)

    def move(self, frame: int) -> None:
        """Put everything where it is at a frame."""
        for part in self._moving:
            part.move(frame)


def shown_forces(
    body: str, view: View, frames: Frames, parts: Mechanism, cuts: list[list[int]]
) -> list[Force]:
    """The forces on a body at the frames, linear between samples, of the cylinders that are drawn;
    the bearings' on the crank, all cylinders' together, where all are in one drawing."""
    forces = forces_on(body, view.scene, parts, partial(at_frames, view, frames))
    drawn = [k for cut in cuts for k in cut]
    every = len(cuts) == 1 and len(drawn) == len(view.scene.cylinders)
    return [each for each in forces if every or each.cylinder in drawn]


def at_frames(view: View, frames: Frames, name: str) -> Array:
    """A variable at the frames, linear between samples, shape (n,) or (n, cylinders)."""
    time, values = view.values("time") - view.window.begin, view.values(name)
    rows = [np.interp(frames.time, time, row) for row in np.atleast_2d(values.T)]
    return np.reshape(np.transpose(rows), (-1, *values.shape[1:]))
