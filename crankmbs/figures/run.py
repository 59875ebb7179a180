"""The figures of one run, by their names, and one of them by its kind."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
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
from crankmbs.figures.style import drawn
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
    "pressure": indicator_figure,
    "transient": lambda view: transient_figure(view.result),
    "bearings": bearings_figure,
    "cycles": lambda view: cycles_figure(view.result),
}
_FILES = {"motion": "piston_motion", "forces": "gas_and_side_force"}  # kinds of other names
_KINDS = ["speed", "motion", "forces", "torque", "orders", "cycles", "bearings", "pressure"]
_KINDS += ["transient", "polar"]
_JOINTS = ["main_bearing", "crank_pin", "piston_pin"]


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
    _check_word("kind", kind, _KINDS)
    _check_word("joint", joint, _JOINTS)
    if kind == "orders":
        return orders_figure(result, engine_orders(result))
    name = joint if kind == "polar" else _FILES.get(kind, kind)
    count = result.cycle_table.length if kind == "cycles" else 0
    missing = _missing(result, count, FEWEST_CYCLES)
    if name in missing:
        raise InputError(missing[name])
    return _FIGURES[name](last_view(result))


def _check_word(option: str, word: str, known: list[str]) -> None:
    if word in known:
        return
    near = did_you_mean(word, known) if isinstance(word, str) else ""
    *most, last = map(shown, known)
    raise InputError(f"{option} must be {', '.join(most)} or {last}; {shown(word)} came{near}")


def _missing(result: Result, cycles: int, fewest: int) -> dict[str, str]:
    """Figures that a result has not, by their names, and why."""
    missing = {}
    if result.scene.gas is None:
        missing["pressure"] = "a pressure is drawn of a scene with [gas]; this one has none"
    if result.scene.throws is None:
        missing["bearings"] = (
            "loads of journals and pins are drawn of a scene with [bearings] whose throws have "
            "places along the crank; give them, such as bearings = Bearings()"
        )
    if cycles < fewest:
        missing["cycles"] = (
            f"cycles are drawn from {fewest} on, and this run has {cycles}; result.cycles has what "
            "there is of them"
        )
    return missing


def save_figures(result: Result, folder: Path) -> list[Path]:
    """Draw every figure of a result into PNG files, which appear together; the cycles where there
    are more than three, or several in a settled period, the bearings and the pressure where a scene
    has them, the whole run over time where its speed varies strongly or is not periodic.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    view = last_view(result)
    cycles = 0 if result.keep is None else result.cycle_table.length
    fewest = 2 if result.scene.settles else FEWEST_CYCLES  # what differs in a settled period
    missing = set(_missing(result, cycles, fewest))
    if not varies_strongly(result) and (result.motion is None or result.measures().steady):
        missing.add("transient")
    names = [name for name in _FIGURES if name not in missing]
    with (
        together(folder) as part,
        ThreadPoolExecutor(1) as other,
    ):  # one is packed while the next is drawn
        files = [other.submit(drawn(_FIGURES[name](view)), part / f"{name}.png") for name in names]
        for file in files:
            file.result()
    return [folder / f"{name}.png" for name in names]
