"""A torque that is any function, given from Python."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Gt
from pydantic import PlainSerializer, PlainValidator, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.numerics.function import Function, named
from crankmbs.scene.angle_rows import is_of_halves
from crankmbs.scene.schema import SAVED, Float, part, si
from crankmbs.scene.torque import Parts, Torque

__all__ = ["Load"]

Numbers = tuple[Float, ...]


class _Kept:
    """The name of a function that a saved result tells, and nothing that could be called."""

    def __init__(self, name: str) -> None:
        self.__name__ = name


def _function(value: Any, info: ValidationInfo) -> Any:
    if info.context is SAVED and isinstance(value, str):
        return _Kept(value)
    if not callable(value) and not isinstance(value, _Kept):
        raise InputError(
            f"must be a function of t, theta and omega that gives a torque; {shown(value)} came"
        )
    return value


@part
class Load(Torque):
    """The torque [N m] that a function(t, theta, omega) gives, of time [s], crank angle [rad] and
    speed [rad/s], three floats in, one out; it must be pure.

    kink_times [s], kink_angles [rad], kink_speeds [rad/s] : where it bends or jumps, the angles
        every ``period``, without one every revolution; what is not declared is found by finer
        cells, and costs accuracy that the stated errors know of
    period [rad] : declares that it does not depend on t and repeats over the crank angle; any
        multiple of half a revolution, or a whole part of two revolutions

    >>> Load(lambda t, theta, omega: -2.0 * omega)(0.0, 0.0, 3.0)
    array(-6.)
    """

    positional: ClassVar[tuple[str, ...]] = ("function",)
    kind: Literal["function"] = "function"
    function: Annotated[Any, PlainValidator(_function), PlainSerializer(named)]
    kink_times: Numbers = ()
    kink_angles: Numbers = ()
    kink_speeds: Numbers = ()
    period: Annotated[Float, Gt(0), si("angle")] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.period is None or is_of_halves(self.period):
            return
        share = 4.0 * math.pi / self.period
        if abs(share - round(share)) > 1e-9 * share:
            raise InputError(
                "period must be a multiple of half a revolution, such as 6 pi, or a whole part of "
                f"two revolutions, such as 4 pi / 3; {self.period:.6g} rad came"
            )

    @cached_property
    def parts(self) -> Parts:
        if isinstance(self.function, _Kept):
            return Parts()
        every = self.period or 2.0 * math.pi
        whole = every if is_of_halves(every) else 4.0 * math.pi
        turns = range(round(whole / every))
        angles = tuple((angle + k * every) % whole for angle in self.kink_angles for k in turns)
        known = self.kink_times, angles, self.kink_speeds
        return Parts(function=Function(self.function, *known, whole if self.period else None))

    @property
    def words(self) -> str:
        return named(self.function)

    @property
    def lacks(self) -> str | None:
        if not isinstance(self.function, _Kept):
            return None
        return (
            f"of the function {named(self.function)} a saved result keeps only the name; to run "
            "the scene again, give the load anew with crankmbs.Load"
        )

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        function: Callable[[float, float, float], float] = self.function

        def scaled(t: float, theta: float, omega: float) -> float:
            return share * function(t, theta, omega / faster)

        scaled.__name__ = named(function)
        speeds = tuple(faster * speed for speed in self.kink_speeds)
        return {"function": scaled, "kink_speeds": speeds}


Torque.unwritten["function"] = Load
