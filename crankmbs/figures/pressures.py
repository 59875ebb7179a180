"""Pressure over the swept volume."""

from __future__ import annotations

from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.cylinders import one_curve_each, whose
from crankmbs.figures.style import STYLE, footer, legend, line_of, panels
from crankmbs.figures.view import View
from crankmbs.scene.units import BAR

__all__ = ["pressures_figure"]


@rc_context(STYLE)
def pressures_figure(view: View) -> Figure:
    """Pressure less ambient over the volume that the piston has swept from its top dead centre, in
    the last cycle; of double-acting cylinders that of both ends, each over its own area times the
    displacement. The area of a loop is the work of a cycle."""
    figure, (ax,) = panels(1, 1, 10.0, 6.0)
    displacement, piston = view.values("piston_displacement"), view.scene.piston
    ends = {"head end": ("gas_pressure", piston.gas_area or 0.0)}
    if view.scene.double_acting:
        ends["crank end"] = "crank_end_pressure", piston.crank_end_area
    groups = one_curve_each(*(view.values(name) for name, _ in ends.values()), displacement)
    for group in groups:
        for end, (name, area) in ends.items():
            parts = [whose(group)] if displacement.shape[1] > 1 else []
            parts += [end] if len(ends) > 1 else []
            volume = area * displacement[:, group[0]] * 1e6
            pressure = view.values(name)[:, group[0]] / BAR
            line = line_of(group[0] * len(ends) + list(ends).index(end))
            ax.plot(volume, pressure, **line, label=", ".join(parts) or None)
    ax.set_xlabel("swept volume [cm$^3$]")
    ax.set_ylabel("pressure less ambient [bar]")
    legend(figure, ax)
    footer(figure, view.result, "pressure over volume")
    return figure
