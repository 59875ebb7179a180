"""The account of a run as labelled tables, in words too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.variables import Variable, dataset
from crankmbs.mechanics.windows import place_of
from crankmbs.motion.account import Kind, Rows
from crankmbs.motion.events import MOST_EVENTS
from crankmbs.numerics.arrays import Labelled
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CYCLES", "EVENTS", "Table", "cycles_table", "dims_of", "events_table"]


class Table(NamedTuple):
    """Rows of what happened.

    coordinates : the names of these among the variables, that of the rows first
    left_out : what is not among the rows, in a sentence
    """

    variables: Labelled
    coordinates: tuple[str, ...]
    left_out: str

    def values(self, name: str) -> NDArray[Any]:
        """The values of a variable."""
        return self.variables[name][1]

    @property
    def length(self) -> int:
        """How many rows there are."""
        return len(self.values(self.coordinates[0]))

    def dataset(self) -> xr.Dataset:
        """The table as xarray has it."""
        return dataset(self.variables, self.coordinates, left_out=self.left_out)


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
    "imep_crank_end": Variable("Pa", "work of the crank end over its volume", "cylinder"),
    "fuel": Variable("1", "share of the firing whose dead centre it holds", "cylinder"),
    "friction_work": Variable("J", "work of the friction on the piston", "cylinder"),
    "load_work": Variable("J", "work of the load"),
    "force_work": Variable("J", "work of the force from outside on the pistons"),
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


def events_table(scene: Scene, rows: Rows) -> Table:
    """The events over ``event``, in their order, each with its kind in a word and a text.

    A cylinder or load is 0 where it is none's, a share NaN where none is decided.
    """
    codes, numbers = (rows.columns[name].astype(np.int64) for name in ("kind", "number"))
    kinds = [Kind(code) for code in codes.tolist()]
    of_loads, torques = np.isin(codes, _OF_LOADS), len(scene.torque)
    variables: Labelled = {
        name: about.labelled(rows.columns[name], rows.errors[name], ("event",))
        for name, about in list(EVENTS.items())[:4]
    }
    times_and_shares = (rows.columns[name].tolist() for name in ("time", "share"))
    said = zip(kinds, numbers.tolist(), *times_and_shares, strict=True)
    more: dict[str, NDArray[Any]] = {
        "kind": np.array([_WORDS[kind] for kind in kinds], dtype=str),
        "cylinder": np.where(codes == Kind.FUEL, numbers, 0),
        "load": np.where(of_loads & (numbers <= torques), numbers, 0),
        "text": np.array([_text(scene, *one) for one in said], dtype=str),
        "event": np.arange(1, rows.count + 1),
    }
    if scene.force:
        more["force"] = np.where(of_loads & (numbers > torques), numbers - torques, 0)
    variables |= {name: (("event",), values, {}) for name, values in more.items()}
    return Table(variables, ("event",), _left_out(rows))


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
    if kind in _OF_LOADS:
        loads = *scene.torque, *scene.force
        load, which = loads[number - 1], place_of(loads, number)
        if kind is Kind.LOAD_ON:
            return f"{which}, {load.called}, sets in at {_met(time, load.after, load.from_speed)}"
        return f"{which}, {load.called}, ends at {_met(time, load.until, load.until_speed)}"
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
    if name == "force_work":
        return "cycle", "force"
    return ("cycle", "cylinder") if CYCLES[name].of else ("cycle",)


def cycles_table(scene: Scene, rows: Rows) -> Table:
    """The whole cycles over ``cycle``, which counts them from 1 at the start."""
    variables: Labelled = {
        "cycle": (("cycle",), rows.columns["number"].astype(np.int64), {}),
        "cylinder": (("cylinder",), np.arange(1, len(scene.cylinders) + 1), {}),
        "load": (("load",), np.arange(1, len(scene.torque) + 1), {}),
    }
    if scene.force:
        variables["force"] = ("force",), np.arange(1, len(scene.force) + 1), {}
    coordinates = tuple(variables)
    for name, values in rows.columns.items():
        if name != "number":
            variables[name] = CYCLES[name].labelled(values, rows.errors[name], dims_of(name))
    said = f"the first {rows.left_out} cycles are left out" if rows.left_out else ""
    return Table(variables, coordinates, said)
