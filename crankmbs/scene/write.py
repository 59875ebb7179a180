"""A scene back to text: its TOML file, and its tables as CSV files beside it."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator
from typing import Any

from crankmbs.scene.drives import Ramp
from crankmbs.scene.scene import Extent, Scene
from crankmbs.scene.tables import Columns, Table
from crankmbs.scene.units import DEGREE, RPM

__all__ = ["scene_files"]

_ANGULAR = {
    **dict.fromkeys(("angle", "phase", "bank"), (DEGREE, "deg", "rad")),
    **dict.fromkeys(
        ("speed", "mean", "amplitude", "from", "to", "from_speed", "until_speed"),
        (RPM, "rpm", "rad/s"),
    ),
}
_WORDS = ("title", "source")
_UNITS = {
    **dict.fromkeys(("radius", "length", "bore", "offset", "center_of_mass"), "m"),
    **dict.fromkeys(("intake_pressure", "exhaust_pressure", "peak_pressure"), "Pa"),
    **dict.fromkeys(("ambient", "closing"), "Pa"),
    "mass": "kg",
    "inertia": "kg m^2",
    "area": "m^2",
    "acceleration": "m/s^2",
    "torque": "N m",
    **dict.fromkeys(("over", "after", "until"), "s"),
}
_COLUMNS = {
    "pressure": Columns("crank_angle_deg", DEGREE, "pressure_Pa", 1.0),
    "speed": Columns("time_s", 1.0, "speed_rpm", RPM),
}
"""Columns of a table by its use; a load states its own."""


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

    >>> list(scene_files(load_scene("propeller"), "mine"))
    ['mine.toml', 'mine_pressure.csv']
    """
    tables: dict[str, str] = {}

    def section(heading: str, part: Any, use: str, columns: Columns | None) -> list[str]:
        lines = ["", heading]
        for key, value in _values(part):
            table = getattr(value, "file", value)
            if isinstance(table, Table):
                assert columns is not None
                file = f"{stem}_{use}.csv"
                tables[file] = _csv(table, columns)
                value = {"file": file} if table is not value else file
            lines.append(f"{key} = {_written(key, value)}")
        return lines

    lines = [f"{key} = {_quoted(value)}" for key, value in _values(scene) if key in _WORDS]
    for key, part in _values(scene):
        if key not in _WORDS and key not in ("torque", "run"):
            use = "pressure" if key == "gas" else "speed"
            lines += section(f"[{key}]", part, use, _COLUMNS[use])
    for number, load in enumerate(scene.torque, start=1):
        heading, *rest = section("[[torque]]", load, f"{load.kind}{number}", load.columns)[1:]
        lines += ["", heading, f"kind = {_quoted(load.kind)}", *rest]
    lines += section("[run]", scene.run, "", None)
    if scene.run.every is None:
        lines.append('every = "none"')
    return {f"{stem}.toml": "\n".join(lines).lstrip("\n") + "\n", **tables}


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
        return f"{{ {', '.join(f'{k} = {_written(k, item)}' for k, item in value.items())} }}"
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


def _csv(table: Table, columns: Columns) -> str:
    x_name, x_factor, y_name, y_factor = columns
    rows = (
        f"{_digits(_divided(x, x_factor))},{_digits(_divided(y, y_factor))}"
        for x, y in zip(table.x, table.y, strict=True)
    )
    return "\n".join([f"{x_name},{y_name}", *rows]) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
