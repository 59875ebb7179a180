"""The gas in the cylinders: pressure files, constants and indicator diagrams, as a user gives them.

Frozen dataclasses in SI units, each checking itself.
"""

from __future__ import annotations

import math
import re
from numbers import Real
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le
from pydantic import (
    AfterValidator,
    BeforeValidator,
    StrictBool,
    StrictInt,
    StrictStr,
    ValidationInfo,
)

from crankmbs.errors import InputError, shown
from crankmbs.scene.cycles import mean_cycle
from crankmbs.scene.measured_rows import HowRead, read_measured, sign_of
from crankmbs.scene.pressure_rows import check_rows
from crankmbs.scene.schema import CsvFile, Float, folder_of, part, si, to_si
from crankmbs.scene.tables import CylinderTable, Header, Table, tables_of
from crankmbs.scene.units import BAR, DEGREE

__all__ = ["CONSTANT", "AnyPressure", "Gas", "Indicator", "Polytrope", "tables_of"]

CONSTANT = "a constant"  # the source of its table, where it stands in a list

Pressure = Annotated[Float, Gt(0), si("pressure")]
CompressionRatio = Annotated[Float, Gt(1), Le(1e4)]
Exponent = Annotated[Float, Gt(0), Le(10)]

_COLUMNS = Header(
    {"crank_angle_deg": DEGREE},
    {
        "pressure_bar": 1e5,
        "pressure_kPa": 1e3,
        "pressure_Pa": 1.0,
        "pressure_MPa": 1e6,
        "pressure_kgf_cm2": 98066.5,
    },
    "crank angles [rad], pressures [Pa]",
    way_out='; columns = "..." with the pressure\'s heading reads a file that has other headings '
    "or separators",
)
_FILE = CsvFile(_COLUMNS, numbered=True, others=', a list of them, or a pressure such as "1 bar"')


@part
class Indicator:
    """An indicator diagram from polytropes over the cylinder's exact volume.

    compression_ratio [1]; n_compression, n_expansion [1]; intake_pressure, exhaust_pressure,
    peak_pressure [Pa], absolute; pre_expansion [1]: volume after combustion at constant pressure
    over the volume before. A two-stroke cycle needs no exhaust_pressure: its cylinder is emptied
    and filled at the bottom dead centre.
    """

    compression_ratio: CompressionRatio
    n_compression: Exponent
    n_expansion: Exponent
    intake_pressure: Pressure
    exhaust_pressure: Pressure | None = None
    peak_pressure: Pressure
    pre_expansion: Annotated[Float, Ge(1)] = 1.0

    def __post_init__(self) -> None:
        if self.pre_expansion >= self.compression_ratio:
            raise InputError(
                f"pre_expansion must be below the compression_ratio {self.compression_ratio:.6g}, "
                f"or nothing is left to expand; {self.pre_expansion:.6g} came"
            )
        reached = self.intake_pressure * self.compression_ratio**self.n_compression
        if self.peak_pressure < reached * (1.0 - 1e-12):
            raise InputError(
                "peak_pressure must be at least what compression reaches, intake_pressure * "
                f"compression_ratio^n_compression = {reached / BAR:.6g} bar; "
                f"{self.peak_pressure / BAR:.6g} bar came"
            )


AnyPressure = float | Table | CylinderTable | tuple[Table, ...]
_NUMBER = re.compile(r"[+-]?\.?[0-9]")
_FILE_NAME = re.compile(r".*\.[^\W\d]\w*")  # which a quantity never is


def _source(value: Any, info: ValidationInfo) -> AnyPressure:
    """A file, a list of files, or a quantity; from Python tables."""
    if isinstance(value, list | tuple):
        if not value:
            raise InputError("must name a file for each cylinder; an empty list came")
        return tuple(_of_one(each, info) for each in value)
    constant = _constant(value, info)
    return _table(value, info) if constant is None else constant


def _constant(value: Any, info: ValidationInfo) -> float | None:
    """A quantity [Pa]; None of what is none."""
    text = isinstance(value, str) and _NUMBER.match(value) and not _FILE_NAME.fullmatch(value)
    if not text and (not isinstance(value, Real) or isinstance(value, bool)):
        return None
    pressure = to_si(value, "pressure", info)
    if not math.isfinite(pressure):
        raise InputError(f"must be a finite number; {shown(value)} came")
    return pressure


def _of_one(value: Any, info: ValidationInfo) -> Any:
    """The pressure of one cylinder, a constant as one in every quarter turn."""
    constant = _constant(value, info)
    if constant is not None:
        angles = tuple(0.5 * math.pi * k for k in range(2 * (info.data or {}).get("stroke", 4)))
        return Table(angles, (constant,) * len(angles), CONSTANT)
    table = _table(value, info)
    if isinstance(table, CylinderTable):
        raise InputError(
            f"{table.source}: a file of a list has one pressure column, of its own cylinder; give "
            "this one without a list"
        )
    return table


def _table(value: Any, info: ValidationInfo) -> Any:
    keys = info.data or {}
    how = HowRead(*(keys.get(name) for name in HowRead._fields))
    if how != HowRead() and isinstance(value, str | Path):
        return read_measured(folder_of(info) / value, how)
    return _FILE(value, info)


@part
class Polytrope:
    """The pressure without combustion from a polytrope p V^n, continued from the pressure file.

    polytrope: its exponent n [1]; closes [rad]: where it takes over, from the true firing dead
    centre, so that what comes before holds no combustion; compression_ratio [1]. It ends at the
    true bottom dead centre behind, where the file goes on.
    """

    polytrope: Exponent
    closes: Annotated[Float, Ge(-math.pi), Le(0), si("angle")]
    compression_ratio: CompressionRatio


def _motored(value: Any, info: ValidationInfo) -> Any:
    """As `_source` takes it, or a Polytrope."""
    if isinstance(value, Polytrope):
        return value
    if isinstance(value, dict) and "y" not in value:
        return Polytrope(**value)
    return _source(value, info)


PressureSource = Annotated[AnyPressure, BeforeValidator(_source)]
MotoredSource = Annotated[AnyPressure | Polytrope, BeforeValidator(_motored)]

_NO_FILE = ("gas_exchange_tdc", "pchip", None, None)
_OF_FILES = "zero, interpolation, closing and cycles belong to a pressure file; remove them"


@part
class Gas:
    """The gas in the cylinders: pressures over the crank angle, or an indicator diagram.

    pressure: a table of crank angle [rad] and pressure [Pa] or a constant [Pa], one for each
    cylinder or for all; absolute: whether the pressure is; ambient [Pa]: crankcase side; stroke: 4
    (period 720 degrees) or 2 (360); zero: the cycle angle of the table's 0; aligned: whether each
    of several columns runs over the cycle angle of its cylinder, else all over that of cylinder 1;
    cycles: what is made of a file longer than a period, its mean cycle or the sequence of them;
    interpolation between the rows, two of which at one angle are a jump; closing [Pa]: a closing
    row so near the first is dropped, by default 1 % of the range; motored: the pressure without
    combustion, given alike or as a Polytrope, of which a firing takes its share (`Fuel`);
    crank_end: the pressure on the side of the piston towards the crank, given alike, which makes a
    cylinder double-acting; pressure and motored are then those of the head end.

    columns, angle, separator, decimal, skip: how a file is read that an indicating system wrote:
    the columns of its pressures and that of the crank angle by name, what separates them, the
    decimal sign, how many lines to leave out at the beginning. They are None again once it is read.
    """

    columns: StrictStr | None = None
    angle: StrictStr | None = None
    separator: Annotated[StrictStr, AfterValidator(sign_of)] | None = None
    decimal: Literal[".", ","] | None = None
    skip: Annotated[StrictInt, Ge(0)] | None = None
    stroke: Literal[2, 4] = 4
    pressure: PressureSource | None = None
    indicator: Indicator | None = None
    absolute: StrictBool = True
    ambient: Pressure | None = None
    zero: Literal["gas_exchange_tdc", "firing_tdc"] = "gas_exchange_tdc"
    interpolation: Literal["pchip", "linear", "cubic", "step"] = "pchip"
    aligned: StrictBool = False
    cycles: Literal["mean", "sequence"] | None = None
    closing: Annotated[Float, Ge(0), si("pressure")] | None = None
    motored: MotoredSource | None = None
    crank_end: PressureSource | None = None

    def __post_init__(self) -> None:
        if (self.pressure is None) == (self.indicator is None):
            came = "neither" if self.indicator is None else "both"
            raise InputError(f"give pressure or indicator, exactly one of the two; {came} came")
        if self.absolute and self.ambient is None:
            raise InputError(
                "an absolute pressure needs ambient, the crankcase side; "
                'give ambient = "1 bar", or absolute = false when the file is gauge'
            )
        if not self.absolute and self.ambient is not None:
            raise InputError(
                "a gauge pressure has its ambient subtracted already; remove ambient, or give "
                "absolute = true"
            )
        self._forget_how_read()
        self._check_files()
        if self.indicator is not None:
            self._check_indicator(self.indicator)

    @property
    def period(self) -> float:
        """Period of the pressure [rad]: 4 pi with stroke 4, 2 pi with stroke 2."""
        return self.stroke * math.pi

    @property
    def tables(self) -> tuple[Table, ...]:
        """The tables of the pressure: of each cylinder, or one of all; none of a constant."""
        return tables_of(self.pressure)

    def _forget_how_read(self) -> None:
        """What was said of a file is done, and does not hold of its rows."""
        keys = [name for name in HowRead._fields if getattr(self, name) is not None]
        if keys and not self.tables + tables_of(self.crank_end):
            raise InputError(f"{', '.join(keys)}: belongs to a pressure file; remove it")
        for name in keys:
            object.__setattr__(self, name, None)

    def _check_files(self) -> None:
        absolute, closing = self.absolute, self.closing
        for table in self.tables + tables_of(self.motored) + tables_of(self.crank_end):
            check_rows(table, self.period, self.cycles, absolute=absolute, closing=closing)
            if self.cycles == "mean":
                mean_cycle(table, self.period)
        if self.motored is not None and self.indicator is not None:
            raise InputError(
                "motored belongs to a pressure file; beside an indicator its compression both ways "
                "is the pressure without combustion; remove it"
            )
        if isinstance(self.motored, Polytrope) and not self.absolute:
            raise InputError(
                "motored: a polytrope needs absolute pressures; give the file absolute with "
                "ambient, or a motored file"
            )
        if isinstance(self.motored, Polytrope) and not self.tables:
            raise InputError("motored: a polytrope continues a pressure file; none came")
        by_column = (isinstance(each, CylinderTable) for each in (self.pressure, self.crank_end))
        if self.aligned and not any(by_column):
            raise InputError(
                "aligned belongs to a file with a pressure column for each cylinder; remove it"
            )
        self._check_constants()

    def _check_constants(self) -> None:
        if isinstance(self.pressure, float):
            self._check_no_file(
                f"a constant of {self.pressure / BAR:g} bar (a bare number is in Pa)"
            )
        for whose, source in (("", self.pressure), ("crank_end: ", self.crank_end)):
            if self.absolute and isinstance(source, float) and source < 0.0:
                raise InputError(
                    f"{whose}an absolute pressure cannot be negative; {source:.6g} Pa came; give "
                    "absolute = false when it is gauge"
                )

    def _check_no_file(self, beside: str) -> None:
        """Refuse what only a file has, unless one is given for the crank end."""
        if tables_of(self.crank_end):
            return
        if (self.zero, self.interpolation, self.closing, self.cycles) != _NO_FILE:
            raise InputError(f"{_OF_FILES} beside {beside}")

    def _check_indicator(self, indicator: Indicator) -> None:
        if not self.absolute:
            raise InputError("an indicator diagram is absolute; remove absolute = false")
        self._check_no_file("an indicator")
        if self.stroke == 4 and indicator.exhaust_pressure is None:
            raise InputError("indicator: a four-stroke cycle needs its exhaust_pressure; none came")
