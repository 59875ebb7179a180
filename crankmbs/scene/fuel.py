"""The fuel: each firing's share of the combustion, from misfires, scatter and a governor."""

from __future__ import annotations

import re
from typing import Annotated

from annotated_types import Ge, Le, Len
from pydantic import BeforeValidator, StrictInt, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import AngularSpeed, Float, Time, part, si

__all__ = ["Fuel", "Governor", "Misfire"]

_CYCLES = re.compile(r"(every +)?([1-9][0-9]{0,8})(?:-([1-9][0-9]{0,8}))?")

Share = Annotated[Float, Ge(0), Le(100)]


def _cycles(value: object, _: ValidationInfo) -> object:
    match = _CYCLES.fullmatch(value) if isinstance(value, str) else None
    if match is None or (match[1] and match[3]) or int(match[3] or match[2]) < int(match[2]):
        raise InputError(
            f'must be a cycle such as "5", cycles such as "5-8", or "every 4"; {shown(value)} came'
        )
    return value


@part
class Misfire:
    """cylinder, counted from 1; cycles: those that do not fire, "5", "5-8" or "every 4"."""

    cylinder: Annotated[StrictInt, Ge(1)]
    cycles: Annotated[str, BeforeValidator(_cycles)]

    def strikes(self, cycle: int) -> bool:
        """Whether a cycle, counted from 1, is one of them.

        >>> Misfire(cylinder=1, cycles="every 4").strikes(8)
        True
        """
        first, last, every = self.bounds
        return cycle % first == 0 if every else first <= cycle <= last

    @property
    def bounds(self) -> tuple[int, int, bool]:
        """The first and the last of the cycles; or the number of which every multiple is one.

        >>> Misfire(cylinder=1, cycles="5-8").bounds
        (5, 8, False)
        """
        match = _CYCLES.fullmatch(self.cycles)
        assert match is not None
        return int(match[2]), int(match[3] or match[2]), match[1] is not None

    @property
    def every(self) -> int | None:
        """n of "every n", else None."""
        first, _, every = self.bounds
        return first if every else None


@part
class Governor:
    """A share of the combustion from the mean speed since the decision before.

    speed [rad/s] that it holds; kp [s/rad], ki [1/rad]; min, max of the share; initial value of
    the integral. With K = integral + ki error T the share is clip(kp error + K, min, max).
    """

    speed: AngularSpeed
    kp: Annotated[Float, Ge(0), si("proportional gain")]
    ki: Annotated[Float, Ge(0), si("integral gain")]
    min: Share = 0.0
    max: Share = 1.0
    initial: Share = 0.0

    def __post_init__(self) -> None:
        if self.min > self.max:
            raise InputError(f"min must be at most max; {self.min:g} and {self.max:g} came")
        if not self.min <= self.initial <= self.max:
            raise InputError(
                f"initial must lie between min and max, {self.min:g} and {self.max:g}; "
                f"{self.initial:g} came"
            )


@part
class Fuel:
    """Each firing's share q of the combustion: the pressure is motored + q (fired - motored).

    misfire: firings with q = 0; scatter: relative standard deviation of q, drawn from ``seed``;
    governor: q from the speed, else 1; after, until [s], from_speed, until_speed [rad/s]: outside
    of them q = 0, judged where q is decided.
    """

    misfire: Annotated[tuple[Misfire, ...], Len(1)] | None = None
    scatter: Annotated[Float, Ge(0), Le(10)] = 0.0
    seed: Annotated[StrictInt, Ge(0)] = 1
    governor: Governor | None = None
    after: Time = 0.0
    until: Time | None = None
    from_speed: AngularSpeed | None = None
    until_speed: AngularSpeed | None = None

    def __post_init__(self) -> None:
        if self.until is not None and self.until <= self.after:
            raise InputError(
                f"until must come later than after, {self.after:g} s; {self.until:g} s came"
            )
