"""Free motion of the crank by Taylor series in time, one formula of gas and loads per step.

The error is that of truncation (below rounding) and of rounding.
"""

from collections.abc import Sequence

from validation.oracles import bodies
from validation.oracles.arithmetic import LONG, Arithmetic, Array, Number
from validation.oracles.events import first_exit, step_size
from validation.oracles.formulas import Formulas, Place
from validation.oracles.machine import Machine
from validation.oracles.path import Advance, Motion, Path, State
from validation.oracles.taylor import derivative, evaluate, motion_series

__all__ = ["Motion", "free_motion", "series_path"]


class _SeriesStepper:
    """Steps by the series of the absolute-coordinate equations."""

    def __init__(self, machine: Machine, arithmetic: Arithmetic, order: int) -> None:
        self.formulas, self.order = Formulas(machine, arithmetic), order
        self.system = bodies.build(machine, bodies.TORQUE, arithmetic)

    def alpha(self, state: State, place: Place) -> Number:
        return 2 * self._series(state, place, 2)[2]

    def advance(self, state: State, place: Place, most: Number) -> Advance:
        formulas = self.formulas
        theta = self._series(state, place, self.order)
        omega = derivative(theta)
        size = min(step_size(omega, formulas.arithmetic), most)
        angle_exit, speed_exit = (
            first_exit(series, grid.bounds(piece), size, formulas.arithmetic)
            for series, grid, piece in (
                (theta, formulas.angles, place.angle),
                (omega, formulas.speeds, place.speed),
            )
        )
        if angle_exit and speed_exit:
            if angle_exit.time <= speed_exit.time:
                speed_exit = None
            else:
                angle_exit = None
        event = angle_exit or speed_exit
        size = event.time if event else size
        return Advance(
            theta,
            size,
            evaluate(theta, size),
            evaluate(omega, size),
            angle_exit.upper if angle_exit else None,
            speed_exit.upper if speed_exit else None,
        )

    def _series(self, state: State, place: Place, order: int) -> Array:
        machine, arithmetic = self.formulas.machine, self.formulas.arithmetic
        theta, omega = (arithmetic.array([x]) for x in (state.theta, state.omega))
        angle, rate = bodies.pose(machine, theta, omega, arithmetic)
        load, gas = self.formulas.load(place, state.time), self.formulas.gas(place)
        return motion_series(self.system, angle[0], rate[0], load, gas, order, arithmetic)


def series_path(
    machine: Machine,
    theta0: Number,
    omega0: Number,
    *,
    order: int | None = None,
    arithmetic: Arithmetic = LONG,
) -> Path:
    """The path from (theta0, omega0) [rad, rad/s] at t = 0.

    order is that of the Taylor series (default 1.3 times the digits).
    """
    stepper = _SeriesStepper(machine, arithmetic, order or round(1.3 * arithmetic.digits))
    return Path(stepper, theta0, omega0)


def free_motion(
    machine: Machine,
    theta0: Number,
    omega0: Number,
    *,
    times: Sequence[Number] | None = None,
    angles: Sequence[Number] | None = None,
    order: int | None = None,
    arithmetic: Arithmetic = LONG,
) -> Motion:
    """The motion at increasing times [s] or at angles [rad] passed in turn: see Path."""
    path = series_path(machine, theta0, omega0, order=order, arithmetic=arithmetic)
    if times is not None and angles is None:
        return path.at_times(arithmetic.array(times))
    if angles is not None and times is None:
        return path.at_angles(arithmetic.array(angles))
    raise ValueError("give either times or angles")
