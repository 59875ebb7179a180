"""The gas: pressure difference across the piston as a periodic piecewise cubic of the cycle angle.

Whatever the scene gives, a table or an indicator diagram, becomes one set of knots and polynomial
pieces. The solvers need the pieces themselves: a knot is a step boundary, and each piece can be
continued beyond its knots.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache, partial

import numpy as np
from scipy.interpolate import PPoly

from crankmbs.errors import InputError
from crankmbs.mechanics.cycle_rows import rows_of, rows_of_table
from crankmbs.mechanics.geometry import Shape, dead_centres
from crankmbs.mechanics.indicator import INDICATOR_RTOL, fit, indicator_pieces, relative_volume
from crankmbs.mechanics.knots import KNOT, apart, repeat
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle, common_period
from crankmbs.scene.cycles import cycles_in
from crankmbs.scene.gas import AnyPressure, Gas, Polytrope, tables_of
from crankmbs.scene.pressure_rows import closing_row, interpolate, overshoot
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.scene.units import BAR, DEGREE

__all__ = [
    "PeriodicPressure",
    "combustion_of",
    "crank_ends_of",
    "motored_of",
    "net_of",
    "pressures_at",
    "pressures_of",
    "remarks",
]


_OVERSHOOT = 0.05  # of the range: a sine in rows 45 degrees apart is overshot by 0.04


@dataclass(frozen=True, eq=False)
class PeriodicPressure(Cycle):
    """Pressure difference across the piston [Pa], periodic in the cycle angle.

    missed : shape (4, n), alike: what the pieces may be off from the pressure that they stand for;
        None where they are that pressure
    """

    missed: Array | None = None

    @property
    def perturbed(self) -> PeriodicPressure:
        """A pressure as far from this one as the true pressure may be."""
        if self.missed is None:
            return self
        return PeriodicPressure(self.knots, self.coefficients + self.missed)

    @cached_property
    def peak(self) -> tuple[float, float]:
        """Cycle angle [rad] and value [Pa] of the highest pressure, the first of equal ones."""
        pieces = PPoly(self.coefficients, self.knots)
        turning = pieces.derivative().roots(discontinuity=False, extrapolate=False)
        turning = turning[np.isfinite(turning)]
        ends = self.piece(np.arange(len(self.knots) - 1), np.diff(self.knots))
        angle = np.concatenate([self.knots[:-1], self.knots[1:], turning])
        value = np.concatenate([self.coefficients[-1], ends, pieces(turning)])
        highest = np.flatnonzero(value >= value.max() - 1e-9 * abs(value.max()))
        first = highest[np.argmin(angle[highest])]
        return float(np.mod(angle[first] + KNOT, self.period) - KNOT), float(value[first])

    def on(self, knots: Array) -> PeriodicPressure:
        """The same between knots of another set [rad], in each of which lies one piece."""
        missed = None if self.missed is None else Cycle(self.knots, self.missed).cubics(knots)
        return PeriodicPressure(knots, self.cubics(knots), missed)


def pressures_at(pressures: Sequence[PeriodicPressure], cycle_angles: Array) -> Array:
    """Pressure differences across the pistons [Pa], each at its own cycle angles, shape
    (cylinders, ...) [rad]; cylinders of one pressure are looked up together.

    >>> pressures_at(pressures_of(load_scene("v_twin")), np.zeros((2, 3))).shape
    (2, 3)
    """
    once = list(dict.fromkeys(pressures))
    if len(once) == 1:
        return once[0](cycle_angles)
    values = np.empty_like(cycle_angles)
    for each in once:
        rows = [k for k, pressure in enumerate(pressures) if pressure is each]
        values[rows] = each(cycle_angles[rows])
    return values


def combustion_of(
    fired: PeriodicPressure, motored: PeriodicPressure
) -> tuple[PeriodicPressure, PeriodicPressure]:
    """The pressure without combustion, and what combustion adds to it, on the same knots."""
    whole, without = _on_all_knots(fired, motored)
    missed = None
    if without.missed is not None and whole.missed is not None:
        missed = whole.missed - without.missed
    more = PeriodicPressure(whole.knots, whole.coefficients - without.coefficients, missed)
    return without, more


def net_of(head: PeriodicPressure, crank_end: PeriodicPressure, share: float) -> PeriodicPressure:
    """The pressure that pushes a whole piston as those of both its ends do: that of the head end
    less that of the crank end on its share of the area, on the knots of both."""
    above, below = _on_all_knots(head, crank_end)
    net = above.coefficients - share * below.coefficients
    return PeriodicPressure(above.knots, net, above.missed)


def _on_all_knots(
    one: PeriodicPressure, other: PeriodicPressure
) -> tuple[PeriodicPressure, PeriodicPressure]:
    """Both on the knots of both, over the least common multiple of their periods."""
    period = common_period(each.period for each in (one, other))
    first = float(one.knots[0])
    inner = [repeat(p.knots[:-1], p.period, first, first + period) for p in (one, other)]
    knots = apart(np.concatenate([[first], *inner]))
    knots = np.append(knots[knots < first + period - KNOT], first + period)
    return one.on(knots), other.on(knots)


def pressures_of(scene: Scene) -> tuple[PeriodicPressure, ...] | None:
    """The pressure of each head end of a scene less ambient; None without gas.

    A table's rows are joined as `crankmbs.scene.pressure_rows.interpolate` says. Cylinders of one
    table share one pressure; a sequence of cycles has them all for its period.

    >>> pressure, = pressures_of(load_scene("propeller"))
    """
    gas = scene.gas
    if gas is None:
        return None
    if gas.indicator is not None:
        return _of_indicator(scene, gas, fires=True)
    assert gas.pressure is not None
    return _of_source(scene, gas, gas.pressure)


def motored_of(scene: Scene) -> tuple[PeriodicPressure, ...]:
    """The same without combustion, of a scene with gas and ``gas.motored`` or an indicator.

    >>> len(motored_of(load_scene("v_twin")))
    2
    """
    gas, fired = scene.gas, pressures_of(scene)
    assert gas is not None
    assert fired is not None
    if gas.indicator is not None:
        return _of_indicator(scene, gas, fires=False)
    assert gas.motored is not None
    if not isinstance(gas.motored, Polytrope):
        return _of_source(scene, gas, gas.motored)
    continued = cache(partial(_continued, gas, gas.motored))
    return tuple(map(continued, fired, (gear.shape for gear in scene.running_gear)))


def crank_ends_of(scene: Scene) -> tuple[PeriodicPressure, ...] | None:
    """The pressure of each crank end less ambient, read as that of `pressures_of`; None without.

    >>> crank_ends_of(load_scene("propeller")) is None
    True
    """
    gas = scene.gas
    if gas is None or gas.crank_end is None:
        return None
    return _of_source(scene, gas, gas.crank_end)


def _of_indicator(scene: Scene, gas: Gas, *, fires: bool) -> tuple[PeriodicPressure, ...]:
    """That of each cylinder over its own volume; cylinders of one shape share it."""

    @cache
    def of_shape(shape: Shape) -> PeriodicPressure:
        knots, coefficients = indicator_pieces(gas, shape, fires=fires)
        absolute = coefficients + np.array([[0.0], [0.0], [0.0], [gas.ambient or 0.0]])
        return PeriodicPressure(knots, coefficients, INDICATOR_RTOL * absolute)

    return tuple(of_shape(gear.shape) for gear in scene.running_gear)


def _of_source(scene: Scene, gas: Gas, source: AnyPressure) -> tuple[PeriodicPressure, ...]:
    """The pressure of each cylinder from what a file, several or a constant say."""
    cylinders = scene.cylinders
    if isinstance(source, float):
        value = np.array([[0.0], [0.0], [0.0], [source - (gas.ambient or 0.0)]])
        return (PeriodicPressure(np.array([0.0, gas.period]), value),) * len(cylinders)
    rows = rows_of(scene, gas, source)
    each = {id(one): one for one in rows}
    once = {k: PeriodicPressure(*interpolate(one, gas.interpolation)) for k, one in each.items()}
    return tuple(once[id(one)] for one in rows)


def _continued(
    gas: Gas, polytrope: Polytrope, fired: PeriodicPressure, shape: Shape
) -> PeriodicPressure:
    """A fired pressure of a cylinder of this shape, from ``closes`` to the true bottom dead centre
    a polytrope in its place, in every cycle.

    Raises
    ------
    InputError : no pressure to begin with
    """
    ambient, ratio = gas.ambient or 0.0, polytrope.compression_ratio
    top, bottom = (2.0 * math.pi + angle for angle in dead_centres(*shape))
    begin, end = top + polytrope.closes, bottom
    whole = np.arange(begin, begin + fired.period - 1e-6, gas.period)
    knots, columns = [], []
    for at in whole:
        pressed = float(fired(at)) + ambient
        if not pressed > 0.0:
            raise InputError(
                f"gas.motored.closes: a polytrope begins with a pressure above 0 absolute; at "
                f"{at / DEGREE:.8g} degrees {pressed / BAR:.3g} bar came between the rows of the "
                'table; give another angle, or interpolation = "pchip"'
            )
        size = float(relative_volume(shape, ratio, np.array(at)))

        def pressure(angle: Array, pressed: float = pressed, size: float = size) -> Array:
            volume = relative_volume(shape, ratio, angle)
            return np.asarray(pressed * (size / volume) ** polytrope.polytrope)

        rows = repeat(fired.knots[:-1], fired.period, at, at + end - begin)
        left, cubics = fit(at, at + end - begin, pressure, rows)
        cubics[-1] -= ambient
        inner = repeat(fired.knots[:-1], fired.period, at + end - begin, at + gas.period)
        rest = np.concatenate([[at + end - begin], inner, [at + gas.period]])
        knots += [left, rest[:-1]]
        columns += [cubics, fired.cubics(rest)]
    coefficients = np.concatenate(columns, axis=1)
    return PeriodicPressure(np.append(np.concatenate(knots), begin + fired.period), coefficients)


def remarks(scene: Scene) -> tuple[str, ...]:
    """What a reader of the pressure tables should know of what was made of them, in sentences.

    >>> remarks(load_scene("propeller"))
    ()
    """
    gas = scene.gas
    if gas is None:
        return ()
    return tuple(
        said
        for table in dict.fromkeys(sum(map(tables_of, (gas.motored, gas.crank_end)), gas.tables))
        for said in _remarks(gas, table)
    )


@lru_cache(maxsize=32)
def _remarks(gas: Gas, table: Table) -> tuple[str, ...]:
    """Of one table."""
    return tuple(_said(gas, table))


def _said(gas: Gas, table: Table) -> Iterator[str]:
    apart = closing_row(table, cycles_in(table, gas.period) * gas.period)
    if apart:
        yield (
            f"{table.source}: the closing row, {apart / BAR:.3g} bar from the first one, is dropped"
        )
    if gas.interpolation != "cubic":
        return
    knots, coefficients = interpolate(rows_of_table(gas, table), gas.interpolation)
    beyond, *between = overshoot(knots, coefficients)
    share = beyond / ((max(table.y) - min(table.y)) or 1.0)
    if share > _OVERSHOOT:
        past = np.array(between) - table.x[0]
        first, second = np.degrees(np.mod(past + KNOT, knots[-1] - knots[0]) - KNOT + table.x[0])
        yield (
            f"warning: {table.source}: between the rows at {first:.8g} and {second:.8g} degrees "
            f"the spline goes {100.0 * share:.3g} % of the table's range beyond both; the run is "
            'that of the spline, not of the machine; use interpolation = "pchip", or give two rows '
            "at one angle for a jump"
        )
