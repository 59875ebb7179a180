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
from crankmbs.indicated.referencing import Raw
from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array

__all__ = ["cylinder_of"]


def cylinder_of(
    raw: Raw, added: Array, shape: Shape | None, period: float, options: Options, absolute: bool
) -> CylinderPressure:
    """The cylinder from its raw cycles and what is added to each, shape (cycles,) [Pa]."""
    pressure = raw.pressure + added[:, None]
    rough = noise(raw.phi, pressure)
    before = pressure
    if options.smooth is not None:
        width = math.degrees(options.smooth)
        pressure = smoothed(raw.phi, pressure, width, f"cylinder {raw.number}")
    mean = np.mean(pressure, axis=0)
    fired = is_fired(raw.phi, mean)
    imep = None
    if shape is not None:
        imep = mean_effective_pressure(raw.phi, pressure, shape, period)
    return CylinderPressure(
        number=raw.number,
        name=raw.name,
        angle=raw.phi,
        pressure=pressure,
        offset=added,
        firing=0.0,
        lag=0.0,
        imep=imep,
        fired=fired,
        dead_centre=_motored(raw.phi, before, rough, options.loss_angle)
        if fired is False
        else _interval(raw.phi, before, shape if absolute else None),
        noise=rough,
        closure=float(np.median(closure(pressure))),
        moved=None if options.smooth is None else _moved(raw.phi, before, pressure, shape, period),
    )


def _motored(phi: Array, pressure: Array, rough: float, loss_angle: float | None) -> DeadCentre:
    loss = None if loss_angle is None else math.degrees(loss_angle)
    row = rough / math.sqrt(len(pressure))
    return motored_dead_centre(phi, np.mean(pressure, axis=0), row, loss)


def _interval(phi: Array, pressure: Array, shape: Shape | None) -> DeadCentre | None:
    if shape is None or shape.ratio is None:
        return None
    return fired_dead_centre(phi, np.mean(pressure, axis=0), shape)


def _moved(
    phi: Array, before: Array, after: Array, shape: Shape | None, period: float
) -> tuple[float, float, float]:
    """By how much smoothing moved peak [Pa], its angle [deg] and imep [Pa] of the mean cycle."""
    rough, smooth = np.mean(before, axis=0), np.mean(after, axis=0)
    work = math.nan
    if shape is not None:
        both = mean_effective_pressure(phi, np.array([rough, smooth]), shape, period)
        work = float(both[1] - both[0])
    peak = float(np.max(smooth) - np.max(rough))
    return peak, float(phi[np.argmax(smooth)] - phi[np.argmax(rough)]), work
