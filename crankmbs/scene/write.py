"""A scene back to text: its TOML file, and its tables as CSV files beside it."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator
from typing import Any

from crankmbs.errors import InputError
from crankmbs.scene.drives import Ramp
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Header, Table
from crankmbs.scene.units import DEGREE, RPM
from crankmbs.scene.windowed import Windowed

__all__ = ["scene_files"]

_ANGULAR = {
    **dict.fromkeys(("angle", "phase", "bank", "period"), (DEGREE, "deg", "rad")),
    **dict.fromkeys(
        ("speed", "mean", "amplitude", "from", "to", "from_speed", "until_speed"),
        (RPM, "rpm", "rad/s"),
    ),
}
_WORDS = ("title", "source")
_PRESSURES = ("motored", "crank_end")  # beside that of the gas
_UNITS = {
    **dict.fromkeys(("radius", "length", "bore", "rod_diameter", "offset", "center_of_mass"), "m"),
    **dict.fromkeys(("position", "spacing", "relaxed_at"), "m"),
    **dict.fromkeys(("intake_pressure", "exhaust_pressure", "peak_pressure"), "Pa"),
    **dict.fromkeys(("ambient", "closing", "pressure", "crank_end"), "Pa"),
    "mass": "kg",
    "inertia": "kg m^2",
    "area": "m^2",
    "acceleration": "m/s^2",
    "torque": "N m",
    **dict.fromkeys(("ring_force", "force"), "N"),
    "stiffness": "N/m",
    "viscous": "N s/m",
    **dict.fromkeys(("over", "after", "until"), "s"),
}
_PRESSURE = Header("crank_angle_deg", DEGREE, "pressure_Pa", 1.0)  # not of speeds and loads


def scene_files(scene: Scene, stem: str) -> dict[str, str]:
    """Write a scene as text that `crankmbs.load_scene` reads to the same scene.

    Every number is kept to its last bit; a table's angles and speeds to rounding where the table
    came from no file. Keys at their default are left out.

    Parameters
    ----------
    scene : the scene; stem : name of the files, without ending

    Returns
    -------
    dict : file name -> text; first STEM.toml, then the tables that it names

    Raises
    ------
    InputError : a load is a function of Python

    >>> list(scene_files(load_scene("propeller"), "mine"))
    ['mine.toml', 'mine_pressure.csv']
    """
    tables: dict[str, str] = {}

    def section(heading: str, part: Any, use: str, header: Header | None) -> list[str]:
        lines = ["", heading]
        for key, value in _values(part):
            table = getattr(value, "file", value)
            name = f"{stem}_{key if key in _PRESSURES else use}"
            if isinstance(table, Table | CylinderTable):
                assert header is not None
                file = f"{name}.csv"
                tables[file] = _csv(table, header)
                rest = {} if table is value else {k: v for k, v in _values(value) if k != "file"}
                value = file if table is value else {"file": file, **rest}
            elif isinstance(value, tuple) and isinstance(value[0], Table):
                assert header is not None
                files = [f"{name}{k}.csv" for k in range(1, len(value) + 1)]
                rows = (_csv(each, header) for each in value)
                tables.update(zip(files, rows, strict=True))
                value = tuple(files)
            lines.append(f"{key} = {_written(key, value)}")
        return lines

    lines = [f"{key} = {_quoted(value)}" for key, value in _values(scene) if key in _WORDS]
    for key, part in _values(scene):
        if key not in _WORDS and key not in ("torque", "force", "run"):
            use = "pressure" if key == "gas" else "speed"
            header = getattr(getattr(part, "speed", None), "header", _PRESSURE)
            lines += section(f"[{key}]", part, use, header)
    every: tuple[tuple[Windowed, ...], ...] = (scene.torque, scene.force)
    for loads in every:
        for number, load in enumerate(loads, start=1):
            heading = f"[[{load.heading}]]"
            rows = section(heading, load, _use(load, number), load.header)[2:]
            lines += ["", heading, f"kind = {_quoted(load.kind)}", *rows]
    lines += section("[run]", scene.run, "", None)
    if scene.run.every is None:
        lines.append('every = "none"')
    return {f"{stem}.toml": "\n".join(lines).lstrip("\n") + "\n", **tables}


def _use(load: Windowed, number: int) -> str:
    """What the files of a load are for, in their names."""
    if load.kind not in load.kinds:
        raise InputError(
            f"{load.heading}[{number}]: what is a function of Python, {load.words}, cannot be "
            "written to a scene file; leave it out, or give it as a table"
        )
    return f"{'force_' * (load.heading == 'force')}{load.kind}{number}"


def _values(part: Any) -> Iterator[tuple[str, Any]]:
    """Key and value of a part's fields, those at their default left out."""
    for field in dataclasses.fields(part):
        value = getattr(part, field.name)
        if value is not None and value != field.default and field.name != "kind":
            yield (
                ("from" if isinstance(part, Ramp) and field.name == "start" else field.name),
                value,
            )


def _written(key: str, value: Any) -> str:
    if isinstance(value, Extent):
        return _extent(value)
    if isinstance(value, tuple):
        return f"[{', '.join(_written(key, item) for item in value)}]"
    if dataclasses.is_dataclass(value):
        value = dict(_values(value))
    if isinstance(value, dict):
        inside = ", ".join(f"{k} = {_written(k, item)}" for k, item in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return _number(key, value)
    return _quoted(value) if isinstance(value, str) else str(value)


def _number(name: str, value: float) -> str:
    if name in _ANGULAR:
        factor, unit, si = _ANGULAR[name]
        number = _divided(value, factor)
        exact = factor * number == value
        return f'"{_digits(number)} {unit}"' if exact else f'"{_digits(value)} {si}"'
    return f'"{_digits(value)} {_UNITS[name]}"' if name in _UNITS else _digits(value)


def _extent(extent: Extent) -> str:
    if extent.unit != "rad":
        return f'"{_digits(extent.value)} {extent.unit}"'
    return _number("angle", extent.value)


def _digits(value: float) -> str:
    """As many digits as tell the number from every other."""
    return repr(value).removesuffix(".0")


def _divided(value: float, factor: float) -> float:
    """The shortest number that times the factor is the value again, if there is one."""
    ratio = value / factor
    near = (
        round(ratio, 9),
        ratio,
        math.nextafter(ratio, math.inf),
        math.nextafter(ratio, -math.inf),
    )
    return next((number for number in near if factor * number == value), ratio)


def _csv(table: Table | CylinderTable, header: Header) -> str:
    x_name, x_factor, y_name, y_factor, y_names = header
    of_each = [(x_name, table.x, x_factor)]
    if isinstance(table, Table):
        of_each.append((y_name, table.y, y_factor))
    else:
        names = y_names or [f"{y_name}_{k}" for k in range(1, len(table.y) + 1)]
        of_each += [(name, y, y_factor) for name, y in zip(names, table.y, strict=True)]
    cells = ([_digits(_divided(v, factor)) for v in values] for _, values, factor in of_each)
    lines = [",".join(row) for row in zip(*cells, strict=True)]
    return "\n".join([",".join(name for name, *_ in of_each), *lines]) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
