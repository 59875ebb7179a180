"""How the crank is moved: a prescribed speed, or the state from which it is free."""

from __future__ import annotations

from numbers import Real
from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import Float, from_file, part, si
from crankmbs.scene.tables import Table, check_abscissae
from crankmbs.scene.units import RPM

__all__ = [
    "Motion",
    "Oscillation",
    "Ramp",
    "SpeedFile",
    "Start",
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
        check_abscissae(self.file, "times", jumps=False)


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
