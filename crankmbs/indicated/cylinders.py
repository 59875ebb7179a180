"""One cylinder's cycles, referenced, smoothed on request, and what they amount to."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.errors import InputError
from crankmbs.indicated.dead_centre import (
    DeadCentre,
    fired_dead_centre,
    is_fired,
    motored_dead_centre,
)
from crankmbs.indicated.findings import CylinderPressure
from crankmbs.indicated.options import Options
from crankmbs.indicated.referencing import Cycles
from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array

__all__ = ["cylinder_of"]

_GAS_EXCHANGE = 200.0  # degrees from the firing dead centre: nothing burns behind
_NORMAL = 1.4826  # standard deviations of a normal law in a median of deviations
_FEW = 20  # differences whose median is no estimate


def cylinder_of(
    cycles: Cycles, added: Array, shape: Shape | None, options: Options, level: bool
) -> CylinderPressure:
    """The cylinder from its cycles and what is added to each, shape (cycles,) [Pa].

    level : whether the pressures are absolute, and not by their own compression
    """
    phi, period = cycles.phi, cycles.period
    before = cycles.pressure + added[:, None]
    mean, rough = np.mean(before, axis=0), _noise(phi, before)
    pressure, moved = before, None
    if options.smooth is not None:
        pressure = _smoothed(phi, before, math.degrees(options.smooth))
        moved = _moved(phi, mean, np.mean(pressure, axis=0), shape, period)
    fired = is_fired(phi, np.mean(pressure, axis=0))
    if fired is None and options.loss_angle is not None:
        fired = False  # a loss angle is of a motored cycle
    centre: DeadCentre | None
    if fired is False:
        loss = None if options.loss_angle is None else math.degrees(options.loss_angle)
        centre = motored_dead_centre(phi, mean, rough / math.sqrt(len(before)), loss)
    else:
        centre = fired_dead_centre(phi, mean, shape if level else None)
        if fired is None and centre is not None and not centre.at_peak:
            fired = True
    return CylinderPressure(
        number=cycles.channel.cylinder,
        name=cycles.channel.name,
        angle=phi,
        pressure=pressure,
        offset=added,
        firing=cycles.firing,
        lag=cycles.lag,
        imep=None if shape is None else _mean_effective_pressure(phi, pressure, shape, period),
        fired=fired,
        dead_centre=centre,
        noise=rough,
        closure=float(np.median(_closure(pressure))),
        moved=moved,
        imep_within=_within(phi, pressure, shape, period, centre),
        imep_a_degree=_a_degree(phi, pressure, shape, period),
    )


def _within(
    phi: Array, pressure: Array, shape: Shape | None, period: float, centre: DeadCentre | None
) -> tuple[float, float] | None:
    """The mean imep [Pa] with the dead centre at either end of where it may lie, the less first."""
    if shape is None or centre is None:
        return None
    low, high = sorted(
        float(np.mean(_mean_effective_pressure(phi - at, pressure, shape, period)))
        for at in (centre.low, centre.high)
    )
    return low, high


def _a_degree(phi: Array, pressure: Array, shape: Shape | None, period: float) -> float | None:
    """By how much the mean imep [Pa] changes with a dead centre one degree later."""
    if shape is None:
        return None
    before, behind = (
        float(np.mean(_mean_effective_pressure(phi - at, pressure, shape, period)))
        for at in (-0.5, 0.5)
    )
    return behind - before


def _moved(
    phi: Array, rough: Array, smooth: Array, shape: Shape | None, period: float
) -> tuple[float, float, float]:
    """By how much smoothing moved peak [Pa], its angle [deg] and imep [Pa] of the mean cycle."""
    work = math.nan
    if shape is not None:
        work = float(_mean_effective_pressure(phi, smooth - rough, shape, period))
    peak = float(np.max(smooth) - np.max(rough))
    return peak, float(phi[np.argmax(smooth)] - phi[np.argmax(rough)]), work


def _mean_effective_pressure(phi: Array, pressure: Array, shape: Shape, period: float) -> Array:
    """Indicated mean effective pressure of each cycle.

    imep = (1 / V_d) int p dV = int p (ds/dphi) dphi over the period, s the travel over the stroke

    Parameters
    ----------
    phi : shape (n,) [deg] from the true firing dead centre; pressure : shape (cycles, n) [Pa]

    Returns
    -------
    shape (cycles,) [Pa]: by the trapezoidal rule, whose error for a smooth periodic pressure at
    even angles falls faster than any power of their distance
    """
    angle = np.radians(phi)
    turned = np.radians(period)
    gaps = np.diff(np.append(angle, angle[0] + turned))
    weight = 0.5 * (gaps + np.roll(gaps, 1))
    return pressure @ (weight * shape.travel_1(angle))


def _noise(phi: Array, pressure: Array) -> float:
    """Standard deviation of a row's noise [Pa], from fourth differences of the gas exchange, or of
    all rows in a two-stroke cycle and where that has few: their median, which neither valves nor
    knocking move.

    Divided differences, sum_k p_k / prod_{j != k} (phi_k - phi_j) over five rows: steps need not be
    even. Each is divided by the standard deviation that noise of 1 gives it.
    """
    five = np.lib.stride_tricks.sliding_window_view(phi, 5)
    apart = five[:, :, None] - five[:, None, :]
    weights = 1.0 / np.prod(apart, axis=2, where=~np.eye(5, dtype=bool))
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    rows = np.lib.stride_tricks.sliding_window_view(pressure[:64], 5, axis=1)
    sizes = np.abs(np.einsum("crk,rk->cr", rows, weights))
    inside = np.abs(phi[2:-2]) > _GAS_EXCHANGE
    if np.max(phi) < 300.0 or sizes[:, inside].size <= _FEW:
        inside = np.full(inside.shape, True)
    return float(_NORMAL * np.median(sizes[:, inside]))


def _closure(pressure: Array) -> Array:
    """How far each cycle's last row lies from the first of the next one, beyond the step before
    it; the first of the same cycle where there is no next: shape (cycles,) [Pa]."""
    following = np.append(pressure[1:, 0], pressure[-1, 0])
    return following - (2.0 * pressure[:, -1] - pressure[:, -2])


def _smoothed(phi: Array, pressure: Array, width: float) -> Array:
    """Cycles under a sliding cubic of least squares (Savitzky and Golay) over ``width`` degrees.

    Raises
    ------
    InputError : angles that are not evenly spaced, or a width of fewer than five rows
    """
    step = float(np.median(np.diff(phi)))
    if not np.allclose(np.diff(phi), step, rtol=1e-3):
        raise InputError(
            "smooth needs evenly spaced angles, and the resolution changes within the "
            "cycle; leave smooth out, or resample the file"
        )
    rows = 2 * round(0.5 * width / step) + 1
    if not 5 <= rows < len(phi):
        raise InputError(
            f"smooth must span at least five rows, {4.0 * step:g} degrees here, and less "
            f"than the cycle; {width:g} degrees came"
        )
    from scipy.signal import savgol_filter  # a fifth of a second: only where it is asked for

    return savgol_filter(pressure, rows, 3, axis=1, mode="wrap")
