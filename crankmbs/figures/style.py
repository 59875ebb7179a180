"""One style for all figures: large type, colours that a colour-blind reader tells apart."""

from __future__ import annotations

import io
import math
import re
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np
from matplotlib import rc_context, rcParams
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.image import imsave
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from crankmbs.figures.panel import Panel
from crankmbs.figures.view import View
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.storage.files import write_in_one_move

__all__ = [
    "COLOURS",
    "FLAT",
    "STYLE",
    "caption",
    "crank_axis",
    "decades",
    "drawn",
    "footer",
    "force_scale",
    "grouped",
    "keep_flat",
    "label_contours",
    "legend",
    "line_of",
    "logarithmic",
    "mark_points",
    "one_curve_each",
    "panels",
    "png",
    "save",
    "tiles",
    "whose",
]

T = TypeVar("T")

# Okabe and Ito's palette without its yellow, which is too pale on white
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
_DASHES = ("-", (0, (6, 2)), (0, (6, 2, 1.5, 2)), (0, (2.5, 1.5)))
_GREY = "0.55"
FLAT = 1e-6  # of the mean: what varies less is drawn as constant
_SAME = 1e-3  # of the range of a panel's curves: less than a pixel of it, a fifth of a line
_NO_BREAK = "\N{NO-BREAK SPACE}"
_TOGETHER = re.compile(  # blanks at which a caption has no new line
    r" (?=\[)|(?<=[\[ ]N|kg) (?=m)| (?=\+- )|(?<=\+-) "
    r"|(?<=\d) (?=(?:%|deg|rpm|rad|rev|k?W|k?N|N m|bar|J|kg|m?m|m?s)(?!\w))"
)
_SMALLER = 2  # points: text at the dead centres and of the caption, than the type of the figure
_EDGE = 0.06  # of a panel's side: the room that the label of a contour takes
_FAST = {"compress_level": 3}  # of a PNG: a third less time for a sixth more bytes
_LINE, _LETTER = 1.27, 0.55  # of its size: a line of text, and a letter's width, rather more
_HANDLE = 5.0  # of the type's size: a line in a legend with its gaps

STYLE: Any = {
    "figure.dpi": 150,
    "savefig.dpi": 150,
    "font.size": 13,
    "axes.titlesize": 14,
    "axes.labelsize": 14,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": "0.9",
    "legend.fontsize": 12,
    "legend.framealpha": 0.9,
    "lines.linewidth": 2.0,
    "lines.solid_joinstyle": "round",
    "axes.spines.top": False,
    "axes.spines.right": False,
}


class _Shown(Figure):
    """A figure that a notebook shows, also without pyplot and its global state."""

    def _repr_png_(self) -> bytes:
        return png(self)


def png(figure: Figure, dpi: float | Literal["figure"] = "figure") -> bytes:
    """The figure as the bytes of a PNG file, by default with the figure's dots per inch."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=dpi)
    return file.getvalue()


@rc_context({"text.hinting": "no_hinting"})  # a fifth faster, and at 150 dpi it looks the same
def drawn(figure: Figure) -> Callable[[Path], None]:
    """Draw the figure, once: savefig would draw it twice; what writes it as a PNG file, on another
    thread too."""
    canvas: Any = figure.canvas  # `panels` made it
    canvas.draw()
    pixels = canvas.buffer_rgba()
    return lambda file: imsave(file, pixels, format="png", dpi=figure.dpi, pil_kwargs=_FAST)


def save(figure: Figure, file: Path) -> Path:
    """Write the figure as a PNG file.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    write_in_one_move(file, drawn(figure))
    return file


def panels(
    rows: int, columns: int, width: float, height: float, **ratios: tuple[float, ...]
) -> tuple[Figure, list[Axes]]:
    """A figure [inch] with its axes, row by row; it belongs to no window and no global state.

    ratios : width_ratios of columns, height_ratios of rows to one another; else all are alike
    """
    figure = _Shown(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(
        rows, columns, squeeze=False, subplot_kw={"axes_class": Panel}, gridspec_kw=ratios
    )
    return figure, [axes for row in grid for axes in row]


def tiles(
    count: int, across: int, size: tuple[float, float], least: tuple[float, float] = (0.0, 0.0)
) -> tuple[Figure, list[Axes]]:
    """Panels of one size [inch], so many side by side at most; the figure has a least size."""
    columns = min(count, across)
    rows = -(-count // columns)
    width, height = max(size[0] * columns, least[0]), max(size[1] * rows, least[1])
    figure, axes = panels(rows, columns, width, height)
    for ax in axes[count:]:
        ax.set_visible(False)
    return figure, axes[:count]


def logarithmic(axis: XAxis | YAxis) -> None:
    """Make an axis logarithmic, with plain numbers at 1, 2 and 5 of each decade."""
    getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(lambda value, _: f"{value:g}")


def decades(values: Iterable[float]) -> tuple[float, float]:
    """Whole decades around positive values."""
    logarithms = np.log10([*values])
    return 10.0 ** math.floor(logarithms.min() - 0.1), 10.0 ** math.ceil(logarithms.max() + 0.1)


def label_contours(
    ax: Axes, contours: QuadContourSet, words: Callable[[float], str], fontsize: float
) -> None:
    """Write what each contour is in the middle of what is clear of the panel's edges, where no
    other label stands; limits and scales of the axes must be final."""
    to_axes = ax.transScale + ax.transLimits
    places: list[tuple[float, float]] = []
    occupied: list[Array] = []
    parts = [p for path in contours.get_paths() for p in path.to_polygons(closed_only=False)]
    for line in map(np.asarray, parts):
        points = to_axes.transform(line)
        inside = np.flatnonzero(np.all(np.abs(points - 0.5) < 0.5 - _EDGE, axis=1))
        if len(inside) and np.max(np.ptp(points, axis=0)) > 2.0 * _EDGE:
            k = inside[len(inside) // 2]
            if all(np.max(np.abs(points[k] - other)) > _EDGE for other in occupied):
                occupied.append(points[k])
                places.append((float(line[k, 0]), float(line[k, 1])))
    ax.clabel(contours, manual=places, fmt=words, fontsize=fontsize)


def line_of(cylinder: int) -> dict[str, Any]:
    """Colour and dashes of a cylinder, counted from 0."""
    return {
        "color": COLOURS[cylinder % len(COLOURS)],
        "linestyle": _DASHES[cylinder % len(_DASHES)],  # curves on one another show through
    }


def force_scale(*forces: NDArray[np.float64]) -> tuple[float, str]:
    """Divisor and unit in which forces read well: N or kN."""
    peak = max(float(np.nanmax(np.abs(force), initial=0.0)) for force in forces)
    return (1e3, "kN") if peak >= 1e3 else (1.0, "N")


def crank_axis(axes: list[Axes], view: View) -> int:
    """Give stacked panels one crank-angle axis, with the dead centres marked; a time axis where the
    crank turns back.

    Returns
    -------
    how many lines of text stand above the panels
    """
    for ax in axes:
        mark_points(ax)
        ax.set_xlim(view.low, view.high)
        ax.tick_params(labelbottom=ax is axes[-1])
    if view.over_time:
        axes[-1].set_xlabel(f"time [s], {view.window.kind}")
        return 0
    span = view.high - view.low
    step = next((s for s in (1, 5, 15, 30, 90, 180) if span <= 8.5 * s), 360)
    ticks = np.arange(math.ceil(view.low / step) * step, view.high + 1e-6, step)
    period = round(math.degrees(view.scene.period))
    names = ticks if view.high <= period + 1e-6 else ticks % period  # 0 again where a cycle begins
    labels = view.dead_centre_labels()
    size = _small()
    below = _lines_below(labels, size, span / axes[0].get_window_extent().width)
    for ax in axes:
        ax.set_xticks(ticks, [f"{name:g}" for name in names])
        for at in labels:
            ax.axvline(at, color=_GREY, linewidth=1.0, linestyle=(0, (6, 4)), zorder=1)
    for at, text in labels.items():
        axes[0].annotate(
            text,
            (at, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3 + below[at] * _LINE * size),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=size,
            color="0.35",
        )
    begun = "" if view.begun is None else f", which began at {round(view.begun, 1):g} deg"
    axes[-1].set_xlabel(f"crank angle [deg], {view.window.kind}{begun}")
    return max((below[at] + text.count("\n") + 1 for at, text in labels.items()), default=0)


def _small() -> float:
    return float(rcParams["font.size"]) - _SMALLER


def _lines_below(labels: dict[float, str], size: float, per_pixel: float) -> dict[float, int]:
    """On how many lines a label has to stand, by its angle [deg]: on those of the one before, where
    it would run into it.

    size [points] : of the type; per_pixel : [deg]
    """
    letter = 0.65 * size / 72.0 * STYLE["figure.dpi"] * per_pixel
    below: dict[float, int] = {}
    end, lines = -math.inf, 0  # of the last label that stands on the panel
    for at, text in sorted(labels.items()):
        half = 0.5 * letter * max(map(len, text.split("\n")))
        below[at] = lines if at - half < end else 0
        if below[at] == 0:
            end, lines = at + half, text.count("\n") + 1
    return below


def mark_points(ax: Axes) -> None:
    """Mark the curves that are one point, of a crank at rest: as lines they cannot be seen."""
    for line in ax.lines:
        if not np.any(np.ptp(line.get_xydata(), axis=0)):
            line.set_marker("o")


def keep_flat(ax: Axes, values: Array) -> None:
    """Draw values, in the unit of the axis, as constant where they are but for rounding."""
    mean = abs(float(np.nanmean(values)))
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low <= FLAT * mean:
        margin = 0.01 * mean or 1.0
        ax.set_ylim(low - margin, low + margin)


def legend(figure: Figure, *axes: Axes) -> None:
    """One legend above the panels, out of the way of the curves of these; each label once."""
    found = {
        label: handle
        for ax in axes
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    if found:
        figure.legend(
            [*found.values()],
            [*found],
            loc="outside upper center",
            ncols=_columns([*found], figure),
        )


def _columns(labels: list[str], figure: Figure) -> int:
    """Columns of a legend, filled one by one, that is no wider than its figure."""
    room = figure.get_figwidth() * 72.0 / float(rcParams["legend.fontsize"])
    for rows in range(1, len(labels)):
        columns = [labels[k : k + rows] for k in range(0, len(labels), rows)]
        if sum(_HANDLE + _LETTER * max(map(len, column)) for column in columns) <= room:
            return len(columns)
    return 1


def footer(figure: Figure, result: Result, about: str, exact: str = "") -> None:
    """Say under the figure which run it shows, what of it, over what window, and how exact."""
    by = " (run by exudyn's rigid bodies)" if result.formulation == "multibody" else ""
    ending = f"; {exact}" if exact else ""
    caption(figure, [result.scene.title, f"{about}{by}{ending}"])


def caption(figure: Figure, lines: Iterable[str]) -> None:
    """Write lines under the figure as they are, in a title a $ is no formula; what is wider than
    the figure goes on below, on three lines at most."""
    letters = int(figure.get_figwidth() * 72.0 / (_LETTER * _small()))
    parts = [part for line in lines for part in _wrapped(line, letters)]
    figure.supxlabel("\n".join(parts), fontsize=_small(), color="0.35", parse_math=False)


def _wrapped(text: str, letters: int) -> list[str]:
    """Text on as few lines as fit, of about one length; numbers and names stay with their unit."""
    whole = _TOGETHER.sub(_NO_BREAK, text)
    parts = textwrap.wrap(whole, letters, max_lines=3, placeholder=" ...")
    for width in range(len(whole) // len(parts) if parts else letters, letters):
        even = textwrap.wrap(whole, width)
        if len(even) == len(parts):
            parts = even
            break
    return [part.replace(_NO_BREAK, " ") for part in parts]


def one_curve_each(*panels: Array) -> list[list[int]]:
    """Cylinders, counted from 0, whose curves coincide in every panel.

    panels : each of shape (n, cylinders), any unit

    >>> one_curve_each([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
    [[0, 2], [1]]
    """
    curves = [np.asarray(panel, dtype=np.float64) for panel in panels]

    def coincide(first: int, second: int) -> bool:
        return all(
            bool(np.all(np.abs(panel[:, first] - panel[:, second]) <= _seen(panel)))
            for panel in curves
        )

    return grouped(range(curves[0].shape[1]), coincide)


def grouped(items: Iterable[T], alike: Callable[[T, T], bool]) -> list[list[T]]:
    """Items in their order, each with those before that are like the first of its group."""
    groups: list[list[T]] = []
    for item in items:
        for group in groups:
            if alike(group[0], item):
                group.append(item)
                break
        else:
            groups.append([item])
    return groups


def whose(group: list[int], part: str = "cylinder") -> str:
    """Legend entry of the cylinders, or other parts, of one curve, counted from 0.

    >>> whose([0, 3])
    'cylinders 1, 4'
    """
    numbers = ", ".join(str(k + 1) for k in group)
    return f"{part}{'s' * (len(group) > 1)} {numbers}"


def _seen(panel: Array) -> float:
    """What can be seen of a difference: nothing where the whole panel is drawn as constant."""
    return max(_SAME * float(np.ptp(panel)), FLAT * float(np.max(np.abs(panel))))
