"""What follows from a frozen object alone, made once and kept with it."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

__all__ = ["forget", "once"]

F = TypeVar("F", bound=Callable[..., object])


class _Kept(dict[Any, Any]):
    """Answers by function and arguments; a deep or pickled copy begins without."""

    def __reduce__(self) -> tuple[type[_Kept], tuple[()]]:
        return _Kept, ()


def once(function: F) -> F:
    """A function of a frozen object, and of what can be hashed, that keeps its answer with this
    very object for as long as that lives: a cached property for floors above the object's own.

    >>> ends = once(lambda train, count: [train.period] * count)
    >>> train = crank_train(load_scene("coasting"))
    >>> ends(train, 2) is ends(train, 2)
    True
    """

    @wraps(function)
    def remembered(of: Any, *others: Any) -> object:
        kept = of.__dict__.get("_kept")
        if kept is None:
            kept = of.__dict__.setdefault("_kept", _Kept())  # another thread may have been here
        key = (function, *others)
        if key not in kept:
            kept.setdefault(key, function(of, *others))
        return kept[key]

    return remembered  # type: ignore[return-value]


def forget(of: object) -> None:
    """Let go of what is kept with an object, and with that in turn: it may hold the object, and
    then stays in memory until the garbage collector comes by, which is late for a few objects with
    large arrays.

    >>> train = crank_train(load_scene("coasting"))
    >>> forget(train.scene)
    >>> crank_train(train.scene) is train
    False
    """
    kept = getattr(of, "__dict__", {}).pop("_kept", {})
    for answer in kept.values():
        forget(answer)
