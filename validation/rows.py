"""Rows of a scene's tables as the oracles' tables: pressures of the cylinders, and loads."""

import math

from crankmbs.mechanics.pressure import PeriodicPressure, pressures_of
from crankmbs.scene.gas import AnyPressure, Gas, tables_of
from crankmbs.scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.torque import Torque
from validation.oracles.machine import Loads, LoadTable, Pressure, PressurePieces, PressureTable

__all__ = ["SAME_ANGLE", "crank_ends_of", "loads_of", "pressure_of", "turns_of"]

SAME_ANGLE = 1e-9  # rad: rows so near stand at one angle


def pressure_of(scene: Scene) -> Pressure | tuple[Pressure, ...] | None:
    """One for all cylinders, or one for each."""
    gas = scene.gas
    if gas is None:
        return None
    if gas.pressure is None:
        return _pieces((pressures_of(scene) or ())[0])
    return _given(scene, gas, gas.pressure)


def crank_ends_of(scene: Scene) -> tuple[Pressure, ...]:
    """One for each cylinder; none where they are single-acting."""
    gas = scene.gas
    if gas is None or gas.crank_end is None:
        return ()
    found = _given(scene, gas, gas.crank_end)
    return found if isinstance(found, tuple) else (found,) * len(scene.cylinders)


def _given(scene: Scene, gas: Gas, source: AnyPressure) -> Pressure | tuple[Pressure, ...]:
    if isinstance(source, float):
        return _table(gas, Table((0.0, gas.period / 3.0, gas.period / 1.5), (source,) * 3))
    if isinstance(source, Table):
        return _table(gas, source)
    first = scene.cylinders[0].phase
    instants = isinstance(source, CylinderTable) and not gas.aligned
    lags = [cylinder.phase - first if instants else 0.0 for cylinder in scene.cylinders]
    return tuple(
        _table(gas, Table(tuple(angle + lag for angle in rows.x), rows.y))
        for rows, lag in zip(tables_of(source), lags, strict=True)
    )


def _pieces(pieces: PeriodicPressure) -> PressurePieces:
    coefficients = tuple(map(tuple, pieces.coefficients[::-1].T.tolist()))
    return PressurePieces(tuple(pieces.knots[:-1].tolist()), coefficients, pieces.period)


def _table(gas: Gas, rows: Table) -> PressureTable:
    angles, values, period = rows.x, rows.y, gas.period
    cycles = math.ceil((angles[-1] - angles[0] - SAME_ANGLE) / period)
    if cycles > 1 and gas.cycles == "mean":
        angles, values = _mean(angles, values, period, cycles)
    elif cycles > 1:
        period *= cycles
    closing = sum(angle - angles[0] > period - SAME_ANGLE for angle in angles)
    before = [values[-2]] if closing == 2 and angles[1] > angles[0] else []
    count = len(angles) - closing
    angles, values = (*angles[: len(before)], *angles[:count]), (*before, *values[:count])
    if gas.zero == "firing_tdc" and gas.stroke == 4:
        angles = tuple(angle + 2.0 * math.pi for angle in angles)
    gauge = tuple(value - (gas.ambient or 0.0) for value in values)
    return PressureTable(angles, gauge, period, gas.interpolation)


def _mean(
    angles: tuple[float, ...], values: tuple[float, ...], period: float, cycles: int
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The mean of cycles whose rows, without jumps at their ends, stand at the same angles."""
    rows = len(angles) - (angles[-1] - angles[0] > cycles * period - SAME_ANGLE)
    one = rows // cycles
    return angles[:one], tuple(math.fsum(values[k:rows:one]) / cycles for k in range(one))


def loads_of(torques: tuple[Torque, ...]) -> Loads:
    """The loads of a free crank, those of one law added up."""
    constant = viscous = quadratic = 0.0
    time_tables: list[LoadTable] = []
    speed_tables: list[LoadTable] = []
    angle_tables: list[PressureTable] = []
    for load in torques:
        match load:
            case Constant():
                constant += load.torque
            case Viscous():
                viscous += load.coefficient
            case Quadratic():
                quadratic += load.coefficient
            case TimeTable():
                time_tables.append(LoadTable(load.file.x, load.file.y))
            case SpeedTable():
                speed_tables.append(LoadTable(load.file.x, load.file.y))
            case AngleTable():
                angle_tables.append(turns_of(load))
    tables = tuple(time_tables), tuple(speed_tables), tuple(angle_tables)
    return Loads(constant, viscous, quadratic, *tables)


def turns_of(load: AngleTable) -> PressureTable:
    """Rows repeat after their period; without one after a turn if they span no more, else after
    two; a closing row that is like the first is left out, an other one is the value before a jump.
    """
    x, y = load.file.x, load.file.y
    turns = 1 if x[-1] - x[0] <= 2.0 * math.pi + SAME_ANGLE else 2
    period = 2.0 * math.pi * turns if load.period is None else load.period
    opening = 2 if x[1] == x[0] else 1
    closing = sum(angle - x[0] > period - SAME_ANGLE for angle in x)
    inner = slice(opening - 1, len(x) - closing)
    before = y[len(x) - closing] if closing else y[0]
    jump = before != y[opening - 1]
    angles = (*((x[0],) if jump else ()), *x[inner])
    torques = (*((before,) if jump else ()), *y[inner])
    return PressureTable(angles, torques, period, load.interpolation)
