"""Which reference a signal has, by word or by its compression, and the signal put upon it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.errors import InputError, UndecidedError
from crankmbs.indicated.options import REFERENCES, Options, Reference
from crankmbs.indicated.reference import at_inlet, by_inlet, by_polytrope, offset_range
from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import BAR

__all__ = ["Raw", "decide", "refer"]

_NEAR = 0.15e5  # Pa: so near 0, or the ambient, an offset has to lie
_AMBIENT = 1.0e5  # Pa, near enough at any site: `_NEAR` is wider than weather and height


class Raw(NamedTuple):
    """One cylinder's cycles before they are referenced: phi [deg], shape (cycles, n) [Pa].

    said : what the file says of the reference; intake : mean cycle [Pa] of the intake, over phi
    """

    number: int
    name: str
    phi: Array
    pressure: Array
    said: str
    intake: Array | None


def decide(
    raws: Sequence[Raw], options: Options, shape: Shape | None, period: float, where: str
) -> tuple[Reference, str]:
    """The reference of the signals, and why: as given, as the file says, as the compression shows.

    Raises
    ------
    UndecidedError : nothing of these
    """
    units = {raw.said for raw in raws}
    if options.reference is not None:
        against = {"absolute": "gauge", "gauge": "absolute"}.get(options.reference.kind)
        though = f", though the unit says {against}" if against in units else ""
        return options.reference, f"as given{though}"
    if len(units) == 1 and "" not in units:
        return Reference(units.pop()), "as the unit says"
    bars = ", ".join(f"{np.mean(_low(raw, period)) / BAR:.3g}" for raw in raws)
    levels = f"the gas exchange lies at {bars} bar"
    if shape is not None and shape.ratio is not None:
        ranges = [offset_range(raw.phi, raw.pressure.mean(axis=0), shape) for raw in raws]
        low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
        least, most = max(r[0] for r in ranges), min(r[1] for r in ranges)
        interval = f"{low / BAR:.2f} to {high / BAR:.2f}"
        zero = all(r[0] - _NEAR <= 0.0 <= r[1] + _NEAR for r in ranges)
        ambient = all(r[0] - _NEAR <= _AMBIENT <= r[1] + _NEAR for r in ranges)
        if zero != ambient and high - low < 2.0 * _AMBIENT and least <= most + 2.0 * _NEAR:
            kind = "absolute" if zero else "gauge"
            return Reference(kind), (
                f"as the compression shows: a polytrope of 1.28 to 1.40 asks for {interval} bar "
                "more"
            )
        levels += f", and a polytrope of 1.28 to 1.40 asks for {interval} bar more"
    raise UndecidedError(
        f"{where}: the file does not say what its pressures are measured from; {levels}", REFERENCES
    )


def refer(
    raw: Raw, reference: Reference, shape: Shape | None, period: float, where: str
) -> tuple[Array, bool, str]:
    """What is added to each cycle, shape (cycles,) [Pa]; whether the sum is absolute; in words.

    Raises
    ------
    InputError : a reference that needs what is not there
    """
    cycles = len(raw.pressure)
    kind, value = reference
    if kind == "absolute":
        return np.zeros(cycles), True, "the pressures are absolute and stay as they are"
    if kind == "gauge":
        if value is None:
            return np.zeros(cycles), False, "the pressures are gauge and stay so"
        return (
            np.full(cycles, value),
            True,
            f"the pressures are gauge; {value / BAR:g} bar is added",
        )
    if kind == "polytrope":
        if shape is None or shape.ratio is None:
            raise InputError(
                f"{where}: a reference by polytrope needs stroke, rod length and compression ratio;"
                " give a scene and compression_ratio"
            )
        assert value is not None
        added = by_polytrope(raw.phi, raw.pressure, shape, value)
        rest = f"the compression is a polytrope of {value:g} from 100 to 40 degrees before"
        return added, True, _of_cycles(added, f"{rest} the dead centre")
    if value is None and raw.intake is None:
        raise InputError(
            f"{where}: the file has no column of the intake's pressure; give it, such as "
            'reference="inlet 1.0 bar"'
        )
    if value is not None:
        added = by_inlet(raw.phi, raw.pressure, period, value)
        rest = f"is the inlet's {value / BAR:g} bar"
    else:
        assert raw.intake is not None
        inlet = float(np.mean(raw.intake[_at(raw, period)]))
        added = by_inlet(raw.phi, raw.pressure, period, inlet)
        rest = f"is the {inlet / BAR:.4g} bar of the intake's column"
    mean = "its mean within 10 degrees of the bottom dead centre"
    return added, True, _of_cycles(added, f"{mean} {rest}")


def _of_cycles(added: Array, why: str) -> str:
    spread = ""
    if len(added) > 1:
        spread = f", cycle by cycle, from {np.min(added) / BAR:.4g} to {np.max(added) / BAR:.4g}"
    return f"{np.mean(added) / BAR:.4g} bar is added{spread}, so that {why}"


def _at(raw: Raw, period: float) -> np.ndarray:
    return at_inlet(raw.phi, period)


def _low(raw: Raw, period: float) -> Array:
    """The mean cycle where it breathes."""
    return np.asarray(raw.pressure.mean(axis=0)[_at(raw, period)])
