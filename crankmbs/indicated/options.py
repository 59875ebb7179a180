"""What a user says of a measured file that the file does not say itself."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Ge, Gt, Le
from pydantic import AfterValidator, BeforeValidator, Strict

from crankmbs.delimited import Sheet, decode, read_sheet
from crankmbs.errors import InputError, shown
from crankmbs.indicated.sensor import Sensor, sensor_of
from crankmbs.indicated.wheel import Wheel, wheel_of
from crankmbs.scene.content import content_of
from crankmbs.scene.headings import PRESSURE_UNITS
from crankmbs.scene.measured_rows import sign_of
from crankmbs.scene.schema import Float, part, si
from crankmbs.scene.units import quantity

__all__ = ["REFERENCES", "Options", "Reference"]

REFERENCES = (
    'reference="absolute"',
    'reference="gauge"',
    'reference="inlet 1.0 bar"',
    'reference="polytrope 1.32"',
)
_MOST = 400_000_000  # bytes
_CYCLES = re.compile(r"mean|all|[1-9][0-9]*(-[1-9][0-9]*)?")


class Reference(NamedTuple):
    """kind: absolute, gauge, inlet or polytrope; value: its pressure [Pa] or exponent, if any."""

    kind: str
    value: float | None = None


def _reference(value: Any) -> Reference:
    if isinstance(value, Reference):
        return value
    kind, _, rest = value.strip().partition(" ") if isinstance(value, str) else ("", "", "")
    if kind == "polytrope" and rest:
        try:
            exponent = float(rest)
        except ValueError:
            exponent = 0.0
        if 1.0 < exponent < 2.0:
            return Reference(kind, exponent)
        point = ", with a decimal point" if "," in rest else ""
        raise InputError(f"a polytrope's exponent lies between 1 and 2{point}; {shown(rest)} came")
    if kind in ("absolute", "gauge", "inlet"):
        if kind == "absolute" and rest:
            raise InputError(f'"absolute" stands alone; {shown(value)} came')
        return Reference(kind, quantity(rest, "pressure") if rest else None)
    raise InputError(
        'must be "absolute", "gauge" (with the ambient, "gauge 1 bar", to make it absolute), '
        f'"inlet 1.0 bar" or "polytrope 1.32"; {shown(value)} came'
    )


def _unit(value: str) -> str:
    unit = value.strip().lower()
    if unit not in PRESSURE_UNITS:
        raise InputError(f"must be one of {', '.join(PRESSURE_UNITS)}; {shown(value)} came")
    return unit


def _at_most(degrees: float) -> AfterValidator:
    """Angles [rad] up to so many degrees."""

    def checked(angle: float) -> float:
        came = math.degrees(angle)
        if came > degrees + 1e-9:
            raise InputError(f"must be at most {degrees:g} degrees; {came:.4g} came")
        return angle

    return AfterValidator(checked)


def _cycles(value: Any) -> tuple[int, int | None] | None:
    """First and last cycle, None for the last there is; None for the mean."""
    text = str(value) if isinstance(value, int) and not isinstance(value, bool) else value
    if not isinstance(text, str) or _CYCLES.fullmatch(text) is None:
        raise InputError(
            f'must be "mean", "all", the number of a cycle or a range such as "1-50"; '
            f"{shown(value)} came"
        )
    if text == "mean":
        return None
    if text == "all":
        return 1, None
    begin, _, end = text.partition("-")
    first, last = int(begin), int(end or begin)
    if last < first:
        raise InputError(f"a range of cycles goes up; {shown(value)} came")
    return first, last


@part
class Options:
    """What a user says of a measured file; all of it is optional.

    columns, angle, separator, decimal, skip : as in `[gas]`; unit : of pressures that have none
    each : whether numbered columns are cycles or cylinders; stroke : 2 or 4
    reference : absolute, gauge, inlet or polytrope; firing_tdc [rad] : the file's angle of the
        firing dead centre; loss_angle [rad] : by which a motored peak comes before it
    wheel : teeth of the wheel over time; index : column of an encoder's mark; sensor : from volts
        to Pa; delay [s] : by which the sensor shows a pressure late
    compression_ratio [1]; invert : turn the signal over; smooth [rad] : width of the smoothing
    cycles : what the table holds
    """

    columns: Annotated[str, Strict()] | None = None
    angle: Annotated[str, Strict()] | None = None
    separator: Annotated[str, Strict(), AfterValidator(sign_of)] | None = None
    decimal: Literal[".", ","] | None = None
    skip: Annotated[int, Strict(), Ge(0)] = 0
    unit: Annotated[str, Strict(), AfterValidator(_unit)] | None = None
    each: Literal["cycle", "cylinder"] | None = None
    stroke: Literal[2, 4] | None = None
    reference: Annotated[Reference, BeforeValidator(_reference)] | None = None
    firing_tdc: Annotated[Float, si("angle")] | None = None
    loss_angle: Annotated[Float, Ge(0), _at_most(3.0), si("angle")] | None = None
    compression_ratio: Annotated[Float, Gt(1), Le(100)] | None = None
    wheel: Annotated[Wheel, BeforeValidator(wheel_of)] | None = None
    index: Annotated[str, Strict()] | None = None
    sensor: Annotated[Sensor, BeforeValidator(sensor_of)] | None = None
    delay: Annotated[Float, Ge(-0.1), Le(0.1), si("time")] | None = None
    invert: Annotated[bool, Strict()] = False
    smooth: Annotated[Float, Gt(0), _at_most(30.0), si("angle")] | None = None
    cycles: Annotated[tuple[int, int | None] | None, BeforeValidator(_cycles)] = None

    def sheet(self, file: str | Path, least: int = 2) -> Sheet:
        """The rows of a file that have at least so many numbers."""
        name = str(file)
        return read_sheet(
            name,
            decode(content_of(Path(file), _MOST, "the working folder"), name),
            separator=self.separator,
            decimal=self.decimal,
            skip=self.skip,
            least=least,
        )
