"""Loads of the plain bearings, each in the frame of the body that carries it.

A main shell stands in the engine and a main journal turns with the crank; a crank pin turns with
its throw and a big-end shell swings with its rod. The load on the one is the opposite of that on
the other, seen from another body.
"""

from __future__ import annotations

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.figures.polar import ENGINE, THROW, alike, coinciding, draw_polar
from crankmbs.figures.style import STYLE, footer, one_curve_each, panels, whose
from crankmbs.figures.view import Plane, View

__all__ = ["bearings_figure"]

_CRANK = ("along the crank's reference line", "90 deg ahead of the crank's reference line")
_COLUMNS = 3  # of a legend that is no wider than its panel
_ON_PIN = ", on a shared pin of its first cylinder"
_SEVERAL = "; before a peak the number of its curve"
_ROD = ("along the rod, to the piston pin", "90 deg ahead of the rod")


@rc_context(STYLE)
def bearings_figure(view: View) -> Figure:
    """Loads on main shells and main journals, on big-end shells and crank pins."""
    figure, axes = panels(2, 2, 15.0, 16.0)
    _draw_journals(view, *axes[:2])
    _draw_pins(view, *axes[2:])
    for ax in axes if len(view.scene.cylinders) > 1 else axes[:2]:
        count = len(ax.get_legend_handles_labels()[1])
        columns = -(-count // -(-count // _COLUMNS))
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=columns)
    throws = view.scene.throws
    several = _ON_PIN * (throws is not None and throws.shared) + _SEVERAL
    about = (
        f"bearing loads over the {view.window.kind}; dots: above crank angle [deg], along main "
        f"journal 1, below cycle angle [deg] of cylinder 1{several}"
    )
    exact = view.exactness("main_journal_force", "crank_pin_force")
    footer(figure, view.result, about, exact)
    return figure


def _draw_journals(view: View, shell: Axes, journal: Axes) -> None:
    force = view.force("main_journal_force")
    labels = {group[0]: whose(group, "main journal") for group in _shared(view, force)}
    turning = force * np.exp(-1j * np.radians(view.degrees))[:, None]
    degrees = np.broadcast_to(view.degrees[:, None], force.shape)
    draw_polar(shell, -force, degrees, labels, ENGINE)
    draw_polar(journal, turning, degrees, labels, _CRANK)
    shell.set_title("load on main bearing shells, engine's frame")
    journal.set_title("load on main journals, turning with the crank")


def _shared(view: View, force: Plane) -> list[list[int]]:
    """Journals, counted from 0, of one curve each: those of equal forces at the same crank angle
    or, in a cycle of two turns, one turn on."""
    forces, count = [force], force.shape[1]
    if view.whole:
        period = math.degrees(view.scene.period)
        for later in np.arange(360.0, period - 1.0, 360.0):
            moved = [
                np.interp(view.degrees + later, view.degrees, f, period=period) for f in force.T
            ]
            forces.append(np.stack(moved, axis=1))
    every = np.concatenate(forces, axis=1)
    groups: list[list[int]] = []
    for group in one_curve_each(every.real, every.imag):
        known = {k for members in groups for k in members}
        journals = sorted({k % count for k in group} - known)
        groups += [journals] if journals else []
    return groups


def _draw_pins(view: View, shell: Axes, pin: Axes) -> None:
    force, cycles = view.force("crank_pin_force"), view.cycle_degrees
    swung = force * np.exp(1j * view.values("rod_angle"))
    draw_polar(shell, swung, cycles, alike(view, swung), _ROD)
    shell.set_title("load on big-end shells, swinging with the rod")
    turned = -force * np.exp(-1j * np.radians(cycles))
    labels = alike(view, turned)
    throws = view.scene.throws
    if throws is not None and throws.shared:
        numbers = np.array(throws.numbers)
        count = len(throws.unbalances)
        pins = [turned[:, numbers == throw].sum(axis=1) for throw in range(count)]
        firsts = [throws.numbers.index(throw) for throw in range(count)]
        turned, cycles = np.stack(pins, axis=1), cycles[:, firsts]
        labels = {g[0]: whose(g, "shared pin") for g in coinciding(view, cycles, turned)}
    draw_polar(pin, turned, cycles, labels, THROW)
    pin.set_title("load on crank pins, turning with the throw")
