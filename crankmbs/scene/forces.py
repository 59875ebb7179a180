"""Forces from outside on the pistons. One class is one force (`crankmbs.scene.force`)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Ge
from pydantic import BeforeValidator, ValidationInfo

from crankmbs.errors import InputError
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.angle_rows import check_turns, cycle_of
from crankmbs.scene.force import Law, PistonForce, force
from crankmbs.scene.schema import CsvFile, Float, dumped, folder_of, from_file, part, si
from crankmbs.scene.tables import (
    CylinderTable,
    Header,
    Table,
    check_abscissae,
    headings,
    read_table,
    undumped,
)
from crankmbs.scene.units import DEGREE

__all__ = ["ConstantForce", "Damper", "ForceAngleTable", "ForceTimeTable", "Spring", "TravelTable"]

_MM = 1e-3  # m
_OVER_TRAVEL = Header("displacement_mm", _MM, "force_N", 1.0, ("forward_N", "back_N"))
_OVER_ANGLE = Header("crank_angle_deg", DEGREE, "force_N", 1.0)
_OVER_TIME = Header("time_s", 1.0, "force_N", 1.0)


@force
@part
class Spring(PistonForce):
    """The force -stiffness (s - relaxed_at), of the piston's displacement s [m] from its top dead
    centre.

    stiffness [N/m]; relaxed_at [m] : the displacement at which it is 0
    """

    kind: Literal["spring"] = "spring"
    stiffness: Annotated[Float, Ge(0), si("stiffness")]
    relaxed_at: Annotated[Float, si("length")] = 0.0

    @cached_property
    def law(self) -> Law:
        line = Piecewise((), ((self.stiffness * self.relaxed_at, -self.stiffness, 0.0),))
        return Law(line, line)

    @property
    def words(self) -> str:
        return (
            f"{self.stiffness:.6g} N/m, relaxed at a displacement of {self.relaxed_at * 1e3:.6g} mm"
        )


@force
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


@force
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


@dataclass(frozen=True)
class _TravelFile(CsvFile):
    """Reads a CSV file of the force over the travel, one for both ways or one for each."""

    def __call__(self, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, CylinderTable):
            return value
        if dumped(value, info):
            return undumped(value)
        if isinstance(value, Table) or not isinstance(value, str):
            return super().__call__(value, info)
        path = folder_of(info) / value
        names = headings(path)
        if "force_N" in names or not {"forward_N", "back_N"}.issubset(names):
            return super().__call__(value, info)
        forward, back = (
            read_table(path, self.x_units, {name: 1.0}) for name in ("forward_N", "back_N")
        )
        return CylinderTable(forward.x, (forward.y, back.y), forward.source)


@force
@part
class TravelTable(PistonForce):
    """Force [N] over the piston's displacement [m], linear; with two columns the first while it
    moves towards the crank, the second on the way back. They change at the true dead centres, and
    where the crank turns back; at rest the piston is held while neither moves it. Covers the
    stroke; ends are held over 0.1 % of it.
    """

    header: ClassVar[Header | None] = _OVER_TRAVEL
    kind: Literal["travel_table"] = "travel_table"
    file: Annotated[
        Table | CylinderTable,
        BeforeValidator(
            _TravelFile(*_OVER_TRAVEL.units, "displacements [m], forces [N], or both ways' forces")
        ),
    ]

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self._ways) > 2:
            raise InputError(
                f"{self.file.source}: a table over the travel has one force, or two, forward and "
                f"back; {len(self._ways)} came"
            )
        check_abscissae(self._ways[0], "displacements", jumps=True)

    @property
    def _ways(self) -> tuple[Table, ...]:
        return (self.file,) if isinstance(self.file, Table) else self.file.tables

    @cached_property
    def law(self) -> Law:
        ways = [Piecewise.through(way.x, way.y) for way in self._ways]
        return Law(ways[0], ways[-1])

    @property
    def words(self) -> str:
        least, most = (pick(pick(way.y) for way in self._ways) for pick in (min, max))
        ways = " each way" if len(self._ways) > 1 else ""
        rows = len(self.file.x)
        return f"{least:+.6g} to {most:+.6g} N in {rows} rows{ways} of {self.file.source}"


class _OfTable(PistonForce):
    """A force whose ``file`` holds it in rows."""

    file: Table

    @property
    def words(self) -> str:
        rows = self.file
        return f"{min(rows.y):+.6g} to {max(rows.y):+.6g} N in {len(rows.x)} rows of {rows.source}"


@force
@part
class ForceAngleTable(_OfTable):
    """Force [N] over the cylinder's cycle angle [rad], modulo 360 degrees where the rows span no
    more, else 720; linear, pchip or cubic. Two rows at one angle, or a closing row unlike the
    first, are a jump."""

    header: ClassVar[Header | None] = _OVER_ANGLE
    kind: Literal["angle_table"] = "angle_table"
    file: Annotated[Table, from_file(*_OVER_ANGLE.units, "cycle angles [rad], forces [N]")]
    interpolation: Literal["linear", "pchip", "cubic"] = "linear"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_turns(self.file, None)

    @cached_property
    def law(self) -> Law:
        return Law(over_angle=cycle_of(self.file, self.interpolation, None))

    @property
    def words(self) -> str:
        return f"{super().words}, {self.interpolation}"


@force
@part
class ForceTimeTable(_OfTable):
    """Force [N] over time [s], linear; two rows at one time are a jump. Covers the run."""

    header: ClassVar[Header | None] = _OVER_TIME
    kind: Literal["time_table"] = "time_table"
    file: Annotated[Table, from_file(*_OVER_TIME.units, "times [s], forces [N]")]

    def __post_init__(self) -> None:
        super().__post_init__()
        check_abscissae(self.file, "times", jumps=True)

    @cached_property
    def law(self) -> Law:
        return Law(over_time=Piecewise.through(self.file.x, self.file.y))

    @property
    def table_over_time(self) -> Table | None:
        return self.file
