"""The commands with their options, the variables of a result, and the public names, as they are."""

from __future__ import annotations

import importlib
import inspect
from collections import defaultdict
from types import ModuleType
from typing import Any

import typer
from typer.main import get_command

import crankmbs
from crankmbs.cli import app
from crankmbs.mechanics.variables import EVERY
from crankmbs.scene.windowed import Windowed

__all__ = ["commands_page", "python_page", "variables_page"]

_ROOMS = {  # where a name is defined, and what such names are for
    "simulate": "Run",
    "choose": "Run",
    "result": "The result",
    "motion": "The result",
    "scene": "The scene",
    "measures": "Measures",
    "compare": "Compare",
    "design": "Design",
    "indicated": "Measured pressures",
    "export": "Export",
    "lecture": "Lecture formulas",
    "errors": "Errors",
}


def commands_page() -> str:
    """Every command with its arguments and options, in Markdown."""
    group: Any = get_command(app)
    with typer.Context(group) as context:
        return "\n".join(
            _command(name, command, context) for name, command in sorted(group.commands.items())
        )


def _command(name: str, command: Any, context: Any) -> str:
    rows = []
    for parameter in command.get_params(context):
        if parameter.name == "help":
            continue
        called = ", ".join(parameter.opts) if parameter.opts[0].startswith("-") else ""
        default = parameter.default
        plain = isinstance(default, str | int | float) and not isinstance(default, bool)
        shown = "needed" if parameter.required else f"`{default}`" if plain else ""
        called = called or parameter.metavar or parameter.name.upper()
        rows.append(f"| `{called}` | {_escaped(parameter.help or '')} | {shown} |")
    head = [f"## `crankmbs {name}`", "", inspect.cleandoc(command.help or ""), ""]
    table = ["| | | default |", "|---|---|---|", *rows, ""] if rows else []
    return "\n".join([*head, *table])


def variables_page() -> str:
    """Every variable of a result with its unit, in Markdown."""
    rows = [
        f"| `{name}` | {about.units.replace('^2', '²')} | {', '.join(about.dims)} | "
        f"{_escaped(about.long_name)} |"
        for name, about in EVERY.items()
    ]
    return "\n".join(["| name | unit | over | what it is |", "|---|---|---|---|", *rows, ""])


def python_page() -> str:
    """Every public name by what it is for, as reStructuredText for autodoc in Markdown."""
    by_room: dict[str, list[str]] = defaultdict(list)
    things = {name: getattr(crankmbs, name) for name in crankmbs.__all__}
    for name, thing in things.items():
        if isinstance(thing, ModuleType):
            continue
        room = thing.__module__.split(".")[1]
        by_room[_ROOMS.get(room, room.capitalize())].append(f"crankmbs.{name}")
    for module in ("crankmbs.lecture", "crankmbs.figures"):
        title = "Lecture formulas" if module.endswith("lecture") else "Figures"
        by_room[title] += [f"{module}.{n}" for n in importlib.import_module(module).__all__]
    lines = []
    for title in dict.fromkeys([*_ROOMS.values(), *by_room]):
        lines += [f"## {title}", "", "```{eval-rst}"]
        lines += [line for name in by_room[title] for line in _autodoc(name)]
        lines += ["```", ""]
    return "\n".join(lines)


def _autodoc(name: str) -> list[str]:
    module, _, last = name.rpartition(".")
    thing = getattr(importlib.import_module(module), last)
    if inspect.isclass(thing):
        members = [] if issubclass(thing, tuple | Windowed) else ["   :members:"]
        return [f".. autoclass:: {name}", *members, ""]
    return [f".. auto{'function' if callable(thing) else 'data'}:: {name}", ""]


def _escaped(text: str) -> str:
    return text.replace("|", "\\|")
