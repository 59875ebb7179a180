"""The cache of compiled kernels, which heals: numba's own fails on a damaged file every time."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from numba.core.caching import FunctionCache

__all__ = ["healing_cache"]


def healing_cache(function: Callable[..., object]) -> Any:
    """The cache of a function.

    Raises
    ------
    RuntimeError : neither the package's folder nor the home folder can be written
    """
    return _HealingCache(function)


class _HealingCache(FunctionCache):
    """What cannot be read is compiled anew and written over; what cannot be written is left."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # unpickling a damaged file raises anything
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(Exception):  # a full disk, or what could not be flushed above
            super().save_overload(sig, data)
