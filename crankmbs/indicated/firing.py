"""Where each cylinder fires, and its cycles cut where their gas exchange is.

Two cylinders' firing dead centres lie as far apart as the rising flanks of their compression.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crankmbs.errors import InputError, UndecidedError
from crankmbs.indicated.options import Options
from crankmbs.indicated.record import Record
from crankmbs.numerics.arrays import Array

__all__ = ["cut_cycles", "firing_angle", "flank", "half_cycles", "lags", "peak_or_given", "places"]

_BEFORE, _BEHIND = 25.0, 60.0  # degrees about a dead centre where the peak of a cycle may lie
_USUAL = 8.0  # degrees behind it
_FLANK = 0.1  # of the range: still compression, before any combustion
_APART = 4.0  # degrees: how well a flank tells a dead centre
_EMPTY = 0.1  # of the others' rise up to the dead centre: nothing was compressed
_GRID = sorted({*range(0, 720, 30), *range(0, 720, 72), *range(0, 720, 45)})


def firing_angle(angle: Array, mean: Array, period: float) -> float:
    """The file's angle [deg] of the firing dead centre of the cylinder that counts as first: the
    multiple of 360 degrees next to the peak.

    Raises
    ------
    UndecidedError : no such angle is near the peak, or two of one cycle have one
    """
    peak = float(angle[np.argmax(mean)])
    nominal = 360.0 * round((peak - 5.0) / 360.0)
    if not -_BEFORE < peak - nominal < _BEHIND:
        raise UndecidedError(
            f"the peak of the pressure lies at {peak:.4g} degrees, not near a multiple of "
            "360: the angles do not count from a dead centre of this cylinder",
            ('firing_tdc="... deg", the file\'s angle of the firing dead centre',),
        )
    _check_alone(angle, mean, period, nominal)
    return nominal


def peak_or_given(record: Record, options: Options) -> float:
    """The angle [deg] of the firing dead centre of a record over time: the one given modulo 360
    that is next to the peak of the first cylinder, else the peak, next to which it lies.

    Raises
    ------
    InputError : the peak is not near it; UndecidedError : two peaks a cycle
    """
    sign = -1.0 if options.invert else 1.0
    mean = sign * np.mean(record.channels[0].values, axis=0)
    peak = float(record.angle[np.argmax(mean)])
    _check_alone(record.angle, mean, record.period, peak)
    if options.firing_tdc is None:
        return peak
    centre = float(np.degrees(options.firing_tdc))
    before = _off_by(peak - centre - _USUAL, 360.0) + _USUAL
    if not -_BEFORE < before < _BEHIND:
        raise InputError(
            f"the peak of the pressure lies {peak % 360.0:.4g} degrees after the first "
            f"edge of a revolution, {before:.4g} degrees from the dead centre given, {centre:g}; "
            "correct firing_tdc, or leave it out"
        )
    return (peak - before) % record.period


def _check_alone(angle: Array, mean: Array, period: float, at: float) -> None:
    """Refuse a four-stroke cycle with a second peak 360 degrees behind."""
    if period < 700.0:
        return
    other = np.interp(at + 360.0, angle, mean, period=period)
    if other - np.min(mean) > 0.5 * (np.max(mean) - np.min(mean)):
        raise UndecidedError(
            f"the pressure is as high at {at:.4g} degrees as 360 degrees later",
            ("stroke=2", "stroke=4 with firing_tdc"),
        )


def flank(angle: Array, mean: Array, period: float, level: float) -> float:
    """The angle [deg] at which the pressure, on its way to the peak, last rises through a level."""
    first = int(np.argmax(mean)) + 1
    at = np.concatenate([angle[first:] - period, angle[:first]])  # up to the peak
    above = np.concatenate([mean[first:], mean[:first]]) - np.min(mean) - level
    k = np.flatnonzero(above <= 0.0)[-1]
    return float(at[k] - (at[k + 1] - at[k]) * above[k] / (above[k + 1] - above[k]))


def lags(angle: Array, means: Sequence[Array], period: float) -> list[float]:
    """By how much [deg] each cylinder fires after the first, within a period."""
    level = _FLANK * min(float(np.ptp(mean)) for mean in means)
    at = [flank(angle, mean, period, level) for mean in means]
    return [(each - at[0]) % period for each in at]


def places(measured: Sequence[float], period: float, known: Sequence[float] | None) -> list[float]:
    """The lags [deg] that the measured ones stand for: that of the scene's layout where it is near,
    else the nearest even one; 0 for all where each cylinder runs over its cycle angle.

    known : those of the layout, modulo the period

    Raises
    ------
    UndecidedError : a lag that is none of these
    """
    near = [_off(each, 0.0, period) for each in measured]
    if max(near, default=0.0) < _APART:
        return [0.0] * len(measured)
    intended = []
    for number, each in enumerate(measured, start=1):
        if known is not None and _off(each, known[number - 1], period) <= _APART:
            intended.append(known[number - 1])
            continue
        nominal = min((g for g in _GRID if g < period), key=lambda g: _off(each, g, period))
        if _off(each, nominal, period) > _APART:
            raise UndecidedError(
                f"the cylinder of pressure column {number} fires {each:.4g} degrees "
                "after the first one, which no even firing has",
                (
                    "scene=..., whose layout says when it fires",
                    'columns="PCYL1" where the others are no pressures',
                ),
            )
        intended.append(float(nominal))
    return intended


def cut_cycles(
    angle: Array, values: Array, period: float, firing: float, consecutive: bool
) -> tuple[int, Array, Array]:
    """The cycles from half a period before the firing dead centre to half a period behind.

    Of consecutive cycles the end of one is joined to the beginning of the next, and the first
    begun and the last unfinished are left out; of others the cycle is closed in itself.

    Returns
    -------
    how many rows the first cycle begins behind the file's; angles [deg] from the firing dead
    centre, shape (n,); values, shape (cycles or cycles - 1, n)
    """
    n = len(angle)
    behind = np.mod(angle - firing + 0.5 * period + 1e-9, period) - 1e-9
    first = int(np.argmin(behind))
    phi = np.roll(behind, -first) - 0.5 * period
    if first == 0:
        return 0, phi, values
    if not consecutive or len(values) < 3:
        return first, phi, np.roll(values, -first, axis=1)
    flat = values.reshape(-1)[first : len(values) * n - (n - first)]
    return first, phi, flat.reshape(len(values) - 1, n)


def half_cycles(phi: Array, pressure: Array) -> tuple[float, float] | None:
    """How far [Pa] the dead centre lies above the lowest pressure, in two-stroke cycles of which
    every second one compresses nothing, and in the others; None where all compress.

    One that only fails to fire compresses as the others do: without, it is a gas exchange.

    Parameters
    ----------
    phi : shape (n,) [deg] from the firing dead centre; pressure : shape (cycles, n) [Pa]
    """
    if np.ptp(phi) > 400.0 or len(pressure) < 2:
        return None
    rise = pressure[:, np.argmin(np.abs(phi))] - np.min(pressure, axis=1)
    low, high = sorted((float(np.mean(rise[::2])), float(np.mean(rise[1::2]))))
    return (low, high) if low < _EMPTY * high else None


def _off(a: float, b: float, period: float) -> float:
    return abs(_off_by(a - b, period))


def _off_by(angle: float, period: float) -> float:
    return (angle + 0.5 * period) % period - 0.5 * period
