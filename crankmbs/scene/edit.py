"""A scene file copied with some values of its crank set: units, comments and order stay."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from crankmbs.scene.read import load_scene, parse_scene
from crankmbs.scene.scene import Scene
from crankmbs.scene.write import scene_files

__all__ = ["edited_files"]

_HEADING = re.compile(r"\s*\[")
_CRANK = re.compile(r"\s*\[\s*crank\s*\]\s*(#.*)?")
_WORDS = {"title", "source"}


def edited_files(
    path: Path, target: Path, crank: Mapping[str, str], remark: str = ""
) -> dict[str, bytes]:
    """The text of a scene file with values of [crank] set, and its tables.

    A file whose [crank] cannot be edited in place, such as an inline table, is written anew as
    `scene_files` does.

    Parameters
    ----------
    path : the scene file; target : where the copy shall stand, beside whose name its tables are
        named unless it stands in the same folder
    crank : key -> value with its unit, "0.3 kg m^2"; remark : the comment beside each

    Returns
    -------
    dict : file name -> content, the scene first

    Raises
    ------
    SceneError, InputError : a bad scene, or one that is bad with these values
    """
    scene = load_scene(path)
    edited = scene.with_(**{f"crank__{key}": value for key, value in crank.items()})
    text = _set(path.read_bytes().decode("utf-8-sig"), crank, remark)
    if not _is(text, path, edited):
        files = scene_files(edited, target.stem)
        return {name: part.encode() for name, part in files.items()}
    tables: dict[str, bytes] = {}
    if target.resolve().parent != path.resolve().parent:
        for name in dict.fromkeys(_files(tomllib.loads(text), path.parent)):
            base = Path(name).name
            copy = base if base.startswith(target.stem) else f"{target.stem}_{base}"
            tables[copy] = (path.parent / name).read_bytes()
            text = text.replace(f'"{name}"', f'"{copy}"').replace(f"'{name}'", f"'{copy}'")
    return {target.name: text.encode(), **tables}


def _set(text: str, crank: Mapping[str, str], remark: str) -> str:
    """The text with these values, where there is a heading [crank]."""
    lines = text.splitlines()
    begin = next((k for k, line in enumerate(lines, 1) if _CRANK.fullmatch(line)), None)
    if begin is None:
        return text
    comment = f"    # {remark}" if remark else ""
    for key, value in crank.items():
        of_key = re.compile(rf"\s*{key}\s*=")
        end = next((k for k in range(begin, len(lines)) if _HEADING.match(lines[k])), len(lines))
        place = next((k for k in range(begin, end) if of_key.match(lines[k])), None)
        new = f'{key} = "{value}"{comment}'
        lines[begin if place is None else place : begin if place is None else place + 1] = [new]
    return "\n".join(lines) + "\n"


def _is(text: str, path: Path, edited: Scene) -> bool:
    try:
        return parse_scene(text, path) == edited
    except ValueError:
        return False


def _files(raw: Any, folder: Path) -> Iterator[str]:
    """The values of a scene that name a file."""
    if isinstance(raw, dict):
        for key, value in raw.items():
            if key not in _WORDS:
                yield from _files(value, folder)
    elif isinstance(raw, list):
        for value in raw:
            yield from _files(value, folder)
    elif isinstance(raw, str) and (folder / raw).is_file():
        yield raw
