"""Quantity strings to SI floats: the only file that knows pint.

A quantity is one number and one unit. The number is split off here, and only the unit is given
to pint, which would otherwise evaluate expressions. Angles and angular speeds take a short list
of units, because pint counts radians as pure numbers and people mean different things by Hz.
"""

from __future__ import annotations

import math
import re
from functools import cache

from crankmbs.errors import InputError, shown

__all__ = ["BAR", "DEGREE", "EXAMPLES", "RPM", "check_size", "extent", "quantity", "unit_of"]

BAR = 1e5  # Pa
DEGREE = math.pi / 180.0  # rad
RPM = math.pi / 30.0  # rad/s

_NUMBER_AND_UNIT = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(\s.*|[^\W\d_].*)"
)
_FACTOR = r"[^\W\d_]+(?:\s*(?:\*\*|\^)\s*-?[1-9])?"  # one exponent: pint would raise 9^9^9
_UNIT = re.compile(rf"{_FACTOR}(?:(?:\s*[*/·]\s*|\s+){_FACTOR})*")
_LONGEST_UNIT = 40  # letters: a longer one is an expression

_SI = {
    "acceleration": "m/s^2",
    "area": "m^2",
    "force": "N",
    "inertia": "kg m^2",
    "integral gain": "1/rad",
    "length": "m",
    "mass": "kg",
    "power": "W",
    "pressure": "Pa",
    "proportional gain": "s/rad",
    "quadratic coefficient": "N m s^2",
    "time": "s",
    "torque": "N m",
    "viscous coefficient": "N m s",
    "viscous friction": "N s/m",
}
_ANGLE = {"rad": 1.0, "deg": DEGREE, "rev": 2.0 * math.pi}
_SMALLEST, _LARGEST = 1e-50, 1e15  # in SI units: products of several neither vanish nor overflow
_ANGULAR_SPEED = {"rpm": RPM, "rad/s": 1.0, "deg/s": DEGREE}
_GAINS = {
    "proportional gain": {"s/rad": 1.0, "s/deg": 1.0 / DEGREE, "1/rpm": 1.0 / RPM},
    "integral gain": {"1/rad": 1.0, "1/deg": 1.0 / DEGREE, "1/rev": 0.5 / math.pi},
}
_CYCLE = {"cycle", "cycles"}

EXAMPLES = {
    "acceleration": '"9.81 m/s^2"',
    "angle": '"30 deg"',
    "angular speed": '"3200 rpm"',
    "area": '"57.08 cm^2"',
    "extent": '"20 cycles", "10 rev" or "0.75 s"',
    "force": '"40 N"',
    "inertia": '"0.15 kg m^2"',
    "integral gain": '"0.02 1/rad"',
    "length": '"46 mm"',
    "mass": '"1.14 kg"',
    "power": '"20 kW"',
    "pressure": '"1 bar"',
    "proportional gain": '"0.004 s/rad"',
    "quadratic coefficient": '"7.8e-4 N m s^2"',
    "time": '"0.75 s"',
    "torque": '"87 N m"',
    "viscous coefficient": '"0.26 N m s"',
    "viscous friction": '"30 N s/m"',
}


def quantity(text: str, dimension: str) -> float:
    """Return the SI value of a quantity string such as ``"46 mm"``.

    Parameters
    ----------
    text : one finite number and one unit; no arithmetic, no decimal comma
    dimension : a name such as "length" or "angular speed"

    Raises
    ------
    InputError : no number, no unit, or a unit of another dimension

    >>> quantity("46 mm", "length")
    0.046
    """
    number, unit = _split(text, dimension)
    if dimension == "angle":
        factor = _ANGLE.get(unit)
    elif dimension == "angular speed":
        factor = _ANGULAR_SPEED.get(unit)
    elif dimension in _GAINS:
        factor = _GAINS[dimension].get(unit)
    else:
        factor = _factor(unit, _SI[dimension])
    if factor is None:
        raise InputError(f"{shown(text)} is no {dimension} here: use {_units_for(dimension)}")
    return number * factor


def extent(text: str) -> tuple[float, str]:
    """Return (value, unit) of a stretch of angle or time; the unit is "rad", "s" or "cycle".

    >>> extent("20 cycles")
    (20.0, 'cycle')
    """
    number, unit = _split(text, "extent")
    if unit in _CYCLE:
        return number, "cycle"
    if unit in _ANGLE:
        return number * _ANGLE[unit], "rad"
    factor = _factor(unit, "s")
    if factor is None:
        raise InputError(f"{shown(text)} is no angle or time: use cycles, rev, deg, rad or s")
    return number * factor, "s"


def unit_of(dimension: str) -> str:
    """The SI unit of a dimension.

    >>> unit_of("angular speed")
    'rad/s'
    """
    return {"angle": "rad", "angular speed": "rad/s"}.get(dimension) or _SI[dimension]


def check_size(value: float, dimension: str, came: object) -> None:
    """Refuse a finite SI value whose products double precision does not hold.

    Raises
    ------
    InputError : what came, in which range it must be

    >>> check_size(0.046, "length", "46 mm")
    """
    if math.isfinite(value) and value != 0.0 and not _SMALLEST <= abs(value) <= _LARGEST:
        unit = unit_of(dimension)
        raise InputError(
            f"must be 0, or from {_SMALLEST:g} to {_LARGEST:g} {unit} in size, or calculating with "
            f"it overflows; {shown(came)} came"
        )


def _split(text: str, dimension: str) -> tuple[float, str]:
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None:
        raise InputError(
            f"{shown(text)} is not a quantity: write one number and one unit, such as "
            f"{EXAMPLES[dimension]}{_hint(text)}"
        )
    number = float(match[1])
    if not math.isfinite(number):
        raise InputError(f"must be finite; {shown(text)} came")
    return number, match[2].strip()


def _hint(text: str) -> str:
    if re.search(r"\d,\d", text):
        return "; the decimal sign is a point"
    if re.search("[\N{MINUS SIGN}\N{EN DASH}\N{EM DASH}]", text):
        return '; the minus sign is the plain "-"'
    return ""


def _units_for(dimension: str) -> str:
    lists = {"angle": _ANGLE, "angular speed": _ANGULAR_SPEED, **_GAINS}
    listed = lists.get(dimension)
    if listed is None:
        return f"a unit such as in {EXAMPLES[dimension]}"
    *most, last = listed
    return f"{', '.join(most)} or {last}"


@cache
def _factor(unit: str, si: str) -> float | None:
    """Factor to the SI unit, or None when ``unit`` is no unit of that dimension."""
    if len(unit) > _LONGEST_UNIT or not _UNIT.fullmatch(unit):
        return None
    import pint  # a sixth of a second: only when a scene is read from text

    registry = pint.application_registry
    try:
        return float(registry.Quantity(1.0, unit).to(si).magnitude)
    except (pint.PintError, AttributeError, ValueError, TypeError, ArithmeticError):
        return None
