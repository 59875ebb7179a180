"""Quantities over the crank angle: speed, piston motion, forces, torque, pressure."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.figures.cycles import mark_events
from crankmbs.figures.polar import alike
from crankmbs.figures.style import (
    STYLE,
    crank_axis,
    footer,
    force_scale,
    keep_flat,
    legend,
    line_of,
    mark_points,
    one_curve_each,
    panels,
    whose,
)
from crankmbs.figures.view import View, over_time
from crankmbs.measures.peaks import torque_of_rods
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import BAR, RPM

__all__ = [
    "forces_figure",
    "indicator_figure",
    "piston_motion_figure",
    "speed_figure",
    "torque_figure",
]


@rc_context(STYLE)
def speed_figure(view: View) -> Figure:
    """Crank speed over the crank angle in the last cycle; above it the whole run.

    The whole run is shown if it is longer, and over time if that is how it was sampled or the crank
    turns back.
    """
    every = view.scene.run.every
    in_time = view.over_time or (every is not None and every.unit == "s")
    whole = in_time or view.window.first > 0
    last = not (view.over_time and view.window.first == 0)
    figure, axes = panels(whole + last, 1, 10.0, 7.0 if whole and last else 5.0)
    if whole:
        source = over_time(view.result).__getitem__ if in_time else view.result.sampled
        time, angle, speed = map(source, ("time", "crank_angle", "crank_speed"))
        _speed(axes[0], time if in_time else np.degrees(angle) / 360.0, speed)
        axes[0].set_xlabel(f"{'time [s]' if in_time else 'crank angle [rev]'}, whole run")
        mark_events(
            axes[0],
            view.result,
            lambda mark: mark.time if in_time else mark.crank_angle / math.tau,
        )
        mark_points(axes[0])
    if last:
        _speed(axes[-1], *view.drawn(view.along, view.values("crank_speed")))
        crank_axis(axes[-1:], view)
    about = f"crank speed over the {view.window.kind}" + (
        ", above over the whole run" if whole and last else ""
    )
    footer(figure, view.result, about, view.exactness("crank_speed"))
    return figure


@rc_context(STYLE)
def piston_motion_figure(view: View) -> Figure:
    """Piston displacement, velocity and acceleration over the crank angle."""
    figure, axes = panels(3, 1, 10.0, 9.0)
    rows = (
        ("piston_displacement", 1e3, "displacement\nfrom TDC [mm]"),
        ("piston_velocity", 1.0, "velocity towards\nthe crank [m/s]"),
        ("piston_acceleration", 1.0, "acceleration towards\nthe crank [m/s²]"),
    )
    groups = one_curve_each(*(view.values(name) for name, _, _ in rows))
    for ax, (name, scale, label) in zip(axes, rows, strict=True):
        _per_cylinder(ax, view, view.values(name) * scale, groups)
        ax.set_ylabel(label)
    crank_axis(axes, view)
    legend(figure, axes[0])
    about = f"piston motion over the {view.window.kind}"
    footer(figure, view.result, about, view.exactness(*(name for name, _, _ in rows)))
    return figure


@rc_context(STYLE)
def forces_figure(view: View) -> Figure:
    """Gas force, applied force and side force over the crank angle, those that there are."""
    names = {"side_force": ("side force", "side force, wall\non piston, along Y")}
    if view.scene.force:
        names = {"applied_force": ("applied force", "applied force,\ntowards the crank"), **names}
    if view.scene.gas is not None:
        names = {"gas_force": ("gas force", "gas force,\ntowards the crank"), **names}
    figure, axes = panels(len(names), 1, 10.0, 3.5 * len(names))
    groups = one_curve_each(*map(view.values, names))
    for ax, (name, (_, label)) in zip(axes, names.items(), strict=True):
        scale, unit = force_scale(view.values(name))
        _per_cylinder(ax, view, view.values(name) / scale, groups)
        ax.set_ylabel(f"{label} [{unit}]")
    crank_axis(axes, view)
    legend(figure, axes[0])
    forces = " and ".join(force for force, _ in names.values())
    footer(figure, view.result, f"{forces} over the {view.window.kind}", view.exactness(*names))
    return figure


@rc_context(STYLE)
def torque_figure(view: View) -> Figure:
    """Gas and inertia torque of each cylinder and of all, and the torque of drive and loads."""
    figure, (ax,) = panels(1, 1, 10.0, 6.0)
    torque = view.values("crank_torque")
    several, total = torque.shape[1] > 1, torque_of_rods(view.scene)
    degrees, drawn = view.drawn(view.along, torque)
    for group in one_curve_each(torque):
        label = whose(group) if several else total
        width = 1.2 if several else 2.0
        ax.plot(degrees, drawn[:, group[0]], **line_of(group[0]), linewidth=width, label=label)
    if several:
        ax.plot(degrees, drawn.sum(axis=1), color="black", linewidth=2.5, label=total)
    external = view.values("external_torque")
    _, drawn = view.drawn(view.along, external)
    ax.plot(degrees, drawn, color="0.45", linestyle=(0, (5, 2)), label=_cause(view, external))
    ax.set_ylabel("torque on the crank, positive\nin the sense of +theta [N m]")
    crank_axis([ax], view)
    legend(figure, ax)
    exact = view.exactness("crank_torque", "external_torque")
    footer(figure, view.result, f"torque on the crank over the {view.window.kind}", exact)
    return figure


def _cause(view: View, external: Array) -> str:
    """What the torque beside that of gas and inertia is."""
    if view.scene.motion is not None:
        return "drive torque that holds the speed"
    if np.min(external) >= 0.0:
        return "drive torque"
    return "load torque" if np.max(external) <= 0.0 else "load and drive torque"


def _per_cylinder(ax: Axes, view: View, values: Array, groups: list[list[int]]) -> None:
    ax.axhline(0.0, color="0.55", linewidth=1.0)
    degrees, drawn = view.drawn(view.along, values)
    for group in groups:
        label = whose(group) if values.shape[1] > 1 else None
        ax.plot(degrees, drawn[:, group[0]], **line_of(group[0]), label=label)


def _speed(ax: Axes, angle: Array, speed: Array) -> None:
    ax.plot(angle, speed / RPM, **line_of(0))
    ax.set_ylabel("crank speed [rpm]")
    keep_flat(ax, speed / RPM)


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
    over_angle = {group[0]: whose(group) for group in one_curve_each(*pressures.values())}
    over_volume = alike(view, *pressures.values(), *volumes.values())
    figure, axes = panels(1, 2, 13.0, 5.5, width_ratios=(1.5, 1.0))
    for number, (end, pressure) in enumerate(pressures.items()):
        lines = {k: line_of(k * len(ends) + number) for k in range(len(pistons))}
        along, drawn = view.drawn(view.along, pressure)
        for k, cylinders in over_angle.items():
            axes[0].plot(along, drawn[:, k], **lines[k], label=_named(view, cylinders, end))
        for k, cylinders in over_volume.items():
            label = _named(view, cylinders, end)
            axes[1].plot(volumes[end][:, k], pressure[:, k], **lines[k], label=label)
    for ax in axes:
        ax.set_ylabel("gauge pressure [bar]")
    axes[1].set_xlabel("volume displaced from TDC [cm³]")
    crank_axis(axes[:1], view)
    legend(figure, axes[0])
    if over_volume != over_angle:
        axes[1].legend()
    exact = view.exactness(*(name for name, _ in ends.values()), "piston_displacement")
    about = f"gauge pressure and indicator diagram over the {view.window.kind}"
    footer(figure, view.result, about, exact)
    return figure


def _named(view: View, cylinders: str, end: str) -> str | None:
    """Legend entry of a curve: whose it is and of which end, where there are several."""
    parts = [cylinders] if len(view.scene.cylinders) > 1 else []
    parts += [end] if view.scene.double_acting else []
    return ", ".join(parts) or None
