"""Gas pressure over the crank angle and over the volume."""

from __future__ import annotations

from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.cylinders import one_curve_each, whose
from crankmbs.figures.style import STYLE, crank_axis, footer, legend, line_of, panels
from crankmbs.figures.view import View
from crankmbs.scene.units import BAR

__all__ = ["indicator_figure"]


@rc_context(STYLE)
def indicator_figure(view: View) -> Figure:
    """Gauge pressure of each cylinder in the last cycle, over the crank angle and, as indicator
    diagram, over the volume that its piston has displaced from the top dead centre."""
    pressure, area = view.values("gas_pressure") / BAR, view.scene.piston.gas_area
    assert area is not None
    volume = view.values("piston_displacement") * area * 1e6
    several = pressure.shape[1] > 1
    figure, axes = panels(1, 2, 13.0, 5.5, ratios=(1.5, 1.0))
    along, drawn = view.drawn(view.along, pressure)
    for group in one_curve_each(pressure):
        k = group[0]
        axes[0].plot(along, drawn[:, k], **line_of(k), label=whose(group) if several else None)
        axes[1].plot(volume[:, k], pressure[:, k], **line_of(k))
    axes[0].set_ylabel("gauge pressure [bar]")
    axes[1].set_ylabel("gauge pressure [bar]")
    axes[1].set_xlabel("volume from top dead centre [cm$^3$]")
    crank_axis(axes[:1], view)
    legend(figure, axes[0])
    footer(figure, view.result, "gas pressure and indicator diagram")
    return figure
