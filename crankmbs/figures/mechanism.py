"""The mechanism as matplotlib artists, to scale, X upwards and Y to the left."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon

from crankmbs.figures.outline import Mechanism, mechanism
from crankmbs.figures.style import STYLE, caption, line_of, tiles, whose
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Drawing", "machine_figure", "on_paper", "slices"]

_MM = 1e3
_METAL, _EDGE, _GAS, _ROD = "0.75", "0.25", "#E69F00", "0.6"
_MARGIN = 0.06  # of the drawing's size, around it
_STROKE_WIDTH = 0.14  # of the crank radius: rod and throw
_ACROSS = 6  # cuts in one row


def slices(scene: Scene) -> list[list[int]]:
    """Cylinders, counted from 0, that one cut across the crankshaft shows: one of each bank.

    >>> slices(load_scene("v_twin"))
    [[0, 1]]
    """
    rows: dict[float, list[int]] = {}
    for k, cylinder in enumerate(scene.cylinders):
        rows.setdefault(cylinder.bank, []).append(k)
    depth = max(map(len, rows.values()))
    return [[row[j] for row in rows.values() if j < len(row)] for j in range(depth)]


class Drawing:
    """Some cylinders of a machine on their axes, movable from sample to sample.

    Parameters
    ----------
    parts : of the whole machine at every sample; cylinders : those drawn, counted from 0
    heat : shape (n, cylinders) [1], from 0 to 1, how strongly the gas is coloured; None: not
    around, above : space [crank radii] around the crank's axis, and above the heads for arrows,
        which are seen on grey rods
    """

    def __init__(
        self,
        ax: Axes,
        parts: Mechanism,
        cylinders: list[int],
        heat: Array | None = None,
        *,
        around: float = 1.0 + _STROKE_WIDTH,
        above: float = 0.0,
    ) -> None:
        self._parts, self._heat = parts, heat
        radius = float(np.hypot(*parts.crank_pin[0, cylinders[0]])) * _MM
        _frame(ax, parts, cylinders, radius * around, radius * above)
        width = _points(ax, _STROKE_WIDTH * radius)
        throw: Any = {"color": _EDGE, "linewidth": width, "solid_capstyle": "round"}
        rod: Any = {"linewidth": 0.8 * width, "marker": "o", "markersize": 0.9 * width}
        rod |= {"markerfacecolor": "white", "markeredgewidth": 1.5}
        self._moving: dict[int, tuple[Line2D, Line2D, Polygon, Polygon]] = {}
        ax.add_patch(Circle((0.0, 0.0), radius, fill=False, color="0.7", linestyle=(0, (4, 4))))
        for k in cylinders:
            ax.plot(*on_paper(parts.liner[k]), color=_EDGE, linewidth=2.5, zorder=4)
            corners = np.zeros((4, 2))
            gas = Polygon(corners, facecolor=_GAS, edgecolor="none", alpha=0.0, zorder=1)
            piston = Polygon(corners, facecolor=_METAL, edgecolor=_EDGE, linewidth=1.2, zorder=2)
            ax.add_patch(gas)
            ax.add_patch(piston)
            colour = _ROD if above else line_of(k)["color"]
            (crank,) = ax.plot([], [], **throw, zorder=5)
            (link,) = ax.plot([], [], **rod, color=colour, zorder=6 + k)
            self._moving[k] = crank, link, piston, gas
        ax.plot(0.0, 0.0, "o", color=_EDGE, markersize=1.3 * width, zorder=20)
        self.move(0)

    def move(self, sample: int) -> None:
        """Put every part where it is at a sample."""
        parts = self._parts
        for k, (throw, rod, piston, gas) in self._moving.items():
            pins = np.stack([np.zeros(2), parts.crank_pin[sample, k], parts.piston_pin[sample, k]])
            throw.set_data(*on_paper(pins[:2]))
            rod.set_data(*on_paper(pins[1:]))
            piston.set_xy(np.stack(on_paper(parts.piston[sample, k]), axis=-1))
            gas.set_xy(np.stack(on_paper(parts.gas[sample, k]), axis=-1))
            if self._heat is not None:
                gas.set_alpha(float(self._heat[sample, k]))


def _frame(ax: Axes, parts: Mechanism, cylinders: list[int], edge: float, above: float) -> None:
    """Limits [mm] that hold every position of the cylinders drawn, and what is around them."""
    liners = parts.liner[cylinders]
    walls = liners[:, 1:3] - liners[:, [0, 3]]  # from foot to head
    along = walls / np.linalg.norm(walls, axis=-1, keepdims=True)
    shapes = (parts.piston[:, cylinders], liners, liners[:, 1:3] + above / _MM * along)
    across, up = on_paper(np.concatenate([shape.reshape(-1, 2) for shape in shapes]))
    left, right = min(across.min(), -edge), max(across.max(), edge)
    low, high = min(up.min(), -edge), max(up.max(), edge)
    margin = _MARGIN * max(right - left, high - low)
    ax.set_xlim(left - margin, right + margin)
    ax.set_ylim(low - margin, high + margin)
    ax.set_aspect("equal")
    ax.axis("off")


def _points(ax: Axes, length: float) -> float:
    """A length on the axes [mm] in points, as line widths are given."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()  # the layout decides the scale
    (x0, _), (x1, _) = ax.transData.transform([(0.0, 0.0), (length, 0.0)])
    return float(x1 - x0) * 72.0 / float(figure.dpi)


def on_paper(points: Array) -> tuple[Array, Array]:
    """Points [m] of shape (..., 2) as abscissae and ordinates [mm]."""
    return -points[..., 1] * _MM, points[..., 0] * _MM


@rc_context(STYLE)
def machine_figure(scene: Scene) -> Figure:
    """Crank, rods, pistons and liners at the angle of the start: one drawing for each cylinder, or
    for those of different banks that stand side by side.

    >>> len(machine_figure(load_scene("yi_diesel_free")).axes)
    4
    """
    cuts = slices(scene)
    figure, axes = tiles(len(cuts), _ACROSS, (2.4, 4.0), least=(3.2, 4.0))
    begin = scene.start or scene.motion
    parts = mechanism(scene, [begin.angle if begin is not None else 0.0])
    for ax, cut in zip(axes, cuts, strict=True):
        Drawing(ax, parts, cut)
        if len(scene.cylinders) > 1:
            ax.set_title(whose(cut))
    caption(figure, ["to scale, at the start of the run", "X upwards, Y to the left"])
    return figure
