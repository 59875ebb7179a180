"""The force on the frame as a curve in the plane, before and after balancing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.design import Balance
from crankmbs.figures.style import STYLE, footer, force_scale, legend, line_of, panels, save
from crankmbs.measures import last_span

__all__ = ["balance_figure", "save_balance_figure"]


@rc_context(STYLE)
def balance_figure(balance: Balance) -> Figure:
    """Over the last cycle, X upwards and Y to the left as the engine stands."""
    figure, (ax,) = panels(1, 1, 8.0, 8.0)
    first = last_span(balance.result).first
    paths = {
        "before": balance.before[first:],
        f"after, share {100 * balance.share:g} %": balance.after[first:],
    }
    scale, unit = force_scale(*paths.values())
    for k, (label, path) in enumerate(paths.items()):
        ax.plot(path[:, 1] / scale, path[:, 0] / scale, **line_of(k), label=label)
    most = 1.05 * max(float(np.max(np.abs(path))) for path in paths.values()) / scale or 1.0
    ax.axhline(0.0, color="0.55", linewidth=1.0, zorder=1)
    ax.axvline(0.0, color="0.55", linewidth=1.0, zorder=1)
    ax.set_xlim(most, -most)
    ax.set_ylim(-most, most)
    ax.set_aspect("equal")
    ax.set_xlabel(f"force on the frame along Y [{unit}]")
    ax.set_ylabel(f"force on the frame along X [{unit}]")
    legend(figure, ax)
    footer(figure, balance.result, "force on the frame over the last cycle")
    return figure


def save_balance_figure(balance: Balance, folder: Path) -> Path:
    """Draw the force on the frame before and after balancing into balance.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return save(balance_figure(balance), folder / "balance.png")
