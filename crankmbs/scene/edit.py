"""A scene file copied with values of its parts set, or set free: units, comments and order stay."""

from __future__ import annotations

import dataclasses
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from crankmbs.scene.read import load_scene, parse_scene
from crankmbs.scene.scene import Scene
from crankmbs.scene.write import scene_files

__all__ = ["edited_files"]

_HEADING = re.compile(r"\s*\[")
_WORDS = {"title", "source"}


def edited_files(
    path: Path,
    target: Path,
    values: Mapping[str, str | Sequence[str]],
    remark: str = "",
    *,
    start: Mapping[str, str] | None = None,
    torque: str | None = None,
) -> dict[str, bytes]:
    """The text of a scene file with values of its parts and [start] set, and its tables.

    A file whose tables cannot be edited in place, such as inline ones, is written anew as
    `scene_files` does.

    Parameters
    ----------
    path : the scene file; target : where the copy shall stand, beside whose name its tables are
        named unless it stands in the same folder
    values : as `Scene.with_` names them, "crank__inertia", each with its unit, "0.3 kg m^2", or a
        list of such; remark : the comment beside each
    start : key -> value of [start], which takes the place of [motion], if any
    torque : of a further constant load, "-23.7 N m"

    Returns
    -------
    dict : file name -> content, the scene first

    Raises
    ------
    SceneError, InputError : a bad scene, or one that is bad with these values
    """
    scene = load_scene(path)
    changes = {name: v if isinstance(v, str) else tuple(v) for name, v in values.items()}
    edited, text = scene.with_(**changes), path.read_bytes().decode("utf-8-sig")
    parts: dict[str, dict[str, str | Sequence[str]]] = {}
    for name, value in values.items():
        heading, _, key = name.partition("__")
        parts.setdefault(heading, {})[key] = value
    for heading, of_part in parts.items():
        text = _set(text, heading, of_part, remark)
    if start is not None:
        load = () if torque is None else ({"kind": "constant", "torque": torque},)
        free: Any = {"start": dict(start), "motion": None, "torque": (*edited.torque, *load)}
        edited = dataclasses.replace(edited, **free)
        text = _set(_without_motion(text), "start", start, "")
        if torque is not None:
            text += f'\n[[torque]]\nkind = "constant"\ntorque = "{torque}"\n'
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


def _set(text: str, heading: str, values: Mapping[str, str | Sequence[str]], remark: str) -> str:
    """The text with these values, where it has this heading."""
    lines = text.splitlines()
    begin = _line_below(lines, heading)
    if begin is None:
        return text
    comment = f"    # {remark}" if remark else ""
    for key, value in reversed(list(values.items())):  # each below the heading, above the last
        of_key = re.compile(rf"\s*{key}\s*=")
        place = next((k for k in range(begin, _end(lines, begin)) if of_key.match(lines[k])), None)
        new = f"{key} = {_toml(value)}{comment}"
        lines[begin if place is None else place : begin if place is None else place + 1] = [new]
    return "\n".join(lines) + "\n"


def _toml(value: str | Sequence[str]) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return f"[{', '.join(map(_toml, value))}]"


def _without_motion(text: str) -> str:
    """The text with an empty [start] in place of [motion]; comments of their own lines stay."""
    lines = text.splitlines()
    begin = _line_below(lines, "motion")
    if begin is None:
        return text
    end = _end(lines, begin)
    kept = [line for line in lines[begin:end] if not line.strip() or line.lstrip()[:1] == "#"]
    return "\n".join([*lines[: begin - 1], "[start]", *kept, *lines[end:]]) + "\n"


def _line_below(lines: Sequence[str], heading: str) -> int | None:
    of_heading = re.compile(rf"\s*\[\s*{heading}\s*\]\s*(#.*)?")
    return next((k for k, line in enumerate(lines, 1) if of_heading.fullmatch(line)), None)


def _end(lines: Sequence[str], begin: int) -> int:
    """The line of the next heading."""
    return next((k for k in range(begin, len(lines)) if _HEADING.match(lines[k])), len(lines))


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
