"""The bridge to pydantic: what a frozen part of a scene is, and the fields it may have.

Rules are written once, as type annotations and ``__post_init__`` checks of the dataclasses of this
room; they hold for a TOML file and for a call from Python alike. A validation context is given for
a TOML file, its folder, and for a scene that was saved with a result.
"""

from __future__ import annotations

import math
import typing
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import Annotated, Any, TypeVar, dataclass_transform

import numpy as np
import pydantic
from annotated_types import Ge, Gt
from pydantic import BeforeValidator, ConfigDict, StrictFloat, ValidationError, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.sentences import sentence
from crankmbs.scene.tables import CylinderTable, Header, Table, read_table
from crankmbs.scene.units import EXAMPLES, check_size, quantity

__all__ = [
    "SAVED",
    "Angle",
    "AnglePeriod",
    "AngularSpeed",
    "CsvFile",
    "Float",
    "Quantity",
    "Time",
    "dimension_of",
    "dumped",
    "folder_of",
    "from_file",
    "of_file",
    "part",
    "si",
    "to_si",
]

T = TypeVar("T")
_CONFIG = ConfigDict(
    allow_inf_nan=False, extra="forbid", validate_by_name=True, validate_by_alias=True
)

_WITH_UNIT = "one number and one unit,"

SAVED = {"saved": True}  # validation context of a dumped scene: it has its tables in itself
Float = StrictFloat  # lax mode would take true as 1.0 and "3" as 3.0


@dataclass_transform(kw_only_default=True, frozen_default=True)
def part(cls: type[T]) -> type[T]:
    """Make a frozen, keyword-only, validated dataclass whose constructor raises InputError."""
    made: Any = pydantic.dataclasses.dataclass(frozen=True, kw_only=True, config=_CONFIG)(cls)
    validate = made.__init__

    def __init__(self: Any, *unnamed: Any, **values: Any) -> None:
        taken: tuple[str, ...] = getattr(made, "positional", ())
        if len(unnamed) > len(taken):
            raise InputError(_by_name(made, len(unnamed)))
        values |= dict(zip(taken, unnamed, strict=False))
        try:
            validate(self, **values)
        except ValidationError as error:
            raise InputError(sentence(error, made, values, in_python=True)) from None

    made.__init__ = __init__
    return made  # type: ignore[no-any-return]


def _by_name(made: Any, count: int) -> str:
    called = ", ".join(f"{name}=..." for name in list(made.__pydantic_fields__)[:count])
    return (
        f"{made.__name__} takes its values by name, {made.__name__}({called}); {count} came without"
    )


@dataclass(frozen=True)
class Quantity:
    """Converts a quantity of this dimension; whoever describes a key asks it for that."""

    dimension: str

    def __call__(self, value: Any, info: ValidationInfo) -> float:
        """The SI value of what came for a key."""
        return to_si(value, self.dimension, info)


def si(dimension: str) -> BeforeValidator:
    """Accept a quantity string of this dimension, or a bare SI number.

    In a file an angle or an angular speed needs its unit: 90 could mean degrees.
    """
    return BeforeValidator(Quantity(dimension))


Angle = Annotated[Float, si("angle")]
AngularSpeed = Annotated[Float, si("angular speed")]
Time = Annotated[Float, Ge(0), si("time")]
AnglePeriod = Annotated[Float, Gt(0), si("angle")]


def dimension_of(owner: type[Any], name: str) -> str | None:
    """The dimension of a field of a part; None where it is no quantity.

    >>> from crankmbs import Crank
    >>> dimension_of(Crank, "inertia")
    'inertia'
    """
    field = owner.__pydantic_fields__[name]
    return next(_dimensions([field.annotation, *field.metadata]), None)


def _dimensions(annotations: Sequence[Any]) -> Iterator[str]:
    for annotation in annotations:
        if isinstance(annotation, BeforeValidator) and isinstance(annotation.func, Quantity):
            yield annotation.func.dimension
        yield from _dimensions(typing.get_args(annotation))


def to_si(value: Any, dimension: str, info: ValidationInfo) -> float:
    """The SI value of a quantity string, or of a bare number.

    Raises
    ------
    InputError : neither, no unit where one is needed, or a size that overflows
    """
    number = _converted(value, dimension, info)
    check_size(number, dimension, value)
    return number


def _converted(value: Any, dimension: str, info: ValidationInfo) -> float:
    if isinstance(value, str):
        return quantity(value, dimension)
    if isinstance(value, bool) or not isinstance(value, Real):
        rule = _WITH_UNIT if of_file(info) else "a number in SI units, or text"
        several = isinstance(value, Sequence | np.ndarray) and not of_file(info)
        raise InputError(
            f"must be {rule} such as {EXAMPLES[dimension]}; {shown(value)} came"
            f"{'; several values take a scene for each' if several else ''}"
        )
    if of_file(info) and dimension in {"angle", "angular speed"}:
        raise InputError(f"needs a unit, such as {EXAMPLES[dimension]}; {shown(value)} came")
    try:
        return float(value)
    except OverflowError:
        return math.inf


def dumped(value: object, info: ValidationInfo) -> bool:
    """Whether this is a dumped dataclass; a file writes it as a string."""
    return isinstance(value, dict) and not of_file(info)


@dataclass(frozen=True)
class CsvFile:
    """Reads a table from a CSV file with these columns.

    numbered : whether it may have a column for each cylinder
    others : what else may stand in its place, in words
    """

    header: Header
    numbered: bool = False
    others: str = ""

    def __call__(self, value: Any, info: ValidationInfo) -> Any:
        """The table of what came for a key."""
        several = self.numbered or self.header.ways
        tables = (Table, CylinderTable) if several else Table
        if isinstance(value, tables) or dumped(value, info):
            return value
        if info.context is SAVED:
            raise InputError(f"must hold its rows in a saved scene; {shown(value)} came")
        if not isinstance(value, str | Path):
            table = f" or a Table({self.header.holds})" if info.context is None else ""
            raise InputError(
                f"must be the name of a CSV file{table}{self.others}; {shown(value)} came"
            )
        return read_table(folder_of(info) / value, self.header, numbered=self.numbered)


def from_file(header: Header) -> BeforeValidator:
    """Accept the path of a CSV file (relative to the scene file), or a table in SI units."""
    return BeforeValidator(CsvFile(header))


def folder_of(info: ValidationInfo) -> Path:
    """The folder to which file names are relative: that of the scene's file."""
    return Path(info.context["folder"]) if info.context else Path()


def of_file(info: ValidationInfo) -> bool:
    """Whether this is read from a TOML file."""
    return info.context is not None and info.context is not SAVED
