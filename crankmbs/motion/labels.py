"""The account of a run as a labelled dataset, in words too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.mechanics.variables import Variable
from crankmbs.motion.account import Kind, Rows
from crankmbs.motion.events import MOST_EVENTS
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CYCLES", "EVENTS", "cycles_dataset", "dims_of", "events_dataset"]

EVENTS = {
    "time": Variable("s", "time"),
    "crank_angle": Variable("rad", "crank angle from the engine's X, unwrapped"),
    "crank_speed": Variable("rad/s", "crank speed"),
    "share": Variable("1", "share of the combustion that is decided"),
    "kind": Variable("1", "what happens, by its number"),
    "number": Variable("1", "of a cylinder or a load; or the sense of rotation after"),
}
"""The columns of the events' rows; kind and number are exact."""

CYCLES = {
    "time": Variable("s", "time at its beginning"),
    "crank_angle": Variable("rad", "crank angle at its beginning, unwrapped"),
    "duration": Variable("s", "duration"),
    "mean_speed": Variable("rad/s", "angle turned over the time it takes"),
    "least_speed": Variable("rad/s", "least crank speed"),
    "largest_speed": Variable("rad/s", "largest crank speed"),
    "kinetic_energy_gained": Variable("J", "kinetic energy at its end less that at its beginning"),
    "gas_work": Variable("J", "work of the gas on the piston", "cylinder"),
    "imep": Variable("Pa", "work of the gas over the displaced volume", "cylinder"),
    "fuel": Variable("1", "share of the firing whose dead centre it holds", "cylinder"),
    "friction_work": Variable("J", "work of the friction on the piston", "cylinder"),
    "load_work": Variable("J", "work of the load"),
    "drive_work": Variable("J", "work of the drive"),
}
"""What a cycle has, where the scene has it too: gas, fuel, loads, a drive."""

_WORDS = {
    Kind.FUEL: "fuel",
    Kind.LOAD_ON: "load on",
    Kind.LOAD_OFF: "load off",
    Kind.REST: "rest",
    Kind.START: "start",
    Kind.REVERSAL: "reversal",
}
_OF_LOADS = (Kind.LOAD_ON, Kind.LOAD_OFF)


def events_dataset(scene: Scene, rows: Rows) -> xr.Dataset:
    """The events over ``event``, in their order, each with its kind in a word and a text.

    A cylinder or load is 0 where it is none's, a share NaN where none is decided.
    """
    import xarray as xr

    codes, numbers = (rows.columns[name].astype(np.int64) for name in ("kind", "number"))
    kinds = [Kind(code) for code in codes.tolist()]
    variables = {}
    for name, about in list(EVENTS.items())[:4]:
        attrs = {
            "units": about.units,
            "long_name": about.long_name,
            "error_estimate": rows.errors[name],
        }
        variables[name] = xr.Variable("event", rows.columns[name], attrs)
    given = (rows.columns[name].tolist() for name in ("time", "share"))
    said = zip(kinds, numbers.tolist(), *given, strict=True)
    own = np.isin(codes, _OF_LOADS)
    variables["kind"] = xr.Variable("event", np.array([_WORDS[kind] for kind in kinds], dtype=str))
    variables["cylinder"] = xr.Variable("event", np.where(codes == Kind.FUEL, numbers, 0))
    variables["load"] = xr.Variable("event", np.where(own, numbers, 0))
    texts = np.array([_text(scene, *one) for one in said], dtype=str)
    variables["text"] = xr.Variable("event", texts)
    return xr.Dataset(
        variables, {"event": np.arange(1, rows.count + 1)}, {"left_out": _left_out(rows)}
    )


def _left_out(rows: Rows) -> str:
    """What is not among the events, in a sentence; nothing where they are all there."""
    if not rows.left_out:
        return ""
    return (
        f"{rows.left_out} events are left out: of more than {MOST_EVENTS} decisions on the fuel "
        "all, of other events all but the first"
    )


def _text(scene: Scene, kind: Kind, number: int, time: float, share: float) -> str:
    sense = "forwards" if number > 0 else "backwards"
    if kind is Kind.FUEL:
        return f"cylinder {number} decides q = {share:.4g}"
    if kind is Kind.LOAD_ON:
        load = scene.torque[number - 1]
        return f"load {number}, {load.name}, sets in at {_met(time, load.after, load.from_speed)}"
    if kind is Kind.LOAD_OFF:
        load = scene.torque[number - 1]
        return f"load {number}, {load.name}, ends at {_met(time, load.until, load.until_speed)}"
    if kind is Kind.REST:
        return "comes to rest" if time > 0.0 else "stands at rest"
    return f"moves off {sense}" if kind is Kind.START else f"turns back, {sense} from here"


def _met(time: float, wanted: float | None, speed: float | None) -> str:
    """Which was met last at a time [s]: the time that was waited for, or a speed [rad/s]."""
    in_time = math.isclose(time, wanted or 0.0, rel_tol=1e-9, abs_tol=1e-12)
    return f"{time:.6g} s" if speed is None or in_time else f"{speed / RPM:.6g} rpm"


def dims_of(name: str) -> tuple[str, ...]:
    """The dimensions of a variable of the cycles."""
    if name == "load_work":
        return "cycle", "load"
    return ("cycle", "cylinder") if CYCLES[name].of else ("cycle",)


def cycles_dataset(scene: Scene, rows: Rows) -> xr.Dataset:
    """The whole cycles over ``cycle``, which counts them from 1 at the start."""
    import xarray as xr

    variables = {}
    for name, values in rows.columns.items():
        if name != "number":
            about = CYCLES[name]
            attrs = {
                "units": about.units,
                "long_name": about.long_name,
                "error_estimate": rows.errors[name],
            }
            variables[name] = xr.Variable(dims_of(name), values, attrs)
    coordinates = {
        "cycle": rows.columns["number"].astype(np.int64),
        "cylinder": np.arange(1, len(scene.cylinders) + 1),
        "load": np.arange(1, len(scene.torque) + 1),
    }
    said = f"the first {rows.left_out} cycles are left out" if rows.left_out else ""
    return xr.Dataset(variables, coordinates, {"left_out": said})
