"""For how long a scene runs, and what is kept of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Le
from pydantic import BeforeValidator, StrictStr, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import Float, dumped, part
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.units import DEGREE, EXAMPLES, extent

__all__ = ["SETTLED", "Extent", "Run"]

SETTLED: Literal["settled"] = "settled"


@dataclass(frozen=True, kw_only=True)
class Extent:
    """A stretch of angle ("rad"), of engine periods ("cycle") or of time ("s")."""

    value: float
    unit: Literal["rad", "cycle", "s"]

    def __post_init__(self) -> None:
        _check_positive(self.value, f"{self.value:g} {self.unit}")
        if self.unit not in ("rad", "cycle", "s"):
            raise InputError(f'unit must be "rad", "cycle" or "s"; {shown(self.unit)} came')

    def resolve(self, period: float) -> tuple[float, bool]:
        """Return (value, is_time): [s] when a time, else [rad]."""
        return (self.value * period if self.unit == "cycle" else self.value), self.unit == "s"


def _check_positive(number: float, written: str) -> None:
    if not 0.0 < number < math.inf:
        raise InputError(f"must be finite and above 0; {written} came")


def _extent(value: object, info: ValidationInfo) -> object:
    if isinstance(value, Extent) or dumped(value, info):
        return value
    if not isinstance(value, str):
        raise InputError(
            f"must be an angle or a time with its unit, such as {EXAMPLES['extent']}; "
            f"{shown(value)} came"
        )
    number, unit = extent(value)
    _check_positive(number, shown(value))
    return Extent(value=number, unit=unit)  # type: ignore[arg-type]


def _end(value: object, info: ValidationInfo) -> object:
    if not isinstance(value, str):
        return _extent(value, info)
    try:
        return value if value == SETTLED else _extent(value, info)
    except InputError as error:
        raise InputError(f"{error}{did_you_mean(value, [SETTLED])}") from None


def _spacing(value: object, info: ValidationInfo) -> object:
    return None if value is None or value == "none" else _extent(value, info)


@part
class Run:
    """until: where the run ends, or "settled": the periodic motion that it comes to; every: output
    spacing, or "none"; rtol; formulation by name, which `crankmbs.choose` knows."""

    until: Annotated[Extent | Literal["settled"], BeforeValidator(_end)]
    every: Annotated[Extent | None, BeforeValidator(_spacing)] = Extent(value=DEGREE, unit="rad")
    rtol: Annotated[Float, Ge(1e-13), Le(1e-2)] = 1e-8
    formulation: StrictStr = "auto"
