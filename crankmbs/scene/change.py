"""A scene with some of its values changed, each named by where it stands."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from crankmbs.errors import InputError, shown
from crankmbs.scene.sentences import did_you_mean

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene

__all__ = ["changed", "field_at", "value_at"]

_STEP = re.compile(r"__|\.|\[|\]\.|\]__|\]$")
_BARE = re.compile(r"[A-Za-z_]\w*(?:(?:\.|__)\w+|\[\d+\])*")
_OF_ONE = re.compile(r"(\w+)((?:[.\[][^:]*)?): ")


class _Change(NamedTuple):
    """A new value, what the caller named it by, and the steps to its place from here on."""

    name: str
    steps: Sequence[str]
    value: Any


def changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """The scene with other values, all at once, so that none has to fit the old ones.

    Parameters
    ----------
    values : by where they stand, "rod.length" or "rod__length"; in a list by number from 1, as in
        every message: "torque[2].coefficient" or "torque__2__coefficient". Numbers in SI units, or
        text with a unit; or a whole part

    Raises
    ------
    InputError : no such place, or a value that cannot be; begins with the name as it was given

    >>> changed(load_scene("propeller"), {"rod.length": "160 mm"}).rod.length
    0.16
    """
    changes = [_Change(name, _steps(name), value) for name, value in values.items()]
    new: Scene = _rebuilt(scene, changes, ())
    return new


def field_at(scene: Scene, name: str) -> tuple[type[Any], str] | None:
    """The class of the part in which a value stands, and its field there; None for an entry of a
    list.

    Raises
    ------
    InputError : no such place; begins with the name as it was given

    >>> field_at(load_scene("propeller"), "rod.length")[1]
    'length'
    """
    *above, last = _steps(name)
    part = _at(scene, above)
    if isinstance(part, tuple) and _entry(part, last) is not None:
        return None
    known = _fields(part)
    if last not in known and last not in known.values():
        changed(scene, {name: None})  # which says what is wrong with the name
    return type(part), known.get(last, last)


def value_at(scene: Scene, name: str) -> Any:
    """The value at a place that `field_at` knows.

    >>> value_at(load_scene("propeller"), "rod.length")
    0.1533333333
    """
    return _at(scene, _steps(name))


def _at(part: Any, steps: Sequence[str]) -> Any:
    for step in steps:
        named = _fields(part).get(step, step)
        part = _entry(part, step) if isinstance(part, tuple) else getattr(part, named, None)
    return part


def _entry(parts: tuple[Any, ...], step: str) -> Any:
    return parts[int(step) - 1] if step.isdigit() and 1 <= int(step) <= len(parts) else None


def _fields(part: Any) -> dict[str, str]:
    """Names of the fields of a part by what a file calls them, such as "from"."""
    fields = getattr(type(part), "__pydantic_fields__", {})
    return {field.validation_alias or name: name for name, field in fields.items()}


def _steps(name: str) -> list[str]:
    if not _BARE.fullmatch(name):
        raise InputError(
            f"{shown(name)} names no value of a scene; write it as rod__length or torque__1__torque"
        )
    return [step for step in _STEP.split(name) if step]


def _by_step(changes: Sequence[_Change]) -> dict[str, list[_Change]]:
    """The changes below each of the next steps."""
    below: dict[str, list[_Change]] = {}
    for name, (step, *rest), value in changes:
        below.setdefault(step, []).append(_Change(name, rest, value))
    return below


def _rebuilt(old: Any, changes: Sequence[_Change], place: tuple[str, ...]) -> Any:
    """A part or a list of parts, made anew from its old values and the changed ones."""
    if isinstance(old, tuple):
        return _list(old, changes, place)
    known = _fields(old)
    new, names = {}, {}
    for key, below in _by_step(changes).items():
        name = known.get(key, key)
        if name not in known.values():
            near = did_you_mean(key, list(known)) or f"; known are {', '.join(known)}"
            part = type(old).__name__
            called = "scene" if part == "Scene" else part
            raise InputError(f"{below[0].name}: a {called} has no {shown(key)}{near}")
        new[name] = _below(getattr(old, name), below, (*place, key))
        names[name] = [change.name for change in below]
    try:
        return dataclasses.replace(old, **new)
    except InputError as error:
        raise InputError(_in_given_names(str(error), names)) from None


def _list(
    old: tuple[Any, ...], changes: Sequence[_Change], place: tuple[str, ...]
) -> tuple[Any, ...]:
    new = list(old)
    for step, below in _by_step(changes).items():
        if not step.isdigit() or not 1 <= int(step) <= len(old):
            raise InputError(
                f"{below[0].name}: {shown(step)} is none of the numbers 1 to {len(old)} of a "
                "list; its first is 1"
            )
        new[int(step) - 1] = _below(old[int(step) - 1], below, (*place, step))
    return tuple(new)


def _below(old: Any, changes: Sequence[_Change], place: tuple[str, ...]) -> Any:
    first = changes[0]
    if any(not change.steps for change in changes):
        if len(changes) > 1:
            raise InputError(
                f"{first.name} and {changes[1].name} change the same part of the scene; give one "
                "of them"
            )
        return first.value
    if hasattr(type(old), "__pydantic_fields__") or (isinstance(old, tuple) and old):
        return _rebuilt(old, changes, place)
    part = "__".join(place)
    state = f"is one value, {shown(old)}" if old not in (None, ()) else "is not there"
    raise InputError(f"{first.name}: in this scene {part} {state}; give {part} as a whole")


def _in_given_names(text: str, names_of: Mapping[str, list[str]]) -> str:
    """The sentence of a refusal with the name that the caller gave where it names a value so."""
    named = _OF_ONE.match(text)
    if named and named[1] in names_of and len(names_of[named[1]]) == 1:
        name = names_of[named[1]][0]
        steps = [*filter(None, re.split(r"[.\[\]]+", named[1] + named[2]))]
        whole = re.split(r"__|[.]", name)
        for k in range(len(whole)):  # the refusal names it from here on
            below = steps[len(whole) - k :]
            if steps[: len(whole) - k] == whole[k:]:
                rest = "".join(f"[{step}]" if step.isdigit() else f".{step}" for step in below)
                return f"{name}{rest}: {text[named.end() :]}"
        return f"{name}: {text}"
    names = [name for several in names_of.values() for name in several]
    if any(text.startswith(name) for name in names):
        return text
    return f"{' and '.join(names)}: {text}"
