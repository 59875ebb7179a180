"""BIBLIOGRAPHY.md: the keys by which claims and references name their sources."""

import re
from collections.abc import Iterable
from pathlib import Path

__all__ = ["BIBLIOGRAPHY", "keys", "links"]

BIBLIOGRAPHY = Path(__file__).parent / "BIBLIOGRAPHY.md"


def keys() -> list[str]:
    """Every key, in the page's order."""
    return re.findall(r"^### (\S+)$", BIBLIOGRAPHY.read_text(encoding="utf-8"), re.MULTILINE)


def links(used: Iterable[str] | None = None) -> list[str]:
    """Lines at the end of a page that make links of its bracketed keys."""
    return [f"[{key}]: {BIBLIOGRAPHY.name}#{key.lower()}" for key in used or keys()]
