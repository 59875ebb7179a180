"""A run whose speed varies strongly, over time: speed and torques, with what happens in it."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.curves import over_time
from crankmbs.figures.cycles import mark_events
from crankmbs.figures.style import COLOURS, STYLE, footer, legend, panels
from crankmbs.result import Result
from crankmbs.scene.units import RPM

__all__ = ["transient_figure", "varies_strongly"]

_STRONGLY = 0.5  # of the highest speed: in a start, a run-up, a run-down, a crank that turns back


def varies_strongly(result: Result) -> bool:
    """Whether the speed of a run covers half of the highest."""
    speed = result.sampled("crank_speed")
    return bool(np.ptp(speed) > _STRONGLY * np.max(np.abs(speed)))


@rc_context(STYLE)
def transient_figure(result: Result) -> Figure:
    """Crank speed, and the torque of gas and inertia beside that of loads and drive, over time."""
    names = "time", "crank_speed", "crank_torque", "external_torque"
    time, speed, torque, outside = map(over_time(result).__getitem__, names)
    figure, axes = panels(2, 1, 10.0, 8.0)
    axes[0].plot(time, speed / RPM, color=COLOURS[0], linewidth=1.2)
    axes[0].set_ylabel("crank speed [rpm]")
    axes[1].plot(time, torque.sum(axis=1), color=COLOURS[4], linewidth=0.6, label="gas and inertia")
    axes[1].plot(time, outside, color=COLOURS[1], linewidth=1.5, label="loads and drive")
    axes[1].set_ylabel("torque on the crank [N m]")
    for ax in axes:
        ax.axhline(0.0, color="0.55", linewidth=1.0)
        ax.tick_params(labelbottom=ax is axes[-1])
    if result.keep is not None:
        mark_events(axes[0], result, result.event_table.values("time"))
    axes[-1].set_xlabel("time [s]")
    legend(figure, axes[1])
    figure.align_ylabels(axes)
    footer(figure, result, "the whole run over time")
    return figure
