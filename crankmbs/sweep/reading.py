"""One number of a case by the words for it, and how much of it is wanted."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from crankmbs.compare import LECTURES, QUANTITIES, short_name
from crankmbs.errors import InputError, shown
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import there_are
from crankmbs.scene.units import quantity, share_of, unit_of
from crankmbs.sweep.columns import Column, columns_of

__all__ = ["Reading", "amount_of", "free_reading_of", "reading_of"]

_DEVIATION = "lecture_deviation"
_LECTURES = {
    key.partition(" ")[0].lower(): name for name in LECTURES for key in (name, short_name(name))
}  # "untruncated", "yi", and by key of the bibliography "s1"
_DIMENSIONS = {
    unit_of(name): name
    for name in ("force", "torque", "pressure", "angle", "angular speed", "speed", "power")
} | {"N/m^2": "pressure", "J": "torque"}
_OF_SPEED = ("fluctuation", "mean_speed", "highest_speed", "lowest_speed")
_LARGEST = {"peak", "largest", "max"}
_NO_NAMES = {"over", "time", "the", "of", "and", "cylinder"}
_WINDOW = re.compile(r"over the (?:(?:last|whole|settled) )?(?:cycle|revolution|period|run|window)")
_UNIT = re.compile(r"\[.*\]|\(.*")


class Reading(NamedTuple):
    """A column, of cylinders the largest value or that of one number; of deviations that of one
    lecture and quantity; sign : -1 of the drive power, which is what the brake power is not."""

    column: str
    about: Column
    lecture: str = ""
    quantity: str = ""
    number: int | None = None
    sign: float = 1.0

    @property
    def words(self) -> str:
        """What a reader is told it is."""
        if self.lecture:
            return f"largest error of {self.quantity} by {short_name(self.lecture)}, over its peak"
        return f"{self.about.long_name}{f', {self.number}' if self.number else ''}"

    def of(self, columns: Mapping[Any, Any]) -> tuple[Any, Any]:
        """It in every case, and its errors, from columns as a block or a dataset has them.

        Raises
        ------
        InputError : there is none of this number
        """
        value, error = columns[self.column], columns[f"{self.column}_error"]
        if self.lecture:
            at = list(LECTURES).index(self.lecture), list(QUANTITIES).index(self.quantity)
            return value[(..., *at)], error[(..., *at)]
        if self.number is not None:
            count = value.shape[-1]
            if not 1 <= self.number <= count:
                raise InputError(
                    f"{self.words}: there are {count}; give a number from 1 to {count}"
                )
            value, error = value[..., self.number - 1], error[..., self.number - 1]
        elif self.about.dims:
            value, error = value.max(axis=-1), error.max(axis=-1)
        return self.sign * value, error


def reading_of(text: str, columns: Mapping[str, Column]) -> Reading:
    """What is read of each case: a measure under any name that commands print, with or without its
    unit, such as "fluctuation", "peak crank pin force", "crank pin 2 [N]" or "brake power"; or what
    a lecture is off by, "side thrust by Grega".

    Raises
    ------
    InputError : no such measure

    >>> from crankmbs.sweep.columns import columns_of
    >>> columns = columns_of(load_scene("propeller"))
    >>> reading_of("peak main bearing force", columns).column
    'main_bearing_peak'
    """
    words = " ".join(_UNIT.sub("", text.replace("_", " ")).split())
    if lectured := _by_lecture(text, words, columns):
        return lectured
    names = [name for name in columns if f"{name}_error" in columns and name != _DEVIATION]
    names = [name for name in names if not name.startswith("series_")]
    known = {key: name for name in names for key in _keys(name, columns[name].long_name)}
    key = _key(words)
    number = next((int(word) for word in key if word.isdecimal()), None)
    key = frozenset(word for word in key if not word.isdecimal())
    if key == {"drive", "power"} and "brake_power" in columns:
        return Reading("brake_power", Column("W", "drive power"), sign=-1.0)
    if key in known and (number is None or columns[known[key]].dims):
        return Reading(known[key], columns[known[key]], number=number)
    printed = {name: _UNIT.sub("", columns[name].long_name).strip(" ,") for name in names}
    spellings = {name.replace("_", " "): words for name, words in printed.items()}
    spellings |= {words.replace("largest", "peak"): words for words in printed.values()}
    listed = there_are(words, list(printed.values()), spellings)
    if _DEVIATION in columns:
        listed += ', and the error of a lecture formula, such as "side thrust by Grega"'
    raise InputError(f"{shown(text)} is no measure of these cases{listed}")


def _by_lecture(text: str, words: str, columns: Mapping[str, Column]) -> Reading | None:
    """The error of a lecture formula, where the words say whose; None where they do not.

    Raises
    ------
    InputError : the lecture has no formula for this, or is unknown
    """
    quantity, by, lecture = words.removeprefix("largest error of ").rpartition(" by ")
    if not by or _DEVIATION not in columns:
        return None
    name = _LECTURES.get(lecture.partition(" ")[0].lower())
    if name is None:
        authors = [short_name(each) for each in LECTURES]
        raise InputError(
            f"{shown(text)}: {shown(lecture)} is no lecture{there_are(lecture, authors)}"
        )
    if quantity not in QUANTITIES:
        known = there_are(quantity, list(QUANTITIES))
        raise InputError(f"{shown(text)}: no lecture formula is for {shown(quantity)}{known}")
    return Reading(_DEVIATION, columns[_DEVIATION], name, quantity)


def _key(words: str) -> frozenset[str]:
    """The words that tell measures apart, in any order."""
    plain = _WINDOW.sub("", _UNIT.sub("", words.lower())).replace("|", " ").replace(",", " ")
    names = {"peak" if word in _LARGEST else word for word in plain.split()}
    return frozenset(names - _NO_NAMES)


def _keys(name: str, long_name: str) -> set[frozenset[str]]:
    """What a column may be called; of a force also without that word, and its peak without that."""
    keys = {_key(name.replace("_", " ")), _key(long_name)}
    if name.endswith(("_peak", "_mean")):
        keys |= {key - {"force"} for key in keys}
        if "_specific_" not in name:
            keys |= {key - {"peak"} for key in keys}
        keys |= {key | {"force"} for key in keys}
    elif name.startswith(("gauge_pressure", "torque_", "external_torque_", "applied_")):
        keys |= {key | {"peak"} for key in keys}
    return keys


def free_reading_of(scene: Scene, text: str, names: Sequence[str]) -> Reading:
    """What is read of the cases of a scene in which these knobs are varied.

    Raises
    ------
    InputError : no such measure, or one that a prescribed speed says itself, where nothing that is
        varied changes it

    >>> free_reading_of(load_scene("propeller"), "fluctuation", ["rod.length"]).column
    'fluctuation'
    """
    reading = reading_of(text, columns_of(scene))
    of_speed = reading.column in _OF_SPEED and not any(name.startswith("motion") for name in names)
    if scene.motion is not None and of_speed:
        raise InputError(
            f"{reading.column.replace('_', ' ')}: with [motion] the speed is prescribed, and "
            "what is varied does not change it; free the crank with [start] and its loads, "
            "[[torque]], as crankmbs flywheel does by itself, or vary motion.speed"
        )
    return reading


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
    share = share_of(text)
    if math.isnan(share):
        raise InputError(f'must be a share, such as "1 %" or 0.01; {shown(text)} came')
    return share
