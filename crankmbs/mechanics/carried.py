"""A pressure carried over to a machine of another geometry.

The gas knows the volume, not the crank angle: within each stroke between the true dead centres the
pressure stays a function of the swept fraction of the stroke, at the same compression ratio. So
the rows of a table move, and are interpolated anew; a diagram of polytropes is a function of the
volume already. Left where they are, rows would fire beside the dead centres that have moved.
"""

from __future__ import annotations

import dataclasses
import math
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError
from crankmbs.mechanics.cycle_rows import Tables, behind
from crankmbs.mechanics.geometry import (
    Shape,
    bottom_position,
    close_loop,
    dead_centres,
    throw_angles,
    top_position,
)
from crankmbs.numerics.arrays import Array
from crankmbs.scene.gas import Gas, tables_of
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table

__all__ = ["carried_angle", "carried_over"]

_TURN = 2.0 * math.pi


def carried_over(scene: Scene, before: Scene) -> Scene:
    """A scene with other crank, rod or piston than before, the rows of its pressures moved to where
    the same fraction of the same stroke is swept; each cylinder's then over its own cycle angle.

    Parameters
    ----------
    scene : with the gas of the scene before

    Raises
    ------
    InputError : a rod as long as the crank, with which the piston rests for half a turn

    >>> carried_over(*2 * [load_scene("v_twin")]) == load_scene("v_twin")
    True
    """
    gas = scene.gas
    pairs = zip(before.running_gear, cycle(scene.running_gear), strict=False)
    shapes_of = [(one.shape, other.shape) for one, other in pairs]
    if gas is None or all(one == other for one, other in shapes_of):
        return scene
    if gas.indicator is not None and not tables_of(gas.crank_end):
        return scene
    shapes = {shape for way in shapes_of for shape in way}
    if any(radius == length and offset == 0.0 for radius, length, offset in shapes):
        raise InputError(
            "rod.length: a rod as long as the crank lets the piston rest for half a turn, where a "
            "table of pressures cannot follow it; give a longer rod"
        )
    moved: dict[str, Any] = {
        name: _moved(before, gas, source, shapes_of)
        for name in ("pressure", "motored", "crank_end")
        if isinstance(source := getattr(gas, name), Table | CylinderTable | tuple)
    }
    if any(isinstance(getattr(gas, name), CylinderTable) for name in moved):
        moved["aligned"] = False
    return dataclasses.replace(scene, gas=dataclasses.replace(gas, **moved))


def carried_angle(cycle_angle: ArrayLike, before: Shape, after: Shape) -> Array:
    """The cycle angles [rad] at which a machine has swept the same fraction of the same stroke as
    another before at these, shape (...).

    >>> same = 0.046, 0.153, 0.001
    >>> f"{carried_angle(1.0, same, same):.12f}"
    '1.000000000000'
    """
    phi = np.asarray(cycle_angle, dtype=np.float64)
    top, bottom = dead_centres(*before)
    turns = np.floor((phi - top) / _TURN)
    within = phi - turns * _TURN
    swept, left = _swept(within, before)
    stroke = top_position(*after) - bottom_position(*after)
    moved = np.where(within <= bottom, *throw_angles(swept * stroke, left * stroke, *after))
    return np.asarray(moved + turns * _TURN)


def _swept(phi: Array, shape: Shape) -> tuple[Array, Array]:
    """The swept fraction of the stroke, and what is left of it; each exact where it is small.

    x_top^2 - x^2 = 4 r l sin^2(psi / 2), x^2 - x_bottom^2 = 4 r l cos^2(psi / 2), psi = phi + beta.
    """
    r, l, _ = shape
    loop = close_loop(phi, *shape)
    half = 0.5 * (phi + loop.beta)
    above = 4.0 * r * l * np.sin(half) ** 2 / (top_position(*shape) + loop.x)
    below = 4.0 * r * l * np.cos(half) ** 2 / (loop.x + bottom_position(*shape))
    return above / (above + below), below / (above + below)


def _moved(
    before: Scene, gas: Gas, source: Tables, shapes: list[tuple[Shape, Shape]]
) -> Table | tuple[Table, ...]:
    """Every table with its rows moved, one for all cylinders of one shape or one for each."""
    shifts = behind(before, gas, source)
    if isinstance(source, Table) and len(set(shapes)) == 1:
        return _table(source, shifts[0], shifts[0], shapes[0])
    tables = (source,) * len(shapes) if isinstance(source, Table) else tables_of(source)
    aligned = behind(before, gas, tables)  # what a list of tables lags
    every = zip(tables, shifts, aligned, shapes, strict=True)
    return tuple(_table(*one) for one in every)


def _table(table: Table, shift: float, back: float, shapes: tuple[Shape, Shape]) -> Table:
    angle = carried_angle(np.add(table.x, shift), *shapes) - back
    return Table(tuple(angle.tolist()), table.y, table.source)
