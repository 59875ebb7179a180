"""The orders of torque and frame force as bars, beside their closed forms."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.style import COLOURS, STYLE, footer, legend, panels
from crankmbs.measures import EngineOrders
from crankmbs.result import Result

__all__ = ["orders_figure"]

_WIDTH = 0.18


@rc_context(STYLE)
def orders_figure(result: Result, found: EngineOrders) -> Figure:
    """One panel a quantity: amplitudes of the run, and of inertia at constant speed."""
    figure, axes = panels(len(found.rows), 1, 10.0, 2.6 * len(found.rows))
    for ax, row in zip(axes, found.rows, strict=True):
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
    footer(figure, result, "orders over the last cycle")
    return figure
