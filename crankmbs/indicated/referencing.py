"""What a pressure is measured from, by word or by its compression, and the signal put upon it.

A transducer of charge gives changes of pressure. Its zero comes from the inlet, where near the
bottom dead centre the cylinder has the pressure of the manifold, or from the compression, which is
nearly a polytrope: p + c = C V^-n is linear in c and C for a given n. Both are described by
A. L. Randolph, Methods of Processing Cylinder-Pressure Transducer Signals to Maximize Data Accuracy
(SAE 900170, 1990), and by M. F. J. Brunt and C. R. Pond, Evaluation of Techniques for Absolute
Cylinder Pressure Correction (SAE 970036, 1997).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.errors import InputError, UndecidedError
from crankmbs.indicated.dead_centre import (
    EXPONENTS,
    fired_dead_centre,
    is_fired,
    motored_dead_centre,
)
from crankmbs.indicated.options import REFERENCES, Options, Reference
from crankmbs.indicated.record import Channel
from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import BAR

__all__ = ["Cycles", "decide", "refer"]

_NEAR = 0.15e5  # Pa: so near 0, or the ambient, an offset has to lie
_AMBIENT = 1.0e5  # Pa, near enough at any site: `_NEAR` is wider than weather and height
_INTAKE = (
    0.3e5  # Pa: an intake's absolute pressure is seldom less, a gauge one without a charger is
)
_COMPRESSION = (-100.0, -40.0)  # degrees from the firing dead centre
_INLET = 10.0  # degrees about the bottom dead centre
_MEAN = "its mean within 10 degrees of the bottom dead centre"


class Cycles(NamedTuple):
    """One cylinder's cycles from gas exchange to gas exchange, before they are referenced.

    phi : shape (n,) [deg] from the firing dead centre; pressure : shape (cycles, n) [Pa]
    period [deg]; firing : the file's angle [deg] of the firing dead centre; lag [deg] : measured,
        behind the first cylinder; intake : mean cycle [Pa] of the intake, over phi
    first : how many rows behind the file's first they begin
    follow : whether each begins where the one before ends; else some between them are left out, or
        the rows before `first` are moved behind the others of the same cycle
    """

    channel: Channel
    phi: Array
    pressure: Array
    period: float
    firing: float
    lag: float
    intake: Array | None
    first: int
    follow: bool

    @property
    def at_inlet(self) -> NDArray[np.bool_]:
        """The rows near the bottom dead centre before the compression."""
        before = (self.phi < 0.0) | (self.period < 400.0)
        return (np.abs(np.mod(self.phi, 360.0) - 180.0) <= _INLET) & before


class _Compression(NamedTuple):
    """What a polytrope of 1.28 to 1.40 asks for.

    ends : for each cylinder what is least and most to be added [Pa]
    """

    ends: list[tuple[float, float]]

    @property
    def asked(self) -> str:
        """In words."""
        low, high = min(low for low, _ in self.ends), max(high for _, high in self.ends)
        return f"a polytrope of 1.28 to 1.40 asks for {low / BAR:.2f} to {high / BAR:.2f} bar more"

    @property
    def telling(self) -> bool:
        """Whether the cylinders ask for the same, and for less than absolute and gauge differ by
        twice."""
        lows, highs = zip(*self.ends, strict=True)
        wide, apart = max(highs) - min(lows), max(lows) - min(highs)
        return bool(wide < 2.0 * _AMBIENT and apart <= 2.0 * _NEAR)

    def asks_for(self, offset: float) -> bool:
        """Whether this [Pa] may be what is to be added."""
        return all(low - _NEAR <= offset <= high + _NEAR for low, high in self.ends)

    @property
    def kind(self) -> str:
        """Absolute or gauge, where only one of them can be; else nothing."""
        absolute, gauge = self.asks_for(0.0), self.asks_for(_AMBIENT)
        if absolute == gauge or not self.telling:
            return ""
        return "absolute" if absolute else "gauge"

    def against(self, reference: Reference) -> str:
        """What speaks against a reference, in words; nothing where it may be right."""
        kind, value = reference
        added = {"absolute": 0.0, "gauge": _AMBIENT if value is None else value}.get(kind)
        if added is None or not self.telling or self.asks_for(added):
            return ""
        other = self.kind or "neither absolute nor gauge"
        cause = "the reference is wrong" if other == kind else f"they are {other}"
        return f"{self.asked}: the dead centre is off, or {cause}"


def decide(
    cylinders: Sequence[Cycles], options: Options, shape: Shape | None
) -> tuple[Reference, str, str]:
    """The reference of the signals, and why: as given, as the file says, as the compression shows;
    and what speaks against it, else nothing.

    Raises
    ------
    UndecidedError : nothing of these
    """
    said = {each.channel.reference for each in cylinders}
    means = [each.pressure.mean(axis=0) for each in cylinders]
    compression = None
    if shape is not None and shape.ratio is not None:
        asked = (
            sorted(
                float(by_polytrope(each.phi - _motored(each.phi, mean), mean[None], shape, n)[0])
                for n in EXPONENTS
            )
            for mean, each in zip(means, cylinders, strict=True)
        )
        compression = _Compression([(low, high) for low, high in asked])
    if options.reference is not None or (len(said) == 1 and "" not in said):
        reference = options.reference or Reference(min(said))
        against = [] if compression is None else [compression.against(reference)]
        other = {"absolute": "gauge", "gauge": "absolute"}.get(reference.kind)
        if other in said:
            against.insert(0, f"the heading says {other}")
        why = "as the heading says" if options.reference is None else "as given"
        return reference, why, ", and ".join(filter(None, against))
    lows = [np.mean(mean[each.at_inlet]) for mean, each in zip(means, cylinders, strict=True)]
    levels = f"the gas exchange lies at {', '.join(f'{low / BAR:.3g}' for low in lows)} bar"
    if compression is not None:
        if compression.kind == "absolute" or (compression.kind and min(lows) < _INTAKE):
            why = f"as the compression shows: {compression.asked}"
            return Reference(compression.kind), why, ""
        levels += f", and {compression.asked}"
        centre = fired_dead_centre(cylinders[0].phi, means[0], shape)
        if centre is not None:
            levels += (
                f"; they may be absolute with a dead centre {centre.middle:+.1f} +- "
                f"{centre.half:.1f} degrees from the file's, or another compression ratio: "
                "check those first"
            )
    raise UndecidedError(
        f"the file does not say what its pressures are measured from; {levels}", REFERENCES
    )


def _motored(phi: Array, mean: Array) -> float:
    """The dead centre [deg] that a motored cycle has by its peak; 0 of others: the file's."""
    if is_fired(phi, mean) is not False:
        return 0.0
    return motored_dead_centre(phi, mean, 0.0, None).middle


def refer(cycles: Cycles, reference: Reference, shape: Shape | None) -> tuple[Array, bool, str]:
    """What is added to each cycle, shape (cycles,) [Pa]; whether the sum is absolute; in words.

    Raises
    ------
    InputError : a reference that needs what is not there
    """
    kind, value = reference
    nothing = np.zeros(len(cycles.pressure))
    if kind == "absolute":
        return nothing, True, "the pressures are absolute and stay as they are"
    if kind == "gauge" and value is None:
        return nothing, False, "the pressures are gauge and stay so"
    if kind == "gauge" and value is not None:
        return nothing + value, True, f"the pressures are gauge; {value / BAR:g} bar is added"
    if kind == "polytrope" and value is not None:
        if shape is None or shape.ratio is None:
            raise InputError(
                "a reference by polytrope needs stroke, rod length and compression ratio; give a "
                "scene and compression_ratio"
            )
        added = by_polytrope(cycles.phi, cycles.pressure, shape, value)
        why = (
            f"the compression is a polytrope of {value:g} from 100 to 40 degrees before the dead "
            "centre"
        )
    elif value is not None:
        added = by_inlet(cycles, value)
        why = f"{_MEAN} is the inlet's {value / BAR:g} bar"
    elif cycles.intake is not None:
        inlet = float(np.mean(cycles.intake[cycles.at_inlet]))
        added = by_inlet(cycles, inlet)
        why = f"{_MEAN} is the {inlet / BAR:.4g} bar of the intake's column"
    else:
        raise InputError(
            "the file has no column of the intake's pressure; give it, such as "
            'reference="inlet 1.0 bar"'
        )
    spread = ""
    if len(added) > 1:
        spread = f", cycle by cycle, from {np.min(added) / BAR:.4g} to {np.max(added) / BAR:.4g}"
    return added, True, f"{np.mean(added) / BAR:.4g} bar is added{spread}, so that {why}"


def by_polytrope(phi: Array, pressure: Array, shape: Shape, exponent: float) -> Array:
    """What is to be added to each cycle so that its compression is a polytrope.

    c of least squares in p + c = C V^-n, from 100 to 40 degrees before the firing dead centre

    Parameters
    ----------
    phi : shape (n,) [deg] from the firing dead centre; pressure : shape (cycles, n) [Pa]
    shape : with its compression ratio; exponent : n [1]

    Returns
    -------
    shape (cycles,) [Pa]; an exponent too high by 0.01 adds some percent of the pressure at the
    beginning of the compression
    """
    window = (phi >= _COMPRESSION[0]) & (phi <= _COMPRESSION[1])
    basis = shape.volume(np.radians(phi[window])) ** -exponent
    columns = np.column_stack([np.full_like(basis, -1.0), basis])
    solved, *_ = np.linalg.lstsq(columns, pressure[:, window].T, rcond=None)
    return np.asarray(solved[0])


def by_inlet(cycles: Cycles, inlet: float) -> Array:
    """What is to be added to each cycle so that it has the inlet's pressure [Pa] where its
    compression begins: on average within 10 degrees of the bottom dead centre; shape (cycles,)."""
    return np.asarray(inlet - np.mean(cycles.pressure[:, cycles.at_inlet], axis=1))
