"""What a drawing of the mechanism needs: pins, pistons and liners, to scale, in the engine's frame.

X runs from the crank axis to the head, Y is X turned by +90 degrees, the main bearing is the
origin. A cylinder's axis is turned from X by its bank and lies by the offset beside the crank axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.geometry import close_loop, top_position
from crankmbs.numerics.arrays import Array
from crankmbs.scene.parts import RunningGear
from crankmbs.scene.scene import Scene

__all__ = ["Mechanism", "in_engine_frame", "mechanism"]


_WIDTH = 1.6  # of the crank radius: a piston without bore
_CROWN, _SKIRT = 0.4, 0.3  # of the piston's width: above and below its pin
_CLEARANCE = 1.0 / 14.0  # of the stroke, where no compression ratio says it


@dataclass(frozen=True)
class Mechanism:
    """Points of the drawing [m], last axis X and Y of the engine's frame.

    crank_pin, piston_pin : shape (n, cylinders, 2)
    piston, gas : shape (n, cylinders, 4, 2), corners of the piston and of the space above it
    liner : shape (cylinders, 4, 2), an open line up one wall, along the head and down the other
    """

    crank_pin: Array
    piston_pin: Array
    piston: Array
    gas: Array
    liner: Array


def mechanism(scene: Scene, crank_angle: ArrayLike) -> Mechanism:
    """Place every part at the crank angles. Pins are exact.

    Bore and compression ratio are the scene's where it has them; what a scene does not say, the
    height of a piston or the width of one without bore, is drawn in usual proportions.

    Parameters
    ----------
    scene : the machine; crank_angle : shape (n,) [rad], any number of turns

    Returns
    -------
    Mechanism : in the engine's frame, [m]

    >>> mechanism(load_scene("propeller"), [0.0]).crank_pin[0, 0].tolist()
    [0.046, 0.0]
    """
    theta = np.asarray(crank_angle, dtype=np.float64)
    gears = scene.running_gear
    r, l, e = np.array([gear.shape for gear in gears]).T
    phi = theta[:, None] + np.array([cylinder.phase for cylinder in scene.cylinders])
    pin = close_loop(phi, r, l, e).x
    top = np.array([top_position(*gear.shape) for gear in gears])
    stroke = np.array([gear.stroke for gear in gears])
    width = np.array([_width(gear) for gear in gears])
    head = top + _CROWN * width + _clearance(scene, stroke)
    crown, skirt = pin + _CROWN * width, pin - _SKIRT * width
    left, right = e + 0.5 * width, e - 0.5 * width
    foot = (top - stroke - _SKIRT * width)[np.newaxis]
    return Mechanism(
        crank_pin=in_engine_frame(scene, r * np.cos(phi), r * np.sin(phi)),
        piston_pin=in_engine_frame(scene, pin, np.broadcast_to(e, pin.shape)),
        piston=_rectangles(scene, skirt, crown, left, right),
        gas=_rectangles(scene, crown, np.broadcast_to(head, crown.shape), left, right),
        liner=_rectangles(scene, foot, head[np.newaxis], left, right)[0],
    )


def in_engine_frame(scene: Scene, x: ArrayLike, y: ArrayLike) -> Array:
    """Turn vectors or points from each cylinder's frame into the engine's by its bank.

    x, y : shape (..., cylinders), any unit; returns shape (..., cylinders, 2) in that unit
    """
    bank = np.array([cylinder.bank for cylinder in scene.cylinders])
    cos, sin = np.cos(bank), np.sin(bank)
    along, across = np.asarray(x), np.asarray(y)
    return np.stack([along * cos - across * sin, along * sin + across * cos], axis=-1)


def _rectangles(scene: Scene, low: Array, high: Array, left: Array, right: Array) -> Array:
    """Corners (low, left), (high, left), (high, right), (low, right) of every cylinder."""
    corners = [(low, left), (high, left), (high, right), (low, right)]
    return np.stack(
        [in_engine_frame(scene, x, np.broadcast_to(y, x.shape)) for x, y in corners], axis=-2
    )


def _width(gear: RunningGear) -> float:
    area = gear.piston.gas_area
    return _WIDTH * gear.radius if area is None else math.sqrt(4.0 * area / math.pi)


def _clearance(scene: Scene, stroke: Array) -> Array:
    indicator = None if scene.gas is None else scene.gas.indicator
    return (
        stroke * _CLEARANCE if indicator is None else stroke / (indicator.compression_ratio - 1.0)
    )
