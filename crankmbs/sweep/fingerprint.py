"""A fingerprint of values that is the same in every process: of functions by their code and by all
that it reaches."""

from __future__ import annotations

import dataclasses
import hashlib
import pickle
import sys
from functools import cached_property
from importlib import metadata
from io import BytesIO
from pathlib import Path
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

__all__ = ["fingerprint"]

_INSTALLED = {"site-packages", "dist-packages"}
_OF_CODE = ["co_code", "co_names", "co_varnames", "co_freevars"]
_OF_CODE += ["co_argcount", "co_kwonlyargcount", "co_flags"]
_WRAPPED = ("__wrapped__", "py_func", "fget")  # of what functools, numba and property make


def fingerprint(value: object) -> str:
    """A digest that differs where the values differ; empty where nothing identifies the value, as
    of a lock or an open file.

    A function is identified by its code, constants and defaults, by what it closes over and by the
    globals it names, functions again; docstrings count. What an installed package defines is
    identified by its name and the package's version, a module that is not installed by its file.

    >>> fingerprint([1.0, "a"]) == fingerprint([1.0, "a"]), fingerprint(1.0) == fingerprint(2.0)
    (True, False)
    """
    try:
        return _digest(value, {})
    except Exception:  # whatever pickling the value raises
        return ""


def _digest(value: object, known: dict[int, tuple[object, str]]) -> str:
    data = BytesIO()
    _Pickler(data, known).dump(value)
    return hashlib.sha256(data.getvalue()).hexdigest()


class _Pickler(pickle.Pickler):
    """Pickles functions and classes by their contents.

    known : digests of these by address, with the value, or another could take its address
    """

    def __init__(self, file: BytesIO, known: dict[int, tuple[object, str]]) -> None:
        super().__init__(file, protocol=4)
        self.fast = True  # equal strings may be one object or two: without a memo it is the same
        self._known = known

    def reducer_override(self, value: Any) -> Any:
        """Replace what pickle would keep by name, and objects by their fields without caches."""
        parts = _parts(value)
        if parts is None:
            return NotImplemented
        if id(value) not in self._known:
            self._known[id(value)] = value, "recursive"
            self._known[id(value)] = value, _digest(parts, self._known)
        return str, (self._known[id(value)][1],)


def _parts(value: Any) -> list[Any] | None:
    """What identifies a value; None where pickle keeps all of it."""
    if isinstance(value, CodeType):
        return [*(getattr(value, name) for name in _OF_CODE), *map(_ordered, value.co_consts)]
    if isinstance(value, ModuleType):
        return _module(value.__name__)
    if isinstance(value, type | FunctionType):
        return _named(value)
    if isinstance(value, MethodType):
        return [value.__self__, value.__func__]
    if dataclasses.is_dataclass(value):
        return [type(value), *(getattr(value, field.name) for field in dataclasses.fields(value))]
    if isinstance(value, cached_property):
        return [value.func]
    return [getattr(value, name) for name in _WRAPPED if hasattr(value, name)] or None


def _named(value: Any) -> list[Any] | None:
    """A class or a function: by name where its module is installed."""
    if value.__module__ == "builtins":
        return None
    if _version(value.__module__) is not None:
        return [value.__qualname__, *_module(value.__module__)]
    if isinstance(value, type):
        members = {
            name: _ordered(member)
            for name, member in sorted(vars(value).items())
            if isinstance(member, FunctionType)
            or not (name.startswith("__") or name == "_abc_impl")
        }
        return [value.__qualname__, value.__bases__, members]
    named = value.__globals__
    reached = [(name, _ordered(named[name])) for name in _names(value.__code__) if name in named]
    closure = [_ordered(cell.cell_contents) for cell in value.__closure__ or ()]
    defaults = [value.__defaults__, value.__kwdefaults__]
    return [value.__qualname__, value.__code__, *defaults, closure, reached]


def _names(code: CodeType) -> list[str]:
    """The names that a code and those in it look up."""
    inside = [constant for constant in code.co_consts if isinstance(constant, CodeType)]
    return sorted(set(code.co_names).union(*map(_names, inside)))


def _ordered(value: Any) -> Any:
    """A set in an order that is the same in every process."""
    return sorted(map(repr, value)) if isinstance(value, set | frozenset) else value


def _module(name: str) -> list[Any]:
    version, file = _version(name), getattr(sys.modules.get(name), "__file__", None)
    return [name, version if version is not None or file is None else Path(file).read_bytes()]


def _version(module: str) -> str | None:
    """The version of an installed module's package; None where it is not installed."""
    top = module.partition(".")[0]
    if top in sys.stdlib_module_names or top == "crankmbs":  # whose version a sweep knows
        return ""
    package = sys.modules.get(top)
    if not _INSTALLED.intersection(Path(getattr(package, "__file__", None) or "").parts):
        return None
    try:
        return metadata.version(top)
    except metadata.PackageNotFoundError:  # installed under another name
        return str(getattr(package, "__version__", ""))
