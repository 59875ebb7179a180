"""The orders of torque and frame force as bars, beside their closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.style import COLOURS, STYLE, footer, legend, panels, save
from crankmbs.measures import EngineOrders
from crankmbs.mechanics.peaks import negligible
from crankmbs.result import Result

__all__ = ["orders_figure", "save_orders_figure"]

_WIDTH = 0.18  # of an order: two bars side by side leave a gap to the next half order


@rc_context(STYLE)
def orders_figure(result: Result, orders: EngineOrders) -> Figure:
    """One panel a quantity that is more than rounding: amplitudes of the run, and of inertia at
    constant speed."""
    largest = {row.quantity: float(np.max(row.orders.amplitude)) for row in orders.rows}
    zero = negligible(largest, {row.quantity: row.units for row in orders.rows})
    rows = [row for row in orders.rows if row.quantity not in zero]
    figure, axes = panels(len(rows), 1, 10.0, 2.6 * len(rows))
    for ax, row in zip(axes, rows, strict=True):
        order = row.orders.order
        ax.bar(order - 0.5 * _WIDTH, row.orders.amplitude, _WIDTH, color=COLOURS[0], label="run")
        if row.closed is not None:
            closed = np.abs(row.closed)
            label = "closed form, constant speed"
            ax.bar(order + 0.5 * _WIDTH, closed, _WIDTH, color=COLOURS[1], label=label)
        ax.set_xlim(0.0, float(order[-1]) + 0.5)
        ax.set_ylabel(f"{row.quantity}\n[{row.units}]")
    axes[-1].set_xlabel("order [1/revolution]")
    legend(figure, axes[-1])
    figure.align_ylabels(axes)
    nothing = f"; {', '.join(sorted(zero))}: none" if zero else ""
    footer(figure, result, f"orders over the {orders.window.kind}{nothing}")
    return figure


def save_orders_figure(result: Result, orders: EngineOrders, folder: Path) -> Path:
    """Draw the orders of a run into orders.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(orders_figure(result, orders), folder / "orders.png")
