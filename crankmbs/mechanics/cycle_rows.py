"""The rows of pressure tables over the cycle angle of each cylinder, gauge and closed."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.scene.cycles import cycles_in, mean_cycle
from crankmbs.scene.gas import Gas, tables_of
from crankmbs.scene.pressure_rows import Period, close
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table

__all__ = ["Tables", "behind", "rows_of", "rows_of_table"]

Tables = Table | CylinderTable | tuple[Table, ...]


def rows_of(scene: Scene, gas: Gas, source: Tables) -> tuple[Period, ...]:
    """The rows that the pressure of each cylinder is joined from [rad, Pa]; cylinders of one table
    share them.

    >>> gas = load_scene("propeller").gas
    >>> rows, = rows_of(load_scene("propeller"), gas, gas.pressure)
    """
    shifts = behind(scene, gas, source)
    if isinstance(source, Table):
        return (rows_of_table(gas, source, shifts[0]),) * len(shifts)
    pairs = zip(tables_of(source), shifts, strict=True)
    return tuple(rows_of_table(gas, table, shift) for table, shift in pairs)


def rows_of_table(gas: Gas, table: Table, shift: float = 0.0) -> Period:
    """The rows of a table, of its mean cycle where that is asked for, at angles higher by a shift
    [rad].

    >>> gas = load_scene("propeller").gas
    >>> rows_of_table(gas, gas.pressure).jumps
    False
    """
    table = mean_cycle(table, gas.period) if gas.cycles == "mean" else table
    angle, value = np.add(table.x, shift), np.subtract(table.y, gas.ambient or 0.0)
    period = cycles_in(table, gas.period) * gas.period
    return close(Table(angle.tolist(), value.tolist()), period)


def behind(scene: Scene, gas: Gas, source: Tables) -> tuple[float, ...]:
    """By how much the angles of the tables lag the cycle angle of each cylinder [rad]."""
    cylinders = scene.cylinders
    by_instant = isinstance(source, CylinderTable) and not gas.aligned
    return tuple(
        _zero(gas) + (c.phase - cylinders[0].phase if by_instant else 0.0) for c in cylinders
    )


def _zero(gas: Gas) -> float:
    """Cycle angle [rad] of a table's 0."""
    return 2.0 * math.pi if gas.zero == "firing_tdc" and gas.stroke == 4 else 0.0
