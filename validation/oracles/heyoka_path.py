"""Free motion of the crank by heyoka: compiled Taylor series of Lagrange's equation, 80-bit floats.

Beside `free_motion` it has mechanics of its own (kinetic energy and work over the crank angle, not
the equations of every body), and its own series, steps and search for events. It shares the
formulas of gas and loads, and what happens on their knots.
"""

from functools import cache
from itertools import count
from types import SimpleNamespace
from typing import Any

import heyoka as hy
import numpy as np

from validation.oracles.arithmetic import LONG, Array, Number
from validation.oracles.events import step_size
from validation.oracles.formulas import Formulas, Place
from validation.oracles.machine import Machine
from validation.oracles.path import Advance, Path, State

__all__ = ["heyoka_path"]

_MACHINE = (
    "crank_radius",
    "crank_inertia",
    "crank_mass",
    "crank_center_of_mass",
    "rod_length",
    "rod_mass",
    "rod_center_of_mass",
    "rod_inertia",
    "piston_mass",
    "offset",
)
_LOAD = ("constant", "per_speed", "per_speed2", "per_time")
_TOLERANCE = LONG.epsilon / 100
_LONGEST = LONG.number(1)  # s; the step of a polynomial would have no end
_TAIL, _TINY = 4, 1e-18  # so many last terms of a series must be so small
_STOPS = {-1: (False, None), -2: (True, None), -3: (None, False), -4: (None, True)}

Expression = Any


def heyoka_path(machine: Machine, theta0: Number, omega0: Number) -> Path:
    """The path from (theta0, omega0) [rad, rad/s] at t = 0, under loads without an angle table."""
    if machine.loads.angle_tables:
        raise ValueError("the compiled equations have no load over the angle")
    return Path(_Stepper(machine), theta0, omega0)


@cache
def _integrator(cylinders: int) -> Any:
    """The compiled equations; parameters in the order of `_Stepper`: machine, then place."""
    theta, omega = hy.make_vars("theta", "omega")
    parameters = (hy.par[k] for k in count())

    def take(*names: str) -> SimpleNamespace:
        return SimpleNamespace(**dict(zip(names, parameters, strict=False)))

    def by_angle(value: Expression) -> Expression:
        return hy.diff(value, theta)

    machine, crank = take(*_MACHINE), take("gx", "gy")
    throws = [take("half", "gx", "gy") for _ in range(cylinders)]
    radius, length = machine.crank_radius, machine.rod_length
    reach = machine.crank_mass * machine.crank_center_of_mass
    load = take(*_LOAD)
    torque = load.constant + load.per_time * hy.time
    torque += omega * (load.per_speed + load.per_speed2 * omega)
    torque += reach * (crank.gy * hy.cos(theta) - crank.gx * hy.sin(theta))
    inertia = machine.crank_inertia
    for own in throws:
        sine, cosine = hy.sin(theta / 2 + own.half), hy.cos(theta / 2 + own.half)
        # Of the throw and of the rod; by half angles the rod's cosine is exact up to a fold.
        throw_x, throw_y = 2 * radius * sine * cosine, radius * (sine * sine - cosine * cosine)
        above = length - machine.offset - radius + 2 * radius * sine * sine
        below = length + machine.offset - radius + 2 * radius * cosine * cosine
        rod_x, rod_y = hy.sqrt(above * below) / length, (machine.offset - throw_y) / length
        spin = by_angle(rod_y) / rod_x
        center = machine.rod_center_of_mass
        to_x, to_y = by_angle(throw_x + center * rod_x), by_angle(throw_y + center * rod_y)
        stroke = by_angle(throw_x + length * rod_x)
        inertia += machine.rod_mass * (to_x * to_x + to_y * to_y)
        inertia += machine.rod_inertia * spin * spin + machine.piston_mass * stroke * stroke
        gas = take("origin", "p0", "p1", "p2", "p3")
        since = theta - gas.origin
        force = gas.p0 + since * (gas.p1 + since * (gas.p2 + since * gas.p3))
        torque += machine.rod_mass * (own.gx * to_x + own.gy * to_y)
        torque += stroke * (machine.piston_mass * own.gx - force)
    alpha = (torque - by_angle(inertia) * omega * omega / 2) / inertia
    directions = (hy.event_direction.negative, hy.event_direction.positive)
    events = []
    for moving in (theta, omega):
        for direction in directions:
            end = take("weight", "at")
            how = {"direction": direction, "cooldown": LONG.number(0), "fp_type": np.longdouble}
            events.append(hy.t_event(end.weight * moving - end.at, **how))
    return hy.taylor_adaptive(
        [(theta, omega), (omega, alpha)],
        [LONG.number(0), LONG.number(0)],
        tol=_TOLERANCE,
        fp_type=np.longdouble,
        compact_mode=True,
        t_events=events,
    )


class _Stepper:
    """Hands the numbers of a machine and the formulas of a place to the compiled equations."""

    def __init__(self, machine: Machine) -> None:
        self.formulas = Formulas(machine, LONG)
        self._integrator = _integrator(len(machine.cylinders))
        self._known: dict[Place, Array] = {}
        gx, gy = LONG.array(machine.gravity)
        own = [*(getattr(machine, name) for name in _MACHINE), gx, gy]
        for phase, bank in (LONG.array(cylinder) for cylinder in machine.cylinders):
            cosine, sine = LONG.cos(bank), LONG.sin(bank)
            own += [phase / 2 + LONG.pi / 4, cosine * gx + sine * gy, cosine * gy - sine * gx]
        self._own = LONG.array(own)

    def alpha(self, state: State, place: Place) -> Number:
        self._step(state, place, LONG.number(0))
        return self._integrator.tc[1, 1].copy()

    def advance(self, state: State, place: Place, most: Number) -> Advance:
        outcome, length = self._step(state, place, min(most, _LONGEST))
        if self._is_too_long(length):
            longest = step_size(self._integrator.tc[1], LONG)
            outcome, length = self._step(state, place, min(most, longest))
        theta, omega = self._integrator.state
        if not np.isfinite(theta) or not np.isfinite(omega):
            raise ArithmeticError(f"at t = {float(state.time)} s heyoka ends: {outcome}")
        upper_angle, upper_speed = _STOPS.get(int(outcome), (None, None))
        if upper_angle is None and upper_speed is None:  # over the end by rounding only?
            upper_angle = _beyond(theta, self.formulas.angles.bounds(place.angle))
            if upper_angle is None:
                upper_speed = _beyond(omega, self.formulas.speeds.bounds(place.speed))
        series = self._integrator.tc[0].copy()
        return Advance(series, length, theta, omega, upper_angle, upper_speed)

    def _is_too_long(self, length: Number) -> bool:
        """Whether zeros among the last terms of the series, as in a symmetry, misled heyoka."""
        terms = np.abs(self._integrator.tc).max(axis=0)
        last = terms[-_TAIL:] * length ** np.arange(len(terms) - _TAIL, len(terms))
        return bool(last.max() > _TINY * max(terms[0], terms[1] * length))

    def _step(self, state: State, place: Place, most: Number) -> tuple[Any, Number]:
        integrator = self._integrator
        if place not in self._known:
            self._known[place] = self._parameters(place)
        integrator.pars[:] = self._known[place]
        if len(state.angle_pieces) == 2 or len(state.speed_pieces) == 2:
            self._set_aside(state)
        integrator.state[:] = state.theta, state.omega
        integrator.time = state.time
        step: tuple[Any, Number] = integrator.step(max_delta_t=most, write_tc=True)
        return step

    def _set_aside(self, state: State) -> None:
        """Move a bound that the step starts on a little out: heyoka would not see the return."""
        at = self._integrator.pars[-7::2]
        for k, value in enumerate((state.theta, state.theta, state.omega, state.omega)):
            if at[k] == value:
                at[k] += (-1, 1)[k % 2] * 4 * LONG.epsilon * (1 + abs(value))

    def _parameters(self, place: Place) -> Array:
        formulas, cylinders = self.formulas, len(self.formulas.machine.cylinders)
        load, gas = formulas.load(place, LONG.number(0)), formulas.gas(place)
        values = [getattr(load, name) for name in _LOAD]
        for k in range(cylinders):
            values += [gas.origin[k], *gas.coefficients[k]] if gas else [0] * 5
        for low, high in (formulas.angles.bounds(place.angle), formulas.speeds.bounds(place.speed)):
            values += [1, low] if np.isfinite(low) else [0, -1]
            values += [1, high] if np.isfinite(high) else [0, 1]
        return np.concatenate([self._own, np.array(values, dtype=LONG.dtype)])


def _beyond(value: Number, bounds: tuple[Number, Number]) -> bool | None:
    """Whether a value is above the upper bound (True), below the lower one (False) or neither."""
    if value > bounds[1]:
        return True
    return False if value < bounds[0] else None
