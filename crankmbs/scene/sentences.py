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

from crankmbs.errors import InputError, shown
from crankmbs.scene.examples import example_of

__all__ = ["RULES", "PartError", "did_you_mean", "sentence", "there_are"]

_CLOSE = 0.7  # where the choices are listed anyway: "spline" is no misspelling of "linear", 0.67
_BARE_KEY = re.compile(r"[\w-]{1,60}")
_UNKNOWN = {"unexpected_keyword_argument", "extra_forbidden"}
_MISSING = {"missing", "missing_keyword_only_argument", "missing_argument"}
RULES = {
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
"""Rules by the kind of problem; the page has those of numbers in the same words."""
_IN_PYTHON = {
    "bool_type": "must be True or False",
    "string_type": "must be a str",
}


class PartError(InputError):
    """A part below another one, of a class that its keys tell, could not be built."""

    def __init__(self, error: ValidationError, root: type[Any], raw: Mapping[str, Any]) -> None:
        super().__init__("a part could not be built")
        self.problem = error, root, raw


def sentence(
    error: ValidationError,
    root: type[Any],
    raw: Mapping[str, Any],
    *,
    in_python: bool = False,
    below: Sequence[int | str] = (),
) -> str:
    """Say the most telling problem of ``error``, met when ``root`` was built from ``came``.

    in_python : by a call; in the words of a call then, else in those of a file
    below : where ``root`` stands
    """
    problem: Any = min(
        error.errors(), key=lambda each: each["type"] not in _UNKNOWN
    )  # a misspelt key is missing, too
    kind, loc = problem["type"], _keys_and_tags(problem)
    cause = problem.get("ctx", {}).get("error")
    if isinstance(cause, PartError):
        return sentence(*cause.problem, in_python=in_python, below=[*below, *loc])
    if in_python:
        loc = _by_name(root, loc)
    place, word = _dotted([*below, *loc]), "argument" if in_python else "key"
    if kind in _MISSING:
        how = _how_to_give(root, loc) if in_python else _how_to_add(root, loc)
        return f"{place}: this {word} is missing; {how}"
    if kind in _UNKNOWN:
        names = _names_at(root, loc[:-1], in_python)
        return f"{place}: unknown {word}{_meant(loc[-1], names) or _known(loc[-1], names, word)}"
    if kind == "value_error":
        text = str(cause)
        text = _as_a_call(text) if in_python else text
        return f"{place}: {text}" if place else text
    value = _value_at(raw, loc)
    near = _near_word(value, problem)
    rule = (_rule_in_python if in_python else _rule)(problem, root, loc)
    return f"{place}: {rule}; {shown(value)} came{near}"


def did_you_mean(word: str, known: Sequence[str], least: float = 0.6) -> str:
    """The way out of a misspelling, or nothing when no known word is near: difflib's ratio."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=least)
    return f'; did you mean "{close[0]}"?' if close else ""


def there_are(word: str, known: Sequence[str], spellings: Mapping[str, str] | None = None) -> str:
    """The way out of an unknown name: every known one, those near to it first.

    spellings : what else a name may be called, to the name

    >>> there_are("mean sped", ["side force", "mean speed"])
    '; did you mean "mean speed"? There are "mean speed", "side force"'
    """
    names = {**(spellings or {}), **{name: name for name in known}}
    close = difflib.get_close_matches(word, names, n=3)
    near = list(dict.fromkeys(names[spelling] for spelling in close))
    listed = ", ".join(f'"{name}"' for name in dict.fromkeys([*near, *known]))
    return f'; did you mean "{near[0]}"? There are {listed}' if near else f"; there are {listed}"


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


def _value_at(raw: Any, loc: Sequence[int | str]) -> Any:
    """What the user wrote there: after conversion it would be in other units."""
    for step in _keys(loc):
        raw = raw[step]
    return raw


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
    if kind in RULES:
        return RULES[kind].format(**context)
    return str(problem["msg"]).replace("Input should", "must")


def _rule_in_python(problem: Any, root: type[Any], loc: Sequence[int | str]) -> str:
    kind = problem["type"]
    if kind == "dataclass_type":
        return f"must be given as {_call(root, loc)}"
    if kind == "tuple_type":
        *most, last = [each.__name__ for each in _parts_at(root, loc)] or [""]
        parts = f" of {', '.join(most)} or {last}" if most else f" of {last}" if last else ""
        return f"must be a tuple or list{parts}"
    return _IN_PYTHON.get(kind) or _rule(problem, root, loc)


def _as_a_call(text: str) -> str:
    """The sentence of a check, which speaks of a file's sections and keys, for a caller.

    >>> _as_a_call("give [motion], or absolute = false")
    'give motion, or absolute=False'
    """
    text = re.sub(r"\[{1,2}(motion|start|gas|torque|force)\]{1,2}", r"\1", text)
    text = re.sub(r"\b([a-z_]+) = (?=true|false|[\"0-9])", r"\1=", text)
    return text.replace("=true", "=True").replace("=false", "=False")


def _meant(word: int | str, names: Sequence[str]) -> str:
    """The way out of a key that others have in place of one that is known."""
    return "; give radius, half the stroke" if word == "stroke" and "radius" in names else ""


def _known(word: int | str, names: Sequence[str], what: str) -> str:
    listed = f"; known {what}s are {', '.join(names)}" if names else ""
    return did_you_mean(str(word), names) or listed


def _how_to_add(root: type[Any], loc: Sequence[int | str]) -> str:
    parts = _parts_at(root, loc)
    if len(parts) != 1:
        return _such_as(root, loc, " = ")
    needed = [key for key, field in _fields_of(parts[0]) if field.is_required()]
    others = [key for key, field in _fields_of(parts[0]) if not field.is_required()]
    lines = ", ".join(f"{key} = {example_of(parts[0], key)}" for key in needed)
    may_have = f"; it may have {', '.join(others)}" if others else ""
    return f"add [{_dotted(loc)}] with {' and '.join(needed)}, such as {lines}{may_have}"


def _how_to_give(root: type[Any], loc: Sequence[int | str]) -> str:
    call = _call(root, loc)
    return f"give {loc[-1]}={call}" if call else _such_as(root, loc, "=")


def _such_as(root: type[Any], loc: Sequence[int | str], sign: str) -> str:
    """The way out where a value is missing."""
    owners = _parts_at(root, loc[:-1])
    example = example_of(owners[0], str(loc[-1])) if len(owners) == 1 else None
    return f"give it, such as {loc[-1]}{sign}{example}" if example else "it has no default"


def _call(root: type[Any], loc: Sequence[int | str]) -> str:
    names = _names_at(root, loc, in_python=True)
    return f"{_parts_at(root, loc)[0].__name__}({', '.join(names)})" if names else ""


def _by_name(root: type[Any], loc: list[int | str]) -> list[int | str]:
    """The location in the names of Python, where a file calls its last key otherwise."""
    for part in _parts_at(root, loc[:-1]):
        for name, field in part.__pydantic_fields__.items():
            if loc and field.validation_alias == loc[-1]:
                return [*loc[:-1], name]
    return loc


def _names_at(root: type[Any], loc: Sequence[int | str], in_python: bool = False) -> list[str]:
    """The keys of the part at ``loc`` below ``root``; none where no single part is meant."""
    parts = _parts_at(root, loc)
    if len(parts) != 1:
        return []
    return list(parts[0].__pydantic_fields__) if in_python else [k for k, _ in _fields_of(parts[0])]


def _fields_of(part: type[Any]) -> list[tuple[str, Any]]:
    """The fields of a part by their keys in a file."""
    fields = part.__pydantic_fields__.items()
    return [(field.validation_alias or name, field) for name, field in fields]


def _parts_at(root: type[Any], loc: Sequence[int | str]) -> list[type[Any]]:
    """The parts that ``loc`` below ``root`` may be, or whose sequence it is."""
    parts = [root]
    for step in loc:
        if isinstance(step, int):
            continue
        if _is_tag(step):
            parts = [each for each in parts if each.__name__ == step]
        else:
            parts = [part for each in parts for part in _parts_of_key(each, step)]
    return parts


def _parts_of_key(owner: type[Any], key: str) -> list[type[Any]]:
    for name, field in owner.__pydantic_fields__.items():
        if key in (name, field.validation_alias):
            return list(_parts_in(field.annotation))
    return []


def _parts_in(annotation: Any) -> Iterator[type[Any]]:
    if hasattr(annotation, "__pydantic_fields__"):
        yield from getattr(annotation, "kinds", {"": annotation}).values()
    for argument in typing.get_args(annotation):
        yield from _parts_in(argument)
