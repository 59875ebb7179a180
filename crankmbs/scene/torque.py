"""What every torque from outside has in common, and how a file names one.

A load says what a file writes of it (its fields), and what it is: functions of time, of the crank
speed and of the crank angle, each a polynomial between its knots, or one of all three. Whatever
solves, draws or writes a scene asks the loads for these; nothing else knows their classes.
"""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from typing import Annotated, Any, ClassVar, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import PlainValidator, SerializeAsAny

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle, Periodic
from crankmbs.numerics.function import Function
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.schema import part
from crankmbs.scene.windowed import Windowed, one_of_kinds

__all__ = ["Acting", "AnyTorque", "Parts", "Torque"]

P = TypeVar("P", bound=Periodic, covariant=True)


class Parts(NamedTuple, Generic[P]):
    """What a torque [N m] is the sum of: functions of time [s], of the crank speed [rad/s], of the
    crank angle [rad], and of all three."""

    over_time: Piecewise | None = None
    over_speed: Piecewise | None = None
    over_angle: P | None = None
    function: Function | None = None

    @property
    def period(self) -> float | None:
        """Crank angle [rad] after which it comes again; None of what does not depend on it, or is
        not known to come again."""
        repeating = self.over_angle or self.function
        return None if repeating is None else repeating.period

    def __call__(self, t: ArrayLike, theta: ArrayLike, omega: ArrayLike) -> Array:
        """Their sum [N m] at times, crank angles and speeds of one shape; on a jump that after
        it."""
        total = np.zeros(np.broadcast_shapes(np.shape(t), np.shape(theta), np.shape(omega)))
        for function, at in zip(self[:3], (t, omega, theta), strict=True):
            total += 0.0 if function is None else function(at)
        if self.function is not None:
            total += self.function(*map(np.asarray, (t, theta, omega)))
        return total


class Acting(Protocol):
    """What acts on the crank, in a window."""

    @property
    def given(self) -> Windowed:
        """As the scene gives it, with its window."""

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of angle and speed."""

    @property
    def parts(self) -> Parts[Periodic]:
        """What it is the sum of."""

    def __call__(self, t: ArrayLike, theta: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s], crank angles [rad] and speeds [rad/s] of one shape."""


@part
class Torque(Windowed):
    """A torque from outside on the free crank; positive drives. It acts in its window
    (`crankmbs.scene.windowed.Windowed`)."""

    kinds: ClassVar[dict[str, type[Torque]]] = {}
    unwritten: ClassVar[dict[str, type[Torque]]] = {}
    heading: ClassVar[str] = "torque"
    unit: ClassVar[str] = "N m"

    @property
    @abstractmethod
    def parts(self) -> Parts[Cycle]:
        """What it is the sum of."""

    def scaled(self, share: float, faster: float) -> Self:
        """A share of it; the same torque as before at a speed so much higher."""
        speeds = {"from_speed": self.from_speed, "until_speed": self.until_speed}
        moved = {name: v * faster for name, v in speeds.items() if v is not None}
        return dataclasses.replace(self, **self._scaled(share, faster), **moved)  # type: ignore[arg-type]

    @abstractmethod
    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        """The fields that make it a share, and the same torque at a speed so much higher."""

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of angle and speed."""
        over_time, _, _, function = self.parts
        varies = over_time is not None and bool(over_time.knots or not over_time.is_constant)
        unknown = function is not None and function.period is None
        return not (varies or self.has_window or unknown)

    @property
    def is_constant(self) -> bool:
        """Whether it is known to be the same at every time, angle and speed."""
        known = not self.lacks
        return known and self.is_steady and all(part is None for part in self.parts[1:])

    def __call__(self, t: ArrayLike, theta: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s], crank angles [rad] and speeds [rad/s] of one shape; on a jump
        that after it.

        >>> Viscous(coefficient=2.0)(0.0, 0.0, [1.0, -3.0])
        array([-2.,  6.])
        """
        return self.parts(t, theta, omega)


AnyTorque = Annotated[SerializeAsAny[Torque], PlainValidator(one_of_kinds(Torque))]
"""A load of whatever class."""
