"""The first problem of a pydantic validation as one sentence: key, rule, what came, way out.

Where a value may be of several classes, the fields are tagged unions whose tags are the names of
the classes: pydantic puts them into the location, and a capital tells them from a key.
"""

from __future__ import annotations

import difflib
import re
import typing
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from crankmbs.errors import shown

__all__ = ["did_you_mean", "sentence"]

_CLOSE = 0.7  # where the choices are listed anyway: "spline" is no misspelling of "linear", 0.67
_BARE_KEY = re.compile(r"[\w-]{1,60}")
_UNKNOWN = {"unexpected_keyword_argument", "extra_forbidden"}
_MISSING = {"missing", "missing_keyword_only_argument", "missing_argument"}
_RULES = {
    "bool_type": "must be true or false",
    "finite_number": "must be finite",
    "float_type": "must be a number",
    "greater_than": "must be above {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "int_type": "must be a whole number",
    "less_than_equal": "must be at most {le:g}",
    "string_type": "must be a text in quotes",
    "too_short": "must have at least {min_length} entry",
    "tuple_type": "must be a list",
}


def sentence(error: ValidationError, root: type[Any], came: Mapping[str, Any]) -> str:
    """Say the most telling problem of ``error``, met when ``root`` was built from ``came``."""
    problem: Any = min(error.errors(), key=lambda each: _rank(each["type"]))
    kind, loc = problem["type"], _keys_and_tags(problem)
    where = _dotted(loc)
    if kind in _MISSING:
        return f"{where}: this key is missing; {_how_to_add(root, loc)}"
    if kind in _UNKNOWN:
        return f"{where}: unknown key{_known(loc[-1], root, loc[:-1])}"
    if kind == "value_error":
        text = str(problem["ctx"]["error"])
        return f"{where}: {text}" if where else text
    value = _value_at(came, loc)
    near = _near_word(value, problem)
    return f"{where}: {_rule(problem, root, loc)}; {shown(value)} came{near}"


def did_you_mean(word: str, known: Sequence[str], least: float = 0.6) -> str:
    """The way out of a misspelling, or nothing when no known word is near: difflib's ratio."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=least)
    return f'; did you mean "{close[0]}"?' if close else ""


def _rank(kind: str) -> int:
    """A misspelt key shows up as one unknown and one missing: name the unknown one."""
    return 0 if kind in _UNKNOWN else 1


def _keys_and_tags(problem: Any) -> list[int | str]:
    """The location; a tag at its end has nothing below it and is dropped."""
    loc = list(problem["loc"])
    ends_in_key = problem["type"] in _UNKNOWN | _MISSING
    return loc[:-1] if loc and _is_tag(loc[-1]) and not ends_in_key else loc


def _is_tag(step: int | str) -> bool:
    return isinstance(step, str) and step[:1].isupper()


def _keys(loc: Sequence[int | str]) -> list[int | str]:
    return [step for step in loc[:-1] if not _is_tag(step)] + list(loc[-1:])


def _dotted(loc: Sequence[int | str]) -> str:
    text = ""
    for step in _keys(loc):
        if isinstance(step, int):
            text += f"[{step + 1}]"
        else:
            text += f".{step if _BARE_KEY.fullmatch(step) else shown(step)}"
    return text.removeprefix(".")


def _value_at(came: Any, loc: Sequence[int | str]) -> Any:
    """What the user wrote there: after conversion it would be in other units."""
    for step in _keys(loc):
        came = came[step]
    return came


def _near_word(value: Any, problem: Any) -> str:
    if problem["type"] != "literal_error" or not isinstance(value, str):
        return ""
    return did_you_mean(value, problem["ctx"]["expected"].split("'")[1::2], _CLOSE)


def _rule(problem: Any, root: type[Any], loc: Sequence[int | str]) -> str:
    kind, context = problem["type"], problem.get("ctx", {})
    if kind == "literal_error":
        return f"must be {context['expected']}".replace("'", '"')
    if kind == "dataclass_type":
        return f"must be a table with {', '.join(_names_at(root, loc))}"
    if kind == "tuple_type" and isinstance(problem["input"], dict):
        return f"must be a list; write [[{_dotted(loc)}]]"
    if kind in _RULES:
        return _RULES[kind].format(**context)
    return str(problem["msg"]).replace("Input should", "must")


def _known(word: int | str, root: type[Any], loc: Sequence[int | str]) -> str:
    names = _names_at(root, loc)
    listed = f"; known keys are {', '.join(names)}" if names else ""
    return did_you_mean(str(word), names) or listed


def _how_to_add(root: type[Any], loc: Sequence[int | str]) -> str:
    names = _names_at(root, loc)
    return f"add [{_dotted(loc)}] with {', '.join(names)}" if names else "it has no default"


def _names_at(root: type[Any], loc: Sequence[int | str]) -> list[str]:
    """The keys of the part at ``loc`` below ``root``; none where no single part is meant."""
    parts = [root]
    for step in loc:
        if isinstance(step, int):
            continue
        if _is_tag(step):
            parts = [each for each in parts if each.__name__ == step]
        else:
            parts = [found for each in parts for found in _parts_of_key(each, step)]
    if len(parts) != 1:
        return []
    fields = parts[0].__pydantic_fields__
    return [field.validation_alias or name for name, field in fields.items()]


def _parts_of_key(owner: type[Any], key: str) -> list[type[Any]]:
    for name, field in owner.__pydantic_fields__.items():
        if key in (name, field.validation_alias):
            return list(_parts_in(field.annotation))
    return []


def _parts_in(annotation: Any) -> Iterator[type[Any]]:
    if hasattr(annotation, "__pydantic_fields__"):
        yield annotation
    for argument in typing.get_args(annotation):
        yield from _parts_in(argument)
