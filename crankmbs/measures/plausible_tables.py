"""Tables that can be taken and are unlikely to be meant so: rows that are missing.

Each rule is one function of the scene that gives its sentences, as in `plausible`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.scene.cycles import SAME_ANGLE, cycles_in
from crankmbs.scene.gas import tables_of
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import BAR, DEGREE

__all__ = ["gaps"]

# A cut record lacks a stroke or more, a hole in one many rows. Tables typed by hand are up to
# three times as coarse away from the peak as beside it, in steps of up to 60 degrees.
_WIDE = 30.0 * DEGREE
_TIMES_THE_OTHERS = 4.0


def gaps(scene: Scene) -> Iterator[str]:
    """A gap far wider than all others, between rows or from the last one to the first.

    Between two rows of one pressure it is meant to stay, and a step holds what it has.

    >>> list(gaps(load_scene("propeller")))
    []
    """
    gas = scene.gas
    if gas is None or gas.interpolation == "step":
        return
    for key in ("pressure", "motored", "crank_end"):
        source = getattr(gas, key)
        several = source if isinstance(source, tuple) else (source,)
        for each in dict.fromkeys(several):
            if not isinstance(each, Table | CylinderTable):
                continue
            found = _gap(each, gas.period)
            if found is None:
                continue
            begin, end, usual, (before, after) = found
            yield (
                f"gas.{key}: {Path(each.source).name} has no row between {begin / DEGREE:.6g} and "
                f"{end / DEGREE:.6g} degrees, and elsewhere one every {usual / DEGREE:.3g} degrees "
                f"or less: {gas.interpolation} draws {(end - begin) / DEGREE:.6g} degrees there, "
                f"from {before / BAR:.4g} to {after / BAR:.4g} bar; add the rows that are missing, "
                "or, where the pressure is meant so, one or two between"
            )


def _gap(
    source: Table | CylinderTable, period: float
) -> tuple[float, float, float, tuple[float, float]] | None:
    """Where a gap begins and ends, the widest of the others [rad], and the pressures around it."""
    count = cycles_in(tables_of(source)[0], period)
    first = source.x[0]
    angle = np.append(source.x, first + count * period)
    width = np.diff(angle)
    if len(width) <= count:
        return None
    usual, widest = np.sort(width)[[-1 - count, -1]]  # each cycle has the gap
    k = int(np.argmax(width))
    if widest < max(_WIDE, _TIMES_THE_OTHERS * usual) - SAME_ANGLE:
        return None
    columns = _columns(source)
    before, after = columns[:, k], columns[:, (k + 1) % len(source.x)]
    if k + 1 < len(source.x) and np.array_equal(before, after):
        return None
    return float(angle[k]), float(angle[k + 1]), float(usual), (float(before[0]), float(after[0]))


def _columns(source: Table | CylinderTable) -> Array:
    columns: Sequence[Sequence[float]] = [table.y for table in tables_of(source)]
    return np.array(columns)
