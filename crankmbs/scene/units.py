"""Quantity strings to SI floats.

A quantity is one number and one unit. Angles and angular speeds take a short list of units: a
radian is a pure number, so that 1/min would be one, and people mean different things by Hz.
"""

from __future__ import annotations

import math
import re

from crankmbs.errors import InputError, shown
from crankmbs.scene.unit_table import factor

__all__ = [
    "BAR",
    "DEGREE",
    "EXAMPLES",
    "RPM",
    "check_size",
    "extent",
    "quantity",
    "share_of",
    "unit_of",
]

BAR = 1e5  # Pa
DEGREE = math.pi / 180.0  # rad
RPM = math.pi / 30.0  # rad/s

_NUMBER_AND_UNIT = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(\s.*|[^\W\d_].*)"
)
_SHARE = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(%?)\s*")

_USUAL = {  # the SI unit first
    "acceleration": ("m/s^2", "ft/s^2"),
    "area": ("m^2", "cm^2", "mm^2", "in^2"),
    "force": ("N", "kN", "kgf", "lbf"),
    "inertia": ("kg m^2", "kg cm^2", "lb in^2"),
    "length": ("m", "cm", "mm", "in"),
    "mass": ("kg", "g", "t", "lb"),
    "power": ("W", "kW", "PS", "hp"),
    "pressure": ("Pa", "kPa", "MPa", "bar", "psi"),
    "quadratic coefficient": ("N m s^2", "N m/rpm^2"),
    "speed": ("m/s", "mm/s", "ft/min"),
    "stiffness": ("N/m", "N/mm", "kN/m", "lbf/in"),
    "time": ("s", "ms", "min"),
    "torque": ("N m", "kN m", "lbf ft"),
    "unbalance": ("kg m", "g mm", "g cm", "lb in"),
    "viscous coefficient": ("N m s", "N m/rpm"),
    "viscous friction": ("N s/m", "lbf s/in"),
}
_LISTED = {  # no others are taken
    "angle": {"rad": 1.0, "deg": DEGREE, "rev": 2.0 * math.pi},
    "angular speed": {"rpm": RPM, "rad/s": 1.0, "deg/s": DEGREE},
    "proportional gain": {"s/rad": 1.0, "s/deg": 1.0 / DEGREE, "1/rpm": 1.0 / RPM},
    "integral gain": {"1/rad": 1.0, "1/deg": 1.0 / DEGREE, "1/rev": 0.5 / math.pi},
}
_SMALLEST, _LARGEST = 1e-50, 1e15  # in SI units: products of several neither vanish nor overflow
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
    "speed": '"10 m/s"',
    "stiffness": '"12 N/mm"',
    "time": '"0.75 s"',
    "torque": '"87 N m"',
    "unbalance": '"0.01 kg m"',
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
    >>> quantity("60\N{DEGREE SIGN}", "angle") == quantity("60 deg", "angle")
    True
    """
    number, unit = _split(text, dimension)
    listed = _LISTED.get(dimension)
    size = listed.get(unit) if listed else factor(unit, unit_of(dimension))
    if size is None:
        *most, last = listed or _USUAL[dimension]
        way_out = f"{', '.join(most)} or {last}"
        raise InputError(f"{shown(text)} is no {dimension} here: use {way_out}")
    return number * size


def extent(text: str) -> tuple[float, str]:
    """Return (value, unit) of a stretch of angle or time; the unit is "rad", "s" or "cycle".

    >>> extent("20 cycles")
    (20.0, 'cycle')
    """
    number, unit = _split(text, "extent")
    if unit in _CYCLE:
        return number, "cycle"
    if unit in _LISTED["angle"]:
        return number * _LISTED["angle"][unit], "rad"
    size = factor(unit, "s")
    if size is None:
        raise InputError(f"{shown(text)} is no angle or time: use cycles, rev, deg, rad or s")
    return number * size, "s"


def share_of(text: str) -> float:
    """A share such as "1 %" or "0.01"; no number of another text.

    >>> share_of("1 %"), share_of("1 N")
    (0.01, nan)
    """
    match = _SHARE.fullmatch(text)
    return math.nan if match is None else float(match[1]) * (0.01 if match[2] else 1.0)


def unit_of(dimension: str) -> str:
    """The SI unit of a dimension.

    >>> unit_of("angular speed")
    'rad/s'
    """
    if dimension == "angular speed":
        return "rad/s"
    return next(iter(_LISTED.get(dimension) or _USUAL[dimension]))


def check_size(value: float, dimension: str, written: object) -> None:
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
            f"it overflows; {shown(written)} came"
        )


def _split(text: str, dimension: str) -> tuple[float, str]:
    match = _NUMBER_AND_UNIT.fullmatch(text.replace("\N{DEGREE SIGN}", " deg"))
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
