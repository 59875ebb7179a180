"""The cases of a sweep: all combinations of some values, a sample of a space, rows of a table."""

from __future__ import annotations

import csv
import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.scene.content import content_of
from crankmbs.scene.scene import Scene
from crankmbs.sweep.knobs import Interval, Knob, interval_of, knob_of

__all__ = ["Cases", "Sample", "cases_of"]

_METHODS = ("sobol", "latin")
_MOST = 10_000_000
_HEADING = re.compile(r"(.*?)\s*(?:\[(.*)\])?")


@dataclass(frozen=True)
class Sample:
    """Cases spread over ranges: n points of a scrambled Sobol sequence, or of a Latin hypercube.

    vary : name -> range, such as {"crank.inertia": "0.05..0.5 kg m^2:log"}
    n : how many; a power of two is best with "sobol"
    method : "sobol" or "latin"
    seed : from which the points are drawn
    """

    vary: Mapping[str, str]
    n: int
    method: str = "sobol"
    seed: int = 1

    def __post_init__(self) -> None:
        for name, least in (("n", 1), ("seed", 0)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= _MOST:
                raise InputError(
                    f"{name} must be a whole number from {least} to {_MOST}; {shown(value)} came"
                )
        if self.method not in _METHODS:
            raise InputError(f'method must be "sobol" or "latin"; {shown(self.method)} came')

    def points(self) -> Array:
        """The points in the unit cube, shape (n, knobs).

        >>> Sample({"rod.length": "0.14..0.2 m"}, 4, "latin").points().shape
        (4, 1)
        """
        engine: Any = qmc.LatinHypercube if self.method == "latin" else qmc.Sobol
        drawn = engine(len(self.vary), rng=self.seed)
        if self.method == "latin":
            return np.asarray(drawn.random(self.n))
        whole = drawn.random_base2(max(self.n - 1, 0).bit_length())
        return np.asarray(whole[: self.n])


@dataclass(frozen=True)
class Cases:
    """What is set to what in each case.

    knobs : their values; of a grid the levels of each, in a list the values case by case
    shape : of a grid, the last knob the fastest; None for a list
    """

    knobs: tuple[Knob, ...]
    shape: tuple[int, ...] | None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the knobs."""
        return tuple(knob.name for knob in self.knobs)

    @property
    def count(self) -> int:
        """How many cases there are."""
        return len(self.knobs[0].values) if self.shape is None else prod(self.shape)

    def values(self, number: int) -> tuple[object, ...]:
        """The values of all knobs in a case, counted from 0."""
        at = self._places(number)
        return tuple(knob.values[k] for knob, k in zip(self.knobs, at, strict=True))

    def labels(self) -> dict[str, Array]:
        """The values of each knob in every case, shape (count,), as a coordinate has them."""
        places = self._places(np.arange(self.count))
        return {knob.name: knob.labels[k] for knob, k in zip(self.knobs, places, strict=True)}

    @cached_property
    def digest(self) -> str:
        """What tells these cases from all others."""
        found = hashlib.sha256(repr((self.names, self.shape)).encode())
        for knob in self.knobs:
            found.update(repr(knob.values).encode())
        return found.hexdigest()

    def _places(self, number: Any) -> tuple[Any, ...]:
        if self.shape is None:
            return (number,) * len(self.knobs)
        return tuple(np.unravel_index(number, self.shape))


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
        return _sampled(scene, vary)
    if isinstance(vary, str | Path):
        return _listed(scene, Path(vary))
    if not isinstance(vary, Mapping) or not vary:
        raise InputError(
            'vary must name what is varied, such as {"rod.length": "0.14..0.2 m:25"}, or be a '
            f"Sample or a file of cases; {shown(vary)} came"
        )
    knobs = tuple(knob_of(scene, name, given) for name, given in vary.items())
    _check_once([knob.name for knob in knobs])
    shape = tuple(len(knob.values) for knob in knobs)
    if prod(shape) > _MOST:
        raise InputError(f"vary: these ranges have {prod(shape)} combinations; at most {_MOST} go")
    return Cases(knobs, shape)


def _sampled(scene: Scene, sample: Sample) -> Cases:
    if not sample.vary:
        raise InputError("vary: a sample needs at least one range; none came")
    between: list[Interval] = [interval_of(scene, *item) for item in sample.vary.items()]
    _check_once([one.name for one in between])
    columns = sample.points().T
    return Cases(
        tuple(one.taken(one.at(column)) for one, column in zip(between, columns, strict=True)), None
    )


def _check_once(names: list[str]) -> None:
    twice = {name for name in names if names.count(name) > 1}
    for name in sorted(twice):
        raise InputError(f"{name}: is varied twice; give it once")


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
        knobs = tuple(_column(scene, heading, list(cells)) for heading, *cells in columns)
        _check_once([knob.name for knob in knobs])
    except InputError as error:
        raise InputError(f"file {file}: {error}") from None
    return Cases(knobs, None)


def _column(scene: Scene, heading: str, cells: list[str]) -> Knob:
    match = _HEADING.fullmatch(heading)
    assert match is not None
    return knob_of(scene, match[1], [f"{cell} {match[2]}" if match[2] else cell for cell in cells])
