"""How the crank is moved: a prescribed speed, or the state from which it is free."""

from __future__ import annotations

from numbers import Real
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import (
    Angle,
    AngularSpeed,
    Float,
    folder_of,
    from_file,
    of_file,
    part,
    si,
)
from crankmbs.scene.speed_rows import check_over_angle, from_first_row
from crankmbs.scene.tables import Header, Table, check_abscissae, headings
from crankmbs.scene.units import DEGREE, RPM

__all__ = [
    "Motion",
    "Oscillation",
    "Ramp",
    "SpeedFile",
    "Start",
]


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


_SPEED = {"speed_rpm": RPM}
_OVER_TIME = Header({"time_s": 1.0}, _SPEED)
_OVER_ANGLE = Header({"crank_angle_deg": DEGREE}, _SPEED)
_EITHER = Header(
    _OVER_TIME.x | _OVER_ANGLE.x, _SPEED, "times [s] or crank angles [rad], speeds [rad/s]"
)


@part
class SpeedFile:
    """Speed over time or over the crank angle, as measured: pchip or cubic between the rows.

    kind : "time_table", of time [s] and speed [rad/s], or "angle_table", of crank angle [rad] and
        speed, which never comes to 0; from a file its columns say it. A time that begins later than
        0 is counted from the first row, where the run begins. Over the angle rows that span
        one or two revolutions and close repeat, all others cover the run
    interpolation : "pchip" keeps monotone stretches monotone; "cubic", the spline with two
        continuous derivatives, is for smooth rows: pchip's acceleration errs there by 2 %
    """

    file: Annotated[Table, from_file(_EITHER)]
    interpolation: Literal["pchip", "cubic"] = "pchip"
    kind: Literal["time_table", "angle_table"] = "time_table"

    def __post_init__(self) -> None:
        abscissae = "times" if self.kind == "time_table" else "crank angles"
        check_abscissae(self.file, abscissae, jumps=False)
        if self.kind == "angle_table":
            check_over_angle(self.file, self.interpolation)
        elif self.file.x[0] > 0.0:
            object.__setattr__(self, "file", from_first_row(self.file))

    @property
    def header(self) -> Header:
        """The headings of its file."""
        return _OVER_TIME if self.kind == "time_table" else _OVER_ANGLE


_SPEED_KEYS = {
    "Oscillation": {"mean", "amplitude", "order", "phase"},
    "Ramp": {"from", "start", "to", "over"},
    "SpeedFile": {"file", "interpolation", "kind"},
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
    return _of_columns(value, info) if isinstance(value, dict) and of_file(info) else value


def _of_columns(value: dict[str, object], info: ValidationInfo) -> dict[str, object]:
    """A table of a scene file, its kind as the columns of its CSV file have it."""
    if "kind" in value:
        raise InputError("kind is no key of a speed: the columns of its file say what it is over")
    file = value.get("file")
    if not isinstance(file, str):
        return value
    try:
        names = headings(folder_of(info) / file)
    except InputError:
        return value  # its reader says so
    over_time, over_angle = (name in names for name in _EITHER.x)
    return {**value, "kind": "angle_table"} if over_angle and not over_time else value


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
