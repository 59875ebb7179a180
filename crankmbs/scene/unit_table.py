"""Units by their symbols, with SI prefixes, their products and powers.

A unit is a factor and its powers of metre, kilogram and second; an angle is a pure number.
"""

from __future__ import annotations

import math
import re
from functools import cache

__all__ = ["PREFIXES", "UNITS", "factor"]

PREFIXES = {
    "P": 1e15,
    "T": 1e12,
    "G": 1e9,
    "M": 1e6,
    "k": 1e3,
    "h": 1e2,
    "da": 1e1,
    "d": 1e-1,
    "c": 1e-2,
    "m": 1e-3,
    "µ": 1e-6,  # the micro sign
    "μ": 1e-6,  # the Greek letter
    "u": 1e-6,
    "n": 1e-9,
    "p": 1e-12,
}
_BASE = {"m": (1, 0, 0), "kg": (0, 1, 0), "s": (0, 0, 1), "rad": (0, 0, 0)}
UNITS: dict[str, tuple[float, str]] = {
    "g": (1e-3, "kg"),
    "N": (1.0, "kg m/s^2"),
    "Pa": (1.0, "N/m^2"),
    "J": (1.0, "N m"),
    "W": (1.0, "J/s"),
    "bar": (1e5, "Pa"),
    "t": (1e3, "kg"),
    "min": (60.0, "s"),
    "h": (3600.0, "s"),
    "Nm": (1.0, "N m"),
    "kp": (9.80665, "N"),
    "kgf": (9.80665, "N"),
    "at": (98066.5, "Pa"),
    "atm": (101325.0, "Pa"),
    "Torr": (101325.0 / 760.0, "Pa"),
    "PS": (735.49875, "W"),
    "deg": (math.pi / 180.0, "rad"),
    "rev": (2.0 * math.pi, "rad"),
    "rpm": (math.pi / 30.0, "rad/s"),
    "in": (0.0254, "m"),
    "inch": (0.0254, "m"),
    "ft": (0.3048, "m"),
    "oz": (0.028349523125, "kg"),
    "lb": (0.45359237, "kg"),
    "slug": (0.45359237 * 9.80665 / 0.3048, "kg"),
    "lbf": (0.45359237 * 9.80665, "N"),
    "psi": (0.45359237 * 9.80665 / 0.0254**2, "Pa"),
    "hp": (550.0 * 0.45359237 * 9.80665 * 0.3048, "W"),
}
"""Unit -> its size in another; the names beside metre, second and radian."""

_PREFIXED = {"m", "g", "s", "rad", "N", "Nm", "Pa", "J", "W", "bar"}
_SUPERSCRIPT = str.maketrans("⁻¹²³⁴⁵⁶⁷⁸⁹", "-123456789")
_RAISED = re.compile("([⁻¹²³⁴⁵⁶⁷⁸⁹]+)")
_FACTOR = r"([^\W\d_]+)(?:\s*(?:\*\*|\^)\s*(-?[1-9]))?"
_FACTORS = re.compile(rf"(?:^|\s*([*/·⋅])\s*|\s+){_FACTOR}")
_LONGEST = 40  # letters: a longer one is an expression


def factor(unit: str, si: str) -> float | None:
    """The factor from a unit to an SI unit, or None where they are no units of one dimension.

    A unit is a product such as "kgf/cm^2", "N*m*s**2" or "m s⁻²", read from the left.

    >>> factor("kN m", "N m"), factor("kN", "N m")
    (1000.0, None)
    """
    product, target = _product(unit), _product(si)
    if product is None or target is None or product[1] != target[1]:
        return None
    return product[0] / target[0]


@cache
def _product(text: str) -> tuple[float, tuple[int, ...]] | None:
    """The factor to SI and the powers of metre, kilogram and second; None where it is no unit."""
    text = _RAISED.sub(lambda raised: f"^{raised[1].translate(_SUPERSCRIPT)}", text)
    if len(text) > _LONGEST:
        return None
    size, at = 1.0, 0
    powers: tuple[int, ...] = (0, 0, 0)
    while at < len(text):
        match = _FACTORS.match(text, at)
        base = match and _single(match[2])
        if not match or not base:
            return None
        power = int(match[3] or 1) * (-1 if match[1] == "/" else 1)
        size *= base[0] ** power
        powers = tuple(p + power * q for p, q in zip(powers, base[1], strict=True))
        at = match.end()
    return size, powers


def _single(name: str) -> tuple[float, tuple[int, ...]] | None:
    """A unit with its prefix, if it has one."""
    if name in _BASE:
        return 1.0, _BASE[name]
    if name in UNITS:
        size, text = UNITS[name]
        known = _product(text)
        return known and (size * known[0], known[1])
    for prefix, size in PREFIXES.items():
        rest = name.removeprefix(prefix)
        if rest != name and rest in _PREFIXED:
            known = _single(rest)
            return known and (size * known[0], known[1])
    return None
