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
    diagram, over the volume that its piston has displaced from the top dead centre; of
    double-acting cylinders that of both ends, each over its own area times the displacement. The
    area of a loop is the work of a cycle."""
    pistons = [gear.piston for gear in view.scene.running_gear]
    displacement = view.values("piston_displacement")
    ends = {"head end": ("gas_pressure", [piston.gas_area or 0.0 for piston in pistons])}
    if view.scene.double_acting:
        ends["crank end"] = "crank_end_pressure", [piston.crank_end_area for piston in pistons]
    pressures = {end: view.values(name) / BAR for end, (name, _) in ends.items()}
    figure, axes = panels(1, 2, 13.0, 5.5, ratios=(1.5, 1.0))
    for group in one_curve_each(*pressures.values(), displacement):
        for number, (end, pressure) in enumerate(pressures.items()):
            parts = [whose(group)] if pressure.shape[1] > 1 else []
            parts += [end] if len(ends) > 1 else []
            k, line = group[0], line_of(group[0] * len(ends) + number)
            along, drawn = view.drawn(view.along, pressure)
            axes[0].plot(along, drawn[:, k], **line, label=", ".join(parts) or None)
            volume = ends[end][1][k] * displacement[:, k] * 1e6
            axes[1].plot(volume, pressure[:, k], **line)
    axes[0].set_ylabel("gauge pressure [bar]")
    axes[1].set_ylabel("gauge pressure [bar]")
    axes[1].set_xlabel("volume from top dead centre [cm$^3$]")
    crank_axis(axes[:1], view)
    legend(figure, axes[0])
    footer(figure, view.result, "gas pressure and indicator diagram")
    return figure
