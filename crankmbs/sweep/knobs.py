"""What is varied of a scene, by name, over which values."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.errors import InputError, at_place, shown
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.function import named
from crankmbs.scene.change import changed, field_at, value_at
from crankmbs.scene.scene import Scene
from crankmbs.scene.schema import dimension_of
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import quantity, unit_of
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.pressure_table import TABLE_KNOBS, TABLE_VALUES, table_at
from crankmbs.sweep.reading import reading_of

__all__ = ["DERIVED", "Interval", "Knob", "interval_of", "knob_of", "number_at"]

DERIVED = {"rod_ratio": None, "settled_speed": "angular speed", **TABLE_KNOBS}
"""Knobs that are no value of a scene, and their dimensions."""

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_RANGE = re.compile(rf"\s*({_NUMBER})\s*\.\.\s*({_NUMBER})\s*([^:]*?)\s*(:.*)?")
_AMOUNT = re.compile(rf"\s*({_NUMBER})\s*(.*)")
_MOST = 100_000  # values of one knob
_GRAMMAR = 'write values as "0.05..0.5 kg m^2:40", "0.14..0.2 m:25:log", or a list "100 mm, 120 mm"'


@dataclass(frozen=True, eq=False)
class Knob:
    """A value of a scene, and what it is set to.

    name : as `Scene.with_` takes it with dots, or of `DERIVED`
    units : of numbers; empty for words
    values : shape (n,), what a scene takes: floats in SI units, whole numbers, or objects
    """

    name: str
    units: str
    values: NDArray[Any]

    @property
    def labels(self) -> NDArray[Any]:
        """The values as a coordinate: numbers, or what tells words, tables and parts apart."""
        if self.values.dtype != object:
            return self.values.astype(np.float64)
        return np.array([_label(value) for value in self.values], np.dtypes.StringDType())


class Interval(NamedTuple):
    """A value of a scene between two bounds, in SI units."""

    name: str
    units: str
    low: float
    high: float
    log: bool = False
    whole: bool = False

    def at(self, share: Array | float) -> Array:
        """The values at shares of the way, shape (n,); on a logarithmic way where asked."""
        if self.log:
            return np.asarray(self.low * (self.high / self.low) ** share)
        if self.whole:
            count = self.high - self.low + 1.0
            return np.asarray(np.minimum(self.low + np.floor(share * count), self.high))
        return np.asarray(self.low + share * (self.high - self.low))

    def taken(self, share: Array) -> Knob:
        """The knob at these values."""
        values = self.at(share)
        return Knob(self.name, self.units, values.astype(np.int64) if self.whole else values)


class _Kind(NamedTuple):
    """What values a knob takes."""

    name: str
    dimension: str | None
    whole: bool

    @property
    def unit(self) -> str:
        """Of its numbers; empty where they have none."""
        return unit_of(self.dimension) if self.dimension else ""


def knob_of(scene: Scene, name: str, values: object, most: int = _MOST) -> Knob:
    """A knob from a text such as "0.05..0.5 kg m^2:40", or from a sequence of values.

    Raises
    ------
    InputError : no such name in the scene, or values that cannot be; begins with the name

    >>> from crankmbs import load_scene
    >>> knob_of(load_scene("propeller"), "rod.length", "0.14..0.2 m:3").values
    array([0.14, 0.17, 0.2 ])
    """
    kind = _kind(scene, name)
    if isinstance(values, str):
        if match := _RANGE.fullmatch(values):
            return _spaced(kind, match)
        items: Sequence[object] = [item.strip() for item in values.split(",")]
    elif isinstance(values, Sequence | np.ndarray):
        items = values.tolist() if isinstance(values, np.ndarray) else values
    else:
        raise InputError(f"{name}: must be a text or a sequence of values; {shown(values)} came")
    if not 1 <= len(items) <= most:
        raise InputError(f"{name}: must have from 1 to {most} values; {len(items)} came")
    return _knob(kind, [_value(scene, kind, item) for item in items])


def interval_of(scene: Scene, name: str, text: object) -> Interval:
    """The bounds of a knob, from a text such as "0.05..0.5 kg m^2" or "0.05..0.5 kg m^2:log".

    Raises
    ------
    InputError : no such name in the scene, or no bounds; begins with the name

    >>> from crankmbs import load_scene
    >>> interval_of(load_scene("propeller"), "rod.length", "140..200 mm").high
    0.2
    """
    kind = _kind(scene, name)
    match = _RANGE.fullmatch(text) if isinstance(text, str) else None
    if match is None or match[4] not in (None, ":log"):
        raise InputError(
            f'{name}: must be two bounds, such as "0.05..0.5 kg m^2" or "0.05..0.5 kg m^2:log"; '
            f"{shown(text)} came"
        )
    return _interval(kind, match, match[4] is not None)


def number_at(scene: Scene, name: str) -> Knob:
    """A knob at the number that the scene has there.

    Raises
    ------
    InputError : no such name, or no number there

    >>> from crankmbs import load_scene
    >>> number_at(load_scene("propeller"), "crank.radius").values
    array([0.046])
    """
    kind = _kind(scene, name)
    derived = {"rod_ratio": scene.crank.radius / scene.rod.length, **TABLE_VALUES}
    value = derived.get(kind.name) if kind.name in DERIVED else value_at(scene, kind.name)
    if kind.whole or isinstance(value, bool) or not isinstance(value, float):
        raise InputError(f"{name}: must be a number that a little can be added to; it is no such")
    return _knob(kind, [value])


def _kind(scene: Scene, name: str) -> _Kind:
    dotted = re.sub(r"\[(\d+)\]", r".\1", name).replace("__", ".")
    if dotted in TABLE_KNOBS:
        table_at(scene, name)
    if dotted in DERIVED:
        return _Kind(dotted, DERIVED[dotted], False)
    try:
        place = field_at(scene, name)
    except InputError as error:
        try:
            reading_of(name, columns_of(scene))
        except InputError:
            raise InputError(f"{error}{did_you_mean(name, list(DERIVED))}") from None
        raise InputError(
            f"{name}: is a measure, which follows from a case; vary what it depends on, such "
            f'as crank.inertia, and draw over it: crankmbs plot SWEEP --over "{name}"'
        ) from None
    if place is None:
        return _Kind(dotted, None, False)
    whole = place[0].__pydantic_fields__[place[1]].annotation is int
    return _Kind(dotted, dimension_of(*place), whole)


def _interval(kind: _Kind, match: re.Match[str], log: bool) -> Interval:
    low, high = (_number(kind, match[k], match[3]) for k in (1, 2))
    if low == high or (log and not low * high > 0.0):
        rule = "of one sign, not 0, for steps by a factor" if log else "apart"
        raise InputError(f"{kind.name}: both bounds must be {rule}; {shown(match[0].strip())} came")
    return Interval(kind.name, kind.unit, low, high, log, kind.whole)


def _spaced(kind: _Kind, match: re.Match[str]) -> Knob:
    count, _, way = (match[4] or ":")[1:].partition(":")
    number = int(count) if count.isdecimal() and len(count) < 9 else 0
    if not 2 <= number <= _MOST or way not in ("", "log"):
        raise InputError(
            f"{kind.name}: a range needs how many values it has, from 2 to {_MOST}, then perhaps "
            f"log; {shown(match[0])} came; {_GRAMMAR}"
        )
    if (
        kind.dimension is None and match[3] and kind.name not in DERIVED
    ):  # of a unit that only the field knows
        space = np.geomspace if way else np.linspace
        numbers = space(float(match[1]), float(match[2]), number).tolist()
        return _knob(kind, [f"{value:.12g} {match[3]}" for value in numbers])
    between = _interval(kind, match, way == "log")
    if kind.whole:
        values = np.round(np.linspace(between.low, between.high, number))
        return _knob(kind, np.unique(values).astype(np.int64).tolist())
    knob = between.taken(np.linspace(0.0, 1.0, number))
    knob.values[-1] = between.high
    return knob


def _number(kind: _Kind, number: str, unit: str) -> float:
    """A number in SI units; only those without a dimension, and bare SI numbers, have no unit."""
    if kind.dimension is not None and (unit or kind.dimension in ("angle", "angular speed")):
        with at_place(kind.name):
            return quantity(f"{number} {unit}", kind.dimension)
    if unit:
        raise InputError(f"{kind.name}: takes numbers without a unit; {shown(unit)} came")
    value = float(number)
    if not math.isfinite(value) or (kind.whole and not value.is_integer()):
        rule = "whole numbers" if kind.whole else "finite numbers"
        raise InputError(f"{kind.name}: takes {rule}; {shown(number)} came")
    return value


def _value(scene: Scene, kind: _Kind, item: object) -> object:
    """One value as a scene takes it: a file is read here, once for all cases."""
    if not isinstance(item, str):
        return int(item) if kind.whole and isinstance(item, float) and item.is_integer() else item
    amount = _AMOUNT.fullmatch(item)
    if amount and (kind.dimension is not None or not amount[2]):
        number = _number(kind, amount[1], amount[2])
        return int(number) if kind.whole else number
    if kind.name in DERIVED:
        raise InputError(f"{kind.name}: {shown(item)} is no number; {_GRAMMAR}")
    return value_at(changed(scene, {kind.name: item}), kind.name)


def _knob(kind: _Kind, values: list[object]) -> Knob:
    if all(isinstance(value, Real) for value in values):
        return Knob(kind.name, kind.unit, np.array(values))
    return Knob(kind.name, kind.unit, np.fromiter(values, dtype=object))


def _label(value: object) -> str:
    if isinstance(value, Table | CylinderTable):
        return value.source
    function = getattr(value, "function", value)
    return named(function) if callable(function) else shown(value).strip('"')
