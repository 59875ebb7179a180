"""How far two runs of one scene differ, beside the error that each states."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.compare.confirm import Difference
from crankmbs.figures.style import (
    STYLE,
    decades,
    footer,
    legend,
    line_of,
    one_curve_each,
    save,
    tiles,
    whose,
)
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["difference_figure", "save_differences"]

_COLUMNS = 3  # panels side by side
_ROUNDING = 1e-17  # of the peak: nothing below it is shown


@rc_context(STYLE)
def difference_figure(result: Result, differences: tuple[Difference, ...]) -> Figure:
    """Every difference over the run, relative to the quantity's peak, on one logarithmic scale.

    Cylinders are one curve where they coincide in every panel. What is below a thousandth of the
    largest difference of its panel tells no two apart: near its zeros that is rounding.
    """
    figure, axes = tiles(len(differences), _COLUMNS, (5.0, 2.9))
    shares = [
        value / (row.peak or 1.0)
        for row in differences
        for value in (row.largest[0], *row.errors)
        if value > 0.0
    ]
    low, high = decades(max(share, _ROUNDING) for share in shares or [_ROUNDING])
    drawn = [np.maximum(row.size / (row.peak or 1.0), low) for row in differences]
    several = [sizes for sizes in drawn if sizes.shape[1] > 1]
    groups = one_curve_each(*several) if several else []
    for ax, row, sizes in zip(axes, differences, drawn, strict=True):
        _draw(ax, row, sizes, groups)
        ax.set_ylim(low, high)
    for ax in axes[-_COLUMNS:]:
        ax.set_xlabel("crank angle [rev]")
    figure.supylabel("difference over the peak of the quantity [1]")
    legend(figure, max(axes, key=lambda ax: len(ax.lines)))
    first, second = differences[0].formulations
    about = f"difference between {first} and {second}, beside the numerical error of each"
    footer(figure, result, about)
    return figure


def save_differences(result: Result, differences: tuple[Difference, ...], folder: Path) -> Path:
    """Draw the differences between two runs of a scene into difference.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(difference_figure(result, differences), folder / "difference.png")


def _draw(ax: Axes, row: Difference, sizes: Array, groups: list[list[int]]) -> None:
    peak = row.peak or 1.0
    turned = row.crank_angle / (2.0 * math.pi)
    several = sizes.shape[1] > 1
    for group in groups if several else [[0]]:
        label = whose(group) if several else "difference"
        ax.semilogy(turned, sizes[:, group[0]], **line_of(group[0]), linewidth=1.2, label=label)
    for error, name, dashes in zip(row.errors, row.formulations, (":", "--"), strict=True):
        ax.axhline(
            error / peak, color="black", linestyle=dashes, label=f"numerical error of {name}"
        )
    ax.locator_params(axis="x", nbins=5)
    ax.set_title(row.quantity, loc="left")
