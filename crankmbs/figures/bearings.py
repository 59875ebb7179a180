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

from crankmbs.figures.polar import ENGINE, THROW, alike, draw_polar
from crankmbs.figures.style import STYLE, footer, one_curve_each, panels
from crankmbs.figures.view import View
from crankmbs.numerics.arrays import Array

__all__ = ["bearings_figure"]

_CRANK = ("along the crank's reference line", "90 deg ahead of that line")
_ROD = ("along the rod, to the piston pin", "90 deg ahead of the rod")


@rc_context(STYLE)
def bearings_figure(view: View) -> Figure:
    """Loads on main shells and main journals, on big-end shells and crank pins."""
    figure, axes = panels(2, 2, 15.0, 16.0)
    _draw_journals(view, *axes[:2])
    _draw_pins(view, *axes[2:])
    for ax in axes if len(view.scene.cylinders) > 1 else axes[:2]:
        columns = min(len(ax.get_legend_handles_labels()[1]), 4)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=columns)
    above = "above crank angle [deg], on the curve of journal 1"
    below = "below cycle angle of cylinder 1 [deg], on its curve or its pin's"
    footer(figure, view.result, f"marks: {above}; {below}; {view.window.kind}")
    return figure


def _draw_journals(view: View, shell: Axes, journal: Axes) -> None:
    force = _force(view, "main_journal_force")
    labels = {group[0]: _named("journal", group) for group in _shared(view, force)}
    turning = force * np.exp(-1j * np.radians(view.degrees))[:, None]
    draw_polar(shell, _parts(-force), view.degrees, labels, ENGINE)
    draw_polar(journal, _parts(turning), view.degrees, labels, _CRANK)
    shell.set_title("main shells: load, engine's frame")
    journal.set_title("main journals: load, turning with the crank")


def _shared(view: View, force: Array) -> list[list[int]]:
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
    force, cycles = _force(view, "crank_pin_force"), _cycles(view)
    swung = force * np.exp(1j * view.values("rod_angle"))
    curves = _parts(swung)
    draw_polar(shell, curves, cycles[0], alike(view, cycles, *curves), _ROD)
    shell.set_title("big-end shells: load, swinging with the rod")
    turned = -force * np.exp(-1j * np.radians(np.transpose(cycles)))
    curves = _parts(turned)
    labels = alike(view, cycles, *curves)
    throws = view.scene.throws
    if throws is not None and throws.shared:
        count = len(throws.unbalances)
        firsts = [throws.numbers.index(throw) for throw in range(count)]
        turned = np.stack(
            [turned[:, np.array(throws.numbers) == throw].sum(axis=1) for throw in range(count)],
            axis=1,
        )
        curves, cycles = _parts(turned), [cycles[first] for first in firsts]
        labels = {throw: _named("pin", [throw]) for throw in range(count)}
    draw_polar(pin, curves, cycles[0], labels, THROW)
    pin.set_title("crank pins: load of all rods, turning with the throw")


def _cycles(view: View) -> list[Array]:
    return [view.cycle_degrees(k) for k in range(len(view.scene.cylinders))]


def _force(view: View, name: str) -> Array:
    """A force as complex numbers, shape (n, how many)."""
    return np.asarray(view.values(f"{name}_x") + 1j * view.values(f"{name}_y"))


def _parts(force: Array) -> tuple[list[Array], list[Array]]:
    """Upwards and to the left."""
    return list(force.real.T), list(force.imag.T)


def _named(part: str, group: list[int]) -> str:
    return f"{part}{'s' * (len(group) > 1)} {', '.join(str(k + 1) for k in group)}"
