"""The indicator diagram from polytropes, straight from the volume; angles in 80-bit floats."""

from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import LONG, Array, Number


@dataclass(frozen=True)
class Diagram:
    """A cylinder and its cycle: lengths in m, absolute pressures in Pa, exhaust None: two-stroke.

    pre_expansion: volume after combustion at constant pressure over the clearance volume.
    """

    crank_radius: Number
    rod_length: Number
    offset: Number
    compression_ratio: Number
    n_compression: Number
    n_expansion: Number
    intake: Number
    peak: Number
    exhaust: Number | None
    pre_expansion: Number = 1


def dead_centres(diagram: Diagram) -> tuple[Number, Number]:
    """Cycle angles [rad] at which crank and rod lie in line."""
    radius, length, offset = _lengths(diagram)
    top = np.arcsin(offset / (length + radius))
    return top, LONG.pi + np.arcsin(offset / (length - radius))


def absolute_pressure(diagram: Diagram, angle: Array) -> Array:
    """Pressure [Pa] at cycle angles [rad]; at a dead centre the value after it.

    p V^n = const from the bottom dead centre (compression) and from the end of combustion
    (expansion); constant in between, and during intake and exhaust.
    """
    angle, number = LONG.array(angle), LONG.number
    top, bottom = dead_centres(diagram)
    turn = 2 * LONG.pi
    since = (angle - top) % (turn if diagram.exhaust is None else 2 * turn)
    fired = turn if diagram.exhaust is not None else number(0)
    down = bottom - top
    volume = _volume(diagram, angle)
    ratio, intake, peak = (
        number(x) for x in (diagram.compression_ratio, diagram.intake, diagram.peak)
    )
    compression = intake * (ratio / volume) ** number(diagram.n_compression)
    spread = number(diagram.pre_expansion) / volume
    expansion = peak * np.minimum(spread, 1) ** number(diagram.n_expansion)
    if diagram.exhaust is None:
        two_stroke: Array = np.where(since < down, expansion, compression)
        return two_stroke
    stroke = [since < down, since < fired, since < fired + down]
    whole: Array = np.select(
        stroke, [intake + 0 * since, compression, expansion], number(diagram.exhaust)
    )
    return whole


def _lengths(diagram: Diagram) -> tuple[Number, Number, Number]:
    lengths = (diagram.crank_radius, diagram.rod_length, diagram.offset)
    radius, length, offset = (LONG.number(x) for x in lengths)
    return radius, length, offset


def _volume(diagram: Diagram, angle: Array) -> Array:
    """Cylinder volume over clearance volume."""
    radius, length, offset = _lengths(diagram)
    across = radius * np.sin(angle) - offset
    pin = radius * np.cos(angle) + np.sqrt(length * length - across * across)
    highest = np.sqrt((length + radius) ** 2 - offset * offset)
    lowest = np.sqrt((length - radius) ** 2 - offset * offset)
    share = (highest - pin) / (highest - lowest)
    result: Array = 1 + (LONG.number(diagram.compression_ratio) - 1) * share
    return result
