"""The samples of a run as columns: one for each variable, or for each of its cylinders."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array, Labelled

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["data_frame", "write_csv"]


class _Column(NamedTuple):
    name: str
    units: str
    values: Array
    error: float

    @property
    def heading(self) -> str:
        return f"{self.name} [{self.units}]"


def write_csv(variables: Labelled, file: Path) -> None:
    """Write time, crank angle and every variable as CSV, in SI units."""
    columns = _columns(variables)
    table = np.column_stack([column.values for column in columns])
    header = ",".join(column.heading for column in columns)
    np.savetxt(file, table, fmt="%.12g", delimiter=",", header=header, comments="")


def data_frame(variables: Labelled) -> pd.DataFrame:
    """The columns of `write_csv` over the crank angle, all angles in degrees."""
    import pandas as pd

    columns = [_in_degrees(column) for column in _columns(variables)]
    angle = columns.pop(1)
    frame = pd.DataFrame(
        {column.heading: column.values for column in columns},
        index=pd.Index(angle.values, name=angle.heading),
    )
    frame.attrs["error_estimate"] = {column.heading: column.error for column in (angle, *columns)}
    return frame


def _columns(variables: Labelled) -> list[_Column]:
    """Time, crank angle, then the variables in their order."""
    columns = []
    first = ("time", "crank_angle")
    for name in (*first, *(name for name in variables if name not in first)):
        dims, values, attrs = variables[name]
        if dims == (name,) and name not in first:  # numbers of cylinders or journals
            continue
        units, error = attrs["units"], float(attrs["error_estimate"])
        if len(dims) > 1:
            for number, column in zip(variables[dims[1]][1], values.T, strict=True):
                columns.append(_Column(f"{name} {number}", units, column, error))
        else:
            columns.append(_Column(name, units, values, error))
    return columns


def _in_degrees(column: _Column) -> _Column:
    if not column.units.startswith("rad"):
        return column
    per = math.degrees(1.0)
    return _Column(column.name, f"deg{column.units[3:]}", column.values * per, column.error * per)
