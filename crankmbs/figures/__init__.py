"""Figures of a result, drawn with matplotlib and without its global state.

`plot` draws one of a result's figures by its kind, which is what ``result.plot(kind)`` gives; the
functions below draw each from a `last_view`, its last cycle with angles in degrees. All return a
matplotlib figure, to be changed and saved as any other:

>>> figure = plot(simulate(load_scene("propeller")), "polar")
>>> _ = figure.axes[0].set_title("my crank pin")

What is drawn is computed elsewhere: in measures, compare and mechanics; here are axes and labels.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from crankmbs.compare.confirm import Difference
from crankmbs.design import Balance
from crankmbs.errors import InputError, shown
from crankmbs.figures.balance import balance_figure
from crankmbs.figures.compare import budget_figure, comparison_figure, save_validation
from crankmbs.figures.cycles import FEWEST_CYCLES, cycles_figure
from crankmbs.figures.difference import difference_figure
from crankmbs.figures.indicated import pressure_figure, scatter_figure, volume_figure
from crankmbs.figures.machine import machine_figure
from crankmbs.figures.orders import orders_figure
from crankmbs.figures.polar import crank_pin_figure, main_bearing_figure, piston_pin_figure
from crankmbs.figures.strips import (
    forces_figure,
    piston_motion_figure,
    speed_figure,
    torque_figure,
)
from crankmbs.figures.style import png
from crankmbs.figures.sweep import sweep_figure
from crankmbs.figures.view import View, last_view
from crankmbs.indicated import Indicated
from crankmbs.measures import EngineOrders, engine_orders
from crankmbs.result import Result
from crankmbs.scene.sentences import did_you_mean
from crankmbs.storage.files import together, write_in_one_move

__all__ = [
    "balance_figure",
    "budget_figure",
    "comparison_figure",
    "crank_pin_figure",
    "cycles_figure",
    "difference_figure",
    "forces_figure",
    "last_view",
    "machine_figure",
    "main_bearing_figure",
    "orders_figure",
    "piston_motion_figure",
    "piston_pin_figure",
    "plot",
    "png",
    "pressure_figure",
    "save_balance_figure",
    "save_differences",
    "save_figures",
    "save_indicated_figures",
    "save_orders_figure",
    "save_validation",
    "scatter_figure",
    "speed_figure",
    "sweep_figure",
    "torque_figure",
    "volume_figure",
]

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
}
_POLAR = {name: _FIGURES[name] for name in ("main_bearing", "crank_pin", "piston_pin")}


def plot(result: Result, kind: str = "speed", joint: str = "crank_pin") -> Figure:
    """One of the figures that ``crankmbs run`` writes.

    Parameters
    ----------
    kind : "speed", "motion" of the pistons, "forces" along and across the cylinders, "polar" load,
        "torque", "orders" of torque and frame force, or "cycles"
    joint : of a "polar" load: "main_bearing", "crank_pin" or "piston_pin"

    Raises
    ------
    InputError : another kind or joint; no orders without a whole cycle, no cycles kept

    >>> len(plot(simulate(load_scene("propeller")), "motion").axes)
    3
    """
    _check_word("kind", kind, [*_KINDS, "polar"])
    _check_word("joint", joint, list(_POLAR))
    return _POLAR[joint](last_view(result)) if kind == "polar" else _KINDS[kind](result)


def _check_word(what: str, word: str, known: list[str]) -> None:
    if word in known:
        return
    near = did_you_mean(word, known) if isinstance(word, str) else ""
    *most, last = map(shown, known)
    raise InputError(f"{what} must be {', '.join(most)} or {last}; {shown(word)} came{near}")


def _cycles(result: Result) -> Figure:
    count = result.cycles.sizes["cycle"]
    if count < FEWEST_CYCLES:
        raise InputError(
            f"cycles are drawn from {FEWEST_CYCLES} on, and this run has {count}; result.cycles "
            "has what there is of them"
        )
    return cycles_figure(result)


def save_figures(result: Result, folder: Path) -> list[Path]:
    """Draw every figure of a result into PNG files, which appear together; the cycles where there
    are more than three, or several in a settled period.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    view = last_view(result)
    with together(folder) as part:
        for name, draw in _FIGURES.items():
            _save(draw(view), part / f"{name}.png")
        names = list(_FIGURES)
        fewest = 2 if result.scene.settles else FEWEST_CYCLES  # what differs in a settled period
        if result.keep is not None and result.cycles.sizes["cycle"] >= fewest:
            _save(cycles_figure(result), part / "cycles.png")
            names.append("cycles")
    return [folder / f"{name}.png" for name in names]


def save_indicated_figures(found: Indicated, folder: Path, stem: str) -> list[Path]:
    """Draw measured pressures into STEM_angle.png, with a geometry STEM_pv.png, and of several
    cycles STEM_cycles.png, which appear together.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    draw = {"angle": pressure_figure}
    if found.shape is not None:
        draw["pv"] = volume_figure
    if any(len(each.pressure) > 1 for each in found.cylinders):
        draw["cycles"] = scatter_figure
    with together(folder) as part:
        for name, figure in draw.items():
            _save(figure(found), part / f"{stem}_{name}.png")
    return [folder / f"{stem}_{name}.png" for name in draw]


def save_differences(result: Result, differences: tuple[Difference, ...], folder: Path) -> Path:
    """Draw the differences between two runs of a scene into difference.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return _save(difference_figure(result, differences), folder / "difference.png")


def save_orders_figure(result: Result, found: EngineOrders, folder: Path) -> Path:
    """Draw the orders of a run into orders.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return _save(orders_figure(result, found), folder / "orders.png")


def save_balance_figure(found: Balance, folder: Path) -> Path:
    """Draw the force on the frame before and after balancing into balance.png.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    return _save(balance_figure(found), folder / "balance.png")


def _save(figure: Figure, file: Path) -> Path:
    write_in_one_move(file, lambda part: figure.savefig(part, format="png"))
    return file
