"""A run as a whole: what changes from cycle to cycle, its speed over time, events."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crankmbs.figures.style import (
    COLOURS,
    STYLE,
    footer,
    force_scale,
    keep_flat,
    legend,
    line_of,
    one_curve_each,
    panels,
    whose,
)
from crankmbs.figures.view import exactness, over_time
from crankmbs.measures.peaks import run_peaks, torque_of_rods
from crankmbs.motion.labels import Table
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.result.event_words import Mark, marks
from crankmbs.scene.units import BAR, RPM

__all__ = ["FEWEST_CYCLES", "cycles_figure", "mark_events", "transient_figure", "varies_strongly"]

FEWEST_CYCLES = 4  # fewer are seen in the figures of the run
_MOST_MARKS = 24  # events that can be told apart in a panel
_LABEL = 0.1  # of a panel's width, what the words of an event take
_HAIR = 1e-9  # of a cycle: an event at its begin or end may be so far outside by rounding
_HEAD = 0.3  # of a panel's height, kept free above the curve for them
_ABOVE = 0.2  # of a panel: room for the labels of two peaks over the curves
_JOINTS = {"main bearing": "main_bearing_force", "crank pin": "crank_pin_force"}
_STRONGLY = 0.5  # of the highest speed: in a start, a run-up, a run-down, a crank that turns back


@rc_context(STYLE)
def cycles_figure(result: Result) -> Figure:
    """Mean, least and largest speed of each cycle and, with gas, the mean effective pressures, as
    steps over the cycles they belong to; the events that lie in one of these at their place in it.
    """
    cycles = result.cycle_table
    number = cycles.values("cycle")
    double = result.scene.double_acting
    ends = {"imep": "head end" * double, "imep_crank_end": "crank end"}
    names = [name for name in ends if name in cycles.variables]
    rows = 2 if names else 1
    figure, axes = panels(rows, 1, 10.0, 3.5 * rows)
    least, largest, mean = (
        cycles.values(f"{name}_speed") / RPM for name in ("least", "largest", "mean")
    )
    edges = np.stack([number - 0.5, number + 0.5], axis=1).ravel()
    between = np.repeat(least, 2), np.repeat(largest, 2)
    band: Any = {"color": COLOURS[4], "alpha": 0.4, "label": "least to largest speed"}
    axes[0].fill_between(edges, *between, **band)
    axes[0].plot(edges, np.repeat(mean, 2), color="black", label="mean speed")
    axes[0].set_ylabel("crank speed [rpm]")
    if names:
        for k, name in enumerate(names):
            imep = cycles.values(name) / BAR
            for group in one_curve_each(imep):
                label = f"{whose(group)} {ends[name]}".rstrip()
                line = line_of(group[0] + k * imep.shape[1])
                axes[1].plot(edges, np.repeat(imep[:, group[0]], 2), **line, label=label)
        keep_flat(axes[1], np.concatenate([cycles.values(name) / BAR for name in names]))
        axes[1].set_ylabel("indicated mean\neffective pressure [bar]")
    mark_events(axes[0], result, lambda mark: _among(mark.time, cycles))
    for ax in axes:
        ax.set_xlim(edges[0], edges[-1])
        ax.locator_params("x", integer=True)
    axes[-1].set_xlabel("cycle")
    legend(figure, *(axes if double or len(result.scene.cylinders) > 1 else axes[:1]))
    drawn = ["mean_speed", "least_speed", "largest_speed", *names]
    about = "crank speed and mean effective pressure" if names else "crank speed"
    footer(figure, result, f"{about}, cycle by cycle", exactness(cycles.variables, *drawn))
    return figure


def _among(time: float, cycles: Table) -> float:
    """Where a time [s] lies on an axis on which cycle n covers n - 1/2 to n + 1/2; NaN in none."""
    begins, durations = cycles.values("time"), cycles.values("duration")
    k = max(int(np.searchsorted(begins, time, side="right")) - 1, 0)
    share = float((time - begins[k]) / durations[k])
    inside = -_HAIR <= share <= 1.0 + _HAIR
    return float(cycles.values("cycle")[k]) - 0.5 + share if inside else math.nan


def mark_events(ax: Axes, result: Result, place: Callable[[Mark], float]) -> None:
    """Thin labelled lines at the first marks of a run, each word at least once; those of one word
    so close that their words would cover one another have one label, which says how many they are.

    place : of a mark, where it stands on the panel's axis
    """
    low, high = ax.get_xlim()
    named = [] if result.keep is None else marks(result)
    words, at = [mark.words for mark in named], [place(mark) for mark in named]
    inside = [k for k in range(len(named)) if low <= at[k] <= high]
    often = {k: [words[j] for j in inside if j < k].count(words[k]) for k in inside}
    shown = sorted(sorted(inside, key=often.__getitem__)[:_MOST_MARKS])  # each word at least once
    if shown:
        bottom, top = ax.get_ylim()
        ax.set_ylim(bottom, top + _HEAD * (top - bottom))
    groups: list[list[int]] = []
    for k in shown:
        ax.axvline(at[k], color="0.35", linewidth=0.9, linestyle=":", zorder=1)
        before = next((group for group in reversed(groups) if words[group[0]] == words[k]), None)
        if before and abs(at[before[-1]] - at[k]) < _LABEL * (high - low):
            before.append(k)
        else:
            groups.append([k])
    for number, group in enumerate(groups):
        first = at[group[0]]
        left = first > high - _LABEL * (high - low)
        ax.annotate(
            words[group[0]] + (f", {len(group)} times" if len(group) > 1 else ""),
            (first, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(-2 if left else 2, -12 * (1 + number % 4)),
            textcoords="offset points",
            horizontalalignment="right" if left else "left",
            fontsize=9,
            color="0.35",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
        )


def varies_strongly(result: Result) -> bool:
    """Whether the speed of a run covers half of the highest."""
    speed = result.sampled("crank_speed")
    return bool(np.ptp(speed) > _STRONGLY * np.max(np.abs(speed)))


@rc_context(STYLE)
def transient_figure(result: Result) -> Figure:
    """Crank speed, the torque of gas and inertia beside that of loads and drive, and the loads of
    main bearing and crank pin with the largest of each marked, over time."""
    curves = over_time(result)
    time, torque = curves["time"], curves["crank_torque"]
    figure, axes = panels(3, 1, 10.0, 11.0)
    axes[0].plot(time, curves["crank_speed"] / RPM, color=COLOURS[0], linewidth=1.2)
    axes[0].set_ylabel("crank speed [rpm]")
    total, outside = torque_of_rods(result.scene), curves["external_torque"]
    axes[1].plot(time, torque.sum(axis=1), color=COLOURS[0], linewidth=1.0, label=total)
    axes[1].plot(time, outside, color=COLOURS[1], linewidth=1.5, label="load and drive torque")
    axes[1].set_ylabel("torque on the crank, positive\nin the sense of +theta [N m]")
    _loads(axes[2], result, curves)
    for ax in axes:
        ax.axhline(0.0, color="0.55", linewidth=1.0)
        ax.tick_params(labelbottom=ax is axes[-1])
    mark_events(axes[0], result, lambda mark: mark.time)
    axes[-1].set_xlabel("time [s]")
    legend(figure, *axes[1:])
    drawn = "crank_speed", "crank_torque", "external_torque", *_JOINTS.values()
    about = "crank speed, torque on the crank and bearing loads over the whole run"
    footer(figure, result, about, exactness(result.variables, *drawn))
    return figure


def _loads(ax: Axes, result: Result, curves: dict[str, Array]) -> None:
    """The loads over time, of several crank pins the largest, with the largest of each marked."""
    many = len(result.scene.cylinders) > 1
    forces = {}
    for joint, name in _JOINTS.items():
        force = np.hypot(curves[f"{name}_x"], curves[f"{name}_y"])
        forces[joint] = force.reshape(len(force), -1).max(axis=1)
    scale, unit = force_scale(*forces.values())
    peaks = run_peaks(result) if result.motion is not None else ()
    for number, (joint, force) in enumerate(forces.items()):
        colour = COLOURS[2 + number]
        label = f"{joint}, the largest of all" if many and joint == "crank pin" else joint
        ax.plot(curves["time"], force / scale, color=colour, linewidth=1.0, label=label)
        tops = [peak for peak in peaks if peak.name == joint]
        if not tops:
            continue
        top = max(tops, key=lambda peak: peak.value.value)
        size = top.value.value / scale
        where = math.degrees(top.crank_angle % result.scene.period)
        ax.plot(top.time, size, "o", color=colour, markersize=5, zorder=4)
        right = top.time > 0.5 * (curves["time"][0] + curves["time"][-1])
        ax.annotate(
            f"{joint}: {size:.4g} {unit} at {top.time:.4g} s, {where:.6g} deg",
            (top.time, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(-8 if right else 8, -10 - 12 * number),
            textcoords="offset points",
            horizontalalignment="right" if right else "left",
            verticalalignment="center",
            fontsize=9,
        )
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + _ABOVE * (high - low))
    ax.set_ylabel(f"bearing load [{unit}]")
