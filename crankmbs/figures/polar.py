"""Polar load diagrams: the force in a bearing as a curve in the plane.

X points up and Y to the left, so that counter-clockwise on paper is counter-clockwise in the
engine. The force is that of the earlier body on the later one, in the order ground, crank, rod,
piston; the load on the earlier body is its opposite.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from crankmbs.figures.style import (
    STYLE,
    footer,
    force_scale,
    legend,
    line_of,
    mark_points,
    one_curve_each,
    panels,
    whose,
)
from crankmbs.figures.view import Plane, View
from crankmbs.numerics.arrays import Array

__all__ = [
    "ENGINE",
    "THROW",
    "alike",
    "coinciding",
    "crank_pin_figure",
    "draw_polar",
    "main_bearing_figure",
    "piston_pin_figure",
]


_CYLINDER = ("X, from crank to head", "Y, 90 deg ahead of X")
ENGINE = ("engine's X", "engine's Y, 90 deg ahead of X")
THROW = ("radial, outwards along the throw", "tangential, in the sense of +theta")
_STEP = 30  # deg, of what is marked
_APART = 0.08  # of the curve's size: so far marks lie from one another
_GAP, _LINE, _LETTER = 0.04, 0.045, 0.017  # of the axes: to the labels; their height and width


class _Mark(NamedTuple):
    at: complex
    label: str


@rc_context(STYLE)
def main_bearing_figure(view: View) -> Figure:
    """Force of the main bearings on the crank, all cylinders, in the engine's frame."""
    figure, (ax,) = panels(1, 1, 8.0, 8.0)
    draw_polar(ax, view.force("main_bearing_force"), view.degrees, {0: ""}, ENGINE)
    ax.set_title("main bearing: bearing on crank, engine's frame")
    _caption(figure, view, "main bearing", "crank angle")
    return figure


@rc_context(STYLE)
def crank_pin_figure(view: View) -> Figure:
    """Force of the crank on the rod: in the cylinder's frame, and turning with the crank."""
    figure, (fixed, turning) = panels(1, 2, 14.0, 8.0)
    force, cycles = view.force("crank_pin_force"), view.cycle_degrees
    labels = alike(view, force)
    draw_polar(fixed, force, cycles, labels, _CYLINDER)
    fixed.set_title("crank pin: crank on rod, cylinder's frame")
    draw_polar(turning, force * np.exp(-1j * np.radians(cycles)), cycles, labels, THROW)
    turning.set_title("crank pin: crank on rod, turning with the crank")
    _finish(figure, fixed, view, "crank pin")
    return figure


@rc_context(STYLE)
def piston_pin_figure(view: View) -> Figure:
    """Force of the rod on the piston in the cylinder's frame."""
    figure, (ax,) = panels(1, 1, 8.0, 8.0)
    force = view.force("piston_pin_force")
    draw_polar(ax, force, view.cycle_degrees, alike(view, force), _CYLINDER)
    ax.set_title("piston pin: rod on piston, cylinder's frame")
    _finish(figure, ax, view, "piston pin")
    return figure


def alike(view: View, *panels: Plane | Array) -> dict[int, str]:
    """Which cylinders' curves are drawn, and whose each is: those of equal values at the same cycle
    angle coincide.

    panels : shape (n, cylinders), a curve of each cylinder
    """
    return {group[0]: whose(group) for group in coinciding(view, view.cycle_degrees, *panels)}


def coinciding(view: View, degrees: Array, *panels: Plane | Array) -> list[list[int]]:
    """Numbers, from 0, of curves that have equal values at equal angles of their own.

    degrees, panels : shape (n, curves), of each curve
    """
    if not view.whole:
        return [[k] for k in range(degrees.shape[1])]
    period = math.degrees(view.scene.period)

    def beside(values: Array) -> Array:
        pairs = zip(degrees.T, values.T, strict=True)
        return np.stack([np.interp(degrees[:, 0], *pair, period=period) for pair in pairs], axis=-1)

    parts = [part for panel in panels for part in (panel.real, panel.imag)]
    return one_curve_each(*map(beside, parts))


def _finish(figure: Figure, ax: Axes, view: View, joint: str) -> None:
    several = len(view.scene.cylinders) > 1
    if several:
        legend(figure, ax)
    whole = "; of a peak, that of the cylinder before it"
    _caption(figure, view, joint, "cycle angle", f" of cylinder 1{whole}" * several)


def _caption(figure: Figure, view: View, joint: str, angle: str, of: str = "") -> None:
    about = f"{joint} force over the {view.window.kind}; dots: {angle} [deg]{of}"
    exact = view.exactness(f"{joint.replace(' ', '_')}_force")
    footer(figure, view.result, about, exact)


def draw_polar(
    ax: Axes, force: Plane, degrees: Array, labels: dict[int, str], sense: tuple[str, str]
) -> None:
    """Draw curves with a label, and mark the largest force of all and angles along the first.

    force : shape (n, curves); sense : what is upwards, to the left
    degrees : of each curve, shape (n, curves), by the number of which the peak is then named where
        several are drawn; or of all, shape (n,)
    """
    scale, unit = force_scale(force.real, force.imag)
    curves = force / scale
    for k, label in labels.items():
        curve = curves[:, k]
        ax.plot(curve.imag, curve.real, **line_of(k), linewidth=1.8, label=label)
    mark_points(ax)
    ax.axhline(0.0, color="0.55", linewidth=1.0, zorder=1)
    ax.axvline(0.0, color="0.55", linewidth=1.0, zorder=1)
    ax.set_ylabel(f"{sense[0]} [{unit}]")
    ax.set_xlabel(f"{sense[1]} [{unit}]")
    _frame(ax, curves, _marks(curves, labels, degrees))


def _marks(curves: Plane, drawn: Collection[int], degrees: Array) -> list[_Mark]:
    """The largest force of all curves drawn; then, on the first, the samples nearest to every 90
    degrees and to every 30 between them, those that lie apart from all before.

    degrees : shape (n, curves) or (n,), as `draw_polar` takes them; labels are within two turns
    """
    numbered = degrees.ndim > 1 and len(drawn) > 1
    own = np.broadcast_to(degrees.reshape(len(degrees), -1), curves.shape)
    degrees = own[:, 0]
    curve, size = curves[:, 0], np.abs(curves)
    apart = _APART * max(float(np.ptp(curve.real)), float(np.ptp(curve.imag)))
    of = max(drawn, key=lambda k: float(size[:, k].max()))
    peak = int(size[:, of].argmax())
    at = round(float(own[peak, of]), 1) % 720.0
    marks = [_Mark(complex(curves[peak, of]), f"{f'{of + 1}: ' * numbered}peak {at:g}")]
    low, high = float(degrees.min()), float(degrees.max())
    first = math.ceil(low / _STEP - 1e-6) * _STEP
    angles = range(first, min(math.floor(high + 1e-6), first + 719) + 1, _STEP)
    for angle in sorted(angles, key=lambda angle: (angle % 90 != 0, angle)):
        spot = complex(curve[np.argmin(np.abs(degrees - angle))])
        if all(abs(spot - mark.at) > apart for mark in marks):
            marks.append(_Mark(spot, str(angle % 720)))
    return marks


def _frame(ax: Axes, curves: Plane, marks: list[_Mark]) -> None:
    """Limits of equal scales around curve and origin, with the labels in a column on either side.

    The axes fill their place, so the limits of one grow: a box that shrinks needs several layouts.
    """
    (low, high), (bottom, top) = (
        (min(float(part.min()), 0.0), max(float(part.max()), 0.0))
        for part in (curves.imag, curves.real)
    )
    letters = max((len(mark.label) for mark in marks), default=0)
    share = 1.0 - 2.0 * (_GAP + _LETTER * letters)
    span = max((high - low) / share, 1.1 * (top - bottom)) or 1.0
    middle = np.array([0.5 * (low + high), 0.5 * (bottom + top)])
    ax.update_datalim([middle - 0.5 * span, middle + 0.5 * span])
    ax.margins(0.0)
    ax.invert_xaxis()  # Y to the left
    ax.set_aspect("equal", adjustable="datalim")
    weight = 0.5 * (float(curves.imag.min()) + float(curves.imag.max()))
    for side, edge in ((1.0, high), (-1.0, low)):
        column = [mark for mark in marks if (mark.at.imag > weight) == (side > 0.0)]
        _label(ax, column, edge + side * _GAP * span, side, span)


def _label(ax: Axes, marks: list[_Mark], at: float, side: float, span: float) -> None:
    """Write the labels of one side below one another, each joined to its mark by a thin line."""
    ordered = sorted(marks, key=lambda mark: -mark.at.real)
    low, free = ax.get_ylim()
    half = 0.5 * _LINE * span
    joints = []
    for k, mark in enumerate(ordered):
        below = 2.0 * half * (len(ordered) - 1 - k)
        height = max(min(mark.at.real, free - half), low + below + half)
        free = height - half
        joints.append([(mark.at.imag, mark.at.real), (at, height)])
    ax.add_collection(LineCollection(joints, colors="0.4", linewidths=0.7, zorder=3))
    spots = np.array([mark.at for mark in ordered], dtype=complex)
    ax.plot(spots.imag, spots.real, "o", color="black", markersize=6, zorder=4)
    for mark, (_, end) in zip(ordered, joints, strict=True):
        ax.text(
            *end,
            f" {mark.label} ",
            ha="right" if side > 0.0 else "left",
            va="center",
            fontsize=12,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
        )
