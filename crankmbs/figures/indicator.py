"""Gas pressure over the crank angle and over the volume."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs.figures.cylinders import one_curve_each, whose
from crankmbs.figures.polar import alike
from crankmbs.figures.style import STYLE, crank_axis, footer, legend, line_of, panels
from crankmbs.figures.view import View
from crankmbs.scene.units import BAR

__all__ = ["indicator_figure"]


@rc_context(STYLE)
def indicator_figure(view: View) -> Figure:
    """Gauge pressure of each cylinder in the last cycle, over the crank angle and, as indicator
    diagram, over the volume that its piston has displaced from the top dead centre; of
    double-acting cylinders that of both ends, each over its area times the displacement. The
    area of a loop is the work of a cycle; cylinders of one loop share it."""
    pistons = [gear.piston for gear in view.scene.running_gear]
    displacement = view.values("piston_displacement")
    ends = {"head end": ("gas_pressure", [piston.gas_area or 0.0 for piston in pistons])}
    if view.scene.double_acting:
        ends["crank end"] = "crank_end_pressure", [piston.crank_end_area for piston in pistons]
    pressures = {end: view.values(name) / BAR for end, (name, _) in ends.items()}
    volumes = {end: 1e6 * displacement * np.array(areas) for end, (_, areas) in ends.items()}
    cycles = [view.cycle_degrees(k) for k in range(len(pistons))]
    loops = [list(values.T) for values in (*pressures.values(), *volumes.values())]
    over_angle = {group[0]: whose(group) for group in one_curve_each(*pressures.values())}
    over_volume = alike(view, cycles, *loops)
    figure, axes = panels(1, 2, 13.0, 5.5, ratios=(1.5, 1.0))
    for number, (end, pressure) in enumerate(pressures.items()):
        lines = {k: line_of(k * len(ends) + number) for k in range(len(pistons))}
        along, drawn = view.drawn(view.along, pressure)
        for k, cylinders in over_angle.items():
            axes[0].plot(along, drawn[:, k], **lines[k], label=_named(view, cylinders, end))
        for k, cylinders in over_volume.items():
            label = _named(view, cylinders, end)
            axes[1].plot(volumes[end][:, k], pressure[:, k], **lines[k], label=label)
    axes[0].set_ylabel("gauge pressure [bar]")
    axes[1].set_ylabel("gauge pressure [bar]")
    axes[1].set_xlabel("volume from top dead centre [cm$^3$]")
    crank_axis(axes[:1], view)
    legend(figure, axes[0])
    if over_volume != over_angle:
        axes[1].legend()
    footer(figure, view.result, "gas pressure and indicator diagram")
    return figure


def _named(view: View, cylinders: str, end: str) -> str | None:
    """Legend entry of a curve: whose it is and of which end, where there are several."""
    parts = [cylinders] if len(view.scene.cylinders) > 1 else []
    parts += [end] if view.scene.double_acting else []
    return ", ".join(parts) or None
