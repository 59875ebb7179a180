"""The cases of a sweep: all combinations of some values, a sample of a space, rows of a table."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path

from crankmbs.errors import InputError, at_place, shown
from crankmbs.scene.content import content_of
from crankmbs.scene.scene import Scene
from crankmbs.sweep.fingerprint import fingerprint
from crankmbs.sweep.knobs import Knob, interval_of, knob_of
from crankmbs.sweep.sample import Sample

__all__ = ["Cases", "cases_of"]

_MOST = 10_000_000
_HEADING = re.compile(r"(.*?)\s*(?:\[(.*)\])?")


@dataclass(frozen=True, eq=False)
class Cases:
    """What is set to what in each case: in a grid all combinations of the values of the knobs, the
    last of them the fastest; else each knob has a value for each case."""

    knobs: tuple[Knob, ...]
    grid: bool

    def __post_init__(self) -> None:
        for name in sorted({name for name in self.names if self.names.count(name) > 1}):
            raise InputError(f"{name}: is varied twice; give it once")
        if self.count > _MOST:
            raise InputError(
                f"vary: these ranges have {self.count} combinations; at most {_MOST} go"
            )

    @property
    def names(self) -> tuple[str, ...]:
        """Of the knobs."""
        return tuple(knob.name for knob in self.knobs)

    @property
    def dims(self) -> tuple[str, ...]:
        """The names of the dimensions."""
        return self.names if self.grid else ("case",)

    @property
    def shape(self) -> tuple[int, ...]:
        """The lengths of the dimensions."""
        return tuple(len(knob.values) for knob in self.knobs)[: len(self.dims)]

    @property
    def count(self) -> int:
        """How many cases there are."""
        return prod(self.shape)

    def values(self, box: Sequence[slice]) -> tuple[tuple[object, ...], ...]:
        """The values of all knobs, case by case, in a part of every dimension."""
        if self.grid:
            pairs = zip(self.knobs, box, strict=True)
            return tuple(product(*(knob.values[part].tolist() for knob, part in pairs)))
        return tuple(zip(*(knob.values[box[0]].tolist() for knob in self.knobs), strict=True))

    @property
    def varied(self) -> tuple[str, ...]:
        """The names of the knobs of more than one value; where there is none, of all."""
        values = {knob.name: knob.values.tolist() for knob in self.knobs}
        several = tuple(name for name, each in values.items() if any(x != each[0] for x in each))
        return several or self.names

    @cached_property
    def fingerprint(self) -> str:
        """What differs from that of all other cases; empty where nothing identifies a value."""
        values = [knob.values for knob in self.knobs]
        contents = [each.tolist() if each.dtype == object else each.tobytes() for each in values]
        return fingerprint([self.grid, self.names, contents])


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
        ranges = [interval_of(scene, *item) for item in vary.vary.items()]
        pairs = zip(ranges, vary.points().T, strict=True)
        return Cases(tuple(knob.taken(share) for knob, share in pairs), grid=False)
    if isinstance(vary, str | Path):
        return _listed(scene, Path(vary))
    if not isinstance(vary, Mapping) or not vary:
        raise InputError(
            'vary must name what is varied, such as {"rod.length": "0.14..0.2 m:25"}, or be a '
            f"Sample or a file of cases; {shown(vary)} came"
        )
    return Cases(tuple(knob_of(scene, name, values) for name, values in vary.items()), grid=True)


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
    with at_place(f"file {file}"):
        knobs = tuple(_column(scene, heading, cells) for heading, *cells in columns)
        return Cases(knobs, grid=False)


def _column(scene: Scene, heading: str, cells: list[str]) -> Knob:
    match = _HEADING.fullmatch(heading)
    assert match is not None
    items = [f"{cell} {match[2]}" if match[2] else cell for cell in cells]
    return knob_of(scene, match[1], items, _MOST)
