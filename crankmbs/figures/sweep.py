"""A measure over what was varied: curves, filled contours, or small multiples of them."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from crankmbs.digits import error_digits
from crankmbs.display import displayed
from crankmbs.errors import InputError, at_place
from crankmbs.figures.style import COLOURS, STYLE, caption, label_contours, logarithmic, tiles
from crankmbs.numerics.arrays import Array
from crankmbs.sweep.columns import Column
from crankmbs.sweep.reading import Reading, amount_of, reading_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["sweep_figure"]

_ON_AXES = {"1": (0.01, "%"), "N": (1e3, "kN")}  # else as in text
_MOST = 12  # panels
_COLUMNS = 3
_SIZES = (4.6, 4.2), (9.0, 6.5)  # inch: of a panel, and of the smallest figure
_LEVELS = 12
_ROUND = [1, 2, 5, 10]  # steps of ticks and levels, times a power of ten
_CELLS = 500  # along an axis: finer than the points that are drawn


class _Drawn(NamedTuple):
    """What is drawn of a sweep, in the units shown.

    values : over the knobs of a grid, or over the cases; limit : where a line is drawn
    over : another measure alike, as an axis in place of the last knob, and its label
    """

    values: Any
    words: str
    unit: str
    limit: float | None
    over: tuple[Any, str] | None = None


class _Axis(NamedTuple):
    """A knob or a measure as an axis: where its values stand, of a measure over a grid a table, and
    their words where they are no numbers."""

    label: str
    at: Array
    words: list[str]
    log: bool

    def along(self, axis: XAxis | YAxis) -> None:
        axis.set_label_text(self.label)
        if self.words:
            axis.set_ticks(self.at, self.words)
        elif self.log:
            logarithmic(axis)
        else:
            axis.set_major_locator(MaxNLocator(6, steps=_ROUND))


@rc_context(STYLE)
def sweep_figure(
    data: xr.Dataset, show: str, limit: str | None = None, over: str | None = None
) -> Figure:
    """A measure of a sweep over what was varied.

    One knob of a grid with several values gives a curve, two filled contours, more a panel of
    contours for each combination of the others; a sample or list of cases points over each knob.

    Parameters
    ----------
    data : as `crankmbs.load_sweep` reads it
    show : a measure in words, "fluctuation" or "peak crank pin force", or "side thrust by Grega"
    limit : of it, "1 %" or "20 kN", where a line is drawn
    over : another measure, "fluctuation", as the axis in place of the knob that was varied last

    Raises
    ------
    InputError : no such measure, no case that has it, a limit of another unit, too many panels
    """
    data = _varied(data)
    columns = {
        str(name): Column(
            variable.attrs["units"],
            variable.attrs["long_name"],
            {str(dim): () for dim in variable.dims if dim not in data["status"].dims},
        )
        for name, variable in data.data_vars.items()
        if "units" in variable.attrs
    }
    reading = reading_of(show, columns)
    values, error = _of_cases(data, reading)
    scale, unit = _on_axis(reading.about.units)
    with at_place("limit"):
        at = None if limit is None else amount_of(limit, reading) / scale
    drawn = _Drawn(values / scale, reading.words, unit, at)
    if over is not None:
        with at_place("over"):
            measure = reading_of(over, columns)
        size, its_unit = _on_axis(measure.about.units)
        label = f"{measure.words} [{_typeset(its_unit)}]"
        drawn = drawn._replace(over=(_of_cases(data, measure)[0] / size, label))
    knobs = [str(name) for name in values.dims if name in data.coords]
    if len(knobs) > 1:
        figure = _over(data, drawn, knobs)
    else:
        names = knobs or [str(name) for name in data.coords if data[name].dims == ("case",)]
        figure = _over_each(data, drawn, names, joined=bool(knobs))
    figure.suptitle(f"{drawn.words} [{unit}]", fontsize=14)
    missing = int(np.count_nonzero(np.isnan(values.values)))
    lines = [str(data.attrs.get("title", "")), f"{values.size} cases; numerical error at most "]
    lines[1] += f"{error_digits(error / scale)} {unit}"
    lines[1] += f"; without a value: {missing}" if missing else ""
    if at is not None and not np.nanmin(drawn.values) <= at <= np.nanmax(drawn.values):
        lines.append(f"all cases lie on one side of {_amount(drawn)}")
    caption(figure, [line for line in lines if line])
    return figure


def _of_cases(data: xr.Dataset, reading: Reading) -> tuple[xr.DataArray, float]:
    """A measure of every case and the largest of its errors."""
    values, errors = reading.of(data)
    if not np.isfinite(values.values).any():
        raise InputError(f"{reading.words}: no case of this sweep has it")
    return values, float(errors.max())


def _varied(data: xr.Dataset) -> xr.Dataset:
    """The data without the knobs of a grid that have one value only."""
    knobs = [dim for dim in data["status"].dims if dim != "case"]
    alone = [dim for dim in knobs if data.sizes[dim] == 1]
    return data.squeeze(alone if len(alone) < len(knobs) else alone[1:], drop=True)


def _over(data: xr.Dataset, drawn: _Drawn, knobs: list[str]) -> Figure:
    """Filled contours over the first two knobs, a panel for each combination of the others."""
    y, x, *further = knobs

    def by_panel(values: xr.DataArray) -> xr.DataArray:
        stacked = values.stack(panel=further) if further else values.expand_dims("panel")
        return stacked.transpose("panel", y, x)

    tables = by_panel(drawn.values)
    count = tables.sizes["panel"]
    if count > _MOST:
        raise InputError(
            f"{', '.join(further)}: {count} panels are too many; at most {_MOST} are drawn, vary "
            "fewer values beside the first two"
        )
    figure, axes = tiles(count, _COLUMNS, *_SIZES)
    levels = _levels(drawn.values.values)
    across = _axis(data, x)
    for k, ax in enumerate(axes):
        if drawn.over is not None:
            along, label = drawn.over
            across = _measured(by_panel(along).values[k], label)
        panel = drawn._replace(values=tables.values[k])
        filled = _contours(ax, (across, _axis(data, y)), panel, levels)
        if further:
            ax.set_title(_title(data, further, tables["panel"].values[k]), fontsize=11)
    figure.colorbar(filled, ax=axes, ticks=levels)
    return figure


def _contours(ax: Axes, at: tuple[_Axis, _Axis], drawn: _Drawn, levels: Array) -> Any:
    (x, y), table, limit = at, np.ma.masked_invalid(drawn.values), drawn.limit
    grid = np.broadcast_arrays(x.at, y.at[:, None])
    ax.set_facecolor("white")
    ax.grid(visible=False)
    filled = ax.contourf(*grid, table, levels, cmap="viridis")
    inks = ["white" if level < np.mean(levels) else "black" for level in levels]
    lines = ax.contour(*grid, table, levels, colors=inks, linewidths=0.6)
    if limit is not None and levels[0] < limit < levels[-1]:
        ax.contour(*grid, table, [limit], colors=COLOURS[1])
        ax.plot([], [], color=COLOURS[1], label=_amount(drawn))  # beside it, it is cut at an edge
        ax.legend(loc="upper right")
    x.along(ax.xaxis)
    y.along(ax.yaxis)
    label_contours(ax, lines, lambda level: f"{level:.6g}", fontsize=11)
    return filled


def _amount(drawn: _Drawn) -> str:
    """The limit in words."""
    assert drawn.limit is not None
    return f"{drawn.limit:.6g} {drawn.unit}"


def _over_each(data: xr.Dataset, drawn: _Drawn, names: list[str], *, joined: bool) -> Figure:
    """A panel over each knob, or over the measure: a curve where the values of a grid are joined,
    else points."""
    every = [_axis(data, name) for name in names]
    if drawn.over is not None:
        every = [_measured(drawn.over[0].values, drawn.over[1])]
    figure, axes = tiles(len(every), _COLUMNS, *_SIZES)
    for ax, axis in zip(axes, every, strict=True):
        at, values = axis.at, drawn.values.values
        line: Any = {
            "marker": "o" if len(at) < 40 else None,
            "linestyle": "" if axis.words else "-",
        }
        if not joined:
            (at, values), line = _apart(at, values), {"marker": ".", "linestyle": "", "ms": 4}
        ax.plot(at, values, color=COLOURS[0], **line)
        axis.along(ax.xaxis)
        if drawn.limit is not None:
            dashes = (0, (6, 3))
            ax.axhline(drawn.limit, color=COLOURS[1], linestyle=dashes, label=_amount(drawn))
            ax.legend()
    return figure


def _apart(x: Array, y: Array) -> tuple[Array, Array]:
    """Of points that nobody can tell apart in the figure one."""
    there = np.isfinite(y)
    x, y = x[there], y[there]
    across, up = (
        np.floor((values - values.min()) * ((_CELLS - 1) / (float(np.ptp(values)) or 1.0)))
        for values in (x, y)
    )
    first = np.unique(across * _CELLS + up, return_index=True)[1]
    return x[first], y[first]


def _axis(data: xr.Dataset, name: str) -> _Axis:
    values = data[name].values
    scale, unit = _on_axis(str(data[name].attrs.get("units", "")))
    if values.dtype.kind != "f":
        words, at = np.unique(values, return_inverse=True)
        return _Axis(name, at.astype(np.float64), [str(w) for w in words], log=False)
    label = f"{name} [{_typeset(unit)}]" if unit else name.replace("_", " ")
    return _Axis(label, values / scale, [], log=_is_log(values))


def _measured(values: Array, label: str) -> _Axis:
    """A measure as an axis; a case that has none has no value to draw either, and any place."""
    return _Axis(label, np.nan_to_num(values, nan=float(np.nanmin(values))), [], _is_log(values))


def _is_log(values: Array) -> bool:
    """Whether neighbours are farther apart by a factor than by a difference, on the whole."""
    values = np.sort(values[np.isfinite(values)])
    ends = values[[0, len(values) // 2, -1]]
    if len(values) < 3 or ends[0] <= 0.0 or ends[2] < 3.0 * ends[0]:
        return False
    even, by_factor = 0.5 * (ends[0] + ends[2]), math.sqrt(ends[0] * ends[2])
    return bool(abs(ends[1] - by_factor) < abs(ends[1] - even))


def _levels(values: Array) -> Array:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        half = 0.5 * abs(high) or 0.5
        return np.array([low - half, high + half])
    return np.asarray(MaxNLocator(_LEVELS, steps=_ROUND).tick_values(low, high))


def _on_axis(units: str) -> tuple[float, str]:
    """By what an SI value is divided on an axis, and the unit there."""
    return _ON_AXES.get(units) or displayed(units)


def _title(data: xr.Dataset, names: list[str], values: Any) -> str:
    """The values of a panel's knobs, in words."""
    words = []
    for name, value in zip(names, values if isinstance(values, tuple) else [values], strict=True):
        amount = value
        if not isinstance(value, str):
            scale, unit = _on_axis(str(data[name].attrs.get("units", "")))
            amount = f"{float(value) / scale:.4g} {_typeset(unit)}".rstrip()
        words.append(f"{name} {amount}")
    return ", ".join(words)


def _typeset(unit: str) -> str:
    """With its powers raised."""
    return re.sub(r"\^(-?\d)", r"$^{\1}$", unit)
