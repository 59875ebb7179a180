"""The figures of one run, by their names, and one of them by its kind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from crankmbs.errors import InputError, shown
from crankmbs.figures.bearings import bearings_figure
from crankmbs.figures.cycles import FEWEST_CYCLES, cycles_figure, transient_figure, varies_strongly
from crankmbs.figures.design import orders_figure
from crankmbs.figures.polar import crank_pin_figure, main_bearing_figure, piston_pin_figure
from crankmbs.figures.strips import (
    forces_figure,
    indicator_figure,
    piston_motion_figure,
    speed_figure,
    torque_figure,
)
from crankmbs.figures.style import save
from crankmbs.figures.view import View, last_view
from crankmbs.measures import engine_orders
from crankmbs.result import Result
from crankmbs.scene.sentences import did_you_mean
from crankmbs.storage.files import together

__all__ = ["plot", "save_figures"]

_FIGURES: dict[str, Callable[[View], Figure]] = {
    "speed": speed_figure,
    "piston_motion": piston_motion_figure,
    "gas_and_side_force": forces_figure,
    "main_bearing": main_bearing_figure,
    "crank_pin": crank_pin_figure,
    "piston_pin": piston_pin_figure,
    "torque": torque_figure,
}

_KINDS: dict[str, Callable[[Result], Figure]] = {
    "speed": lambda result: speed_figure(last_view(result)),
    "motion": lambda result: piston_motion_figure(last_view(result)),
    "forces": lambda result: forces_figure(last_view(result)),
    "torque": lambda result: torque_figure(last_view(result)),
    "orders": lambda result: orders_figure(result, engine_orders(result)),
    "cycles": lambda result: _cycles(result),
    "bearings": lambda result: _bearings(result),
    "pressure": lambda result: _pressure(result),
    "transient": transient_figure,
}
_POLAR = {name: _FIGURES[name] for name in ("main_bearing", "crank_pin", "piston_pin")}


def plot(result: Result, kind: str = "speed", joint: str = "crank_pin") -> Figure:
    """One of the figures that ``crankmbs run`` writes.

    Parameters
    ----------
    kind : "speed", "motion" of the pistons, "forces" along and across the cylinders, "polar" load,
        "torque", "orders" of torque and frame force, "cycles", "bearings", "pressure" over angle
        and volume, or the whole run over time as "transient"
    joint : of a "polar" load: "main_bearing", "crank_pin" or "piston_pin"

    Raises
    ------
    InputError : another kind or joint; no orders without a whole cycle, no cycles kept, no
        journals, no gas

    >>> len(plot(simulate(load_scene("propeller")), "motion").axes)
    3
    """
    _check_word("kind", kind, [*_KINDS, "polar"])
    _check_word("joint", joint, list(_POLAR))
    return _POLAR[joint](last_view(result)) if kind == "polar" else _KINDS[kind](result)


def _check_word(option: str, word: str, known: list[str]) -> None:
    if word in known:
        return
    near = did_you_mean(word, known) if isinstance(word, str) else ""
    *most, last = map(shown, known)
    raise InputError(f"{option} must be {', '.join(most)} or {last}; {shown(word)} came{near}")


def _cycles(result: Result) -> Figure:
    count = result.cycle_table.length
    if count < FEWEST_CYCLES:
        raise InputError(
            f"cycles are drawn from {FEWEST_CYCLES} on, and this run has {count}; result.cycles "
            "has what there is of them"
        )
    return cycles_figure(result)


def _bearings(result: Result) -> Figure:
    if result.scene.throws is None:
        raise InputError(
            "loads of journals and pins are drawn of a scene with [bearings] whose throws have "
            "places along the crank; give them, such as bearings = Bearings()"
        )
    return bearings_figure(last_view(result))


def _pressure(result: Result) -> Figure:
    if result.scene.gas is None:
        raise InputError("a pressure is drawn of a scene with [gas]; this one has none")
    return indicator_figure(last_view(result))


def save_figures(result: Result, folder: Path) -> list[Path]:
    """Draw every figure of a result into PNG files, which appear together; the cycles where there
    are more than three, or several in a settled period, the bearings and the pressure where a scene
    has them, the whole run over time where its speed varies strongly.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    view = last_view(result)
    with together(folder) as part:
        for name, draw in _FIGURES.items():
            save(draw(view), part / f"{name}.png")
        names = list(_FIGURES)
        if result.scene.gas is not None:
            save(indicator_figure(view), part / "pressure.png")
            names.append("pressure")
        if varies_strongly(result):
            save(transient_figure(result), part / "transient.png")
            names.append("transient")
        if result.scene.throws is not None:
            save(bearings_figure(view), part / "bearings.png")
            names.append("bearings")
        fewest = 2 if result.scene.settles else FEWEST_CYCLES  # what differs in a settled period
        if result.keep is not None and result.cycle_table.length >= fewest:
            save(cycles_figure(result), part / "cycles.png")
            names.append("cycles")
    return [folder / f"{name}.png" for name in names]
