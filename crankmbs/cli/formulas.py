"""Formulas that the command line names: functions in files of Python."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from crankmbs.compare import formulas_of
from crankmbs.errors import InputError, shown
from crankmbs.scene.sentences import did_you_mean

__all__ = ["named_formulas"]


def named_formulas(texts: Sequence[str]) -> dict[str, Callable[..., Any]]:
    """The functions that "FILE:NAME" names, by the label "NAME of FILE" under which they are shown.

    Raises
    ------
    InputError : no such file or name; a file that Python cannot run; a function that is no formula
    """
    formulas: dict[str, Callable[..., Any]] = {}
    files: dict[Path, ModuleType] = {}
    for text in texts:
        place, _, name = text.rpartition(":")
        if not place or not name:
            raise InputError(
                f'--formula: must be FILE:NAME, such as "mine.py:torque_series"; {shown(text)} came'
            )
        path = Path(place)
        if path not in files:
            files[path] = _run(path)
        label = f"{name} of {path.name}"
        if label in formulas:
            raise InputError(
                f"--formula: {label} comes twice; give each once, from files of different names"
            )
        formulas[label] = _function(files[path], path, name)
    formulas_of(formulas)
    return formulas


def _function(module: ModuleType, path: Path, name: str) -> Any:
    functions = [key for key, value in vars(module).items() if callable(value) and key[:1] != "_"]
    if name not in vars(module):
        near = did_you_mean(name, functions) or f"; it has {', '.join(functions) or 'no function'}"
        raise InputError(f"--formula: {path} has no {name}{near}")
    return vars(module)[name]


def _run(path: Path) -> ModuleType:
    """The module that a file makes, its neighbours importable while it runs."""
    if not path.is_file():
        raise InputError(f"--formula: {path} is no file; give the path of one that Python can run")
    spec = importlib.util.spec_from_loader(path.stem, None, origin=str(path))
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    module.__file__ = str(path)
    try:
        code = compile(path.read_bytes(), str(path), "exec")
        with _beside(path):
            exec(code, vars(module))
    except Exception as error:  # whatever the file of a user may raise
        raise InputError(f"--formula: {path}{_line(error, path)}; correct the file") from error
    return module


@contextmanager
def _beside(path: Path) -> Iterator[None]:
    """Imports find what lies beside a file, as they do when Python runs it."""
    sys.path.insert(0, str(path.resolve().parent))
    try:
        yield
    finally:
        sys.path.pop(0)


def _line(error: Exception, path: Path) -> str:
    """Where in a file it went wrong, and what."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
    line = error.lineno if isinstance(error, SyntaxError) else lines[-1] if lines else None
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    message = f"{type(error).__name__}: {text}" if text else type(error).__name__
    return f", line {line}: {message}" if line else f": {message}"
