"""A run against its references, and the causes of the lectures' errors, over the crank angle."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.compare import (
    CAUSES,
    CLOSED_FORM,
    LECTURES,
    QUANTITIES,
    Budget,
    Comparison,
    Excerpt,
    Split,
)
from crankmbs.figures.style import STYLE, crank_axis, footer, force_scale, line_of, panels
from crankmbs.figures.view import last_view
from crankmbs.numerics.arrays import Array
from crankmbs.storage.files import together

__all__ = ["FAMILIES", "budget_figure", "comparison_figure", "save_validation"]


FAMILIES = {
    "motion": ("piston displacement", "piston velocity", "piston acceleration"),
    "rod": ("net force", "side thrust", "rod force"),
    "throw": ("tangential force", "radial force"),
    "torque": ("torque", "gas torque"),
    "piston_pin": ("piston pin force x", "piston pin force y"),
    "crank_pin": ("crank pin force x", "crank pin force y"),
    "main_bearing": ("main bearing force x", "main bearing force y"),
}
"""The quantities that are drawn side by side, by the name of their figure."""

_SHOWN = {"m": (1e-3, "mm"), "m/s^2": (1.0, "m/s$^2$")}  # unit -> divisor and unit on an axis
_UNSEEN = 1e-3  # of the largest of a panel's causes: no line can be told from zero
_STYLES: dict[str, dict[str, Any]] = {
    "run": {"color": "black", "linewidth": 2.5},
    "lecture": {"color": "0.5", "linestyle": (0, (4, 2))},
    "sum of the causes": {"color": "0.65", "linewidth": 5.0},
    **{name: line_of(k) for k, name in enumerate((CLOSED_FORM, *LECTURES))},
    **{name: line_of(k) for k, name in enumerate(CAUSES)},
}


def save_validation(comparison: Comparison, budget: Budget, folder: Path) -> list[Path]:
    """Draw comparison and budget of every family into PNG files, which appear together.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    files = []
    with together(folder) as part:
        for family, quantities in FAMILIES.items():
            drawn = {
                f"comparison_{family}.png": comparison_figure(comparison, quantities),
                f"budget_{family}.png": budget_figure(budget, quantities),
            }
            for name, figure in drawn.items():
                if figure is not None:
                    figure.savefig(part / name, format="png")
                    files.append(folder / name)
    return files


@rc_context(STYLE)
def comparison_figure(comparison: Comparison, quantities: tuple[str, ...]) -> Figure | None:
    """Run, closed form and truncated lecture above, the error of every reference below.

    None where none of the quantities could be compared.
    """
    shown = [name for name in quantities if name in comparison.simulated]
    if not shown:
        return None
    drawn = {CLOSED_FORM, comparison.references[-1]}  # the last lecture truncates most
    columns = []
    for name in shown:
        rows = [comparison.row(name, reference) for reference in comparison.references]
        above = {row.reference: row.values for row in rows if row.reference in drawn}
        errors = {row.reference: row.error for row in rows}
        columns.append((name, {"run": comparison.simulated[name], **above}, errors))
    return _figure(comparison.excerpt, columns, "formula minus run", "run against formulas")


@rc_context(STYLE)
def budget_figure(budget: Budget, quantities: tuple[str, ...]) -> Figure | None:
    """Truncated lecture and run above, below their difference and the causes it is made of.

    A cause that could not be told from zero is not drawn; the footer names those that no panel has.
    None where none of the quantities could be split.
    """
    splits = [split for split in budget.splits if split.quantity in quantities]
    if not splits:
        return None
    columns = [
        (
            split.quantity,
            {"run": split.simulated, "lecture": split.lecture},
            {"sum of the causes": split.total.curve, **_seen(split)},
        )
        for split in splits
    ]
    drawn = {label for _, _, errors in columns for label in errors}
    unseen = [cause.name for cause in splits[0].causes if cause.name not in drawn]
    about = "error budget of the lecture"
    if unseen:
        about += f" (too small to be seen: {', '.join(unseen)})"
    return _figure(budget.excerpt, columns, "lecture minus run", about)


def _seen(split: Split) -> dict[str, Array]:
    """The curves of the causes that are worth something, by name."""
    least = _UNSEEN * max(cause.size.largest for cause in split.causes)
    return {c.name: c.curve for c in split.causes if split.share(c) and c.size.largest >= least}


def _figure(
    excerpt: Excerpt,
    columns: list[tuple[str, dict[str, Array], dict[str, Array]]],
    below: str,
    about: str,
) -> Figure:
    """A column for each quantity: its curves above, its errors below, one crank-angle axis."""
    n = len(columns)
    figure, axes = panels(2, n, max(9.0, 5.6 * n), 8.0)
    view = last_view(excerpt.result)
    degrees = view.degrees[excerpt.samples - excerpt.window.first]
    several = len(excerpt.result.scene.cylinders) > 1
    of_one = several and any(QUANTITIES[name].per_cylinder for name, _, _ in columns)
    for k, (name, curves, errors) in enumerate(columns):
        top, bottom = axes[k], axes[n + k]
        for ax, drawn, what in ((top, curves, ""), (bottom, errors, f"{below} ")):
            on_axis = {label: view.drawn(degrees, curve) for label, curve in drawn.items()}
            _panel(ax, name, on_axis, what)
        lines = crank_axis([top, bottom], view)
        symbol = QUANTITIES[name].symbol
        top.set_title(f"{name} ${symbol}$" if symbol else name, loc="left", pad=8.0 + 16.0 * lines)
    handles = {
        str(line.get_label()): line
        for ax in axes
        for line in ax.lines
        if str(line.get_label()) in _STYLES
    }
    figure.legend(
        list(handles.values()),
        list(handles),
        loc="outside upper center",
        ncols=-(-len(handles) // -(-len(handles) // int(figure.get_figwidth() / 3.0))),
    )
    footer(figure, excerpt.result, f"{about}, cylinder {excerpt.cylinder}" if of_one else about)
    return figure


def _panel(ax: Axes, quantity: str, curves: dict[str, tuple[Array, Array]], what: str) -> None:
    units = QUANTITIES[quantity].units
    scale, unit = _SHOWN.get(units, (1.0, units))
    if units == "N":
        scale, unit = force_scale(*(curve for _, curve in curves.values()))
    ax.axhline(0.0, color="0.55", linewidth=1.0)
    for label, (degrees, curve) in curves.items():
        ax.plot(degrees, curve / scale, **_STYLES[label], label=label)
    ax.set_ylabel(f"{what}[{unit}]")
