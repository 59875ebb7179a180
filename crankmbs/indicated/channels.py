"""Which columns are pressures of which cylinder and cycle, told by their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from crankmbs.errors import InputError, UndecidedError, shown
from crankmbs.indicated.options import Options
from crankmbs.scene.headings import PRESSURE_UNITS, Heading, angle_places, by_name, pick

__all__ = [
    "Column",
    "angle_column",
    "columns_of",
    "is_pressure",
    "refuse_unit",
    "several_words",
]

_KINDS = {
    "intake": r"^p?[ _.-]*(int|inl|ein|saug|man(?!o)|map$|boost|lade)|intake|inlet|ansaug",
    "exhaust": r"^p?[ _.-]*(exh|abg|aus(?!s)|out)|exhaust|abgas",
    "other": r"^[ignpbf]?mep|^p[ _]?max|rail|inj|fuel|kraftstoff|oil|oel|öl|coolant|baro|ambient",
    "mean": r"(?<![a-z])(mean|avg|average|mittel\w*|mw|moy)(?![a-z])",
    "minimum": r"(?<![a-z])min(imum)?(?![a-z])",
    "maximum": r"(?<![a-z])max(imum)?(?![a-z])",
    "spread": r"(?<![a-z])(std|stdev|sdev|stddev|sigma|cov|var)(?![a-z])",
}
_CYCLE = re.compile(r"(?:cycle|cyc|zyklus|zyk|#)[ _.:-]*0*([0-9]+)|[\[(]([0-9]+)[\])]$")
_COUNTER = re.compile(r"(cycle|cyc|zyklus|zyk)([ _.-]*(no|nr|number|count|index))?[ .]*", re.I)
_PRESSURE_NAME = re.compile(
    r"(p[ _]?(cyl|zyl|zyk)?|cyl(inder)?|zyl(inder)?|(zylinder)?druck|cylinder pressure|pressure"
    r"|cyl[ _]?press\w*|cylpr|p[ _]?cylinder|cycle|cyc|zyklus)[ _.#(\[-]*[0-9]*([ _.#(\[-].*)?",
    re.IGNORECASE,
)
_WRITTEN = {unit.lower(): unit for unit in ("Pa", "hPa", "kPa", "MPa", "N/mm^2")}
_MOST_CYLINDERS = 24  # of one engine: more columns alike are its cycles


class Column(NamedTuple):
    """A column of a pressure: place in the sheet, factor to Pa, what it is; cycle 0: not said."""

    place: int
    name: str
    factor: float
    kind: str
    cylinder: int
    cycle: int = 0
    reference: str = ""


def angle_column(headings: Sequence[Heading], angle: str | None) -> int:
    """The place of the crank angle, the column of this name where one is given.

    Raises
    ------
    InputError : no column of this name; UndecidedError : none is an angle by its name or unit
    """
    angles = angle_places(headings, angle, "angle")
    if angles:
        return angles[0]
    listed = ", ".join(shown(heading.name) for heading in headings[:8])
    others = [each.name for each in headings if each.name and not is_pressure(each)]
    raise UndecidedError(
        f"no column is a crank angle by its name or its unit; the columns are {listed}",
        tuple(f'angle="{name}"' for name in others[:1])
        or ('the column a heading, such as "crank_angle_deg"',),
    )


def several_words(headings: Sequence[Heading], at: int, *, time: bool) -> list[str]:
    """Which of several columns named as a time, or as a crank angle, is read; nothing of one."""
    places = by_name(headings, time=time)
    if len(places) < 2:
        return []
    names = [shown(_with_unit(headings[k])) for k in places]
    what, way_out = "times", ""
    if not time:
        another = next(headings[k].name for k in places if k != at)
        what, way_out = "crank angles", f'; angle="{another}" takes another'
    return [f"{' and '.join(names)} are {what}: {shown(_with_unit(headings[at]))} is read{way_out}"]


def _with_unit(heading: Heading) -> str:
    return f"{heading.name} [{heading.unit}]" if heading.unit else heading.name


def columns_of(headings: Sequence[Heading], options: Options, angle: int) -> tuple[Column, ...]:
    """The columns of pressures, each with its cylinder and cycle.

    Raises
    ------
    InputError : no such columns, a unit for those that have one; UndecidedError : no unit, or
        numbers that may count either
    """
    chosen = None
    if options.columns is not None:
        chosen = [k for k in pick(headings, options.columns, "columns") if k != angle]
    others = [k for k, heading in enumerate(headings) if k != angle and is_pressure(heading)]
    rest = list(dict.fromkeys([*(chosen or ()), *others]))
    if not rest or (chosen is not None and not chosen):
        listed = ", ".join(shown(heading.name) for heading in headings[:8])
        raise InputError(
            f"no column is a pressure by its name or its unit; the columns are {listed}; "
            'name some, such as columns="PCYL1..4"'
        )
    named = [(k, _kind(headings[k].name) if k not in (chosen or ()) else "") for k in rest]
    read = [(k, kind) for k, kind in named if kind or chosen is None or k in chosen]
    refuse_unit([headings[k] for k, _ in read], options.unit)
    return _apart(_numbered(headings, read, options), chosen is not None)


def refuse_unit(headings: Sequence[Heading], unit: str | None) -> None:
    """Refuse a unit where all pressures have theirs, and one has another."""
    if unit is None or any(heading.pressure is None for heading in headings):
        return
    for heading in headings:
        if heading.pressure != PRESSURE_UNITS[unit]:
            raise InputError(
                f'unit="{_WRITTEN.get(unit, unit)}" is for pressures without a unit, and column '
                f"{shown(heading.name)} is in {_WRITTEN.get(heading.unit, heading.unit)}; leave it "
                "out, or correct the heading"
            )


def is_pressure(heading: Heading, units: Sequence[str] = ("",)) -> bool:
    """Whether the column is a pressure by its unit, or by its name under one of some units.

    >>> is_pressure(Heading("PCYL1", "")), is_pressure(Heading("PCYL1", "v"), ("v",))
    (True, True)
    """
    if heading.pressure is not None:
        return True
    plain = _PRESSURE_NAME.fullmatch(heading.name) is not None or heading.name.isdigit()
    return heading.unit in units and plain and _COUNTER.fullmatch(heading.name) is None


def _kind(name: str) -> str:
    low = name.lower()
    return next((kind for kind, rule in _KINDS.items() if re.search(rule, low)), "")


def _numbered(
    headings: Sequence[Heading], read: list[tuple[int, str]], options: Options
) -> list[Column]:
    numbers = [_numbers(headings[k].name) for k, _ in read]
    plain = {
        cylinder
        for (_, kind), (cylinder, cycle) in zip(read, numbers, strict=True)
        if not kind and not cycle
    }
    bare = [headings[k].name for k, kind in read if not kind and headings[k].name.isdigit()]
    each = options.each
    if each is None and len(bare) > 1 and len(bare) <= _MOST_CYLINDERS:
        raise UndecidedError(
            f"the columns are named {bare[0]} to {bare[-1]}, and these may be cycles of "
            "one cylinder or cylinders",
            ('each="cycle"', 'each="cylinder"', f'columns="{bare[0]}" for a pressure alone'),
        )
    as_cycles = each == "cycle" or (each is None and len(plain) > _MOST_CYLINDERS)
    columns = []
    for (k, kind), (cylinder, cycle) in zip(read, numbers, strict=True):
        heading = headings[k]
        if as_cycles and not kind and not cycle:
            cylinder, cycle = 1, cylinder
        factor = _factor(heading, options)
        columns.append(
            Column(
                k, heading.name, factor, kind or "cycle", cylinder or 1, cycle, heading.reference
            )
        )
    return columns


def _apart(columns: list[Column], chosen: bool) -> tuple[Column, ...]:
    """The columns, no two of them the same cycle of a cylinder: chosen ones count cylinders then.

    Raises
    ------
    UndecidedError : two pressures of one cylinder that are no cycles by their names
    """
    single = [each for each in columns if each.kind == "cycle" and not each.cycle]
    for number in sorted({each.cylinder for each in single}):
        names = list(dict.fromkeys(each.name for each in single if each.cylinder == number))
        if len(names) < 2:
            continue
        if chosen:
            place = {name: k for k, name in enumerate((each.name for each in single), start=1)}
            return tuple(
                each._replace(cylinder=place[each.name]) if each in single else each
                for each in columns
            )
        raise UndecidedError(
            f"{shown(names[0])} and {shown(names[1])} may both be the pressure of "
            f"cylinder {number}",
            tuple(f'columns="{name}"' for name in names[:2]),
        )
    return tuple(columns)


def _numbers(name: str) -> tuple[int, int]:
    """The numbers of cylinder and cycle in a name, 0 where it has none."""
    low = name.lower()
    match = _CYCLE.search(low)
    cycle = 0
    if match:
        cycle = int(match[1] or match[2])
        low = low[: match.start()] + low[match.end() :]
    numbers = [int(each) for each in re.findall(r"[0-9]+", low)]
    cylinder = numbers[0] if numbers else 0
    if not cycle and len(numbers) > 1:
        cycle = numbers[1]
    return cylinder, cycle


def _factor(heading: Heading, options: Options) -> float:
    if heading.pressure is not None:
        return heading.pressure
    if options.unit is None:
        lack = "no unit, neither in the name nor in a row below the names"
        if heading.unit or re.search(r"\[.+\]|\(.+\)", heading.name):
            lack = "a unit that is not known"
        raise UndecidedError(
            f"the pressures of column {shown(heading.name)} have {lack}",
            ('unit="bar"', f"another of kPa, Pa, MPa, psi{_and_reference(options)}"),
        )
    return PRESSURE_UNITS[options.unit]


def _and_reference(options: Options) -> str:
    """What a pressure without a unit leaves open besides, so that both are asked for at once."""
    ways = ', with reference="absolute" or "gauge" unless the compression shows it'
    return "" if options.reference else ways
