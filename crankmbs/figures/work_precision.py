"""Speed against error: a panel for the state at the end, for the motion and for every reaction."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.figures.style import STYLE, caption, decades, legend, save, tiles
from crankmbs.work_precision import END, MOTION, WorkPrecision

__all__ = ["save_figure", "work_precision_figure"]

_COLUMNS = 3  # panels side by side
_TITLES = {END: "state at the end", MOTION: "motion over the run"}
_COLORS = {"crank_angle": "#D55E00", "minimal": "#0072B2", "multibody": "#009E73"}
_PEERS = ("black", "0.45", "#56B4E9", "#CC79A7", "#E69F00", "#7A5230", "#8A8AC0", "#5B8C5A")
_MARKS = "^vsDPX<>"


def save_figure(outcome: WorkPrecision, folder: Path) -> Path:
    """Draw the figure into work_precision.png, replaced in one move.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(work_precision_figure(outcome), folder / "work_precision.png")


@rc_context(STYLE)
def work_precision_figure(outcome: WorkPrecision) -> Figure:
    """Wall time over relative error: lower and further left is better.

    Grey is below the error that the reference states; what lies there is drawn on its edge.
    """
    names = outcome.quantities
    figure, axes = tiles(len(names), _COLUMNS, (16.0 / _COLUMNS, 5.5))
    styles = _styles(outcome)
    floors = outcome.reference.floors
    errors = [
        max(error, floors[name]) for row in outcome.rows for name, error in row.errors.items()
    ]
    left, right = decades([*errors, *floors.values()])
    limits = decades(row.time for row in outcome.rows)
    for k, ax in enumerate(axes):
        # before anything is drawn, whose own limits may be one point
        ax.set(xscale="log", yscale="log", xlim=(left, min(right, 1.0)), ylim=limits)
        _draw(ax, outcome, names[k], styles)
        if k + _COLUMNS >= len(names):
            ax.set_xlabel("relative error [1]")
        if k % _COLUMNS == 0:
            ax.set_ylabel("wall time [s]")
    legend(figure, axes[0])
    about = "wall time over relative error, lower and further left is better"
    grey = "grey: less than the numerical error of the reference, points are drawn at its edge"
    title = outcome.reference.result.scene.title
    caption(figure, [title, f"{about}; {grey}", *outcome.machine])
    return figure


def _draw(ax: Axes, outcome: WorkPrecision, name: str, styles: dict[str, dict[str, Any]]) -> None:
    floor = outcome.reference.floors[name]
    ax.axvspan(1e-30, floor, color="0.9", zorder=0)
    for contender, rows in outcome.contenders.items():
        points = [(max(row.errors[name], floor), row.time) for row in rows if name in row.errors]
        if points:
            ax.plot(*zip(*points, strict=True), **styles[contender], label=contender)
    ax.set_title(_TITLES.get(name, name), loc="left")


def _styles(outcome: WorkPrecision) -> dict[str, dict[str, Any]]:
    """Formulations in strong lines, dashed for the end only, dotted for a kernel
    alone; peers thin, each with its mark."""
    styles: dict[str, dict[str, Any]] = {}
    peers = 0
    for contender, rows in outcome.contenders.items():
        if rows[0].is_peer:
            k = peers % len(_PEERS)
            styles[contender] = {"color": _PEERS[k], "marker": _MARKS[k], "linewidth": 1.2}
            peers += 1
        else:
            name, _, part = contender.partition(",")
            styles[contender] = {
                "color": _COLORS.get(name, _COLORS["crank_angle"]),
                "marker": "o",
                "linewidth": 2.5,
                "linestyle": {"": "-", " end only": "--"}.get(part, ":"),
                "markerfacecolor": "white" if part else None,
            }
    return styles
