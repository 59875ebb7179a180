"""The figures of lesson 5: what shakes and drives engines with several cylinders.

Each takes the limit of its axes, in the unit drawn, so that all frames of a figure have one scale.
"""

from __future__ import annotations

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs import lecture
from crankmbs.figures.mechanism import Drawing
from crankmbs.figures.outline import mechanism
from crankmbs.figures.style import STYLE, crank_axis, legend, line_of, panels
from crankmbs.figures.view import last_view
from crankmbs.lessons.shaking import FRAME
from crankmbs.measures import orders
from crankmbs.result import Result

__all__ = ["force_figure", "polar_figure", "torque_figure"]

_HIGHEST = 6.5  # order drawn


@rc_context(STYLE)
def force_figure(result: Result, limit: float) -> Figure:
    """Over one cycle, with the lectures' first and second order, and the orders as bars."""
    figure, (left, right) = panels(1, 2, 11.0, 4.8, ratios=(1.6, 1.0))
    scene, view = result.scene, last_view(result)
    theta = result.data["crank_angle"].values
    machine = {
        "reciprocating_mass": scene.piston.mass,
        "crank_radius": scene.crank.radius,
        "rod_length": scene.rod.length,
        "omega": float(result.data["crank_speed"].values[0]),
    }
    phi = theta[:, None] + np.array([cylinder.phase for cylinder in scene.cylinders])
    left.axhline(0.0, color="0.55", linewidth=1.0)
    left.plot(
        view.degrees,
        view.values("frame_force_x") * 1e-3,
        color="black",
        linewidth=3.0,
        label="simulated",
    )
    terms = (lecture.first_order_inertia_force, lecture.second_order_inertia_force)
    for k, (name, term) in enumerate(zip(("first", "second"), terms, strict=True)):
        # the lectures count towards the crank, the frame's X towards the head
        part = -np.asarray(term(phi, **machine)).sum(axis=1) * 1e-3
        left.plot(view.degrees, part, **line_of(k), label=f"{name} order, lecture")
    left.set_ylim(-limit, limit)
    crank_axis([left], view)
    left.set_ylabel("force on the frame\ntowards the head [kN]")
    _bars(right, result, "frame_force_x", 1e-3)
    right.set_ylim(0.0, limit)
    right.set_ylabel("amplitude [kN]")
    legend(figure, left)
    return figure


@rc_context(STYLE)
def torque_figure(result: Result, limit: float) -> Figure:
    """Over one cycle, and the orders as bars."""
    figure, (left, right) = panels(1, 2, 11.0, 4.8, ratios=(1.6, 1.0))
    view = last_view(result)
    torque = view.values("crank_torque").sum(axis=1)
    left.axhline(0.0, color="0.55", linewidth=1.0)
    left.plot(view.degrees, torque, **line_of(0), label="all cylinders, simulated")
    mean = np.full_like(view.degrees, orders(result, "crank_torque").mean.sum())
    left.plot(view.degrees, mean, color="0.5", linestyle=(0, (4, 2)), label="mean")
    left.set_ylim(-limit, limit)
    crank_axis([left], view)
    left.set_ylabel("torque on the crank [N m]")
    _bars(right, result, "external_torque", 1.0)  # at constant speed the opposite of all rods'
    right.set_ylim(0.0, 0.5 * limit)
    right.set_ylabel("amplitude [N m]")
    legend(figure, left)
    return figure


def _bars(ax: Axes, result: Result, name: str, scale: float) -> None:
    split = orders(result, name, _HIGHEST)
    ax.bar(split.order, split.amplitude * scale, width=0.36, color=line_of(0)["color"])
    ax.set_xticks(range(7))
    ax.set_xlim(0.0, _HIGHEST)
    ax.set_xlabel("order [1/turn]")


@rc_context(STYLE)
def polar_figure(result: Result, limit: float) -> Figure:
    """The engine, and the force on its frame as a curve in the plane."""
    figure, (left, right) = panels(1, 2, 11.0, 5.0, ratios=(1.0, 1.2))
    Drawing(left, mechanism(result.scene, np.array([0.0, 0.5 * math.pi, math.pi])), [0, 1])
    x, y = (result.data[name].values[:361] * 1e-3 for name in FRAME)
    right.plot(y, x, color="black", linewidth=2.5, label="both pistons, simulated")
    theta = result.data["crank_angle"].values[:361]
    first = []
    for name in FRAME:
        split = orders(result, name)
        at = int(np.argmin(np.abs(split.order - 1.0)))
        first.append(split.amplitude[at] * np.cos(theta + split.phase[at]) * 1e-3)
    right.plot(first[1], first[0], **line_of(1), label="its first order")
    right.set_xlim(limit, -limit)  # Y to the left
    right.set_ylim(-limit, limit)
    right.set_aspect("equal")
    right.set_xlabel("force along Y [kN]")
    right.set_ylabel("force along X, upwards [kN]")
    legend(figure, right)
    return figure
