"""The variables of a result: unit, long name, and of what each has its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from crankmbs.numerics.arrays import Array, Labelled
from crankmbs.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["COORDINATES", "EVERY", "SUMS", "VARIABLES", "Variable", "dataset", "variables_of"]


class Variable(NamedTuple):
    """Unit and long name of a variable; of : its dimension beside time, "cylinder", "journal" or
    "pin", where it has one."""

    units: str
    long_name: str
    of: str = ""

    @property
    def dims(self) -> tuple[str, ...]:
        """The dimensions of its array."""
        return ("time", self.of) if self.of else ("time",)

    @property
    def per_cylinder(self) -> bool:
        """Whether each cylinder has its own."""
        return self.of == "cylinder"

    def labelled(
        self, values: Array, error: float, dims: tuple[str, ...] | None = None
    ) -> tuple[tuple[str, ...], Array, dict[str, Any]]:
        """Values with their dimensions, unit, long name and error, as `Labelled` has them."""
        attrs = {"units": self.units, "long_name": self.long_name, "error_estimate": error}
        return self.dims if dims is None else dims, values, attrs


VARIABLES = {
    "time": Variable("s", "time"),
    "crank_angle": Variable("rad", "crank angle from the engine's X, unwrapped"),
    "crank_speed": Variable("rad/s", "crank speed"),
    "crank_acceleration": Variable("rad/s^2", "crank acceleration"),
    "external_torque": Variable("N m", "torque on the crank from outside: drive and loads"),
    "main_bearing_force_x": Variable("N", "bearing on crank, engine's X, all cylinders"),
    "main_bearing_force_y": Variable("N", "bearing on crank, engine's Y, all cylinders"),
    "frame_force_x": Variable("N", "moving parts on the frame, engine's X; the gas cancels"),
    "frame_force_y": Variable("N", "moving parts on the frame, engine's Y; the gas cancels"),
    "frame_moment": Variable("N m", "moving parts on the frame about the crank axis, with gas"),
    "rocking_moment_x": Variable("N m", "moving parts on the frame about X, middle of the crank"),
    "rocking_moment_y": Variable("N m", "moving parts on the frame about Y, middle of the crank"),
    "kinetic_energy": Variable("J", "kinetic energy of crank, rods and pistons"),
    "energy_residual": Variable("J", "kinetic energy gained minus work done"),
    "rod_angle": Variable("rad", "rod angle beta from the cylinder axis", "cylinder"),
    "rod_angular_speed": Variable("rad/s", "rate of the rod angle beta", "cylinder"),
    "rod_angular_acceleration": Variable(
        "rad/s^2", "second rate of the rod angle beta", "cylinder"
    ),
    "piston_position": Variable("m", "piston pin, cylinder's X from the crank axis", "cylinder"),
    "piston_displacement": Variable(
        "m", "piston displacement from its top dead centre", "cylinder"
    ),
    "piston_velocity": Variable("m/s", "piston velocity towards the crank", "cylinder"),
    "piston_acceleration": Variable("m/s^2", "piston acceleration towards the crank", "cylinder"),
    "gas_pressure": Variable("Pa", "pressure of the head end less ambient", "cylinder"),
    "crank_end_pressure": Variable("Pa", "pressure of the crank end less ambient", "cylinder"),
    "gas_force": Variable("N", "gas force on the piston towards the crank", "cylinder"),
    "side_force": Variable("N", "cylinder wall on piston, cylinder's Y", "cylinder"),
    "piston_pin_force_x": Variable("N", "rod on piston, cylinder's X", "cylinder"),
    "piston_pin_force_y": Variable("N", "rod on piston, cylinder's Y", "cylinder"),
    "crank_pin_force_x": Variable("N", "crank on rod, cylinder's X", "cylinder"),
    "crank_pin_force_y": Variable("N", "crank on rod, cylinder's Y", "cylinder"),
    "crank_torque": Variable("N m", "moment of the rod's force on the crank", "cylinder"),
    "journal_torque": Variable(
        "N m", "rods 1 to this one on the crank: its next journal", "cylinder"
    ),
    "pin_torque": Variable(
        "N m", "rods before this one and half of this one on the crank", "cylinder"
    ),
}

SUMS = frozenset({"journal_torque", "pin_torque"}) | {
    name for name in VARIABLES if name.startswith(("frame_", "rocking_"))
}
"""Sums in which the cylinders may cancel to nothing: no error relative to their own peak is asked
of them, for that of what they sum up is."""

EVERY = VARIABLES | {
    "fuel": Variable("1", "share of the combustion of the firing that acts", "cylinder"),
    "friction_force": Variable("N", "wall's friction on the piston towards the crank", "cylinder"),
    "applied_force": Variable(
        "N", "force from outside on the piston towards the crank", "cylinder"
    ),
    "main_journal_force_x": Variable("N", "bearing on main journal, engine's X", "journal"),
    "main_journal_force_y": Variable("N", "bearing on main journal, engine's Y", "journal"),
    "pin_force_x": Variable("N", "crank on the rods of one pin, engine's X", "pin"),
    "pin_force_y": Variable("N", "crank on the rods of one pin, engine's Y", "pin"),
}
"""With those that only some scenes have."""

COORDINATES = ("time", "crank_angle", "cylinder")
"""What the data of a result lie over."""


def variables_of(scene: Scene) -> dict[str, Variable]:
    """The variables that a result of a scene has: rocking moments where the cylinders have places,
    the pressure of the crank end where cylinders are double-acting, the shares of the combustion
    where there is fuel, friction and forces from outside where there are, the forces of main
    journals where there are bearings, those of pins where two rods share one.

    >>> "rocking_moment_x" in variables_of(load_scene("propeller"))
    False
    """
    without = {"fuel"} if scene.fuel is None else set()
    without |= set() if scene.double_acting else {"crank_end_pressure"}
    without |= {"friction_force"} if scene.friction is None else set()
    without |= set() if scene.force else {"applied_force"}
    without |= {"rocking_moment_x", "rocking_moment_y"} if scene.levers is None else set()
    throws = scene.throws
    without |= {name for name, about in EVERY.items() if about.of == "journal" and throws is None}
    shared = throws is not None and throws.shared
    without |= {name for name, about in EVERY.items() if about.of == "pin" and not shared}
    return {name: about for name, about in EVERY.items() if name not in without}


def dataset(variables: Labelled, coordinates: tuple[str, ...], **attrs: str) -> xr.Dataset:
    """The variables as a Dataset, some of them as coordinates."""
    import xarray as xr

    data = {name: one for name, one in variables.items() if name not in coordinates}
    return xr.Dataset(data, {name: variables[name] for name in coordinates}, attrs)
