"""What a machine should have: its flywheel, its counterweights, and the orders that they leave."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.digits import error_digits
from crankmbs.figures.polar import ENGINE, draw_polar
from crankmbs.figures.style import (
    COLOURS,
    STYLE,
    footer,
    legend,
    logarithmic,
    panels,
    save,
)
from crankmbs.figures.view import exactness
from crankmbs.measures import EngineOrders, last_span
from crankmbs.mechanics.peaks import negligible
from crankmbs.result import Result

if TYPE_CHECKING:
    from crankmbs.design import Balance, Flywheel

__all__ = [
    "balance_figure",
    "flywheel_figure",
    "orders_figure",
    "save_balance_figure",
    "save_flywheel_figure",
    "save_orders_figure",
]

_NOTHING = 1e-9  # of the crank's inertia
_WIDTH = 0.18  # of an order: two bars side by side leave a gap to the next half order


@rc_context(STYLE)
def balance_figure(balance: Balance) -> Figure:
    """Over the last cycle, in the engine's frame, with marks at every 90 degrees before."""
    figure, (ax,) = panels(1, 1, 8.0, 8.0)
    first = last_span(balance.result).first
    degrees = np.degrees(balance.result.sampled("crank_angle")[first:])
    before, after = (path[first:] @ (1.0, 1j) for path in (balance.before, balance.after))
    labels = {0: "before", 1: "after"}
    draw_polar(ax, np.stack([before, after], axis=1), degrees, labels, ENGINE)
    ax.set_title("frame force, engine's frame")
    legend(figure, ax)
    share = f"{100 * balance.share:g} % of the reciprocating mass"
    about = f"frame force over the last cycle before and after balancing {share}; "
    about += "dots: crank angle [deg]"
    exact = exactness(balance.result.variables, "frame_force", first=first)
    footer(figure, balance.result, about, exact)
    return figure


def save_balance_figure(balance: Balance, folder: Path) -> Path:
    """Draw the force on the frame before and after balancing into balance.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(balance_figure(balance), folder / "balance.png")


@rc_context(STYLE)
def flywheel_figure(wheel: Flywheel, curve: Sequence[tuple[float, float]]) -> Figure:
    """Settled cycles and the textbook's formula over the inertia, and the answer.

    curve : inertia [kg m2] and fluctuation [1] of settled cycles
    """
    figure, (ax,) = panels(1, 1, 9.0, 6.0)
    inertia, fluctuation = zip(*curve, strict=True)
    ax.plot(
        inertia, [100.0 * each for each in fluctuation], color=COLOURS[0], label="settled cycles"
    )
    work, speed = wheel.work.value, wheel.mean_speed.value
    at, percent = wheel.inertia.value, 100.0 * wheel.fluctuation.value
    formula = [100.0 * work / ((each + wheel.moving) * speed**2) for each in inertia]
    dashes = (0, (5, 3))
    ax.plot(inertia, formula, color=COLOURS[1], linestyle=dashes, label="formula W / (J ω²)")
    ax.plot([at], [percent], "o", color="black", label=f"{percent:.4g} % with {at:.4g} kg m²")
    present = at - wheel.added
    if min(inertia) <= present <= max(inertia):
        ax.axvline(present, color="0.55", linewidth=1.0, label=f"the scene's {present:.4g} kg m²")
    for axis in (ax.xaxis, ax.yaxis):
        logarithmic(axis)
    ax.set_xlabel("inertia of crank and flywheel [kg m²]")
    ax.set_ylabel("coefficient of fluctuation [%]")
    legend(figure, ax)
    about = "coefficient of fluctuation of settled cycles over the inertia"
    if wheel.moving > _NOTHING * at:
        about += f"; J includes {wheel.moving:.3g} kg m\u00b2 of rods and pistons"
    exact = f"numerical error of the inertia {error_digits(wheel.inertia.error)} kg m\u00b2"
    footer(figure, wheel.result, about, exact)
    return figure


def save_flywheel_figure(
    wheel: Flywheel, curve: Sequence[tuple[float, float]], folder: Path
) -> Path:
    """Draw the fluctuation over the inertia into flywheel.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(flywheel_figure(wheel, curve), folder / "flywheel.png")


@rc_context(STYLE)
def orders_figure(result: Result, orders: EngineOrders) -> Figure:
    """One panel a quantity that is more than rounding, or the first: amplitudes of the run, and of
    inertia at constant speed."""
    largest = {row.quantity: float(np.max(row.orders.amplitude)) for row in orders.rows}
    zero = negligible(largest, {row.quantity: row.units for row in orders.rows})
    rows = [row for row in orders.rows if row.quantity not in zero] or orders.rows[:1]
    figure, axes = panels(len(rows), 1, 10.0, 2.6 * len(rows))
    for ax, row in zip(axes, rows, strict=True):
        order = row.orders.order
        ax.bar(order - 0.5 * _WIDTH, row.orders.amplitude, _WIDTH, color=COLOURS[0], label="run")
        if row.closed is not None:
            closed = np.abs(row.closed)
            label = "inertia alone, constant speed"
            ax.bar(order + 0.5 * _WIDTH, closed, _WIDTH, color=COLOURS[1], label=label)
        ax.set_xlim(0.0, float(order[-1]) + 0.5)
        ax.set_ylabel(f"{row.quantity}\n[{row.units}]")
    axes[-1].set_xlabel("order [1/revolution]")
    legend(figure, axes[-1])
    nothing = f" ({', '.join(sorted(zero))}: zero but for rounding)" if zero else ""
    shares = [row.orders.error / largest[row.quantity] for row in rows if largest[row.quantity]]
    worst = error_digits(100.0 * max(shares, default=0.0))
    exact = f"numerical error at most {worst} % of the largest"
    about = f"amplitudes of the orders over the {orders.window.kind}{nothing}"
    footer(figure, result, about, exact)
    return figure


def save_orders_figure(result: Result, orders: EngineOrders, folder: Path) -> Path:
    """Draw the orders of a run into orders.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(orders_figure(result, orders), folder / "orders.png")
