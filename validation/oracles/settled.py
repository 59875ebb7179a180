"""The periodic motion of a crank: its energy over the crank angle, panel by panel, by Picard's
iteration on Gauss nodes, and the fixed point of the energy after a period by the secant method.

dE/dtheta = T(theta) + L(omega), E = J omega^2 / 2. No panel holds a knot of the pressure; one that
an abscissa of a speed table lies in is halved until what it misses is rounding.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from validation.oracles.arithmetic import LONG, Array, Number
from validation.oracles.free_motion import Motion
from validation.oracles.machine import Loads, Machine
from validation.oracles.many_turns import NODES, Turning, antiderivatives

NARROWEST = 1e-6  # of a panel [rad]: of a kink it misses 1e-14
BEYOND = 0.1  # of the range of speeds at a panel's nodes: its ends and turns lie within
SAME = 1e-12  # rad: edges so near are one
CLOSE = 1e-15  # of the energy: the secant's next step is its square
PICARD, SECANT = 200, 60
NUDGE = 1e-6  # of the energy, for a difference


class Settled(NamedTuple):
    """The periodic motion at the wanted angles, and the factor by which a disturbance changes in a
    period."""

    motion: Motion
    factor: float


class _Panels(NamedTuple):
    """Panels in the order in which they are passed: edges, and at the nodes of each inertia and
    torque of gas, gravity and constant loads, shape (panels, NODES)."""

    edges: Array
    inertia: Array
    push: Array


class _Rule(NamedTuple):
    nodes: Array
    weights: Array
    inside: Array


def settled_motion(
    machine: Machine, theta0: Number, omega0: Number, period: Number, offsets: Array
) -> Settled:
    """The periodic motion that the secant method comes to from (theta0, omega0) [rad, rad/s].

    period [rad], a whole number of turns; offsets : shape (n,) [rad], from 0 up to the period, in
    the sense of the rotation, where it is wanted. The loads must not depend on time.

    Raises
    ------
    ArithmeticError : the crank comes to a stop, or nothing converges
    """
    if machine.loads.time_tables or machine.loads.angle_tables:
        raise ValueError("nothing settles under a load that depends on time")
    sense = 1 if omega0 > 0 else -1
    turning, period = Turning(machine), LONG.whole_turns(period)
    wanted = LONG.array(offsets)
    wanted = np.where(abs(wanted - period) < 1e-9, period, wanted)
    start = LONG.number(theta0)
    panels = _panels(turning, start, sense, period, wanted[:0])
    inertia = turning.inertia(LONG.array([theta0]))[0]
    load, speeds = _load(machine.loads), _speeds(machine.loads)

    def after(energy: Number) -> Number:
        return _energies(turning, panels, load, speeds, energy)[0][-1]

    energy = _fixed_point(after, inertia * LONG.number(omega0) ** 2 / 2)
    nudge = NUDGE * energy
    factor = float((after(energy + nudge) - after(energy - nudge)) / (2 * nudge))
    panels = _panels(turning, start, sense, period, wanted)
    energies, times = _energies(turning, panels, load, speeds, energy)
    at = np.searchsorted(sense * (panels.edges - start), wanted - SAME)
    theta, energies, times = panels.edges[at], energies[at], times[at]
    inertias = turning.inertia(theta)
    omega = sense * np.sqrt(2 * energies / inertias)
    alpha = (turning.push(theta, omega) + load(omega)) / inertias
    return Settled(Motion(times, theta, omega, alpha, len(panels.edges)), factor)


def _fixed_point(after: Callable[[Number], Number], energy: Number) -> Number:
    other = energy * (1 + LONG.number(NUDGE))
    gain, gain_there = after(energy) - energy, after(other) - other
    for _ in range(SECANT):
        new = other - gain_there * (other - energy) / (gain_there - gain)
        energy, gain, other = other, gain_there, new if new > 0 else other / 2
        if abs(other - energy) <= CLOSE * other:
            return other
        gain_there = after(other) - other
    raise ArithmeticError("no periodic motion found")


def _panels(turning: Turning, start: Number, sense: int, period: Number, wanted: Array) -> _Panels:
    begin = start if sense > 0 else start - period
    offsets = wanted if sense > 0 else (period - wanted)[::-1]
    edges = turning.edges(begin, offsets, period)
    edges = edges[np.append(np.diff(edges) > SAME, True)]
    edges[0] = begin
    edges = edges if sense > 0 else edges[::-1]
    return _tabulated(turning, edges)


def _tabulated(turning: Turning, edges: Array) -> _Panels:
    half = np.diff(edges)[:, None] / 2
    theta = edges[:-1, None] + half * (1 + _RULE.nodes)
    flat = theta.ravel()
    inertia, push = turning.inertia(flat), turning.push(flat, 0 * flat)
    return _Panels(edges, inertia.reshape(theta.shape), push.reshape(theta.shape))


def _energies(
    turning: Turning,
    panels: _Panels,
    load: Callable[[Array], Array],
    speeds: Array,
    energy: Number,
) -> tuple[Array, Array]:
    """Energy and time at the edges."""
    energies, times = [energy], [0 * energy]
    for k, half in enumerate(np.diff(panels.edges) / 2):
        inertia, push = panels.inertia[k], panels.push[k]
        inside = energy + 0 * inertia
        for _ in range(PICARD):
            if not (inside > 0).all():
                raise ArithmeticError("the crank comes to a stop")
            omega = np.copysign(np.sqrt(2 * inside / inertia), half)
            torque = push + load(omega)
            before, inside = inside, energy + half * (_RULE.inside @ torque)
            if (abs(inside - before) <= 8 * LONG.epsilon * inside).all():
                break
        after, spent = energy + half * (_RULE.weights @ torque), half * (_RULE.weights / omega)
        margin = BEYOND * (omega.max() - omega.min())
        near = (speeds > omega.min() - margin) & (speeds < omega.max() + margin)
        if 2 * abs(half) > NARROWEST and near.any():
            begin, end = panels.edges[k : k + 2]
            halves = _tabulated(turning, np.array([begin, (begin + end) / 2, end]))
            found, passed = _energies(turning, halves, load, speeds, energy)
            energy, spent = found[-1], passed[-1:]
        else:
            energy = after
        energies.append(energy)
        times.append(times[-1] + spent.sum())
    return np.array(energies), np.array(times)


def _load(loads: Loads) -> Callable[[Array], Array]:
    """What loads give at speeds, but for the constant one, which is in the push."""
    viscous, quadratic = LONG.number(loads.viscous), LONG.number(loads.quadratic)
    tables = [(LONG.array(t.abscissae), LONG.array(t.torques)) for t in loads.speed_tables]

    def torque(omega: Array) -> Array:
        total = -viscous * omega - quadratic * omega * abs(omega)
        for x, y in tables:
            k = np.clip(np.searchsorted(x, omega), 1, len(x) - 1)
            share = (np.clip(omega, x[0], x[-1]) - x[k - 1]) / (x[k] - x[k - 1])
            total = total + y[k - 1] + share * (y[k] - y[k - 1])
        return np.asarray(total)

    return torque


def _speeds(loads: Loads) -> Array:
    return LONG.array([x for table in loads.speed_tables for x in table.abscissae])


def _rule() -> _Rule:
    nodes, weights = (LONG.array(x) for x in legendre.leggauss(NODES))
    inside = LONG.array(antiderivatives().ravel()).reshape(NODES, NODES)
    return _Rule(nodes, weights, inside)


_RULE = _rule()
