"""The dead centre as the compression shows it.

A motored cycle peaks before the dead centre, by the thermodynamic loss angle: heat and mass that it
loses. Given that angle the peak is the dead centre; without it, and in a fired cycle, which shows
its compression only up to the ignition, the dead centre is an interval.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array

__all__ = [
    "EXPONENTS",
    "LATE_PEAK",
    "DeadCentre",
    "fired_dead_centre",
    "is_fired",
    "motored_dead_centre",
]

EXPONENTS = (1.28, 1.40)  # of the compression of air and mixture in engines
_ABOUT = 8.0  # degrees about the peak: a quartic follows a motored one to 0.01 degrees
_LOSS = (0.2, 1.2)  # degrees: loss angles that engines are taken to have where none is given
_FIT = 0.02  # degrees: what the quartic may be off
_SIGMAS = 2.0  # standard deviations of the cycles that the interval takes in
_COMPRESSION = (-100.0, -30.0)  # degrees: before any ignition
_OFFSETS = (-5e3, 5e3)  # Pa: how well a referenced pressure is known
_ASIDE = 45.0  # degrees from the peak, where burnt gas shows
_CHORDS = (0.85, 0.7, 0.5, 0.35, 0.25)  # of the range: levels of chords through the peak
_LEAN = (-1.7, 0.6)  # degrees: the middles of a motored cycle's chords from that of the highest
_LEANING = (-2.5, 1.2)  # degrees: beyond, it burns
LATE_PEAK = 2.5  # degrees: a peak farther behind the dead centre is a fired one's, or this is off
_MOTORED, _FIRED = 1.06, 1.25  # of the pressures behind and before the peak


class DeadCentre(NamedTuple):
    """Where the true dead centre lies, from that which the file has: ``low`` to ``high`` [deg].

    peak : angle [deg] of the peak; motored : whether it rests on that, else on the compression
    loss_angle [deg] : behind the peak, where it was given
    skew : how far [deg] the middle of the chord at 70 % of the peak lies from the peak
    """

    low: float
    high: float
    peak: float
    motored: bool
    loss_angle: float | None = None
    skew: float = math.nan

    @property
    def middle(self) -> float:
        """The middle of the interval [deg]."""
        return 0.5 * (self.low + self.high)

    @property
    def at_peak(self) -> bool:
        """Whether it may lie where a motored cycle with this peak has it."""
        return self.low <= self.peak + _LOSS[1] and self.peak + _LOSS[0] <= self.high

    @property
    def half(self) -> float:
        """Half its width [deg]: the uncertainty."""
        return 0.5 * (self.high - self.low)


def is_fired(phi: Array, mean: Array) -> bool | None:
    """Whether a mean cycle burns, by the pressures 45 degrees before and behind its peak and by how
    far it leans; None where these do not tell.

    A motored cycle is symmetric about its peak but for its losses, wherever the file's dead centre
    lies. Some that burn little are, too, and peak late: a late symmetric peak tells nothing.
    """
    peak = float(phi[np.argmax(mean)])
    before, behind = np.interp([peak - _ASIDE, peak + _ASIDE], phi, mean)
    low = float(np.min(mean))
    rise = 0.02 * (np.max(mean) - low)  # a signal without reference has no ratios
    ratio = (behind - low + rise) / (before - low + rise)
    if ratio > _FIRED or ratio < 1.0 / _FIRED:  # the last one backwards
        return True
    middles = np.array([_chord(phi, mean, level) for level in _CHORDS])
    least, most = np.min(middles - middles[0]), np.max(middles - middles[0])
    symmetric = ratio < _MOTORED and _LEAN[0] <= least and most <= _LEAN[1]
    if least < _LEANING[0] or most > _LEANING[1] or (peak > LATE_PEAK and not symmetric):
        return True
    return False if symmetric and peak <= LATE_PEAK else None


def _chord(phi: Array, mean: Array, level: float) -> float:
    """Middle [deg] of the chord about the highest row at a level over the lowest, of the range."""
    above = mean - np.min(mean) - level * np.ptp(mean)
    top = int(np.argmax(mean))
    first = int(np.max(np.flatnonzero(above[:top] < 0.0), initial=0))
    last = top + int(np.min(np.flatnonzero(above[top:] < 0.0), initial=len(phi) - 1 - top))
    rising, falling = slice(first, first + 2), slice(last, last - 2, -1)
    return 0.5 * float(
        np.interp(0.0, above[rising], phi[rising]) + np.interp(0.0, above[falling], phi[falling])
    )


def peak_of(phi: Array, mean: Array, noise: float) -> tuple[float, float]:
    """Angle [deg] of a smooth peak, by a quartic about it, and its standard deviation.

    noise : standard deviation of a row of the mean [Pa]
    """
    middle = float(phi[np.argmax(mean)])
    for _ in range(2):  # the second time about the peak itself
        window = np.abs(phi - middle) <= _ABOUT
        x, y = (phi[window] - middle) / _ABOUT, mean[window]
        quartic, variances = np.polyfit(x, y, 4, cov="unscaled")
        slope = np.polyder(quartic)
        turning = np.roots(slope)
        real = turning.real[(np.abs(turning.imag) < 1e-9) & (np.abs(turning.real) <= 1.0)]
        at = float(real[np.argmin(np.abs(real))]) if len(real) else 0.0
        middle += _ABOUT * at
    bend = abs(float(np.polyval(np.polyder(slope), at)))
    gradient = np.array([4.0 * at**3, 3.0 * at**2, 2.0 * at, 1.0, 0.0])
    spread = gradient @ variances @ gradient
    return middle, _ABOUT * noise * math.sqrt(max(float(spread), 0.0)) / max(bend, 1e-300)


def motored_dead_centre(
    phi: Array, mean: Array, noise: float, loss_angle: float | None
) -> DeadCentre:
    """The dead centre of a motored cycle: its peak and the loss angle behind it [deg].

    noise : standard deviation of a row of the mean [Pa]
    loss_angle : None: between 0.2 and 1.2 degrees, which are taken for what engines have
    """
    at, spread = peak_of(phi, mean, noise)
    off = _FIT + _SIGMAS * spread
    least, most = _LOSS if loss_angle is None else (loss_angle, loss_angle)
    skew = _skew(phi, mean, at)
    return DeadCentre(at + least - off, at + most + off, at, True, loss_angle, skew)


def fired_dead_centre(phi: Array, mean: Array, shape: Shape | None) -> DeadCentre | None:
    """The interval of the dead centre in which the compression before the ignition is a polytrope
    of an exponent between 1.28 and 1.40, the pressure known to 0.05 bar.

    least squares of ln(p + c) = ln C - n ln V(phi - d) in d and C, from 100 to 30 degrees before;
    None where the pressure is no absolute one there, or no compression ratio is known
    """
    if shape is None or shape.ratio is None:
        return None
    window = (phi >= _COMPRESSION[0]) & (phi <= _COMPRESSION[1])
    angle, pressure = phi[window], mean[window]
    if np.min(pressure) <= -_OFFSETS[0]:
        return None
    centres = [_shift(angle, pressure + c, shape, n) for n in EXPONENTS for c in _OFFSETS]
    peak = float(phi[np.argmax(mean)])
    return DeadCentre(min(centres), max(centres), peak, motored=False)


def _shift(phi: Array, pressure: Array, shape: Shape, exponent: float) -> float:
    logarithm = np.log(pressure)

    def residual(unknown: Array) -> Array:
        volume = shape.volume(np.radians(phi - unknown[0]))
        return np.asarray(logarithm - unknown[1] + exponent * np.log(volume))

    begin = float(np.mean(logarithm + exponent * np.log(shape.volume(np.radians(phi)))))
    return float(least_squares(residual, [0.0, begin]).x[0])


def _skew(phi: Array, mean: Array, peak: float) -> float:
    """Middle of the chord at 70 % of the peak less the peak [deg]."""
    level = 0.7 * float(np.max(mean))
    before = (phi < peak) & (phi > peak - 60.0)
    behind = (phi > peak) & (phi < peak + 60.0)
    first = float(np.interp(level, mean[before], phi[before]))
    second = float(np.interp(-level, -mean[behind], phi[behind]))
    return 0.5 * (first + second) - peak
