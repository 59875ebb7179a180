"""A scene in steps over time, for a model that runs beside it and sets its load and its fuel."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, NamedTuple

from pydantic import TypeAdapter

from crankmbs.errors import FormulationError, InputError, shown
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import COORDINATES, dataset
from crankmbs.motion.assemble import labelled
from crankmbs.motion.stepwise.driven import Prescribed
from crankmbs.motion.stepwise.free import Free
from crankmbs.motion.stepwise.standing import Standing, Steps
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.scene.units import check_size
from crankmbs.simulate import functions_of, why

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Snapshot", "Stepper", "StepperState"]

_MOST_FUEL = 100.0  # as in a scene
_SERVES = ("auto", "crank_angle", "minimal", "kinetostatic")


class StepperState(NamedTuple):
    """Where a `Stepper` stands.

    time [s], crank_angle [rad], crank_speed [rad/s], crank_acceleration [rad/s2]
    crank_angle_error, crank_speed_error : estimates of their largest errors since the start
    status, message : of the last step. 0: it came to its time; 1: a physical end came before; -1:
        a numerical one, and it was not taken
    """

    time: float
    crank_angle: float
    crank_speed: float
    crank_acceleration: float
    crank_angle_error: float
    crank_speed_error: float
    status: int
    message: str


@dataclass(frozen=True)
class Snapshot:
    """Where a `Stepper` stood when it was saved; goes through ``pickle``.

    scene : what tells the scene from others; standing : all that the next step needs
    """

    scene: str
    standing: Standing


class Stepper:
    """The motion of a scene from its start on, one step after the other.

    Between two steps a model of the user takes the state and sets what follows: a torque that
    is held over the step, and the share of the combustion. `crankmbs.simulate` gives the same
    motion within both errors. Of ``[run]`` rtol and formulation count: a step errs so little that a
    run of some revolutions comes near it; nothing is refined afterwards, and the errors say what
    has come of it. They are what two passes, carried side by side, have differed by at most.

    A free crank is carried as in a run, over the crank angle, and over time across rest and
    reversal, where the scene names `minimal` over time throughout; a prescribed speed is followed
    (`kinetostatic`). The memory does not grow.

    Raises
    ------
    FormulationError : the scene names a formulation that does not step over time
    InputError : no scene; a load that cannot be called

    >>> stepper = Stepper(load_scene("yi_diesel_free"))
    >>> state = stepper.advance(1e-3, load=-50.0)
    >>> state.time, state.status
    (0.001, 0)
    """

    def __init__(self, scene: Scene) -> None:
        check_scene(scene)
        if scene.run.formulation not in _SERVES:
            raise FormulationError(
                f"formulation {scene.run.formulation!r} cannot step over time: it solves a run as "
                'a whole; leave run.formulation at "auto"'
            )
        self.scene = scene
        self._functions = functions_of(scene)
        self._steps = _steps(scene)
        self._now = self._steps.begin()

    def advance(self, dt: float, load: float = 0.0, fuel: float | None = None) -> StepperState:
        """Carry the motion on by a time.

        Parameters
        ----------
        dt [s] : above 0
        load [N m] : torque on the crank beside the scene's, held over this step; positive
            drives, so that what brakes is below 0
        fuel : share of the combustion that cylinders take which decide in this step, 0 to 100, in
            place of governor, misfires, scatter and windows; None leaves it to the scene. A
            cylinder decides at its cycle angle of 180 degrees, for one period

        Returns
        -------
        StepperState : with status 1 or -1 it stands before the time that was asked for, its
            sentence says why, and the next step begins there; a crank that rests goes on resting

        Raises
        ------
        InputError : no such numbers; a load with a prescribed speed, fuel in a scene without; a
            table that ends before the step does. The motion then stands where it stood
        """
        _check_number("dt", "a time [s]", dt)
        _check_number("load", "a torque [N m]", load)
        self._check(dt, load, fuel)
        now = self._now.states[0].time
        if not now + dt > now:
            raise InputError(f"dt: does not change the time, {now:g} s, by a digit; {dt:g} came")
        for _, function in self._functions:
            function.failure = ""
        self._now = self._steps.advance(self._now, now + float(dt), float(load), fuel)
        return self.state

    @property
    def state(self) -> StepperState:
        """Where it stands: time, angle, speed and acceleration.

        >>> Stepper(load_scene("torque_driven")).state.crank_speed
        0.0
        """
        status, message = self._steps.said(self._now)
        ended = why(status, message, self._functions)
        return StepperState(self._now.states[0].time, *self._steps.moving(self._now), status, ended)

    @property
    def data(self) -> xr.Dataset:
        """Every variable where it stands, as ``Result.data`` has it, of the one time; each with
        the ``error_estimate`` of this moment. Without ``energy_residual`` where the speed is
        prescribed.

        Steps can be put together with ``xarray.concat(..., dim="time")``.

        >>> stepper = Stepper(load_scene("yi_diesel_free"))
        >>> stepper.data["crank_pin_force_x"].shape
        (1, 4)
        """
        present = dataset(labelled(self._steps.assembled(self._now)), COORDINATES)
        return present.drop_vars("energy_residual") if self.scene.motion is not None else present

    def save(self) -> Snapshot:
        """Where it stands now, to go back to.

        >>> Stepper(load_scene("coasting")).save() == Stepper(load_scene("coasting")).save()
        True
        """
        return Snapshot(self._digest, self._now)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to where a stepper of this scene stood: what follows is the same to the last bit.

        Raises
        ------
        InputError : no snapshot, or one of another scene

        >>> stepper = Stepper(load_scene("coasting"))
        >>> begin = stepper.save()
        >>> first = stepper.advance(1e-3)
        >>> stepper.restore(begin)
        >>> stepper.advance(1e-3) == first
        True
        """
        if not isinstance(snapshot, Snapshot):
            raise InputError(f"snapshot must be what save gave; {shown(snapshot)} came")
        if snapshot.scene != self._digest:
            raise InputError(
                "snapshot: is of another scene than this stepper's; restore it in a stepper of the "
                "scene that it was saved of"
            )
        self._now = snapshot.standing

    @cached_property
    def _digest(self) -> str:
        """What tells the scene from others."""
        text = json.dumps(_SCENE.dump_python(self.scene, mode="json"))
        return hashlib.sha256(text.encode()).hexdigest()

    def _check(self, dt: float, load: float, fuel: float | None) -> None:
        """Refuse what a step cannot be told."""
        if not dt > 0.0:
            raise InputError(f"dt: must be a time above 0 s; {dt:g} came")
        check_size(dt, "time", dt)
        check_size(load, "torque", load)
        if load != 0.0 and self.scene.motion is not None:
            raise InputError(
                "load: with [motion] the drive is an answer, not a load; leave load out, or free "
                f"the crank with [start]; {load:g} came"
            )
        if fuel is None:
            return
        if self.scene.fuel is None:
            raise InputError(
                f"fuel: the scene has no [fuel], and no share to take; add [fuel] to it; {fuel!r} "
                "came"
            )
        _check_number("fuel", "a share of the combustion", fuel)
        if not 0.0 <= fuel <= _MOST_FUEL:
            raise InputError(f"fuel: must be from 0 to {_MOST_FUEL:g}; {fuel:g} came")


def _steps(scene: Scene) -> Steps:
    train = crank_train(scene)
    if scene.motion is not None:
        return Prescribed(train)
    return Free(train)


def _check_number(name: str, kind: str, value: object) -> None:
    number = isinstance(value, Real) and not isinstance(value, bool)
    if not number or not math.isfinite(value):  # type: ignore[arg-type]
        raise InputError(f"{name}: must be {kind}, a finite number; {shown(value)} came")


_SCENE = TypeAdapter(Scene)
