"""Every key of a scene file with its value, default and rule, from the dataclasses themselves."""

from __future__ import annotations

import inspect
import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

from annotated_types import Ge, Gt, Le, Len, Lt

from crankmbs.scene.drives import SpeedFile
from crankmbs.scene.examples import example_of
from crankmbs.scene.force import PistonForce
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.schema import CsvFile, Quantity
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.torque import Torque
from crankmbs.scene.units import DEGREE, EXAMPLES
from crankmbs.scene.windowed import Windowed

__all__ = ["Key", "keys_of", "keys_page", "sections"]

_BOUNDS = {Ge: ("ge", "at least"), Gt: ("gt", "above"), Le: ("le", "at most"), Lt: ("lt", "below")}
_PLAIN = {bool: "`true` or `false`", int: "whole number", float: "number", str: "text"}
_FILE = "file name"
_BY_CHECK = {  # what a check of its own takes, by its name
    "_source": (EXAMPLES["pressure"], _FILE, "list of either"),
    "_motored": (EXAMPLES["pressure"], _FILE, "list of either", "a table"),
    "_spacing": ('"0.5 deg" or "0.1 ms"', '`"none"`'),
    "_cycles": ('"5"', '"5-8"', '"every 4"'),
}


class Key(NamedTuple):
    """A key as its file writes it: the values it takes, its default, its rules in words, and the
    classes whose keys a table in its place has."""

    name: str
    values: tuple[str, ...]
    default: str
    rules: tuple[str, ...]
    parts: tuple[type, ...]


def keys_of(part: type) -> list[Key]:
    """The keys of a part of a scene, in their order."""
    fields = part.__pydantic_fields__
    by_columns = part is SpeedFile  # its columns say of what kind it is
    return [_key(part, n, field) for n, field in fields.items() if not (by_columns and n == "kind")]


def sections(part: type = Scene, path: str = "") -> Iterator[tuple[str, type]]:
    """Every table of a scene file, ``[crank]`` or ``[fuel] misfire``, with its class."""
    for key in keys_of(part):
        for inner in key.parts:
            listed = f"[[{key.name}]]" if issubclass(inner, Windowed) else f"[{key.name}]"
            here = f"{path} {key.name}" if path else listed
            yield here, inner
            yield from sections(inner, here)


def keys_page() -> str:
    """All of them in Markdown."""
    pages = [_table("Outside all tables", Scene, _own(keys_of(Scene)))]
    for path, part in sections():
        pages.append(_table(f"`{path}`", part, keys_of(part)))
    return "\n".join(pages)


def _own(keys: list[Key]) -> list[Key]:
    return [key for key in keys if not key.parts]


def _table(title: str, part: type, keys: list[Key]) -> str:
    about = inspect.cleandoc(part.__doc__ or "").replace("``", "`")
    kind = next((key.default for key in keys if key.name == "kind"), "")
    title += f" of kind {kind}" if kind and issubclass(part, Windowed) else f", {part.__name__}"
    rows = [
        f"| `{key.name}` | {' or '.join(key.values)} | {key.default} | {', '.join(key.rules)} |"
        for key in keys
    ]
    lines = [
        f"## {title}",
        "",
        about,
        "",
        "| key | such as | default | rule |",
        "|---|---|---|---|",
    ]
    return "\n".join([*lines, *rows, ""])


def _key(part: type, name: str, field: Any) -> Key:
    key = field.validation_alias or name
    found = _Found(example_of(part, key))
    found.look(field.annotation)
    for one in field.metadata:
        found.note(one)
    values = tuple(dict.fromkeys(found.values))
    rules = tuple(
        dict.fromkeys(found.rules + [_bound(one, found.dimension) for one in found.bounds])
    )
    default = "needed" if field.is_required() else _shown(field.get_default(), found.dimension)
    return Key(key, values, default, rules, tuple(found.parts))


class _Found:
    """What an annotation says."""

    def __init__(self, example: str | None) -> None:
        self.example = example  # of a quantity
        self.values: list[str] = []
        self.rules: list[str] = []
        self.bounds: list[Any] = []
        self.parts: list[type] = []
        self.dimension = ""

    def look(self, annotation: Any) -> None:
        """Into an annotation and all that is in it."""
        origin, inner = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            self.look(inner[0])
            for one in inner[1:]:
                self.note(one)
        elif origin is Literal:
            self.values += [f"`{one}`" if isinstance(one, int) else f'`"{one}"`' for one in inner]
        elif origin is tuple:
            self.look(inner[0])
            self.rules.append("a list")
        elif inner:
            for one in inner:
                self.look(one)
        elif annotation is not type(None):
            self._name(annotation)

    def _name(self, one: Any) -> None:
        if one in (Table, CylinderTable):
            self.values.append(_FILE)
        elif one is Extent:
            self.values.append(EXAMPLES["extent"])
        elif one in (Torque, PistonForce):
            self.parts += one.kinds.values()
            self.values.append("tables")
        elif hasattr(one, "__pydantic_fields__"):
            self.parts.append(one)
            self.values.append("a table")
        else:
            self.values.append(_PLAIN.get(one, one.__name__))

    def note(self, one: Any) -> None:
        """What stands beside a type in its annotation."""
        check = getattr(one, "func", None)
        if isinstance(check, Quantity):
            self.dimension = check.dimension
            number = _PLAIN[float]
            assert self.example is not None, f"no example of a {check.dimension}"
            self.values = [self.example if v == number else v for v in self.values]
        elif isinstance(check, CsvFile):
            header = check.header
            names = [" or ".join(f"`{n}`" for n in side) for side in (header.x, header.y)]
            ways = " and ".join(f"`{n}`" for n in header.ways)
            self.rules.append(f"columns {' and '.join(names)}{f', or {ways}' if ways else ''}")
        elif isinstance(one, Len):
            self.rules.append(f"at least {one.min_length}")
        elif type(one) in _BOUNDS:
            self.bounds.append(one)
        elif getattr(check, "__name__", None) in _BY_CHECK:
            self.values, self.rules = list(_BY_CHECK[check.__name__]), []
        elif getattr(one, "tag", None) is None and hasattr(one, "metadata"):
            for inner in one.metadata:
                self.note(inner)


def _bound(one: Any, dimension: str) -> str:
    attribute, words = _BOUNDS[type(one)]
    return f"{words} {_shown(getattr(one, attribute), dimension)}"


def _shown(value: Any, dimension: str) -> str:
    match value:
        case None | ():
            return "none"
        case bool():
            return f"`{str(value).lower()}`"
        case str():
            return f'`"{value}"`' if value else "none"
        case Extent(unit="rad"):
            return f"{value.value / DEGREE:g} deg"
        case int() | float() if dimension == "angle" and value:
            return f"{math.degrees(value):g} deg"
        case int() | float():
            return f"{value:g}"
        case _:
            return "one cylinder"
