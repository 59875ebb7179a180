"""The cases of a sweep: all combinations of some values, a sample of a space, rows of a table."""

from __future__ import annotations

import csv
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from math import prod
from pathlib import Path

import numpy as np

from crankmbs.errors import InputError, shown
from crankmbs.scene.content import content_of
from crankmbs.scene.scene import Scene
from crankmbs.sweep.fingerprint import fingerprint
from crankmbs.sweep.knobs import Interval, Knob, interval_of, knob_of
from crankmbs.sweep.sample import Sample

__all__ = ["Cases", "Grid", "Listed", "Spread", "cases_of"]

_MOST = 10_000_000
_FIRST = 64  # points of a sample in its fingerprint
_HEADING = re.compile(r"(.*?)\s*(?:\[(.*)\])?")


class Cases(ABC):
    """What is set to what in each case, block by block: of many cases no list is held.

    names, units : of the knobs
    dims, shape : over the knobs of a grid, the last of them the fastest, else over "case"
    count : how many cases there are
    """

    def __init__(self, knobs: Sequence[Knob | Interval], shape: tuple[int, ...]) -> None:
        self.names = tuple(knob.name for knob in knobs)
        self.units = tuple(knob.units for knob in knobs)
        for name in sorted({name for name in self.names if self.names.count(name) > 1}):
            raise InputError(f"{name}: is varied twice; give it once")
        self.dims: tuple[str, ...] = ("case",)
        self.shape, self.count = shape, prod(shape)

    @abstractmethod
    def at(self, rows: range) -> tuple[Knob, ...]:
        """The knobs at some successive cases, counted from 0."""

    @property
    @abstractmethod
    def _identity(self) -> object:
        """What all values follow from."""

    @property
    def levels(self) -> tuple[Knob, ...]:
        """The knobs at all of their values: of a grid its levels, else case by case."""
        return self.at(range(self.count))

    def values(self, rows: range) -> tuple[tuple[object, ...], ...]:
        """The values of all knobs in some successive cases, case by case."""
        return tuple(zip(*(knob.values.tolist() for knob in self.at(rows)), strict=True))

    @property
    def varied(self) -> tuple[str, ...]:
        """The names of the knobs of more than one value; where there is none, of all."""
        return self.names

    @cached_property
    def fingerprint(self) -> str:
        """What differs from that of all other cases; empty where nothing identifies a value."""
        return fingerprint([type(self).__name__, self.names, self.shape, self._identity])


class Grid(Cases):
    """All combinations of the values of some knobs."""

    def __init__(self, knobs: tuple[Knob, ...]) -> None:
        super().__init__(knobs, tuple(len(knob.values) for knob in knobs))
        self._knobs, self.dims = knobs, self.names
        if self.count > _MOST:
            raise InputError(
                f"vary: these ranges have {self.count} combinations; at most {_MOST} go"
            )

    def at(self, rows: range) -> tuple[Knob, ...]:
        """Taken from the levels by place."""
        places = np.unravel_index(np.arange(rows.start, rows.stop), self.shape)
        return tuple(knob.at(k) for knob, k in zip(self._knobs, places, strict=True))

    @property
    def levels(self) -> tuple[Knob, ...]:
        """Each knob over itself alone."""
        return self._knobs

    @property
    def varied(self) -> tuple[str, ...]:
        """Those of several levels."""
        return _varied(self._knobs)

    @property
    def _identity(self) -> object:
        return [knob.values.tolist() for knob in self._knobs]


class Listed(Cases):
    """Knobs with their values case by case."""

    def __init__(self, knobs: tuple[Knob, ...]) -> None:
        super().__init__(knobs, (len(knobs[0].values),))
        self._knobs = knobs

    def at(self, rows: range) -> tuple[Knob, ...]:
        """Cut from the lists."""
        return tuple(knob.at(slice(rows.start, rows.stop)) for knob in self._knobs)

    @property
    def varied(self) -> tuple[str, ...]:
        """Those that differ in the list."""
        return _varied(self._knobs)

    @property
    def _identity(self) -> object:
        return [knob.values.tolist() for knob in self._knobs]


class Spread(Cases):
    """Points of a sample, in ranges."""

    def __init__(self, ranges: tuple[Interval, ...], sample: Sample) -> None:
        super().__init__(ranges, (sample.n,))
        self._ranges, self._sample = ranges, sample

    def at(self, rows: range) -> tuple[Knob, ...]:
        """Drawn anew."""
        columns = self._sample.points(rows).T
        pairs = zip(self._ranges, columns, strict=True)
        return tuple(knob.taken(knob.at(column)) for knob, column in pairs)

    @property
    def _identity(self) -> object:
        """The first points too: another version of SciPy may draw others."""
        return [self._ranges, self._sample, self._sample.points(range(min(self.count, _FIRST)))]


def _varied(knobs: tuple[Knob, ...]) -> tuple[str, ...]:
    """The names of the knobs of more than one value; where there is none, of all."""
    values = {knob.name: knob.values.tolist() for knob in knobs}
    several = tuple(name for name, each in values.items() if any(x != each[0] for x in each))
    return several or tuple(values)


def cases_of(scene: Scene, vary: object) -> Cases:
    """The cases of a scene: a mapping varies each name over its values and combines them all; a
    `Sample` spreads them; a file of cases has a column for each name, with its unit in brackets.

    Raises
    ------
    InputError : no such name, values that cannot be, or a file that cannot be read

    >>> from crankmbs import load_scene
    >>> cases_of(load_scene("propeller"), {"rod.length": "0.14..0.2 m:3"}).count
    3
    """
    if isinstance(vary, Sample):
        if not vary.vary:
            raise InputError("vary: a sample needs at least one range; none came")
        return Spread(tuple(interval_of(scene, *item) for item in vary.vary.items()), vary)
    if isinstance(vary, str | Path):
        return _listed(scene, Path(vary))
    if not isinstance(vary, Mapping) or not vary:
        raise InputError(
            'vary must name what is varied, such as {"rod.length": "0.14..0.2 m:25"}, or be a '
            f"Sample or a file of cases; {shown(vary)} came"
        )
    return Grid(tuple(knob_of(scene, name, values) for name, values in vary.items()))


def _listed(scene: Scene, file: Path) -> Cases:
    """The rows of a CSV file of cases."""
    if not file.is_file():
        raise InputError(f"file {file} of cases is missing; give a CSV file that is there")
    try:
        text = content_of(file).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"file {file} is no UTF-8 text; save the cases as CSV in UTF-8") from None
    lines = [line for line in text.splitlines() if line.strip() and line.lstrip()[0] != "#"]
    rows = [[cell.strip() for cell in row] for row in csv.reader(lines)]
    if len(rows) < 2:
        raise InputError(f"file {file}: needs a header with names and a row for each case")
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(rows[0]) or not all(row):
            raise InputError(
                f"file {file}: case {number} has {len([c for c in row if c])} values under a "
                f"header of {len(rows[0])}; every case needs each"
            )
    columns = zip(rows[0], *rows[1:], strict=True)
    try:
        return Listed(tuple(_column(scene, heading, cells) for heading, *cells in columns))
    except InputError as error:
        raise InputError(f"file {file}: {error}") from None


def _column(scene: Scene, heading: str, cells: list[str]) -> Knob:
    match = _HEADING.fullmatch(heading)
    assert match is not None
    items = [f"{cell} {match[2]}" if match[2] else cell for cell in cells]
    return knob_of(scene, match[1], items, _MOST)
