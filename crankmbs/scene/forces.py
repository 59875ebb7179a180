"""Forces from outside on the pistons. One class is one force (`crankmbs.scene.force`)."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, ClassVar, Literal

from annotated_types import Ge

from crankmbs.errors import InputError
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.force import Law, PistonForce
from crankmbs.scene.parts import Distance
from crankmbs.scene.schema import Float, from_file, part, si
from crankmbs.scene.table_loads import OfTable, OverAngle, OverTime
from crankmbs.scene.tables import CylinderTable, Header, Table, tables_of
from crankmbs.scene.units import DEGREE
from crankmbs.scene.windowed import registered

__all__ = ["ConstantForce", "Damper", "ForceAngleTable", "ForceTimeTable", "Spring", "TravelTable"]

_FORCE = {"force_N": 1.0}
_OVER_TRAVEL = Header(
    {"displacement_mm": 1e-3},
    _FORCE,
    "displacements [m], forces [N], or both ways' forces",
    ("forward_N", "back_N"),
)
_OVER_ANGLE = Header({"crank_angle_deg": DEGREE}, _FORCE, "cycle angles [rad], forces [N]")
_OVER_TIME = Header({"time_s": 1.0}, _FORCE, "times [s], forces [N]")


@registered
@part
class Spring(PistonForce):
    """The force -stiffness (s - relaxed_at), of the piston's displacement s [m] from its top dead
    centre.

    stiffness [N/m]; relaxed_at [m] : the displacement at which it is 0
    """

    kind: Literal["spring"] = "spring"
    stiffness: Annotated[Float, Ge(0), si("stiffness")]
    relaxed_at: Distance = 0.0

    @cached_property
    def law(self) -> Law:
        line = Piecewise((), ((self.stiffness * self.relaxed_at, -self.stiffness, 0.0),))
        return Law(line, line)

    @property
    def words(self) -> str:
        return (
            f"{self.stiffness:.6g} N/m, relaxed at a displacement of {self.relaxed_at * 1e3:.6g} mm"
        )


@registered
@part
class Damper(PistonForce):
    """The force -c v, of the piston's velocity v towards the crank, c = coefficient [N s/m]."""

    kind: Literal["damper"] = "damper"
    coefficient: Annotated[Float, Ge(0), si("viscous friction")]

    @cached_property
    def law(self) -> Law:
        return Law(viscous=self.coefficient)

    @property
    def words(self) -> str:
        return f"-c v with c = {self.coefficient:.6g} N s/m"


@registered
@part
class ConstantForce(PistonForce):
    """A constant force [N]."""

    kind: Literal["constant"] = "constant"
    force: Annotated[Float, si("force")]

    @cached_property
    def law(self) -> Law:
        line = Piecewise((), ((self.force, 0.0, 0.0),))
        return Law(line, line)

    @property
    def words(self) -> str:
        return f"{self.force:+.6g} N"


@registered
@part
class TravelTable(OfTable, PistonForce):
    """Force [N] over the piston's displacement [m], linear; with two columns the first while it
    moves towards the crank, the second on the way back. They change at the true dead centres, and
    where the crank turns back; at rest the piston is held while neither moves it. Covers the
    stroke; ends are held over 0.1 % of it.
    """

    header: ClassVar[Header] = _OVER_TRAVEL
    kind: Literal["travel_table"] = "travel_table"
    file: Annotated[Table | CylinderTable, from_file(_OVER_TRAVEL)]

    def __post_init__(self) -> None:
        super().__post_init__()
        ways = len(tables_of(self.file))
        if ways > 2:
            raise InputError(
                f"{self.file.source}: a table over the travel has one force, or two, forward and "
                f"back; {ways} came"
            )

    @cached_property
    def law(self) -> Law:
        return Law(self.lines[0], self.lines[-1])


@registered
@part
class ForceAngleTable(OverAngle, PistonForce):
    """Force [N] over the cylinder's cycle angle [rad], modulo 360 degrees where the rows span no
    more, else 720; linear, pchip or cubic. Two rows at one angle, or a closing row unlike the
    first, are a jump."""

    header: ClassVar[Header] = _OVER_ANGLE
    kind: Literal["angle_table"] = "angle_table"
    file: Annotated[Table, from_file(_OVER_ANGLE)]
    interpolation: Literal["linear", "pchip", "cubic"] = "linear"

    @cached_property
    def law(self) -> Law:
        return Law(over_angle=self.cycle)


@registered
@part
class ForceTimeTable(OverTime, PistonForce):
    """Force [N] over time [s], linear; two rows at one time are a jump. Covers the run."""

    header: ClassVar[Header] = _OVER_TIME
    kind: Literal["time_table"] = "time_table"
    file: Annotated[Table, from_file(_OVER_TIME)]

    @cached_property
    def law(self) -> Law:
        return Law(over_time=self.lines[0])
