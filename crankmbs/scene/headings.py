"""What the columns of a measured table are, by their names and units, and which are meant.

A name may carry its unit, "PCYL1 [bar]" or "pressure_bar"; else a row of units below the names has
it.
"""

from __future__ import annotations

import fnmatch
import math
import re
from collections.abc import Sequence
from typing import NamedTuple

from crankmbs.errors import InputError, shown
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.units import DEGREE

__all__ = [
    "PRESSURE_UNITS",
    "TIME_UNITS",
    "Heading",
    "angle_factor",
    "angle_places",
    "by_name",
    "headings_of",
    "is_angle",
    "is_time",
    "pick",
]

PRESSURE_UNITS = {
    "bar": 1e5,
    "mbar": 100.0,
    "hpa": 100.0,
    "kpa": 1e3,
    "pa": 1.0,
    "mpa": 1e6,
    "n/mm^2": 1e6,
    "psi": 6894.757293168361,
    "kgf/cm^2": 98066.5,
    "at": 98066.5,
    "atm": 101325.0,
}
_SPELT = {
    "lbf/in^2": "psi",
    "lb/in^2": "psi",
    "kgf_cm2": "kgf/cm^2",
    "kgf/cm2": "kgf/cm^2",
    "kg/cm2": "kgf/cm^2",
    "kg/cm^2": "kgf/cm^2",
    "kp/cm2": "kgf/cm^2",
    "kp/cm^2": "kgf/cm^2",
    "n/mm2": "n/mm^2",
    "bars": "bar",
}
_REFERENCED = re.compile(r"(bar|psi|kpa|mpa|mbar)[ _]?\(?([ag])(?:bs|auge)?\)?")
_REFERENCES = {  # words of a name
    "absolute": re.compile(r"(?<![^\W\d_])(abs|absolute?|absolutdruck)(?![^\W\d_])", re.IGNORECASE),
    "gauge": re.compile(
        r"(?<![^\W\d_])(gauge|rel|relativ|relative|(ü|ue)berdruck)(?![^\W\d_])", re.IGNORECASE
    ),
}
_DEGREES = {"deg", "°", "degca", "deg ca", "°ca", "ca", "cad", "°kw", "grad", "degree", "degrees"}
_DEGREES |= {"°crk", "deg crk", "degcrk", "°ka", "kw", "deg crank", "dega", "ºca", "º"}
_ANGULAR = {**dict.fromkeys(_DEGREES, DEGREE), "rad": 1.0, "rev": 2.0 * math.pi}
TIME_UNITS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
_NO_UNITS = {"", "-", "1", "%", "a", "v", "mv", "c", "°c", "k", "mm", "j/deg", "kj/m3deg", "j"}

_ANGLE_NAME = re.compile(
    r"((crank|kurbel)[ _]?(angle|winkel).*|crk[ _]?ang.*|°?ca|cad|deg|degrees?|angle|winkel|kw|°kw"
    r"|theta|alpha|phi|α|φ|ca[ _]?deg|deg[ _]?ca|degca|x[ _]?axis)([ _][ab]?tdc\w*)?"
)
_TIME_NAME = re.compile(r"time|zeit|t|timestamp|time[ _]?stamp|abs(olute)?[ _]?time|temps")
_BRACKETED = re.compile(r"(.*?)\s*[\[(]([^\])]*(?:\([ag](?:bs|auge)?\))?)[\])]\s*([ _.#-].*)?")
_AFTER = re.compile(r"(.+?)(?:\s*/\s*|,\s*|\s+in\s+)(\S.*)")  # "p/bar", "p, bar", "p in bar"
_OF_TDC = re.compile(r"\s*[ab]?tdcf?$")
_NUMBERED_UNIT = re.compile(r"(.+?)_(bar|kPa|Pa|MPa|psi|kgf_cm2|deg|rad)((?:_[1-9][0-9]*)?)")
_TIME_UNIT = re.compile(rf"({_TIME_NAME.pattern})_(s|ms|us)()", re.IGNORECASE)  # "p_s" is no time
_RANGE = re.compile(r"(.*?)([0-9]+)\.\.([0-9]+)(.*)")
_ROWS = 5  # above the numbers among which names and units are looked for
_MOST = 10_000  # columns that a range names


class Heading(NamedTuple):
    """What stands above a column: its name without its unit, and the unit in small letters.

    reference : "absolute" or "gauge" where the unit says so, as bar(a) does, or a word of the name
    """

    name: str
    unit: str
    reference: str = ""

    @property
    def pressure(self) -> float | None:
        """The factor to Pa; None without a unit of pressure."""
        return PRESSURE_UNITS.get(self.unit)


def headings_of(above: Sequence[Sequence[str]], width: int) -> tuple[Heading, ...]:
    """The headings of ``width`` columns, from the lines above their numbers.

    Names stand in the row that has that of a crank angle, else above the units, else in the last
    that has a word for every column; a row of numbers of cycles below the names belongs to them.
    A row is of units by some of its cells: what else is measured may have any unit.

    >>> headings_of([["CA", "PCYL1", "TOIL"], ["deg", "bar", "degF"]], 3)[1]
    Heading(name='PCYL1', unit='bar', reference='')
    """
    rows = [_wide(row, width) for row in above]
    end = len(rows)
    while end and not any(rows[end - 1]):
        end -= 1
    near = range(max(end - _ROWS, 0), end)
    full = [k for k in near if _given(rows[k]) >= min(width, 2)]
    under = _units_at(rows, near, full)
    units = [""] * width if under is None else rows[under]
    named = [k for k in full if k != under and _has_angle(rows[k], units)]
    at = named[-1] if named else (end if under is None else under) - 1
    if at not in full:
        at = next((k for k in reversed(full) if k < at and _are_words(rows[k])), -1)
    if at < 0:
        return tuple(_heading("", unit) for unit in units)
    names = rows[at]
    if width > 2 and at and _are_cycles(names) and _given(above[at - 1]) == width:
        pairs = zip(rows[at - 1], names, strict=True)
        names = [f"{name} {cycle}" if k else name for k, (name, cycle) in enumerate(pairs)]
    return tuple(_heading(*pair) for pair in zip(names, units, strict=True))


def is_angle(heading: Heading) -> bool:
    """Whether the column is a crank angle.

    >>> is_angle(Heading("Crank Angle", "deg")), is_angle(Heading("PCYL1", "bar"))
    (True, False)
    """
    if heading.pressure is not None or heading.unit in TIME_UNITS:
        return False
    return _is_angle_name(heading.name) or heading.unit in _ANGULAR


def is_time(heading: Heading) -> bool:
    """Whether the column is a time.

    >>> is_time(Heading("Time", "s"))
    True
    """
    return heading.unit in TIME_UNITS or (_is_time_name(heading.name) and heading.unit == "")


def by_name(headings: Sequence[Heading], *, time: bool) -> list[int]:
    """The places of the columns that are named as a time, or as a crank angle; other columns of the
    same unit may be durations, or the angles of events.

    >>> by_name([Heading("Time", "s"), Heading("Injection", "ms")], time=True)
    [0]
    """
    tells, is_named = (is_time, _is_time_name) if time else (is_angle, _is_angle_name)
    return [k for k, each in enumerate(headings) if tells(each) and is_named(each.name)]


def angle_places(headings: Sequence[Heading], angle: str | None, file: str) -> list[int]:
    """The places of the columns that may be the crank angle: the one called ``angle``, else those
    told by their names or units.

    Raises
    ------
    InputError : no column has this name

    >>> angle_places([Heading("p", "bar"), Heading("CA", "deg")], None, "a.csv")
    [1]
    """
    if angle is not None:
        return pick(headings, angle, file)[:1]
    return [k for k, heading in enumerate(headings) if is_angle(heading)]


def angle_factor(heading: Heading) -> float:
    """The factor of an angle's column to rad; degrees where it has no unit."""
    return _ANGULAR.get(heading.unit, DEGREE)


def pick(headings: Sequence[Heading], columns: str, file: str) -> list[int]:
    """The places of the columns that ``columns`` names, in its order.

    columns : names with commas between them; "PCYL1..4" are PCYL1 to PCYL4, "P*" all that begin so

    Raises
    ------
    InputError : a name that no column has

    >>> pick([Heading("CA", "deg"), Heading("P1", "bar"), Heading("P2", "bar")], "P1..2", "a.csv")
    [1, 2]
    """
    known = [heading.name for heading in headings]
    indices: list[int] = []
    for name in _expanded(columns):
        low = name.lower()
        places = [k for k, each in enumerate(known) if each.lower() == low]
        if not places and re.search(r"[*?]", low):
            places = [k for k, each in enumerate(known) if fnmatch.fnmatchcase(each.lower(), low)]
        if not places:
            listed = ", ".join(dict.fromkeys(filter(None, known))) or "without names"
            listed = listed if len(listed) < 200 else f"{listed[:200]} ..."
            raise InputError(
                f"{file}: no column is named {shown(name)}; the columns are {listed}"
                f"{did_you_mean(name, known)}"
            )
        indices += [k for k in places if k not in indices]
    return indices


def _expanded(columns: str) -> list[str]:
    names = []
    for name in filter(None, (part.strip() for part in columns.split(","))):
        match = _RANGE.fullmatch(name)
        if match is None:
            names.append(name)
            continue
        first, last = int(match[2]), int(match[3])
        if not first <= last < first + _MOST:
            raise InputError(
                f'columns: a range goes up, as "PCYL1..4" does, over at most {_MOST} columns; '
                f"{shown(name)} came"
            )
        names += [f"{match[1]}{k}{match[4]}" for k in range(first, last + 1)]
    if not names:
        raise InputError(f'columns: must name columns, such as "PCYL1..4"; {shown(columns)} came')
    return names


def _is_angle_name(name: str) -> bool:
    return _ANGLE_NAME.fullmatch(name.lower().strip("# ")) is not None


def _is_time_name(name: str) -> bool:
    return _TIME_NAME.fullmatch(name.lower().strip("# ")) is not None


def _has_angle(row: Sequence[str], units: Sequence[str]) -> bool:
    """Whether a row of names has that of a crank angle."""
    return any(
        _is_angle_name(_heading(name, unit).name)
        for name, unit in zip(row, units, strict=True)
        if name
    )


def _wide(row: Sequence[str], width: int) -> list[str]:
    return [*row[:width], *[""] * (width - len(row))]


def _given(row: Sequence[str]) -> int:
    return sum(bool(cell) for cell in row)


def _unit(text: str) -> tuple[str, str]:
    """A unit in small letters and common spelling, and the reference that it names."""
    unit = " ".join(text.strip("[]() \t").lower().replace("²", "^2").split())
    unit = _OF_TDC.sub("", unit)
    match = _REFERENCED.fullmatch(unit)
    if match:
        return match[1], {"a": "absolute", "g": "gauge"}[match[2]]
    return _SPELT.get(unit, unit), ""


def _is_unit(text: str) -> bool:
    unit = _unit(text)[0]
    return unit in PRESSURE_UNITS or unit in _ANGULAR or unit in TIME_UNITS or unit in _NO_UNITS


def _units_at(rows: Sequence[Sequence[str]], near: range, full: Sequence[int]) -> int | None:
    """The place of the row of units: the last that is one in itself, else the last that has those
    of the names in another row."""
    alone = (k for k in reversed(near) if _are_units(rows[k]))
    beside = (
        k for k in reversed(full) if any(_are_units_of(rows[j], rows[k]) for j in full if j != k)
    )
    return next(alone, next(beside, None))


def _are_units(row: Sequence[str]) -> bool:
    """Whether a row has nothing but known units, or those of two quantities among others."""
    telling = _telling(row)
    of = {_quantity(cell) for cell in telling}
    return len(of) > 1 or (bool(telling) and all(map(_is_unit, row)))


def _telling(row: Sequence[str]) -> list[str]:
    """The cells that are units of an angle, a time or a pressure, and no names; none of a row that
    gives a value, as "ambient, 1.02, bar" does."""
    if any(re.fullmatch(r"[+-]?[0-9.,]+", cell) for cell in row if cell != "1"):
        return []
    units = [cell for cell in row if _is_unit(cell) and _unit(cell)[0] not in _NO_UNITS]
    return [cell for cell in units if cell not in ("CA", "KW", "Grad")]


def _are_units_of(names: Sequence[str], row: Sequence[str]) -> bool:
    """Whether a row with cells that are no known units has those of these names: most are known, or
    one stands in the column of a name of its quantity."""
    telling = _telling(row)
    if not _are_words([name for name in names if name]):
        return False
    known = [cell for cell in row if cell not in ("", "-", "1") and _is_unit(cell)]
    if telling and len(known) > 1 and 2 * len(known) > _given(row):
        return True
    return any(
        cell in telling
        and (_heading(name, "").unit == _unit(cell)[0] or _names(name) == _quantity(cell))
        for name, cell in zip(names, row, strict=True)
    )


def _quantity(cell: str) -> str:
    """What a telling unit is of."""
    unit = _unit(cell)[0]
    return "pressure" if unit in PRESSURE_UNITS else "time" if unit in TIME_UNITS else "angle"


def _names(name: str) -> str:
    """The quantity that a name is of, where it is a time or an angle."""
    return "time" if _is_time_name(name) else "angle" if _is_angle_name(name) else ""


def _are_words(row: Sequence[str]) -> bool:
    return all(re.search(r"[^\W\d]", cell) for cell in row)


def _are_cycles(names: Sequence[str]) -> bool:
    """Whether all but the first cell count cycles."""
    return all(re.fullmatch(r"[0-9]+", name) for name in names[1:])


def _heading(name: str, unit: str) -> Heading:
    text, written = name.strip().strip("#%").strip(), unit
    bracketed = _BRACKETED.fullmatch(text)
    numbered = _NUMBERED_UNIT.fullmatch(text) or _TIME_UNIT.fullmatch(text)
    after = _AFTER.fullmatch(text)
    if not unit and after and _is_unit(after[2]) and not _is_unit(after[1].split()[-1]):
        text, written = after[1], after[2]  # "heat release J/deg" has a quotient for its unit
    elif bracketed and bracketed[1] and _is_unit(bracketed[2]) and bracketed[2] != "1":
        text, written = bracketed[1] + (bracketed[3] or ""), written or bracketed[2]
    elif numbered and not unit:
        text, written = numbered[1] + numbered[numbered.re.groups], numbered[numbered.re.groups - 1]
    plain, reference = _unit(written)
    if not reference and plain not in TIME_UNITS and plain not in _ANGULAR:
        named = [kind for kind, word in _REFERENCES.items() if word.search(text)]
        reference = named[0] if len(named) == 1 else ""
    return Heading(text, plain, reference)
