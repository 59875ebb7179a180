"""What every torque from outside has in common, and how a file names one.

A load says what a file writes of it (its fields), and what it is: functions of time, of the crank
speed and of the crank angle, each a polynomial between its knots, or one of all three. Whatever
solves, draws or writes a scene asks the loads for these; nothing else knows their classes.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from typing import Annotated, Any, ClassVar, NamedTuple, Self, TypeVar

import numpy as np
from annotated_types import Ge
from numpy.typing import ArrayLike
from pydantic import PlainValidator, SerializeAsAny, TypeAdapter, ValidationError, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.function import Function
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.schema import SAVED, Float, of_file, part, si
from crankmbs.scene.sentences import PartError, did_you_mean
from crankmbs.scene.tables import Header, Table
from crankmbs.scene.units import RPM

__all__ = ["AnyTorque", "Parts", "Torque", "load"]

T = TypeVar("T", bound="type[Torque]")
Time = Annotated[Float, Ge(0), si("time")]
AngularSpeed = Annotated[Float, si("angular speed")]


class Parts(NamedTuple):
    """What a torque [N m] is the sum of: functions of time [s], of the crank speed [rad/s], of the
    crank angle [rad], and of all three."""

    over_time: Piecewise | None = None
    over_speed: Piecewise | None = None
    over_angle: Cycle | None = None
    function: Function | None = None

    @property
    def period(self) -> float | None:
        """Crank angle [rad] after which it comes again; None of what does not depend on it, or is
        not known to come again."""
        found = self.over_angle or self.function
        return None if found is None else found.period


@part
class Torque(ABC):
    """A torque from outside on the free crank; positive drives.

    It acts from when the time ``after`` [s] and the speed ``from_speed`` [rad/s] have both been met
    to the time ``until`` or, after that, the speed ``until_speed``, and then never again; what is
    not given bounds nothing.
    """

    kinds: ClassVar[dict[str, type[Torque]]] = {}
    unwritten: ClassVar[dict[str, type[Torque]]] = {}  # no file names them, but a saved result
    header: ClassVar[Header | None] = None  # of its table, if it has one
    kind: str
    after: Time | None = None
    until: Time | None = None
    from_speed: AngularSpeed | None = None
    until_speed: AngularSpeed | None = None

    def __post_init__(self) -> None:
        begin = self.after or 0.0
        if self.until is not None and self.until <= begin:
            raise InputError(
                f"until must be later than {'after' if begin else 'the start'}, {begin:g} s, or it "
                f"never acts; {self.until:g} s came"
            )

    @property
    def window_words(self) -> str:
        """What a reader is told of when it acts; nothing where it does throughout."""
        speeds = [("from", self.from_speed), ("until", self.until_speed)]
        times = [("after", self.after), ("until", self.until)]
        said = [f"{word} {t:.6g} s" for word, t in times if t is not None]
        said += [f"{word} {v / RPM:.6g} rpm" for word, v in speeds if v is not None]
        return "".join(f", {one}" for one in said)

    @property
    def has_window(self) -> bool:
        """Whether it does not act throughout."""
        ends = self.after, self.until, self.from_speed, self.until_speed
        return any(end is not None for end in ends)

    @property
    @abstractmethod
    def parts(self) -> Parts:
        """What it is the sum of."""

    @property
    @abstractmethod
    def words(self) -> str:
        """What a reader is told of it, after its kind."""

    def scaled(self, share: float, faster: float) -> Self:
        """A share of it; the same torque as before at a speed so much higher."""
        speeds = {"from_speed": self.from_speed, "until_speed": self.until_speed}
        moved = {name: v * faster for name, v in speeds.items() if v is not None}
        return dataclasses.replace(self, **self._scaled(share, faster), **moved)  # type: ignore[arg-type]

    @abstractmethod
    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        """The fields that make it a share, and the same torque at a speed so much higher."""

    @property
    def name(self) -> str:
        """Its kind in words."""
        return self.kind.replace("_", " ")

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of angle and speed."""
        over_time, _, _, function = self.parts
        varies = over_time is not None and bool(over_time.knots or not over_time.is_constant)
        unknown = function is not None and function.period is None
        return not (varies or self.has_window or unknown)

    @property
    def table_over_time(self) -> Table | None:
        """Its table, if that must cover the time in which it acts."""
        return None

    @property
    def lacks(self) -> str | None:
        """Why it cannot be run again, and the way out; None where it can."""
        return None

    def check_time(self, t: float) -> None:
        """Refuse a time [s] at which it is not known.

        Raises
        ------
        InputError : key, what came, and the way out
        """
        table = self.table_over_time
        if table is not None and t >= table.x[-1]:
            raise InputError(
                f"file: {table.source}: the time table ends at {table.x[-1]:g} s, before the run "
                "does; lengthen the table or shorten the run"
            )

    def __call__(self, t: ArrayLike, theta: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s], crank angles [rad] and speeds [rad/s] of one shape; on a jump
        that after it.

        >>> Viscous(coefficient=2.0)(0.0, 0.0, [1.0, -3.0])
        array([-2.,  6.])
        """
        total = np.zeros(np.broadcast_shapes(np.shape(t), np.shape(theta), np.shape(omega)))
        for function, at in zip(self.parts[:3], (t, omega, theta), strict=True):
            total += 0.0 if function is None else function(at)
        if self.parts.function is not None:
            total += self.parts.function(*map(np.asarray, (t, theta, omega)))
        return total


def load(cls: T) -> T:
    """Make a part a load that a file names by its kind.

    >>> Torque.kinds["viscous"].__name__
    'Viscous'
    """
    Torque.kinds[cls.kind] = cls
    return cls


def _read(value: Any, info: ValidationInfo) -> Torque:
    """A load as it is, or by its kind from a table of a file."""
    if isinstance(value, Torque):
        return value
    if not isinstance(value, dict) and info.context is None:
        names = ", ".join(cls.__name__ for cls in Torque.kinds.values())
        raise InputError(f"must be one of {names}; {shown(value)} came")
    if not isinstance(value, dict):
        raise InputError(f"must be a table with its kind, [[torque]]; {shown(value)} came")
    kind = value.get("kind")
    known = Torque.kinds | (Torque.unwritten if info.context is SAVED else {})
    if not isinstance(kind, str) or kind not in known:
        came = f"{shown(kind)} came" if "kind" in value else "none came"
        near = did_you_mean(kind, list(Torque.kinds)) if isinstance(kind, str) else ""
        raise InputError(f"kind must be one of {', '.join(Torque.kinds)}; {came}{near}")
    cls: Any = known[kind]
    by_name = False if of_file(info) else None
    try:
        made: Torque = TypeAdapter(cls).validate_python(
            value, context=info.context, by_name=by_name
        )
    except ValidationError as error:
        raise PartError(error, cls, value) from None
    return made


AnyTorque = Annotated[SerializeAsAny[Torque], PlainValidator(_read)]
"""A load of whatever class."""
