"""TOML files to scenes."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from crankmbs.errors import InputError, SceneError, shown
from crankmbs.scene.cylinder_tables import by_layout
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import did_you_mean, sentence
from crankmbs.scene.shipped import shipped_scenes
from crankmbs.scene.whole import MOTION_OR_START

__all__ = ["load_scene", "parse_scene", "scene_path"]


def scene_path(name: str | Path) -> Path:
    """The file of a scene that is given as a path or as a shipped name.

    Raises
    ------
    SceneError : no name, or that of neither a file nor a shipped scene
    """
    if not isinstance(name, str | Path):
        raise SceneError(
            f'a scene is named by its file or as shipped, such as "propeller"; {shown(name)} came'
        )
    path = Path(name)
    shipped = shipped_scenes()
    if path.is_file():
        return path
    if str(name) in shipped:
        return shipped[str(name)]
    if path.is_dir():
        raise SceneError(f"{path}: a folder came; give the scene file in it")
    if path.with_name(f"{path.name}.toml").is_file():
        raise SceneError(f'{name}: no such scene file; did you mean "{name}.toml"?')
    hint = did_you_mean(path.stem, list(shipped)) or f"; shipped are {', '.join(shipped)}"
    raise SceneError(f"{name}: no such scene file and no shipped scene{hint}")


def load_scene(name: str | Path) -> Scene:
    """Read and check a scene: a path of a TOML file, or the name of a shipped scene.

    Raises
    ------
    SceneError : file missing, unreadable or wrong; the message names file, key, rule, what came
        and the way out

    >>> load_scene("propeller").crank.radius
    0.046
    """
    path = scene_path(name)
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise SceneError(
            f"{path}: no UTF-8 text (byte {error.start} is wrong); a scene is a TOML text file"
        ) from None
    return parse_scene(text, path)


def parse_scene(text: str, path: Path) -> Scene:
    """Check the text of a scene; ``path`` names it and paths in it are relative to its folder."""
    try:
        raw: dict[str, Any] = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a number of 5000 digits is a ValueError
        way_out = (
            _in_quotes(text, error)
            or _twice(text, error)
            or "crankmbs new NAME writes a scene to compare with"
        )
        raise SceneError(f"{path}: not valid TOML: {error}; {way_out}") from None
    if {"motion", "start"} <= raw.keys():  # before what may be missing in either
        raise SceneError(f"{path}: {MOTION_OR_START}; both came")
    try:
        raw = by_layout(raw)
        scene: Scene = _SCENE.validate_python(raw, context={"folder": path.parent}, by_name=False)
    except ValidationError as error:
        raise SceneError(f"{path}: {_as_written(sentence(error, Scene, raw), text)}") from None
    except InputError as error:
        raise SceneError(f"{path}: {_as_written(str(error), text)}") from None
    return scene


def _as_written(said: str, text: str) -> str:
    """What is wrong, of a cylinder where it stands in the file."""
    return said.replace("layout.cylinders", "cylinder") if "[[cylinder]]" in text else said


def _in_quotes(text: str, error: Exception) -> str:
    """The way out where a quantity with its unit stands bare in the line that is no TOML."""
    line = re.search(r"\(at line (\d+),", str(error))
    bare = line and _BARE_QUANTITY.search(text.split("\n")[int(line[1]) - 1])
    if not bare:
        return ""
    return f"a quantity with a unit is written in quotes, here {shown(bare[1].strip())}"


def _twice(text: str, error: Exception) -> str:
    """The way out where a key is given a second time."""
    line = re.search(r"Cannot overwrite a value \(at line (\d+),", str(error))
    key, given, _ = text.split("\n")[int(line[1]) - 1].partition("=") if line else ("", "", "")
    return f"{key.strip()} is given twice in its table, leave one of the two out" if given else ""


_BARE_QUANTITY = re.compile(r"=\s*([+-]?[0-9][0-9.eE+-]*\s*[^\W\d_][^#,}\"']*)")
_SCENE = TypeAdapter(Scene)
