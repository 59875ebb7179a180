"""What a pressure table may be wrong by: its dead centre, its gain and its zero, as knobs."""

from __future__ import annotations

import numpy as np

from crankmbs.errors import InputError
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import DEGREE

__all__ = ["TABLE_KNOBS", "TABLE_VALUES", "corrected", "step_from_zero", "table_at"]

TABLE_KNOBS = {"gas.shift": "angle", "gas.scale": None, "gas.offset": "pressure"}
"""Knobs of a pressure table, and their dimensions."""

TABLE_VALUES = {"gas.shift": 0.0, "gas.scale": 1.0, "gas.offset": 0.0}
"""With which the table is as it was given."""

_SHIFT_STEP = 0.1 * DEGREE  # the resolution of indicating systems; peaks turn within degrees
_OFFSET_STEP = 2e-3  # of the largest pressure: enters loads linearly, far above their error


def table_at(scene: Scene, name: str) -> Table | CylinderTable:
    """The one pressure table of a scene, with a column for each cylinder or one for all.

    Raises
    ------
    InputError : no table, or several; begins with the name of the knob
    """
    gas = scene.gas
    if gas is not None and isinstance(gas.pressure, Table | CylinderTable):
        if gas.crank_end is None and not isinstance(gas.motored, Table | CylinderTable | tuple):
            return gas.pressure
        instead = "crank_end" if gas.crank_end is not None else "motored"
        instead = f"pressure and {instead} came"
    elif gas is None:
        instead = "the scene has no [gas]"
    elif isinstance(gas.pressure, tuple):
        instead = f"a list of {len(gas.pressure)} came, each with errors of its own"
    else:
        instead = "an indicator came" if gas.pressure is None else "a constant came"
    raise InputError(f"{name}: belongs to a single pressure table in [gas]; {instead}")


def corrected(scene: Scene, knobs: dict[str, float]) -> Scene:
    """The scene with the pressure scale p(a - shift) + offset in place of p(a), in all cylinders.

    knobs : some of `TABLE_KNOBS`, in SI units

    Raises
    ------
    InputError : no table, or several; a scale not above 0, or a pressure that cannot be

    >>> scene = load_scene("yi_diesel")
    >>> first = corrected(scene, {"gas.offset": 1e4}).gas.pressure.y[0]
    >>> print(f"{first - scene.gas.pressure.y[0]:.0f}")
    10000
    """
    shift, scale, offset = (TABLE_VALUES | knobs).values()
    table = table_at(scene, next(iter(knobs)))
    if not scale > 0.0:
        raise InputError(f"gas.scale: must be above 0; {scale:g} came")
    angle, pressure = np.array(table.x) + shift, scale * np.array(table.y) + offset
    moved = type(table)(tuple(angle.tolist()), tuple(pressure.tolist()), table.source)
    return scene.with_(gas__pressure=moved)


def step_from_zero(scene: Scene, name: str) -> float | None:
    """A small change of a table's shift [rad] or offset [Pa]; None for any other knob."""
    if name == "gas.shift":
        return _SHIFT_STEP
    if name == "gas.offset":
        return _OFFSET_STEP * float(np.abs(table_at(scene, name).y).max())
    return None
