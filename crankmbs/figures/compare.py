"""A run against its references, and the causes of the formulas' errors, as slides."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.compare import (
    CAUSES,
    CLOSED_FORM,
    LECTURES,
    OBSERVABLES,
    QUANTITIES,
    REST,
    Budget,
    Comparison,
    Deviation,
    Excerpt,
    Split,
    short_name,
)
from crankmbs.figures.headline import budget_headline, comparison_headline
from crankmbs.figures.slide import SIZE, SLIDE, head
from crankmbs.figures.style import (
    crank_axis,
    footer,
    force_scale,
    grouped,
    legend,
    line_of,
    panels,
    save,
)
from crankmbs.figures.view import error_words, last_view
from crankmbs.numerics.arrays import Array
from crankmbs.storage.files import together

__all__ = ["FAMILIES", "budget_figure", "comparison_figure", "save_validation"]


FAMILIES = {
    "displacement": ("piston displacement",),
    "motion": ("piston velocity", "piston acceleration"),
    "side_thrust": ("side thrust",),
    "rod": ("net force", "rod force"),
    "throw": ("tangential force", "radial force"),
    "torque": ("torque", "gas torque"),
    "piston_pin": ("piston pin force x", "piston pin force y"),
    "crank_pin": ("crank pin force x", "crank pin force y"),
    "main_bearing": ("main bearing force x", "main bearing force y"),
}
"""The quantities that a slide shows, one or two side by side, by its name."""

_SHOWN = {"m": (1e-3, "mm"), "m/s^2": (1.0, "m/s²")}  # unit -> divisor and unit on an axis
_UNTRUNCATED, *_TRUNCATED = LECTURES
_GREGA, _YI = map(short_name, _TRUNCATED)
_SUM = "sum of the causes"
_BY_YI = f"formula of {_YI}"
_ABSENT = 1e-9  # of the error: a peak so small has no percent
_APART = 0.02  # of the larger: curves nearer than this are one line
_UNSEEN = 1e-3  # of the largest of a panel's causes: no line can be told from zero
_STYLES: dict[str, dict[str, Any]] = {
    "run": {"color": "black", "linewidth": 3.0},
    _BY_YI: {"color": "0.5", "linestyle": (0, (4, 2))},
    _SUM: {"color": "0.65", "linewidth": 7.0},
    **{name: line_of(k) for k, name in enumerate((_GREGA, _YI, CLOSED_FORM, _UNTRUNCATED))},
    f"{_GREGA} and {_YI}": line_of(0) | {"color": line_of(2)["color"]},
    **{name: line_of(k) for k, name in enumerate((*CAUSES, REST))},
    "formula": line_of(0),  # what one of the user's own cuts off
}
_USER = 5  # the first line for formulas of the user: dashed, of a colour that no reference has


class _Column(NamedTuple):
    """Of a quantity the run's peak, the curves above and the errors below, by their labels."""

    quantity: str
    peak: float
    curves: dict[str, Array]
    errors: dict[str, Array]


def save_validation(comparison: Comparison, budget: Budget, folder: Path) -> list[Path]:
    """Draw comparison and budget of every family into PNG files, which appear together; what only
    formulas of the user stand for into comparison_formulas.png, their budgets into
    budget_formula_1.png, ... in their order.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    drawn = {}
    for family, quantities in FAMILIES.items():
        drawn[f"comparison_{family}.png"] = comparison_figure(comparison, quantities)
        drawn[f"budget_{family}.png"] = budget_figure(budget, quantities)
    further = tuple(name for name in comparison.simulated if name not in QUANTITIES)
    drawn["comparison_formulas.png"] = comparison_figure(comparison, further)
    users = [split for split in budget.splits if not split.is_lecture]
    for k, split in enumerate(users, start=1):
        figure = budget_figure(budget, (split.quantity,), split.reference)
        drawn[f"budget_formula_{k}.png"] = figure
    files = []
    with together(folder) as part:
        for name, figure in drawn.items():
            if figure is not None:
                save(figure, part / name)
                files.append(folder / name)
    return files


@rc_context(SLIDE)
def comparison_figure(comparison: Comparison, quantities: tuple[str, ...]) -> Figure | None:
    """The error of the truncated lectures and of the user's formulas, in percent of the run's peak,
    below a strip of the run.

    Formulas that cannot be told apart share a curve. The headline is the largest error. None where
    none of the quantities could be compared.
    """
    shown = [name for name in quantities if name in comparison.simulated]
    if not shown:
        return None
    columns = []
    every: list[Deviation] = []
    for name in shown:
        rows = [row for row in comparison.rows if row.quantity == name]
        truncated = [row for row in rows if row.reference not in (CLOSED_FORM, _UNTRUNCATED)]
        every += truncated + [row for row in rows if row.reference == CLOSED_FORM]
        run = {"run": comparison.simulated[name]}
        columns.append(_Column(name, rows[0].peak, run, _errors(truncated or rows)))
    independent = comparison.excerpt.result.formulation == "multibody"
    headline = comparison_headline(every, independent=independent)
    return _figure(comparison.excerpt, columns, headline, "error: formula minus run")


def _errors(rows: list[Deviation]) -> dict[str, Array]:
    """Errors by formula; those that coincide are one curve with both labels."""

    def coincide(first: Deviation, row: Deviation) -> bool:
        return bool(np.max(np.abs(first.error - row.error)) <= _APART * row.size.largest)

    return {
        " and ".join(short_name(row.reference) for row in group): group[0].error
        for group in grouped(rows, coincide)
    }


@rc_context(SLIDE)
def budget_figure(
    budget: Budget, quantities: tuple[str, ...], reference: str | None = None
) -> Figure | None:
    """Formula and run above, below their difference and the causes it is made of.

    reference : the label of a formula of the user; by default the truncated lecture is drawn

    The headline is the largest error in percent of its quantity's peak, and its largest cause. A
    cause that could not be told from zero is not drawn; the footer names those that no panel has.
    None where none of the quantities could be split.
    """
    splits = [
        split
        for split in budget.splits
        if split.quantity in quantities
        and (split.is_lecture if reference is None else split.reference == reference)
    ]
    if not splits:
        return None
    columns = [
        _Column(
            split.quantity,
            split.peak,
            {"run": split.simulated, reference or _BY_YI: split.values},
            {_SUM: split.total.curve, **_seen(split)},
        )
        for split in splits
    ]
    drawn = {label for column in columns for label in column.errors}
    names = [splits[0].heading(cause.name) for cause in splits[0].causes]
    unseen = [name for name in names if name not in drawn]
    about = "error: formula minus run, and its causes"
    if unseen:
        about += f" (too small: {', '.join(unseen)})"
    return _figure(budget.excerpt, columns, budget_headline(splits), about)


def _seen(split: Split) -> dict[str, Array]:
    """The curves of the causes that are worth something, by name."""
    least = _UNSEEN * max(cause.size.largest for cause in split.causes)
    return {
        split.heading(cause.name): cause.curve
        for cause in split.causes
        if split.share(cause) and cause.size.largest >= least
    }


def _figure(
    excerpt: Excerpt,
    columns: list[_Column],
    headline: tuple[str, str],
    about: str,
) -> Figure:
    """A column for each quantity: its curves above, below twice as high its errors in percent of
    the run's peak, one crank-angle axis."""
    n = len(columns)
    labels = dict.fromkeys(
        label for column in columns for label in (*column.curves, *column.errors)
    )
    users = [label for label in labels if label not in _STYLES]
    styles = _STYLES | {label: line_of(_USER + k) for k, label in enumerate(users)}
    if _SUM in labels:  # beside causes, which have all the colours, a formula is drawn as Yi's is
        styles |= dict.fromkeys(users, _STYLES[_BY_YI])
    figure, axes = panels(2, n, *SIZE, height_ratios=(1.0, 2.0))
    view = last_view(excerpt.result)
    degrees = view.degrees[excerpt.samples - excerpt.window.first]
    several = len(excerpt.result.scene.cylinders) > 1
    of_one = several and any(OBSERVABLES[column.quantity].per_cylinder for column in columns)
    for k, (name, peak, curves, errors) in enumerate(columns):
        top, bottom = axes[k], axes[n + k]
        for ax, drawn, whole in ((top, curves, None), (bottom, errors, peak)):
            on_axis = {label: view.drawn(degrees, curve) for label, curve in drawn.items()}
            _panel(ax, name, on_axis, styles, whole)
        above = crank_axis([top, bottom], view)
        symbol = OBSERVABLES[name].symbol
        if n > 1:
            title = f"{name} ${symbol}$" if symbol else name
            top.set_title(title, loc="left", pad=8.0 + 21.0 * above)
    legend(figure, *axes)
    head(figure, headline)
    of = f", cylinder {excerpt.cylinder}" if of_one else ""
    exact = error_words(excerpt.result.error.estimated)
    footer(figure, excerpt.result, f"{about}{of}, over the {view.window.kind}", exact)
    return figure


def _panel(
    ax: Axes,
    quantity: str,
    curves: dict[str, tuple[Array, Array]],
    styles: dict[str, dict[str, Any]],
    peak: float | None,
) -> None:
    """Curves in their unit, or errors in percent of a peak, if there is one."""
    units = OBSERVABLES[quantity].units
    scale, unit = _SHOWN.get(units, (1.0, units))
    if units == "N":
        scale, unit = force_scale(*(curve for _, curve in curves.values()))
    largest = max(float(np.nanmax(np.abs(curve))) for _, curve in curves.values())
    if peak is not None and peak > _ABSENT * largest:
        scale, unit = 0.01 * peak, "% of peak"
    low = min(np.nanmin(curve) for _, curve in curves.values())
    high = max(np.nanmax(curve) for _, curve in curves.values())
    if 2.0 * low - high <= 0.0 <= 2.0 * high - low:  # else the swing of a speed could not be seen
        ax.axhline(0.0, color="0.55", linewidth=1.0)
    for label, (degrees, curve) in curves.items():
        ax.plot(degrees, curve / scale, **styles[label], label=label)
    ax.set_ylabel(f"[{unit}]" if peak is None else f"error [{unit}]")
    # as many ticks whatever the height: the layout leaves room for the numbers that it sees
    ax.locator_params("y", nbins=3 if peak is None else 6)
