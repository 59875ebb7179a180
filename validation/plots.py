"""The figures of the report: what a lecture gives, the simulated curve on top, the difference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crankmbs.figures.style import STYLE

__all__ = ["Array", "Dots", "Panel", "overlay"]

Array = NDArray[np.float64]

_LECTURE: Any = {"color": "#0072B2", "linewidth": 4.0, "alpha": 0.45}
_SIMULATED: Any = {"color": "#D55E00", "linewidth": 1.6}
_DOTS: Any = {"color": "black", "marker": "o", "markersize": 4.5, "linestyle": ""}
_OPEN: Any = {"marker": "D", "markerfacecolor": "none", "markeredgewidth": 1.2}


@dataclass(frozen=True)
class Dots:
    """Values at single abscissae: what they are, abscissae and values, shape (m,).

    missed : shape (m,), value minus simulated, where the lecture gives points only
    computed : drawn open, not printed by the source but computed from what it prints
    """

    name: str
    abscissae: Array
    values: Array
    missed: Array | None = None
    computed: bool = False


@dataclass(frozen=True)
class Panel:
    """One quantity over the abscissa: label with unit; simulated and lecture shape (n,)."""

    label: str
    simulated: Array
    lecture: Array | None = None
    dots: tuple[Dots, ...] = ()


def overlay(
    abscissa: Array,
    panels: Sequence[Panel],
    title: str,
    names: tuple[str, str] = ("lecture", "simulated"),
    axis: str = "crank angle [deg]",
) -> Figure:
    """Curves one on top of the other, and below each panel lecture minus simulated."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.5, 1.4 + 3.2 * len(panels)), layout="constrained")
        FigureCanvasAgg(figure)
        rows = figure.subplots(
            2 * len(panels), 1, sharex=True, squeeze=False, height_ratios=[3, 1] * len(panels)
        )[:, 0]
        for k, panel in enumerate(panels):
            _draw(rows[2 * k], rows[2 * k + 1], abscissa, panel, names)
        if axis.endswith("[deg]"):
            step = 90 if abscissa[-1] > 400 else 30
            rows[-1].set_xticks(np.arange(0, abscissa[-1] + 1, step))
        rows[-1].set_xlim(abscissa.min(), abscissa.max())
        rows[-1].set_xlabel(axis)
        handles, labels = rows[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3, title=title)
        figure.align_ylabels()
    return figure


def _draw(above: Axes, below: Axes, abscissa: Array, panel: Panel, names: tuple[str, str]) -> None:
    if panel.lecture is not None:
        above.plot(abscissa, panel.lecture, label=names[0], **_LECTURE)
        below.plot(abscissa, panel.lecture - panel.simulated, color="0.25", linewidth=1.5)
    above.plot(abscissa, panel.simulated, label=names[1], **_SIMULATED)
    for dots in panel.dots:
        style = {**_DOTS, **(_OPEN if dots.computed else {})}
        above.plot(dots.abscissae, dots.values, label=dots.name, **style)
        if dots.missed is not None:
            below.plot(dots.abscissae, dots.missed, **style)
            below.axhline(0.0, color="0.6", linewidth=1.0)
    above.set_ylabel(panel.label)
    below.set_ylabel("difference", fontsize=11)
