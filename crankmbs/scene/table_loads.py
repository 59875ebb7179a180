"""What torques and forces from outside have in common whose ``file`` holds them in rows."""

from __future__ import annotations

from typing import ClassVar

from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.angle_rows import check_turns, cycle_of
from crankmbs.scene.tables import CylinderTable, Header, Table, check_abscissae, tables_of
from crankmbs.scene.units import DEGREE
from crankmbs.scene.windowed import Windowed

__all__ = ["OfTable", "OverAngle", "OverTime"]


class OfTable(Windowed):
    """Over what its header says, linear; two rows with the same abscissa are a jump."""

    file: Table | CylinderTable
    header: ClassVar[Header]
    unit: ClassVar[str]

    def __post_init__(self) -> None:
        super().__post_init__()
        check_abscissae(self.file, self.header.abscissae, jumps=True)

    @property
    def lines(self) -> tuple[Piecewise, ...]:
        """Straight lines between the rows, for each of its ordinates."""
        return tuple(Piecewise.through(table.x, table.y) for table in tables_of(self.file))

    @property
    def words(self) -> str:
        """What a reader is told of it, after its kind."""
        rows, tables = self.file, tables_of(self.file)
        least, most = (pick(pick(table.y) for table in tables) for pick in (min, max))
        ways = " each way" if len(tables) > 1 else ""
        return (
            f"{least:+.6g} to {most:+.6g} {self.unit} in {len(rows.x)} rows{ways} of {rows.source}"
        )


class OverTime(OfTable):
    """Over time [s]; covers the time in which it acts."""

    file: Table

    @property
    def table_over_time(self) -> Table | None:
        """Its table, which must cover the time in which it acts."""
        return self.file


class OverAngle(OfTable):
    """Over an angle [rad], after whose period it comes again."""

    file: Table
    interpolation: str
    period: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_turns(self.file, self.period)

    @property
    def cycle(self) -> Cycle:
        """The periodic function that the rows make."""
        return cycle_of(self.file, self.interpolation, self.period)

    @property
    def words(self) -> str:
        """What a reader is told of it, after its kind."""
        every = "" if self.period is None else f", every {self.period / DEGREE:g} degrees"
        return f"{super().words}, {self.interpolation}{every}"
