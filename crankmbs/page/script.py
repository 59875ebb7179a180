"""The modules in JavaScript joined to one script: an `import` of a neighbour fails from a file."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

__all__ = ["FOLDER", "joined"]

FOLDER = Path(__file__).parent / "js"
_IMPORT = re.compile(r'^import \{([^}]*)\} from "\./(\w+)\.js";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)


def joined(module: str | Path) -> str:
    """A module, by its name or its file, and all that it imports, as one script that gives what
    the module exports.

    Each module is a function, so that their names do not meet.

    Raises
    ------
    ValueError : a module that imports or exports in a way that is not joined

    >>> joined("geometry").startswith("(() => {")
    True
    """
    source = module if isinstance(module, Path) else FOLDER / f"{module}.js"
    order: dict[str, str] = {}
    _collect(source, order)
    parts = [f"const {name} = (() => {{\n{text}}})();\n" for name, text in order.items()]
    return f"(() => {{\n{''.join(parts)}return {source.stem};\n}})()"


def _collect(source: Path, order: dict[str, str]) -> None:
    """Add a module after those that it imports."""
    if source.stem in order:
        return
    text, needed = _module(source)
    for each in needed:
        _collect(FOLDER / f"{each}.js", order)
    order[source.stem] = text


@cache
def _module(source: Path) -> tuple[str, tuple[str, ...]]:
    """The body of a module, and the modules that it imports."""
    text = source.read_text(encoding="utf-8")
    needed = tuple(match[2] for match in _IMPORT.finditer(text))
    exports = [match[1] for match in _EXPORT.finditer(text)]
    body = _IMPORT.sub(r"const {\1} = \2;", text)
    body = _EXPORT.sub("", body)
    if re.search(r"^(import|export)\b", body, re.MULTILINE):
        raise ValueError(f"{source.name}: an import or export that cannot be joined")
    return f"{body}return {{ {', '.join(exports)} }};\n", needed
