"""Loops that numba compiles, the only way in which they run: one call gives what every other gives.

Loading numba and the kernels from its cache takes half a second, once a process; so the modules
that hold kernels are imported where a run needs them. Kernels of one file call none of another:
numba's cache does not see a change there.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

__all__ = ["kernel"]

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile a function when it is first called, or take it from the cache; while it runs other
    threads do.

    >>> double = kernel(lambda x: 2.0 * x)
    >>> double(1.5)
    3.0
    """
    from numba import njit

    from crankmbs.numerics.kernel_cache import healing_cache

    compiled: Any = njit(error_model="numpy", nogil=True)(function)
    with suppress(RuntimeError):  # nothing can be cached
        compiled._cache = healing_cache(function)  # cache=True would put numba's own there
    return compiled  # type: ignore[no-any-return]
