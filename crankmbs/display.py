"""The units in which people read numbers; data files stay in SI."""

from __future__ import annotations

from crankmbs.scene.units import BAR, DEGREE, RPM

__all__ = ["displayed", "with_unit"]

_DISPLAYED = {
    "rad/s": (RPM, "rpm"),
    "rad": (DEGREE, "deg"),
    "Pa": (BAR, "bar"),
    "N/m^2": (1e6, "N/mm^2"),  # of bearings
    "W": (1e3, "kW"),
    "m": (1e-3, "mm"),
}


def displayed(units: str) -> tuple[float, str]:
    """By what an SI value is divided to be read, and the unit it is read in.

    >>> displayed("W")
    (1000.0, 'kW')
    """
    return _DISPLAYED.get(units, (1.0, units))


def with_unit(name: str, units: str) -> str:
    """A name, and in brackets the unit that people read for these SI units, if any.

    >>> with_unit("crank pin", "Pa")
    'crank pin [bar]'
    """
    return f"{name} [{displayed(units)[1]}]" if units not in ("", "1") else name
