"""Docstrings as the project writes them, for autodoc: sentences, formulas that are indented,
sections of entries ``name : what it is``, examples."""

from __future__ import annotations

import inspect
import re
import typing
from itertools import groupby
from typing import TYPE_CHECKING, Any

from sphinx.util.inspect import stringify_signature

if TYPE_CHECKING:
    from sphinx.application import Sphinx

__all__ = ["restructured", "setup"]

_ENTRY = re.compile(r"(\w[\w, ]*(?: \[[^]]*\])?) : (.*)|(Source|Arguments|Returns|Raises): (.*)")
_CODE = re.compile(r"(``?[^`]+``?)")
_SPECIAL = re.compile(r"[\\*|]|_(?!\w)")


def restructured(lines: list[str]) -> list[str]:
    r"""The lines of a docstring as reStructuredText.

    >>> restructured(["Least |x|."])
    ['Least \\|x\\|.', '']
    """
    made: list[str] = []
    for blank, group in groupby(lines, lambda line: not line.strip()):
        if not blank:
            made += _block(list(group))
    return made


def _block(block: list[str]) -> list[str]:
    if block[0].startswith(">>>"):
        return [*block, ""]
    if block[0].startswith("    "):
        return ["::", "", *block, ""]
    if len(block) > 1 and block[1].strip() and not block[1].strip("- "):
        return [f".. rubric:: {block[0]}", "", *_items(block[2:], listed=True)]
    return _items(block, listed=False)


def _items(block: list[str], *, listed: bool) -> list[str]:
    """Sentences, and entries as items of a list; ``listed``: nothing else is there."""
    made: list[str] = []
    inside = False
    for line in block:
        entry = _ENTRY.match(line)
        text = _escaped(line.strip())
        if entry:
            name, words = entry[1] or entry[3], entry[2] or entry[4]
            made += ["", f"* **{_escaped(name)}**: {_escaped(words)}"]
        elif listed and not made:
            made.append(f"* {text}")
        else:
            made.append(f"{'  ' if inside else ''}{text}")
        inside = inside or listed or entry is not None
    return [*made, ""]


def _escaped(text: str) -> str:
    parts = _CODE.split(text)
    plain = (_SPECIAL.sub(r"\\\g<0>", part) for part in parts[::2])
    code = (f"``{part.strip('`')}``" for part in parts[1::2])
    merged = [""] * len(parts)
    merged[::2], merged[1::2] = list(plain), list(code)
    return "".join(merged)


def _process(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    lines[:] = restructured(lines)


def _typed(app: Sphinx, what: str, name: str, thing: Any, *_: Any) -> tuple[str, str] | None:
    """The types of a part's fields as Python has them, without the rules that the keys state."""
    if not hasattr(thing, "__pydantic_fields__"):
        return None
    types, plain = typing.get_type_hints(thing), inspect.signature(thing)
    parameters = [
        each.replace(annotation=types.get(each.name, each.annotation))
        for each in plain.parameters.values()
    ]
    bare = plain.replace(parameters=parameters)
    return stringify_signature(bare, show_return_annotation=False, unqualified_typehints=True), ""


def setup(app: Sphinx) -> dict[str, Any]:
    """Have autodoc read docstrings this way."""
    app.connect("autodoc-process-docstring", _process)
    app.connect("autodoc-process-signature", _typed)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
