"""One number of a case by the words for it, and how much of it is wanted."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.compare import LECTURES, QUANTITIES, short_name
from crankmbs.errors import InputError, shown
from crankmbs.measures import Estimate
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.units import quantity
from crankmbs.sweep.columns import Column, Row

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Reading", "amount_of", "reading_of"]

_DEVIATION = "lecture_deviation"
_LECTURES = {name.partition(" ")[0].lower(): name for name in LECTURES}  # "s1", "untruncated"
_DIMENSIONS = {"N": "force", "N m": "torque", "Pa": "pressure", "W": "power"}
_DIMENSIONS |= {"rad": "angle", "rad/s": "angular speed"}
_SHARE = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(%?)\s*")
_PEAK = re.compile(r"(peak|largest|mean) (main bearing|crank pin|piston pin|side)(?: force)?")


class Reading(NamedTuple):
    """A column, of cylinders the largest value; of deviations that of one lecture and quantity."""

    column: str
    about: Column
    lecture: str = ""
    quantity: str = ""

    @property
    def words(self) -> str:
        """What a reader is told it is."""
        if not self.lecture:
            return self.about.long_name
        return f"largest error of {self.quantity} by {short_name(self.lecture)}, over its peak"

    def of_row(self, row: Row) -> Estimate:
        """It in one case, with its error; NaN where the case has none."""
        value, error = row.get(self.column), row.get(f"{self.column}_error")
        if value is None or error is None:
            return Estimate(np.nan, np.nan)
        if self.lecture:
            at = list(LECTURES).index(self.lecture), list(QUANTITIES).index(self.quantity)
            return Estimate(float(value[at]), float(error[at]))
        return Estimate(float(np.max(value)), float(np.max(error)))

    def of_sweep(self, data: xr.Dataset) -> tuple[xr.DataArray, float]:
        """It in every case, and the largest of its errors."""
        value, error = data[self.column], data[f"{self.column}_error"]
        if self.lecture:
            at = {"lecture": self.lecture, "quantity": self.quantity}
            value, error = value.sel(at), error.sel(at)
        elif many := [of for of in ("cylinder", "journal", "pin") if of in value.dims]:
            value = value.max(many)
        return value, float(error.max())


def reading_of(text: str, columns: Mapping[str, Column]) -> Reading:
    """What is read of each case: a column's name in words, such as "fluctuation", "peak crank pin
    force" or "mean speed"; or what a lecture is off by, "side thrust by S1".

    Raises
    ------
    InputError : no such words

    >>> from crankmbs.sweep.columns import columns_of
    >>> columns = columns_of(load_scene("propeller"), series=False)
    >>> reading_of("peak main bearing force", columns).column
    'main_bearing_peak'
    """
    words = " ".join(text.replace("_", " ").split())
    quantity, by, lecture = words.rpartition(" by ")
    if by and quantity in QUANTITIES and lecture.lower() in _LECTURES and _DEVIATION in columns:
        return Reading(_DEVIATION, columns[_DEVIATION], _LECTURES[lecture.lower()], quantity)
    match = _PEAK.fullmatch(words)
    if match:
        joint = "side force" if match[2] == "side" else match[2]
        words = f"{joint} {'mean' if match[1] == 'mean' else 'peak'}"
    known = {name.replace("_", " "): name for name in columns if f"{name}_error" in columns}
    known = {words: name for words, name in known.items() if name != _DEVIATION}
    if words in known:
        return Reading(known[words], columns[known[words]])
    listed = [name for name in known if not name.startswith("series ")]
    near = did_you_mean(words, listed) or f"; known are {', '.join(listed)}, and QUANTITY by S1"
    raise InputError(f"{shown(text)} is nothing that a case has{near}")


def amount_of(text: str, reading: Reading) -> float:
    """An amount of what is read, in SI units: "1 %" or 0.01 of a share, else with its unit.

    Raises
    ------
    InputError : no number, or of another unit

    >>> amount_of("1 %", Reading("fluctuation", Column("1", "")))
    0.01
    """
    dimension = _DIMENSIONS.get(reading.about.units)
    if dimension is not None:
        return quantity(text, dimension)
    match = _SHARE.fullmatch(text)
    if match is None:
        raise InputError(f'must be a share, such as "1 %" or 0.01; {shown(text)} came')
    return float(match[1]) * (0.01 if match[2] else 1.0)
