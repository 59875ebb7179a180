"""Loops that numba compiles where that pays.

Loading numba takes longer than most single runs, so the arrays of the formulations come first and
these loops second: `pay` decides. Both give the same to rounding. Kernels of one file call none of
another: numba's cache does not see a change there.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

__all__ = ["kernel", "pay"]

F = TypeVar("F", bound=Callable[..., object])

_LOADING = 0.5  # s, for numba and the kernels from its cache

_functions: list[Callable[..., object]] = []
_spent = 0.0  # s of work in this process that the kernels would have saved
are_compiled = False


def pay(seconds: float) -> bool:
    """Whether the kernels are compiled now, after a piece of work that takes the arrays so long.

    They are loaded where numba is imported already, or as soon as the arrays have cost as much
    time in this process as loading does.
    """
    global _spent
    _spent += seconds
    if not are_compiled and ("numba" in sys.modules or _spent > _LOADING):
        _compile()
    return are_compiled


def _compile() -> None:
    """Put the compiled kernels in the place of the plain ones, which call one another by name."""
    global are_compiled
    for function in _functions:
        setattr(sys.modules[function.__module__], function.__name__, _compiled(function))
    are_compiled = True


def _compiled(function: Callable[..., object]) -> Any:
    from numba import njit

    from crankmbs.numerics.kernel_cache import healing_cache

    compiled: Any = njit(error_model="numpy")(function)
    with suppress(RuntimeError):  # nothing can be cached
        compiled._cache = healing_cache(function)  # cache=True would put numba's own there
    return compiled


def kernel(function: F) -> F:
    """Mark a function to be compiled together with the others."""
    _functions.append(function)
    return function
