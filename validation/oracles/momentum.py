"""What the moving parts do to the frame, by differentiating their momenta and energy in time.

Places and angles are written out; everything else is a derivative that mpmath takes of them.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath

from validation.oracles.arithmetic import Number
from validation.oracles.machine import Machine

__all__ = ["FrameLoads", "frame_by_momentum"]

_DIGITS = 40

Path = Callable[[Number], Number]


class FrameLoads(NamedTuple):
    """Force [N], moment about the crank and moments about X and Y, middle of the crank [N m]."""

    frame_force_x: float
    frame_force_y: float
    frame_moment: float
    rocking_moment_x: float
    rocking_moment_y: float


class _Body(NamedTuple):
    """Mass [kg], own inertia [kg m2]; place x + i y [m] and angle [rad] over time; lever [m]."""

    mass: Number
    inertia: Number
    place: Path
    angle: Path
    lever: Number

    def energy(self, t: Number) -> Number:
        """Kinetic energy [J]."""
        speed, spin = mpmath.diff(self.place, t), mpmath.diff(self.angle, t)
        return (self.mass * abs(speed) ** 2 + self.inertia * spin**2) / 2

    def turning(self, t: Number) -> Number:
        """Angular momentum about the crank axis [kg m2/s]."""
        across = mpmath.conj(self.place(t)) * mpmath.diff(self.place, t)
        return self.mass * across.imag + self.inertia * mpmath.diff(self.angle, t)


def frame_by_momentum(
    machine: Machine, state: tuple[float, float, float], gas_force: tuple[float, ...]
) -> FrameLoads:
    """Of a crank at (theta, omega, alpha) [rad, rad/s, rad/s2], omega not 0; 15 digits and more.

    force = weight - dP/dt;  moment = torque + moment of weights - dL/dt, where the torque from
    outside is what the power leaves: (dE/dt - power of gas and weights) / omega. gas_force [N] is
    that on each piston towards the crank. The crank's own mass stands at the crank's middle.
    """
    with mpmath.workdps(_DIGITS):
        theta, omega, alpha = (mpmath.mpf(q) for q in state)
        gravity = mpmath.mpc(*map(mpmath.mpf, machine.gravity))
        bodies, strokes = _bodies(machine, lambda t: theta + (omega + alpha * t / 2) * t)
        force, moment, rocking, power = mpmath.mpc(0), mpmath.mpf(0), mpmath.mpc(0), mpmath.mpf(0)
        for body in bodies:
            weight = body.mass * gravity
            on_frame = weight - body.mass * mpmath.diff(body.place, 0, 2)
            force, rocking = force + on_frame, rocking + body.lever * on_frame
            moment += (mpmath.conj(body.place(0)) * weight).imag - mpmath.diff(body.turning, 0)
            gained = mpmath.diff(body.energy, 0)
            power += gained - (mpmath.conj(weight) * mpmath.diff(body.place, 0)).real
        for push, stroke in zip(gas_force, strokes, strict=True):
            power += mpmath.mpf(push) * mpmath.diff(stroke, 0)
        moment += power / omega
        numbers: tuple[Any, ...] = (force.real, force.imag, moment, -rocking.imag, rocking.real)
        return FrameLoads(*(float(number) for number in numbers))


def _bodies(machine: Machine, theta: Path) -> tuple[list[_Body], list[Path]]:
    """Crank, rods and pistons; every piston's way along its cylinder."""
    r, l, e, a, centre, heavy = (
        mpmath.mpf(q)
        for q in (
            *(machine.crank_radius, machine.rod_length, machine.offset),
            *(machine.rod_center_of_mass, machine.crank_center_of_mass, machine.crank_mass),
        )
    )
    own = mpmath.mpf(machine.crank_inertia) - heavy * centre**2
    bodies = [_Body(heavy, own, lambda t: centre * mpmath.expj(theta(t)), theta, mpmath.mpf(0))]
    strokes: list[Path] = []
    levers = machine.levers or (0,) * len(machine.cylinders)
    for (phase, bank), lever in zip(machine.cylinders, levers, strict=True):
        rod, stroke, lean = _slider(r, l, e, a, _shifted(theta, mpmath.mpf(phase)))
        turn, at = mpmath.expj(mpmath.mpf(bank)), mpmath.mpf(lever)
        strokes.append(stroke)
        heavy, turned = mpmath.mpf(machine.rod_mass), mpmath.mpf(machine.rod_inertia)
        bodies.append(_Body(heavy, turned, _turned(rod, turn), lean, at))
        mass = mpmath.mpf(machine.piston_mass)
        bodies.append(_Body(mass, mpmath.mpf(0), _turned(_beside(stroke, e), turn), _still, at))
    return bodies, strokes


def _slider(r: Number, l: Number, e: Number, a: Number, throw: Path) -> tuple[Path, Path, Path]:
    """The rod's centre x + i y, the piston's x and the rod's angle, in the cylinder's frame."""

    def lean(t: Number) -> Number:
        return -mpmath.asin((r * mpmath.sin(throw(t)) - e) / l)

    def rod(t: Number) -> Number:
        return r * mpmath.expj(throw(t)) + a * mpmath.expj(lean(t))

    def stroke(t: Number) -> Number:
        return r * mpmath.cos(throw(t)) + l * mpmath.cos(lean(t))

    return rod, stroke, lean


def _shifted(angle: Path, by: Number) -> Path:
    return lambda t: angle(t) + by


def _turned(place: Path, turn: Number) -> Path:
    return lambda t: turn * place(t)


def _beside(stroke: Path, offset: Number) -> Path:
    return lambda t: mpmath.mpc(stroke(t), offset)


def _still(_: Number) -> Number:
    return mpmath.mpf(0)
