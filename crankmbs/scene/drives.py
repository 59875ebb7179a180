"""How the crank is moved: a prescribed speed, or a start and torques on the free crank."""

from __future__ import annotations

from itertools import pairwise
from numbers import Real
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import Float, from_file, part, si
from crankmbs.scene.sentences import did_you_mean
from crankmbs.scene.tables import Table
from crankmbs.scene.units import RPM

__all__ = [
    "Constant",
    "Motion",
    "Oscillation",
    "Quadratic",
    "Ramp",
    "SpeedFile",
    "SpeedTable",
    "Start",
    "TimeTable",
    "Torque",
    "Viscous",
]

Angle = Annotated[Float, si("angle")]
AngularSpeed = Annotated[Float, si("angular speed")]


@part
class Oscillation:
    """omega = mean + amplitude cos(order theta + phase); mean [rad/s] is taken over the angle."""

    mean: AngularSpeed
    amplitude: Annotated[Float, Ge(0), si("angular speed")]
    order: Annotated[Float, Gt(0), Le(1e6)]
    phase: Angle = 0.0

    def __post_init__(self) -> None:
        if self.amplitude >= abs(self.mean):
            raise InputError(
                f"amplitude must be below the mean speed, or the crank stops; "
                f"{self.amplitude:.6g} and {self.mean:.6g} rad/s came"
            )


@part
class Ramp:
    """A linear change in time from one speed to another [rad/s] over a time [s], then held.

    A file calls the first speed ``from``, which is no Python name.
    """

    start: Annotated[AngularSpeed, Field(validation_alias="from")]
    to: AngularSpeed
    over: Annotated[Float, Gt(0), si("time")]


@part
class SpeedFile:
    """Speed over time: table of time [s] and speed [rad/s]; pchip between the rows."""

    file: Annotated[
        Table, from_file({"time_s": 1.0}, {"speed_rpm": RPM}, "times [s], speeds [rad/s]")
    ]

    def __post_init__(self) -> None:
        _check_abscissae(self.file, "times", jumps=False)


_SPEED_KEYS = {
    "Oscillation": {"mean", "amplitude", "order", "phase"},
    "Ramp": {"from", "start", "to", "over"},
    "SpeedFile": {"file"},
}


def _speed_class(value: object) -> str:
    if isinstance(value, dict):
        return max(_SPEED_KEYS, key=lambda name: len(_SPEED_KEYS[name] & value.keys()))
    name = type(value).__name__
    return name if name in _SPEED_KEYS else "Constant"


def _check_speed(value: object, info: ValidationInfo) -> object:
    known = isinstance(value, str | Real | dict) or type(value).__name__ in _SPEED_KEYS
    if info.context is None and not known:
        raise InputError(
            'must be a number in rad/s, text such as "3200 rpm", or one of '
            f"{', '.join(_SPEED_KEYS)}; {shown(value)} came"
        )
    if isinstance(value, dict) and not set().union(*_SPEED_KEYS.values()) & value.keys():
        raise InputError(
            'must be a speed such as "3200 rpm", or a table with mean, amplitude, order, or with '
            f"from, to, over, or with file; {shown(value)} came"
        )
    return value


Speed = Annotated[
    Annotated[AngularSpeed, Tag("Constant")]
    | Annotated[Oscillation, Tag("Oscillation")]
    | Annotated[Ramp, Tag("Ramp")]
    | Annotated[SpeedFile, Tag("SpeedFile")],
    Discriminator(_speed_class),
    BeforeValidator(_check_speed),
]


@part
class Motion:
    """A prescribed speed [rad/s] and the crank angle [rad] where it starts."""

    speed: Speed
    angle: Angle = 0.0


@part
class Start:
    """The state from which a free crank starts: angle [rad], speed [rad/s]."""

    angle: Angle
    speed: AngularSpeed


@part
class Constant:
    """A constant torque [N m]."""

    kind: Literal["constant"] = "constant"
    torque: Annotated[Float, si("torque")]


@part
class Viscous:
    """The torque -c omega, c = coefficient [N m s]."""

    kind: Literal["viscous"] = "viscous"
    coefficient: Annotated[Float, Ge(0), si("viscous coefficient")]


@part
class Quadratic:
    """The torque -c omega |omega|, c = coefficient [N m s2]: a propeller or a brake."""

    kind: Literal["quadratic"] = "quadratic"
    coefficient: Annotated[Float, Ge(0), si("quadratic coefficient")]


@part
class TimeTable:
    """Torque [N m] over time [s], linear; two rows at one time are a jump. Covers the run."""

    kind: Literal["time_table"] = "time_table"
    file: Annotated[
        Table, from_file({"time_s": 1.0}, {"torque_Nm": 1.0}, "times [s], torques [N m]")
    ]

    def __post_init__(self) -> None:
        _check_abscissae(self.file, "times", jumps=True)


@part
class SpeedTable:
    """Torque [N m] over speed [rad/s], linear, ends held; two rows at one speed are a jump."""

    kind: Literal["speed_table"] = "speed_table"
    file: Annotated[
        Table, from_file({"speed_rpm": RPM}, {"torque_Nm": 1.0}, "speeds [rad/s], torques [N m]")
    ]

    def __post_init__(self) -> None:
        _check_abscissae(self.file, "speeds", jumps=True)


_TORQUE_KINDS = {
    "constant": "Constant",
    "viscous": "Viscous",
    "quadratic": "Quadratic",
    "time_table": "TimeTable",
    "speed_table": "SpeedTable",
}


def _torque_class(value: object) -> str:
    return _TORQUE_KINDS[value["kind"]] if isinstance(value, dict) else type(value).__name__


def _check_kind(value: object, info: ValidationInfo) -> object:
    if type(value).__name__ in _TORQUE_KINDS.values():
        return value
    if not isinstance(value, dict) and info.context is None:
        raise InputError(f"must be one of {', '.join(_TORQUE_KINDS.values())}; {shown(value)} came")
    if not isinstance(value, dict):
        raise InputError(f"must be a table with its kind, [[torque]]; {shown(value)} came")
    kind = value.get("kind")
    if not isinstance(kind, str) or kind not in _TORQUE_KINDS:
        came = f"{shown(kind)} came" if "kind" in value else "none came"
        near = did_you_mean(kind, list(_TORQUE_KINDS)) if isinstance(kind, str) else ""
        raise InputError(f"kind must be one of {', '.join(_TORQUE_KINDS)}; {came}{near}")
    return value


Torque = Annotated[
    Annotated[Constant, Tag("Constant")]
    | Annotated[Viscous, Tag("Viscous")]
    | Annotated[Quadratic, Tag("Quadratic")]
    | Annotated[TimeTable, Tag("TimeTable")]
    | Annotated[SpeedTable, Tag("SpeedTable")],
    Discriminator(_torque_class),
    BeforeValidator(_check_kind),
]


def _check_abscissae(table: Table, what: str, *, jumps: bool) -> None:
    x = table.x
    if len(x) < 2:
        raise InputError(f"{table.source}: the table needs at least two rows; {len(x)} came")
    for k, (a, b) in enumerate(pairwise(x)):
        third = k > 0 and x[k - 1] == a == b
        if b < a or third or (b == a and not jumps):
            rule = "not decrease (two equal ones are a jump)" if jumps else "strictly increase"
            raise InputError(f"{table.source}: {what} must {rule}; row {k + 2} breaks this")
