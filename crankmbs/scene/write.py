"""A scene back to text: its TOML file, and its tables as CSV files beside it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

from crankmbs.errors import InputError
from crankmbs.scene.gas import Gas
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.schema import dimension_of
from crankmbs.scene.tables import CylinderTable, Header, Table, tables_of
from crankmbs.scene.units import DEGREE, quantity, unit_of
from crankmbs.scene.windowed import Windowed

__all__ = ["scene_files"]

_READ_IN = {  # the first, unless another needs far fewer digits; all else in SI
    "angle": ("deg", "rad"),
    "angular speed": ("rpm", "rad/s"),
    "area": ("cm^2", "mm^2", "m^2"),
    "force": ("N", "kN", "lbf"),
    "inertia": ("kg m^2", "kg cm^2", "lb in^2"),
    "length": ("mm", "m", "in"),
    "mass": ("kg", "g", "lb"),
    "pressure": ("bar", "kPa", "kgf/cm^2", "psi", "Pa"),
    "stiffness": ("N/mm", "N/m", "lbf/in"),
    "time": ("s", "ms"),
    "torque": ("N m", "kN m", "lbf ft"),
    "unbalance": ("kg m", "g mm", "g cm"),
    "viscous coefficient": ("N m s", "N m/rpm"),
    "quadratic coefficient": ("N m s^2", "N m/rpm^2"),
}
_FAR_FEWER = 4
_PRESSURES = ("pressure", "motored", "crank_end")  # constants where they are no tables
_PRESSURE = Header({"crank_angle_deg": DEGREE}, {"pressure_Pa": 1.0})  # not of speeds and loads


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

    def written(value: Any, dimension: str | None, name: str, header: Header) -> str:
        if isinstance(value, Table | CylinderTable):
            tables[f"{name}.csv"] = _csv(value, header)
            return _quoted(f"{name}.csv")
        if isinstance(value, tuple):
            items = (written(v, dimension, f"{name}{k}", header) for k, v in enumerate(value, 1))
            return f"[{', '.join(items)}]"
        if hasattr(value, "__pydantic_fields__"):
            inside = ", ".join(keys(value, name, header))
            return f"{{ {inside} }}" if inside else "{}"
        return _scalar(value, dimension)

    def keys(part: Any, name: str, header: Header) -> Iterator[str]:
        header = getattr(part, "header", header)
        for key, value, dimension in _values(part):
            yield f"{key} = {written(value, dimension, name or f'{stem}_{key}', header)}"

    parts = {key: value for key, value, _ in _values(scene)}
    lines = [f"{key} = {_quoted(parts.pop(key))}" for key in ("title", "source") if key in parts]
    run = parts.pop("run")
    loads = parts.pop("torque", ()), parts.pop("force", ())
    for heading, part in parts.items():
        lines += ["", f"[{heading}]", *keys(part, "", _PRESSURE)]
    for number, load in (each for loads_of in loads for each in enumerate(loads_of, start=1)):
        lines += ["", f"[[{load.heading}]]", f"kind = {_quoted(load.kind)}"]
        lines += keys(load, f"{stem}_{_use(load, number)}", _PRESSURE)
    lines += ["", "[run]", *keys(run, "", _PRESSURE)]
    if run.every is None:
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


def _values(part: Any) -> Iterator[tuple[str, Any, str | None]]:
    """Key, value and dimension of a part's fields, but of its kind and those at their default."""
    for name, field in type(part).__pydantic_fields__.items():
        value = getattr(part, name)
        if value is not None and value != field.default and name != "kind":
            constant = isinstance(part, Gas) and name in _PRESSURES
            dimension = "pressure" if constant else dimension_of(type(part), name)
            yield field.validation_alias or name, value, dimension


def _scalar(value: Any, dimension: str | None) -> str:
    if isinstance(value, Extent):
        if value.unit == "rad":
            turns = value.value / (2.0 * math.pi)
            whole = turns == round(turns) and quantity(f"{turns:g} rev", "angle") == value.value
            return f'"{turns:g} rev"' if whole else _number(value.value, "angle")
        unit = "cycles" if value.unit == "cycle" and value.value != 1.0 else value.unit
        return f'"{_digits(value.value)} {unit}"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return _number(value, dimension)
    return _quoted(value) if isinstance(value, str) else str(value)


def _number(value: float, dimension: str | None) -> str:
    if dimension is None:
        return _digits(value)
    best, length = f"{_digits(value)} {unit_of(dimension)}", math.inf
    for unit in _READ_IN.get(dimension, (unit_of(dimension),)):
        factor = quantity(f"1 {unit}", dimension)
        text = next((t for t in _texts(value / factor) if float(t) * factor == value), None)
        if text is not None and len(text) < length:
            best, length = f"{text} {unit}", len(text) - _FAR_FEWER
    return f'"{best}"'


def _texts(number: float) -> Iterator[str]:
    """A number with ever more digits, and its neighbours with all."""
    for count in range(1, 17):
        rounded = float(f"{number:.{count}g}")
        yield _digits(rounded)
    for neighbour in (number, math.nextafter(number, math.inf), math.nextafter(number, -math.inf)):
        yield _digits(neighbour)


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
    (x_name, x_factor), *_ = header.x.items()
    (y_name, y_factor), *_ = header.y.items()
    columns, names = [each.y for each in tables_of(table)], [y_name]
    if isinstance(table, CylinderTable):
        names = list(header.ways) or [f"{y_name}_{k}" for k in range(1, len(columns) + 1)]
    factors = [x_factor, *[y_factor] * len(columns)]
    cells = (
        [_digits(_divided(value, factor)) for value in column]
        for column, factor in zip([table.x, *columns], factors, strict=True)
    )
    lines = [",".join(row) for row in ((x_name, *names), *zip(*cells, strict=True))]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
