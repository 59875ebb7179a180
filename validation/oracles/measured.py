"""Cylinder pressures as a transducer sees them, of a cycle known to the last digit, and its faults.

A closed cycle by the first law with Newtonian heat loss, dp = -gamma p dV / V + (gamma - 1) (dQ -
h A (T - T_w) dphi) / V, burning by Wiebe's law or not, by Runge and Kutta's fourth order in
steps of 0.02 degrees; intake and exhaust at constant pressures, joined smoothly. What a measurement
adds is put in by who calls: a dead centre that is off, an offset from cycle to cycle, noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Engine", "loss_angle", "mean_effective_pressure", "pressure_of"]

Array = NDArray[np.float64]
_STEP = 0.02  # degrees
_GAMMA = 1.37


@dataclass(frozen=True)
class Engine:
    """A cylinder and its cycle: stroke and rod length over the crank radius, pressures in bar.

    heat : released by the combustion, over p_in V_d [1], 0 for a motored cycle; loss : of heat,
        over p_in V_d, per radian and temperature of the inlet
    """

    radius: float = 46.0
    rod_length: float = 153.3333
    ratio: float = 18.0
    inlet: float = 1.02
    exhaust: float = 1.12
    heat: float = 0.0
    burns: float = -4.0
    lasts: float = 55.0
    loss: float = 0.1


def relative_volume(engine: Engine, phi: Array) -> Array:
    """V / V_clearance at angles [deg] from the dead centre."""
    angle = np.radians(phi)
    r, l = engine.radius, engine.rod_length
    x = r * np.cos(angle) + np.sqrt(l**2 - (r * np.sin(angle)) ** 2)
    return 1.0 + (engine.ratio - 1.0) * (r + l - x) / (2.0 * r)


def pressure_of(engine: Engine, phi: Array) -> Array:
    """Absolute pressure [bar] at angles [deg] from the firing dead centre, modulo 720."""
    angle, pressure = _cycle(engine)
    return np.interp(np.mod(phi + 360.0, 720.0) - 360.0, angle, pressure)


def loss_angle(engine: Engine) -> float:
    """By how much [deg] the peak comes before the dead centre."""
    angle, pressure = _cycle(engine)
    k = int(np.argmax(pressure))
    a, b, c = pressure[k - 1 : k + 2]
    return -float(angle[k] + _STEP * 0.5 * (a - c) / (a - 2.0 * b + c))


def mean_effective_pressure(engine: Engine) -> float:
    """Net indicated mean effective pressure [bar], by Stieltjes sums of the fine cycle."""
    angle, pressure = _cycle(engine)
    volume = relative_volume(engine, angle) / (engine.ratio - 1.0)
    return float(np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)))


def _cycle(engine: Engine) -> tuple[Array, Array]:
    key = engine
    if key not in _KNOWN:
        _KNOWN[key] = _made(engine)
    return _KNOWN[key]


_KNOWN: dict[Engine, tuple[Array, Array]] = {}


def _made(engine: Engine) -> tuple[Array, Array]:
    count = round(300.0 / _STEP)
    pressure = np.empty(count + 1)
    p = pressure[0] = (
        engine.inlet
        * float(
            relative_volume(engine, np.array(-180.0)) / relative_volume(engine, np.array(-170.0))
        )
        ** 1.3
    )
    at = float(p * relative_volume(engine, np.array(-170.0)))
    fine: Array = -170.0 + 0.5 * _STEP * np.arange(2 * count + 1, dtype=np.float64)
    volume = relative_volume(engine, fine)
    volume_1 = np.gradient(volume, np.radians(fine), edge_order=2)
    x = np.clip((fine - engine.burns) / engine.lasts, 0.0, None)
    burnt = 6.9 * 2.0 / np.radians(engine.lasts) * x * np.exp(-6.9 * x**2)
    released = engine.heat * engine.inlet * (engine.ratio - 1.0) * burnt * (_GAMMA - 1.0)
    surface = 1.0 + 0.35 * (volume - 1.0) / (engine.ratio - 1.0)
    h = np.radians(_STEP)

    def slope(k: int, p: float) -> float:
        heat = engine.loss * engine.inlet * (engine.ratio - 1.0) * surface[k]
        warmer = p * volume[k] / at - 1.2
        lost = heat * (_GAMMA - 1.0) * warmer * (p / engine.inlet) ** 0.5
        return float((-_GAMMA * p * volume_1[k] + released[k] - lost) / volume[k])

    for k in range(count):
        a = slope(2 * k, p)
        b = slope(2 * k + 1, p + 0.5 * h * a)
        c = slope(2 * k + 1, p + 0.5 * h * b)
        d = slope(2 * k + 2, p + h * c)
        p += h * (a + 2.0 * b + 2.0 * c + d) / 6.0
        pressure[k + 1] = p
    angle = -360.0 + _STEP * np.arange(round(720.0 / _STEP) + 1)
    begins, ends = round(190.0 / _STEP), round(490.0 / _STEP)
    whole = np.empty_like(angle)
    whole[begins : ends + 1] = pressure
    before = np.clip((angle[:begins] + 350.0) / 20.0, 0.0, 1.0)
    ease = before**2 * (3.0 - 2.0 * before)
    low = engine.exhaust + (engine.inlet - engine.exhaust) * ease
    towards = np.clip((angle[:begins] + 190.0) / 20.0, 0.0, 1.0) ** 2
    whole[:begins] = low + (pressure[0] - engine.inlet) * towards
    out = np.exp(-((angle[ends + 1 :] - 130.0) / 18.0))
    whole[ends + 1 :] = engine.exhaust + (pressure[-1] - engine.exhaust) * out
    return np.asarray(angle, dtype=np.float64), whole
