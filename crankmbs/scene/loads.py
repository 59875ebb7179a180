"""Torques from outside on the free crank. One class is one load.

A load says what a file writes of it (its fields), and what it is: functions of time, of the crank
speed and of the crank angle, each a polynomial between its knots. Whatever solves, draws or writes
a scene asks the loads for these; nothing else knows their classes.
"""

from __future__ import annotations

import dataclasses
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self, TypeVar

import numpy as np
from annotated_types import Ge
from numpy.typing import ArrayLike
from pydantic import PlainValidator, SerializeAsAny, TypeAdapter, ValidationError, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.angle_rows import check_turns, cycle_of
from crankmbs.scene.schema import Float, from_file, of_file, part, si
from crankmbs.scene.sentences import PartError, did_you_mean
from crankmbs.scene.tables import Header, Table, check_abscissae
from crankmbs.scene.units import DEGREE, RPM

__all__ = [
    "AngleTable",
    "AnyTorque",
    "Constant",
    "Parts",
    "Quadratic",
    "SpeedTable",
    "TimeTable",
    "Torque",
    "Viscous",
    "load",
]

T = TypeVar("T", bound="type[Torque]")
Time = Annotated[Float, Ge(0), si("time")]
AngularSpeed = Annotated[Float, si("angular speed")]


class Parts(NamedTuple):
    """What a torque [N m] is the sum of: functions of time [s], of the crank speed [rad/s] and of
    the crank angle [rad]."""

    over_time: Piecewise | None = None
    over_speed: Piecewise | None = None
    over_angle: Cycle | None = None


@part
class Torque:
    """A torque from outside on the free crank; positive drives.

    It acts from when the time ``after`` [s] and the speed ``from_speed`` [rad/s] have both been met
    to the time ``until`` or, after that, the speed ``until_speed``, and then never again; what is
    not given bounds nothing.
    """

    kinds: ClassVar[dict[str, type[Torque]]] = {}
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
    def has_window(self) -> bool:
        """Whether it does not act throughout."""
        ends = self.after, self.until, self.from_speed, self.until_speed
        return any(end is not None for end in ends)

    @cached_property
    def parts(self) -> Parts:
        """What it is the sum of."""
        raise NotImplementedError

    @property
    def words(self) -> str:
        """What a reader is told of it, after its kind."""
        raise NotImplementedError

    def scaled(self, share: float, faster: float) -> Self:
        """A share of it; the same torque as before at a speed so much higher."""
        speeds = {"from_speed": self.from_speed, "until_speed": self.until_speed}
        moved = {name: v * faster for name, v in speeds.items() if v is not None}
        return dataclasses.replace(self, **self._scaled(share, faster), **moved)  # type: ignore[arg-type]

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        """The fields that make it a share, and the same torque at a speed so much higher."""
        raise NotImplementedError

    @property
    def name(self) -> str:
        """Its kind in words."""
        return self.kind.replace("_", " ")

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of the speed."""
        over_time = self.parts.over_time
        varies = over_time is not None and bool(over_time.knots or not over_time.is_constant)
        return not (varies or self.has_window)

    @property
    def table_over_time(self) -> Table | None:
        """Its table, if that must cover the time in which it acts."""
        return None

    def check_time(self, t: float) -> None:
        """Refuse a time [s] at which it is not known.

        Raises
        ------
        InputError : key, what came, and the way out
        """

    def __call__(self, t: ArrayLike, theta: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s], crank angles [rad] and speeds [rad/s] of one shape; on a jump
        that after it.

        >>> Viscous(coefficient=2.0)(0.0, 0.0, [1.0, -3.0])
        array([-2.,  6.])
        """
        total = np.zeros(np.broadcast_shapes(np.shape(t), np.shape(theta), np.shape(omega)))
        for function, at in zip(self.parts, (t, omega, theta), strict=True):
            total += 0.0 if function is None else function(at)
        return total


def load(cls: T) -> T:
    """Make a part a load that a file names by its kind.

    >>> Torque.kinds["viscous"].__name__
    'Viscous'
    """
    Torque.kinds[cls.kind] = cls
    return cls


@load
@part
class Constant(Torque):
    """A constant torque [N m]."""

    kind: Literal["constant"] = "constant"
    torque: Annotated[Float, si("torque")]

    @cached_property
    def parts(self) -> Parts:
        return Parts(over_time=Piecewise((), ((self.torque, 0.0, 0.0),)))

    @property
    def words(self) -> str:
        return f"{self.torque:+.6g} N m"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"torque": self.torque * share}


@load
@part
class Viscous(Torque):
    """The torque -c omega, c = coefficient [N m s]."""

    kind: Literal["viscous"] = "viscous"
    coefficient: Annotated[Float, Ge(0), si("viscous coefficient")]

    @cached_property
    def parts(self) -> Parts:
        return Parts(over_speed=Piecewise((), ((0.0, -self.coefficient, 0.0),)))

    @property
    def words(self) -> str:
        return f"-c omega with c = {self.coefficient:.6g} N m s"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"coefficient": self.coefficient * share / faster}


@load
@part
class Quadratic(Torque):
    """The torque -c omega |omega|, c = coefficient [N m s2]: a propeller or a brake."""

    kind: Literal["quadratic"] = "quadratic"
    coefficient: Annotated[Float, Ge(0), si("quadratic coefficient")]

    @cached_property
    def parts(self) -> Parts:
        c = self.coefficient
        return Parts(over_speed=Piecewise((0.0,), ((0.0, 0.0, c), (0.0, 0.0, -c))))

    @property
    def words(self) -> str:
        return f"-c omega |omega| with c = {self.coefficient:.6g} N m s^2"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"coefficient": self.coefficient * share / faster**2}


_OVER_TIME = Header("time_s", 1.0, "torque_Nm", 1.0)
_OVER_SPEED = Header("speed_rpm", RPM, "torque_Nm", 1.0)


@load
@part
class TimeTable(Torque):
    """Torque [N m] over time [s], linear; two rows at one time are a jump. Covers the run."""

    header: ClassVar[Header | None] = _OVER_TIME
    kind: Literal["time_table"] = "time_table"
    file: Annotated[Table, from_file(*_OVER_TIME.units, "times [s], torques [N m]")]

    def __post_init__(self) -> None:
        super().__post_init__()
        check_abscissae(self.file, "times", jumps=True)

    @cached_property
    def parts(self) -> Parts:
        return Parts(over_time=Piecewise.through(self.file.x, self.file.y))

    @property
    def words(self) -> str:
        return _rows(self.file)

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share)}

    @property
    def is_steady(self) -> bool:
        """Whether it is always the same function of the speed."""
        over_time = self.parts.over_time
        varies = over_time is not None and bool(over_time.knots or not over_time.is_constant)
        return not (varies or self.has_window)

    @property
    def table_over_time(self) -> Table | None:
        return self.file

    def check_time(self, t: float) -> None:
        if t >= self.file.x[-1]:
            raise InputError(
                f"file: {self.file.source}: the time table ends at {self.file.x[-1]:g} s, before "
                "the run does; lengthen the table or shorten the run"
            )


@load
@part
class SpeedTable(Torque):
    """Torque [N m] over speed [rad/s], linear, ends held; two rows at one speed are a jump."""

    header: ClassVar[Header | None] = _OVER_SPEED
    kind: Literal["speed_table"] = "speed_table"
    file: Annotated[Table, from_file(*_OVER_SPEED.units, "speeds [rad/s], torques [N m]")]

    def __post_init__(self) -> None:
        super().__post_init__()
        check_abscissae(self.file, "speeds", jumps=True)

    @cached_property
    def parts(self) -> Parts:
        return Parts(over_speed=Piecewise.through(self.file.x, self.file.y))

    @property
    def words(self) -> str:
        return _rows(self.file)

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share, faster)}


_OVER_ANGLE = Header("crank_angle_deg", DEGREE, "torque_Nm", 1.0)


@load
@part
class AngleTable(Torque):
    """Torque [N m] over the crank angle [rad], modulo 360 degrees where its rows span no more, else
    720; linear, pchip or cubic. Two rows at one angle, or a closing row unlike the first, are a
    jump, up to which and from which it is interpolated.
    """

    header: ClassVar[Header | None] = _OVER_ANGLE
    kind: Literal["angle_table"] = "angle_table"
    file: Annotated[Table, from_file(*_OVER_ANGLE.units, "crank angles [rad], torques [N m]")]
    interpolation: Literal["linear", "pchip", "cubic"] = "linear"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_turns(self.file)

    @cached_property
    def parts(self) -> Parts:
        return Parts(over_angle=cycle_of(self.file, self.interpolation))

    @property
    def words(self) -> str:
        return f"{_rows(self.file)}, {self.interpolation}"

    def _scaled(self, share: float, faster: float) -> dict[str, Any]:
        return {"file": self.file.scaled(share)}


def _rows(table: Table) -> str:
    return (
        f"{min(table.y):+.6g} to {max(table.y):+.6g} N m in {len(table.x)} rows of {table.source}"
    )


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
    if not isinstance(kind, str) or kind not in Torque.kinds:
        came = f"{shown(kind)} came" if "kind" in value else "none came"
        near = did_you_mean(kind, list(Torque.kinds)) if isinstance(kind, str) else ""
        raise InputError(f"kind must be one of {', '.join(Torque.kinds)}; {came}{near}")
    cls: Any = Torque.kinds[kind]
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
