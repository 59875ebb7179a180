"""One cylinder's cycles, referenced, smoothed on request, and what they amount to."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.indicated.dead_centre import (
    DeadCentre,
    fired_dead_centre,
    is_fired,
    motored_dead_centre,
)
from crankmbs.indicated.findings import CylinderPressure
from crankmbs.indicated.options import Options
from crankmbs.indicated.quality import closure, mean_effective_pressure, noise, smoothed
from crankmbs.indicated.referencing import Cycles
from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array

__all__ = ["cylinder_of"]


def cylinder_of(
    cycles: Cycles, added: Array, shape: Shape | None, options: Options, absolute: bool
) -> CylinderPressure:
    """The cylinder from its cycles and what is added to each, shape (cycles,) [Pa]."""
    phi, period = cycles.phi, cycles.period
    before = cycles.pressure + added[:, None]
    mean, rough = np.mean(before, axis=0), noise(phi, before)
    pressure, moved = before, None
    if options.smooth is not None:
        pressure = smoothed(phi, before, math.degrees(options.smooth))
        moved = _moved(phi, mean, np.mean(pressure, axis=0), shape, period)
    fired = is_fired(phi, np.mean(pressure, axis=0))
    centre: DeadCentre | None
    if fired is False:
        loss = None if options.loss_angle is None else math.degrees(options.loss_angle)
        centre = motored_dead_centre(phi, mean, rough / math.sqrt(len(before)), loss)
    else:
        centre = fired_dead_centre(phi, mean, shape if absolute else None)
    return CylinderPressure(
        number=cycles.channel.cylinder,
        name=cycles.channel.name,
        angle=phi,
        pressure=pressure,
        offset=added,
        firing=cycles.firing,
        lag=cycles.lag,
        imep=None if shape is None else mean_effective_pressure(phi, pressure, shape, period),
        fired=fired,
        dead_centre=centre,
        noise=rough,
        closure=float(np.median(closure(pressure))),
        moved=moved,
    )


def _moved(
    phi: Array, rough: Array, smooth: Array, shape: Shape | None, period: float
) -> tuple[float, float, float]:
    """By how much smoothing moved peak [Pa], its angle [deg] and imep [Pa] of the mean cycle."""
    work = math.nan
    if shape is not None:
        work = float(mean_effective_pressure(phi, smooth - rough, shape, period))
    peak = float(np.max(smooth) - np.max(rough))
    return peak, float(phi[np.argmax(smooth)] - phi[np.argmax(rough)]), work
