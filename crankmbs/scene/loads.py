"""Torques from outside on the free crank. One class is one load (`crankmbs.scene.torque`)."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge, Gt

from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.angle_rows import check_turns, cycle_of
from crankmbs.scene.schema import Float, from_file, part, si
from crankmbs.scene.tables import Header, Table, check_abscissae
from crankmbs.scene.torque import Parts, Torque, load
from crankmbs.scene.units import DEGREE, RPM

__all__ = ["AngleTable", "Constant", "Quadratic", "SpeedTable", "TimeTable", "Viscous"]


@load
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


@load
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


@load
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


class _OfTable(Torque):
    """A torque whose ``file`` holds it in rows."""

    file: Table

    @property
    def words(self) -> str:
        rows = self.file
        return (
            f"{min(rows.y):+.6g} to {max(rows.y):+.6g} N m in {len(rows.x)} rows of {rows.source}"
        )

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share)}


_OVER_TIME = Header("time_s", 1.0, "torque_Nm", 1.0)
_OVER_SPEED = Header("speed_rpm", RPM, "torque_Nm", 1.0)


@load
@part
class TimeTable(_OfTable):
    """Torque [N m] over time [s], linear; two rows at one time are a jump. Covers the run."""

    header: ClassVar[Header | None] = _OVER_TIME
    kind: Literal["time_table"] = "time_table"
    file: Annotated[Table, from_file(*_OVER_TIME.units, "times [s], torques [N m]")]

    def __post_init__(self) -> None:
        super().__post_init__()
        check_abscissae(self.file, "times", jumps=True)

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_time=Piecewise.through(self.file.x, self.file.y))

    @property
    def table_over_time(self) -> Table | None:
        return self.file


@load
@part
class SpeedTable(_OfTable):
    """Torque [N m] over speed [rad/s], linear, ends held; two rows at one speed are a jump."""

    header: ClassVar[Header | None] = _OVER_SPEED
    kind: Literal["speed_table"] = "speed_table"
    file: Annotated[Table, from_file(*_OVER_SPEED.units, "speeds [rad/s], torques [N m]")]

    def __post_init__(self) -> None:
        super().__post_init__()
        check_abscissae(self.file, "speeds", jumps=True)

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_speed=Piecewise.through(self.file.x, self.file.y))

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share, faster)}


_OVER_ANGLE = Header("crank_angle_deg", DEGREE, "torque_Nm", 1.0)


@load
@part
class AngleTable(_OfTable):
    """Torque [N m] over the crank angle [rad], modulo its period; linear, pchip or cubic. Two rows
    at one angle, or a closing row unlike the first, are a jump, up to which and from which it is
    interpolated.

    period [rad] : any multiple of half a revolution; by default 360 degrees where the rows span no
        more, else 720
    """

    header: ClassVar[Header | None] = _OVER_ANGLE
    kind: Literal["angle_table"] = "angle_table"
    file: Annotated[Table, from_file(*_OVER_ANGLE.units, "crank angles [rad], torques [N m]")]
    interpolation: Literal["linear", "pchip", "cubic"] = "linear"
    period: Annotated[Float, Gt(0), si("angle")] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_turns(self.file, self.period)

    @cached_property
    def parts(self) -> Parts[Cycle]:
        return Parts(over_angle=cycle_of(self.file, self.interpolation, self.period))

    @property
    def words(self) -> str:
        every = "" if self.period is None else f", every {self.period / DEGREE:g} degrees"
        return f"{super().words}, {self.interpolation}{every}"
