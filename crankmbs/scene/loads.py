"""Torques from outside on the free crank. One class is one load (`crankmbs.scene.torque`)."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge

from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.schema import AnglePeriod, Float, from_file, part, si
from crankmbs.scene.table_loads import OfTable, OverAngle, OverTime
from crankmbs.scene.tables import Header, Table
from crankmbs.scene.torque import Parts, Torque
from crankmbs.scene.units import DEGREE, RPM
from crankmbs.scene.windowed import registered

__all__ = ["AngleTable", "Constant", "Quadratic", "SpeedTable", "TimeTable", "Viscous"]


@registered
@part
class Constant(Torque):
    """A constant torque [N m]."""

    kind: Literal["constant"] = "constant"
    torque: Annotated[Float, si("torque")]

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_time=Piecewise((), ((self.torque, 0.0, 0.0),)))

    @property
    def words(self) -> str:
        return f"{self.torque:+.6g} N m"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"torque": self.torque * share}


@registered
@part
class Viscous(Torque):
    """The torque -c omega, c = coefficient [N m s]."""

    kind: Literal["viscous"] = "viscous"
    coefficient: Annotated[Float, Ge(0), si("viscous coefficient")]

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_speed=Piecewise((), ((0.0, -self.coefficient, 0.0),)))

    @property
    def words(self) -> str:
        return f"-c omega with c = {self.coefficient:.6g} N m s"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"coefficient": self.coefficient * share / faster}


@registered
@part
class Quadratic(Torque):
    """The torque -c omega |omega|, c = coefficient [N m s2]: a propeller or a brake."""

    kind: Literal["quadratic"] = "quadratic"
    coefficient: Annotated[Float, Ge(0), si("quadratic coefficient")]

    @cached_property
    def parts(self) -> Parts[Cycle]:
        c = self.coefficient
        return Parts(over_speed=Piecewise((0.0,), ((0.0, 0.0, c), (0.0, 0.0, -c))))

    @property
    def words(self) -> str:
        return f"-c omega |omega| with c = {self.coefficient:.6g} N m s^2"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"coefficient": self.coefficient * share / faster**2}


_OVER_TIME = Header({"time_s": 1.0}, {"torque_Nm": 1.0}, "times [s], torques [N m]")
_OVER_SPEED = Header({"speed_rpm": RPM}, {"torque_Nm": 1.0}, "speeds [rad/s], torques [N m]")
_OVER_ANGLE = Header(
    {"crank_angle_deg": DEGREE}, {"torque_Nm": 1.0}, "crank angles [rad], torques [N m]"
)


class _Rows(OfTable):
    """A torque whose ``file`` holds it in rows."""

    file: Table

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share)}


@registered
@part
class TimeTable(_Rows, OverTime, Torque):
    """Torque [N m] over time [s], linear; two rows at one time are a jump. Covers the run."""

    header: ClassVar[Header] = _OVER_TIME
    kind: Literal["time_table"] = "time_table"
    file: Annotated[Table, from_file(_OVER_TIME)]

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_time=self.lines[0])


@registered
@part
class SpeedTable(OfTable, Torque):
    """Torque [N m] over speed [rad/s], linear, ends held; two rows at one speed are a jump."""

    header: ClassVar[Header] = _OVER_SPEED
    kind: Literal["speed_table"] = "speed_table"
    file: Annotated[Table, from_file(_OVER_SPEED)]

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_speed=self.lines[0])

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share, faster)}


@registered
@part
class AngleTable(_Rows, OverAngle, Torque):
    """Torque [N m] over the crank angle [rad], modulo its period; linear, pchip or cubic. Two rows
    at one angle, or a closing row unlike the first, are a jump, up to which and from which it is
    interpolated.

    period [rad] : any multiple of half a revolution; by default 360 degrees where the rows span no
        more, else 720
    """

    header: ClassVar[Header] = _OVER_ANGLE
    kind: Literal["angle_table"] = "angle_table"
    file: Annotated[Table, from_file(_OVER_ANGLE)]
    interpolation: Literal["linear", "pchip", "cubic"] = "linear"
    period: AnglePeriod | None = None

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_angle=self.cycle)
