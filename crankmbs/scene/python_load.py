"""A torque that is any function, given from Python."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from pydantic import PlainSerializer, PlainValidator, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.function import Function, named
from crankmbs.scene.angle_rows import is_of_halves
from crankmbs.scene.schema import SAVED, AnglePeriod, Float, part
from crankmbs.scene.torque import Parts, Torque
from crankmbs.scene.windowed import Windowed

__all__ = ["KeptName", "Load", "Numbers", "OfFunction", "function_of", "within_period"]

Numbers = tuple[Float, ...]


class KeptName:
    """The name of a function that a saved result tells, and nothing that could be called."""

    def __init__(self, name: str) -> None:
        self.__name__ = name

    def lacks(self, anew: str) -> str:
        """Why it cannot be run again, and the way out: to give that anew."""
        return (
            f"of the function {self.__name__} a saved result keeps only the name; to run the scene "
            f"again, give the {anew}"
        )


def function_of(arguments: str, gives: str) -> Callable[[Any, ValidationInfo], Any]:
    """What takes a function of these arguments that gives something, both in words."""

    def taken(value: Any, info: ValidationInfo) -> Any:
        if info.context is SAVED and isinstance(value, str):
            return KeptName(value)
        if not callable(value) and not isinstance(value, KeptName):
            raise InputError(
                f"must be a function of {arguments} that gives {gives}; {shown(value)} came"
            )
        return value

    return taken


def check_period(period: float | None) -> None:
    """Refuse a period [rad] that does not fit the engine's.

    Raises
    ------
    InputError : the rule and what came
    """
    if period is None or is_of_halves(period):
        return
    share = 4.0 * math.pi / period
    if abs(share - round(share)) > 1e-9 * share:
        raise InputError(
            "period must be a multiple of half a revolution, such as 6 pi, or a whole part of "
            f"two revolutions, such as 4 pi / 3; {period:.6g} rad came"
        )


def within_period(
    angles: tuple[float, ...], given: float | None
) -> tuple[tuple[float, ...], float | None]:
    """Angles [rad] that come again every period given, or every revolution, within the multiple of
    half a revolution after which all do; and that, where a period is given.

    >>> within_period((1.0,), 4.0 * math.pi / 2.0)[0]
    (1.0,)
    """
    every = given or 2.0 * math.pi
    whole = every if is_of_halves(every) else 4.0 * math.pi
    turns = range(round(whole / every))
    inside = tuple((angle + k * every) % whole for angle in angles for k in turns)
    return inside, whole if given else None


class OfFunction(Windowed):
    """What a torque and a force of a function share: its period is checked, its name is known."""

    function: Any
    period: float | None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_period(self.period)

    @property
    def words(self) -> str:
        return named(self.function)

    @property
    def lacks(self) -> str | None:
        if not isinstance(self.function, KeptName):
            return None
        name = type(self).__name__
        return self.function.lacks(f"{name.lower()} anew with crankmbs.{name}")


@part
class Load(OfFunction, Torque):
    """The torque [N m] that a function(t, theta, omega) gives, of time [s], crank angle [rad] and
    speed [rad/s], three floats in, one out; it must be pure.

    kink_times [s], kink_angles [rad], kink_speeds [rad/s] : where it bends or jumps, the angles
        every ``period``, without one every revolution; what is not declared costs accuracy,
        which the stated errors know of unless it is a pulse that lies between the solver's nodes
    period [rad] : declares that it does not depend on t and repeats over the crank angle; any
        multiple of half a revolution, or a whole part of two revolutions

    >>> Load(lambda t, theta, omega: -2.0 * omega)(0.0, 0.0, 3.0)
    array(-6.)
    """

    positional: ClassVar[tuple[str, ...]] = ("function",)
    kind: Literal["function"] = "function"
    function: Annotated[
        Any,
        PlainValidator(function_of("t, theta and omega", "a torque")),
        PlainSerializer(named),
    ]
    kink_times: Numbers = ()
    kink_angles: Numbers = ()
    kink_speeds: Numbers = ()
    period: AnglePeriod | None = None

    @cached_property
    def parts(self) -> Parts[Cycle]:
        if isinstance(self.function, KeptName):
            return Parts()
        angles, period = within_period(self.kink_angles, self.period)
        known = self.kink_times, angles, self.kink_speeds
        return Parts(function=Function(self.function, *known, period))

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        function: Callable[[float, float, float], float] = self.function

        def scaled(t: float, theta: float, omega: float) -> float:
            return share * function(t, theta, omega / faster)

        scaled.__name__ = named(function)
        speeds = tuple(faster * speed for speed in self.kink_speeds)
        return {"function": scaled, "kink_speeds": speeds}


Torque.unwritten["function"] = Load
