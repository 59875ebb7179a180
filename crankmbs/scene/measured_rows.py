"""A pressure file as an indicating system writes it, read as `[gas]` says."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from crankmbs.delimited import decode, read_sheet
from crankmbs.errors import InputError, shown
from crankmbs.scene.content import content_of
from crankmbs.scene.headings import angle_factor, angle_places, headings_of, pick
from crankmbs.scene.tables import CylinderTable, Table

__all__ = ["HowRead", "read_measured", "sign_of"]

_SEPARATORS = {"tab": "\t", "semicolon": ";", "comma": ",", "blank": " ", "bar": "|"}


class HowRead(NamedTuple):
    """How a file is read: the columns of pressures and of the crank angle by name, and what is not
    to be detected."""

    columns: str | None = None
    angle: str | None = None
    separator: str | None = None
    decimal: str | None = None
    skip: int | None = None


def sign_of(separator: str) -> str:
    r"""The separator's sign, where it was given by its name.

    Raises
    ------
    InputError : neither a sign nor a name

    >>> sign_of("tab"), sign_of(";")
    ('\t', ';')
    """
    sign = _SEPARATORS.get(separator, separator)
    if sign not in _SEPARATORS.values():
        raise InputError(f'must be ";", ",", "|" or "tab", "blank"; {shown(separator)} came')
    return sign


def read_measured(path: Path, how: HowRead) -> Table | CylinderTable:
    """The crank angle and the pressures that ``how.columns`` names, in SI units.

    The angle's column is the one called ``how.angle``, else told by its name or unit, else it is
    the first. Without ``columns`` all columns with a unit of pressure are read.

    Raises
    ------
    InputError : no such column, a column without its unit, a cell without a number
    """
    name = str(path)
    source = decode(content_of(path), name)
    sheet = read_sheet(
        name, source, separator=how.separator, decimal=how.decimal, skip=how.skip or 0
    )
    headings = headings_of(sheet.above, sheet.values.shape[1])
    angle = next(iter(angle_places(headings, how.angle, f"file {name}")), 0)
    if headings[angle].pressure is not None:
        raise InputError(
            f"file {name}: no column is a crank angle by its name or its unit, and the first is a "
            'pressure; name it, such as angle = "CA"'
        )
    if how.columns is None:
        places = [k for k, each in enumerate(headings) if each.pressure is not None]
    else:
        places = [k for k in pick(headings, how.columns, f"file {name}") if k != angle]
    if not places:
        raise InputError(
            f'file {name}: no column of pressures; name some, such as columns = "PCYL1..4"'
        )
    for k in places:
        column = f"file {name}: column {shown(headings[k].name or k + 1)}"
        if headings[k].pressure is None:
            raise InputError(
                f"{column} has no unit of pressure, neither "
                "in its name nor in a row below the names; crankmbs pressure reads it with --unit"
            )
        missing = np.flatnonzero(np.isnan(sheet.values[:, k]))
        if len(missing):
            raise InputError(
                f"{column} has no number in row "
                f"{missing[0] + 1} below its headings; crankmbs pressure deals with missing cells"
            )
    x = tuple((sheet.values[:, angle] * angle_factor(headings[angle])).tolist())
    y = tuple(tuple((sheet.values[:, k] * (headings[k].pressure or 1.0)).tolist()) for k in places)
    return Table(x, y[0], name) if len(y) == 1 else CylinderTable(x, y, name)
