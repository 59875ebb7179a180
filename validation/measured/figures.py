"""Measured and predicted speed over the crank angle, one row a record."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from crankmbs.figures.style import COLOURS, STYLE
from validation.measured.held import Held
from validation.measured.logged import Array

__all__ = ["half_orders_figure", "whole_figure"]

_MEASURED, _PREDICTED, _OTHER = "black", COLOURS[1], COLOURS[0]


def half_orders_figure(
    rows: Sequence[Held],
    others: Sequence[Held],
    names: tuple[str, str],
    places: Array,
    titles: Sequence[str],
) -> Figure:
    """Half orders over one revolution, and what the prediction leaves of them.

    others : the same rows by another delay; names : of both; places : middles of the intervals
        [deg]
    """
    with mpl.rc_context(STYLE):
        figure, axes = _grid(len(rows))
        for row, another, pair, title in zip(rows, others, axes, titles, strict=True):
            mean = row.measured.mean(axis=0)
            pair[0].plot(places, row.mean * row.measured.T, color="0.8", linewidth=0.7)
            pair[0].plot(places, row.mean * mean, color=_MEASURED, linewidth=2.2, label="measured")
            for k, (each, name, colour) in enumerate(
                ((row, names[0], _PREDICTED), (another, names[1], _OTHER))
            ):
                ours = each.predicted.mean(axis=0)
                line = {"color": colour, "linewidth": 1.8, "linestyle": "--" if k else "-"}
                pair[0].plot(places, row.mean * ours, label=name, **line)
                pair[1].plot(places, row.mean * (mean - ours), **line)
                low, high = (row.mean * (mean - ours + s * each.band) for s in (-1.0, 1.0))
                pair[1].fill_between(places, low, high, color=colour, alpha=0.25, linewidth=0.0)
            pair[0].set_ylabel("half orders [rpm]")
            pair[1].set_ylabel("measured less predicted [rpm]")
            pair[0].set_title(title)
            pair[1].set_title("band: 95 % by the scatter of the cycles alone")
        _finish(figure, axes, 360.0, "crank angle behind the first edge after the gap [deg]")
    return figure


def whole_figure(rows: Sequence[Held], places: Array, titles: Sequence[str]) -> Figure:
    """The whole speed of the mean cycle, and its even part, with the wheel's errors taken off."""
    both = np.append(places, places + 360.0)
    with mpl.rc_context(STYLE):
        figure, axes = _grid(len(rows))
        for k, (row, pair, title) in enumerate(zip(rows, axes, titles, strict=True)):
            for values, name, colour, width in (
                (row.whole_measured, "measured, wheel's errors taken off", _MEASURED, 2.2),
                (row.whole_predicted, "predicted", _PREDICTED, 1.8),
            ):
                line = {"color": colour, "linewidth": width}
                pair[0].plot(both, row.mean * values.ravel(), label=name, **line)
                pair[1].plot(places, row.mean * values.mean(axis=0), **line)
            pair[0].set_ylabel("speed less its mean [rpm]")
            pair[1].set_ylabel("even part [rpm]")
            pair[0].set_title(title)
            pair[1].set_title("mean of both revolutions" + (", equal by construction" * (k == 0)))
            pair[1].set_xlim(0.0, 360.0)
        _finish(figure, axes, 720.0, "crank angle behind the first edge after the gap [deg]")
    return figure


def _grid(rows: int) -> tuple[Figure, np.ndarray]:
    figure = Figure(figsize=(15.0, 1.0 + 3.6 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, 2, squeeze=False)


def _finish(figure: Figure, axes: np.ndarray, end: float, label: str) -> None:
    for ax in axes.ravel():
        ax.axhline(0.0, color="0.6", linewidth=0.8)
    column: Axes
    for k, column in enumerate(axes.T):
        for ax in column:  # type: ignore[attr-defined]
            last = end if k == 0 else 360.0
            ax.set_xlim(0.0, last)
            ax.set_xticks(np.arange(0.0, last + 1.0, last / 8.0))
        column[-1].set_xlabel(label)  # type: ignore[index]
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
