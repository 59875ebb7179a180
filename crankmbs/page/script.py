"""The modules in JavaScript joined to one script: an `import` of a neighbour fails from a file."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

__all__ = ["FOLDER", "joined"]

FOLDER = Path(__file__).parent / "js"
_IMPORT = re.compile(r'^import \{([^}]*)\} from "\./(\w+)\.js";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)


def joined(name: str) -> str:
    """A module and all that it imports, as one script that gives what the module exports.

    Each module is a function, so that their names do not meet.

    Raises
    ------
    ValueError : a module that imports or exports in a way that is not joined

    >>> joined("geometry").startswith("(() => {")
    True
    """
    order: dict[str, str] = {}
    _collect(name, order)
    parts = [f"const {module} = (() => {{\n{text}}})();\n" for module, text in order.items()]
    return f"(() => {{\n{''.join(parts)}return {name};\n}})()"


def _collect(name: str, order: dict[str, str]) -> None:
    """Add a module after those that it imports."""
    if name in order:
        return
    text, needed = _module(name)
    for each in needed:
        _collect(each, order)
    order[name] = text


@cache
def _module(name: str) -> tuple[str, tuple[str, ...]]:
    """The body of a module, and the modules that it imports."""
    source = (FOLDER / f"{name}.js").read_text(encoding="utf-8")
    needed = tuple(match[2] for match in _IMPORT.finditer(source))
    exports = [match[1] for match in _EXPORT.finditer(source)]
    body = _IMPORT.sub(r"const {\1} = \2;", source)
    body = _EXPORT.sub("", body)
    if re.search(r"^(import|export)\b", body, re.MULTILINE):
        raise ValueError(f"{name}.js: an import or export that cannot be joined")
    return f"{body}return {{ {', '.join(exports)} }};\n", needed
