"""Whether a table covers what it is used for."""

from __future__ import annotations

from crankmbs.errors import InputError
from crankmbs.scene.cycles import SAME_ANGLE
from crankmbs.scene.tables import Table
from crankmbs.scene.units import DEGREE

__all__ = ["check_angles", "check_times"]


def check_times(table: Table, begin: float, end: float, span: str) -> None:
    """Refuse a table over time that does not reach from one time to another [s]."""
    if table.x[0] > begin or table.x[-1] < end:
        raise InputError(
            f"{table.source}: the table must cover {span}, {begin:g} to {end:g} s; it goes from "
            f"{table.x[0]:g} to {table.x[-1]:g} s"
        )


def check_angles(table: Table, low: float, high: float) -> None:
    """Refuse a table over the angle that does not reach from one to another [rad]."""
    first, last = table.x[0], table.x[-1]
    if first - SAME_ANGLE > low or last + SAME_ANGLE < high:
        raise InputError(
            f"{table.source}: the table must cover the run, {low / DEGREE:g} to {high / DEGREE:g} "
            f"degrees, or be 360 or 720 degrees whose last row repeats the first; it goes from "
            f"{first / DEGREE:g} to {last / DEGREE:g} degrees"
        )
