"""What can go wrong before a run starts.

CrankmbsError
├── InputError (ValueError)      a value that cannot be, in a scene, a table or an argument
│   ├── SceneError               the same, found while reading a scene: names file and key
│   └── UndecidedError           what the data leave open: `options` are what decides it
├── FormulationError             the formulation asked for cannot serve the scene
└── OutputError (OSError)        a result that cannot be written or read

A hard problem met during a run is no exception: the result comes back with its status and a
sentence.
"""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = [
    "CrankmbsError",
    "FormulationError",
    "InputError",
    "OutputError",
    "SceneError",
    "UndecidedError",
    "at_place",
    "shown",
]

_LONGEST = 60  # characters of a value that a message repeats
_LONGEST_INTEGER = 4096  # bits; Python refuses to write out much longer ones


class CrankmbsError(Exception):
    """Base of every error that crankmbs raises on purpose."""


class InputError(CrankmbsError, ValueError):
    """A value that cannot be; the message says what, the rule, what came and the way out."""


class SceneError(InputError):
    """A scene that cannot be; the message begins with file and key."""


class UndecidedError(InputError):
    """What the data leave open and nobody should guess.

    options : the arguments any of which decides it, as they are written in Python
    """

    def __init__(self, question: str, options: tuple[str, ...]) -> None:
        *most, last = options
        ways = f"{', '.join(most)} or {last}" if most else last
        super().__init__(f"{question}; give {ways}")
        self.options = options


class FormulationError(CrankmbsError):
    """The formulation asked for cannot serve the scene; the message says which can."""


class OutputError(CrankmbsError, OSError):
    """A result that cannot be written or read."""


@contextmanager
def at_place(place: str) -> Iterator[None]:
    """Begin the sentence of what cannot be with where it stands.

    >>> with at_place("--at"):
    ...     raise InputError("must be an angle")
    Traceback (most recent call last):
    crankmbs.errors.InputError: --at: must be an angle
    """
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def shown(value: object) -> str:
    """What came, as a scene file writes it, on one line and cut to a readable length.

    >>> shown(True), shown("46 mm")
    ('true', '"46 mm"')
    """
    text = " ".join(_text(value).split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 4]} ..."


def _text(value: object) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if value is None:
        return "None"
    if isinstance(value, dict):
        return f"a table with {', '.join(map(str, value))}" if value else "an empty table"
    if isinstance(value, int) and value.bit_length() > _LONGEST_INTEGER:
        return "a huge number"
    try:
        return json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        return _object(value)


def _object(value: object) -> str:
    """What only Python has, or a date."""
    if getattr(value, "shape", ()):
        return f"an array of shape {value.shape}"  # type: ignore[attr-defined]
    if inspect.isroutine(value):
        return "a function"
    return str(value) if type(value).__module__ == "datetime" else repr(value)
