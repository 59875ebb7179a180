"""What tells values apart from one day to the next: numbers by their digits, functions by their
code and all that it reaches."""

from __future__ import annotations

import dataclasses
import hashlib
import sys
from functools import cached_property
from importlib import metadata
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

__all__ = ["NotTold", "digest_of"]

_PLAIN = (type(None), bool, int, float, complex, str, bytes, type(Ellipsis))
_INSTALLED = {"site-packages", "dist-packages"}


class NotTold(Exception):
    """Nothing tells this value from another of its kind."""


def digest_of(value: object) -> str:
    """A digest that is another one of another value.

    Of a function it takes in the code, its constants, defaults, what it closes over, and of the
    globals it names their values, other functions again; docstrings too. What a package with a
    version defines is told by its name and that version, a module without one by its file.

    Raises
    ------
    NotTold : a value that holds something of a process, such as an open file

    >>> digest_of([1.0, "a"]) == digest_of([1.0, "a"]), digest_of(1.0) == digest_of(2.0)
    (True, False)
    """
    return _Teller({}, 0).told(value)


class _Teller:
    """Walks a value. What was met before is not walked again, as functions may call themselves."""

    def __init__(self, met: dict[int, tuple[object, str]], depth: int) -> None:
        self._met = met  # by address, with the value, or another could take its address
        self._depth = depth
        self._found = hashlib.sha256()

    def told(self, value: object) -> str:
        """The digest of a value, walked by a teller of its own."""
        if isinstance(value, _PLAIN):
            return f"{type(value).__name__} {value!r}"
        if id(value) not in self._met:
            self._met[id(value)] = value, f"around, {self._depth}"
            below = _Teller(self._met, self._depth + 1)
            below._tell(value)
            self._met[id(value)] = value, below._found.hexdigest()
        return self._met[id(value)][1]

    def _tell(self, value: Any) -> None:
        if isinstance(value, tuple | list):
            self._say(type(value).__name__, len(value))
            self._all(value)
        elif isinstance(value, dict):
            self._say("dict", len(value))
            for pair in value.items():
                self._all(pair)
        elif isinstance(value, set | frozenset):
            self._say(type(value).__name__, sorted(self.told(one) for one in value))
        elif isinstance(value, np.ndarray) and value.dtype != object:
            self._say("array", value.dtype.str, value.shape)
            self._found.update(np.ascontiguousarray(value).tobytes())
        elif isinstance(value, CodeType):
            self._code(value)
        elif isinstance(value, ModuleType):
            self._module(value.__name__)
        elif isinstance(value, FunctionType):
            self._function(value)
        elif isinstance(value, type | BuiltinFunctionType):
            self._named(value)
        else:
            self._object(value)

    def _function(self, function: FunctionType) -> None:
        self._say("function", function.__qualname__)
        if _version(function.__module__):
            self._module(function.__module__)
            return
        self._all([function.__code__, function.__defaults__, function.__kwdefaults__])
        for cell in function.__closure__ or ():
            try:
                inside = cell.cell_contents
            except ValueError:  # not filled yet
                self._say("empty")
            else:
                self._all([inside])
        for name in sorted(_names(function.__code__)):
            if name in function.__globals__:
                self._say("global", name)
                self._all([function.__globals__[name]])

    def _code(self, code: CodeType) -> None:
        self._say("code", code.co_argcount, code.co_kwonlyargcount, code.co_flags)
        self._found.update(code.co_code)
        self._all([code.co_consts, code.co_names, code.co_varnames, code.co_freevars])

    def _named(self, value: Any) -> None:
        """A class, or a function in another language: by its name where its module is known."""
        module = value.__module__ or "builtins"
        self._say("named", module, value.__qualname__)
        if _version(module):
            self._module(module)
        elif isinstance(value, type):
            self._all(value.__bases__)
            self._all([dict(sorted(_members(value).items()))])
        else:
            self._module(module)

    def _module(self, name: str) -> None:
        version, file = _version(name), getattr(sys.modules.get(name), "__file__", None)
        self._say("module", name, version)
        if not version:
            if file is None:
                raise NotTold(f"the module {name}")
            self._found.update(Path(file).read_bytes())

    def _object(self, value: Any) -> None:
        """What pickle would keep of it; of a function compiled by numba what it was made of."""
        inside = [getattr(value, name, None) for name in ("py_func", "__func__", "func", "fget")]
        if isinstance(value, staticmethod | classmethod | property | cached_property) or inside[0]:
            self._all(inside)
            return
        if dataclasses.is_dataclass(value):
            self._all([type(value)])
            self._all(getattr(value, field.name) for field in dataclasses.fields(value))
            return
        try:
            kept = value.__reduce_ex__(4)
        except Exception:
            raise NotTold(f"a {type(value).__name__}") from None
        if isinstance(kept, str):
            self._say(type(value).__name__, kept)
            return
        make, given, *state = kept
        self._all(
            [make, *given, *(list(one) if hasattr(one, "__next__") else one for one in state)]
        )

    def _all(self, values: Any) -> None:
        for value in values:
            self._say(self.told(value))

    def _say(self, *words: object) -> None:
        self._found.update(f"{words!r};".encode())


def _names(code: CodeType) -> set[str]:
    """The names that a code and those in it look up."""
    inside = [one for one in code.co_consts if isinstance(one, CodeType)]
    return set(code.co_names).union(*(_names(one) for one in inside))


def _members(of: type) -> dict[str, Any]:
    """What is written in a class, without what Python adds."""
    return {
        name: value
        for name, value in vars(of).items()
        if isinstance(value, FunctionType) or not (name.startswith("__") or name == "_abc_impl")
    }


def _version(module: str | None) -> str:
    """The version that a module goes by; none of one that is not installed."""
    top = (module or "").partition(".")[0]
    if top in sys.stdlib_module_names:
        return sys.version.partition(" ")[0]
    file = getattr(sys.modules.get(top), "__file__", None) or ""
    if top != "crankmbs" and not _INSTALLED.intersection(Path(file).parts):
        return ""
    try:
        return metadata.version(top)
    except metadata.PackageNotFoundError:  # installed under another name
        return str(getattr(sys.modules[top], "__version__", ""))
