"""From a scene to what the oracle of `validation.oracles.changing` takes, in the scene's floats.

A function of Python goes over by the description in smooth pieces that it carries as `pieces`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from crankmbs.scene.force import PistonForce
from crankmbs.scene.forces import (
    ConstantForce,
    Damper,
    ForceAngleTable,
    ForceTimeTable,
    Spring,
    TravelTable,
)
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.gas import Gas, Polytrope
from crankmbs.scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.python_force import Force
from crankmbs.scene.python_load import Load
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from crankmbs.scene.windowed import Windowed
from validation.adapter import machine_of
from validation.oracles.changes import (
    Changes,
    Curve,
    Firings,
    Line,
    Pull,
    Push,
    continued,
    curve_of,
    line_through,
)
from validation.oracles.firings import Governor
from validation.rows import turns_of

__all__ = ["changes_of"]


def changes_of(scene: Scene) -> Changes:
    """The machine of a scene with a free crank, and all that it meets on its way."""
    machine, rings = machine_of(scene), scene.friction
    gas, fuel = scene.gas, scene.fuel
    fired = tuple(curve_of(pressure) for pressure in machine.pressures)
    firings = _firings(scene, gas, fuel, fired) if gas and fuel else None
    return Changes(
        machine,
        tuple(replace(_always(load), **_window(load)) for load in scene.torque),
        fired,
        firings,
        gas.period if gas else 4.0 * math.pi,
        (rings.ring_force, rings.ring_pressure, rings.viscous) if rings else None,
        tuple(curve_of(pressure) for pressure in machine.crank_ends),
        tuple(_push(force) for force in scene.force),
    )


def _firings(scene: Scene, gas: Gas, fuel: Fuel, fired: tuple[Curve, ...]) -> Firings:
    given, law = gas.motored, fuel.governor
    governor = None
    if law is not None:
        governor = Governor(law.speed, law.kp, law.ki, law.min, law.max, law.initial)
    if isinstance(given, Polytrope):
        numbers = given.polytrope, given.closes, given.compression_ratio, gas.ambient or 0.0
        machine = machine_of(scene)
        motored = tuple(
            continued(machine.of(k), each, gas.period, numbers) for k, each in enumerate(fired)
        )
    elif isinstance(given, float):
        level = given - (gas.ambient or 0.0)
        motored = (Curve((0.0,), (lambda x: level,), gas.period),) * len(fired)
    else:
        assert given is not None
        cold = machine_of(replace(scene, gas=replace(gas, pressure=given, motored=None), fuel=None))
        motored = tuple(curve_of(pressure) for pressure in cold.pressures)
    until = math.inf if fuel.until is None else fuel.until
    return Firings(
        motored,
        partial(_part, fuel),
        governor,
        fuel.after,
        until,
        fuel.from_speed,
        fuel.until_speed,
    )


def _part(fuel: Fuel, cylinder: int, cycle: int) -> float:
    """What misfires and scatter leave of a share, by the letter of the rule."""
    for one in fuel.misfire or ():
        first, _, last = one.cycles.removeprefix("every ").partition("-")
        struck = int(first) <= cycle <= int(last or first)
        if one.cycles.startswith("every "):
            struck = cycle % int(first) == 0
        if one.cylinder == cylinder and struck:
            return 0.0
    z = float(np.random.default_rng((fuel.seed, cylinder, cycle)).standard_normal())
    return max(0.0, 1.0 + fuel.scatter * z)


def _window(load: Windowed) -> dict[str, Any]:
    return {
        "after": load.after or 0.0,
        "until": math.inf if load.until is None else load.until,
        "from_speed": load.from_speed,
        "until_speed": load.until_speed,
    }


def _push(force: PistonForce) -> Push:
    cylinder = None if force.cylinder is None else force.cylinder - 1
    return replace(_pushes(force), cylinder=cylinder, **_window(force))


def _pushes(force: PistonForce) -> Push:
    match force:
        case ConstantForce():
            given = force.force
            return Push(smooth=lambda t, angle, s, v: given)
        case Spring():
            k, s_0 = force.stiffness, force.relaxed_at
            return Push(smooth=lambda t, angle, s, v: -k * (s - s_0))
        case Damper():
            c = force.coefficient
            return Push(smooth=lambda t, angle, s, v: -c * v)
        case TravelTable():
            ways = (force.file,) if isinstance(force.file, Table) else force.file.tables
            lines = [line_through(way.x, way.y, held=True) for way in ways]
            return Push(forward=lines[0], back=lines[-1])
        case ForceAngleTable():
            rows = AngleTable(file=force.file, interpolation=force.interpolation)
            return Push(over_angle=curve_of(turns_of(rows)))
        case ForceTimeTable():
            return Push(over_time=line_through(force.file.x, force.file.y, held=False))
        case Force():
            pieces: Push = force.function.pieces
            return pieces
        case _:
            raise TypeError(f"no oracle for {force.kind}")


def _always(load: Torque) -> Pull:
    match load:
        case Constant():
            torque = load.torque
            return Pull(smooth=lambda t, theta, omega: torque)
        case Viscous():
            c = load.coefficient
            return Pull(smooth=lambda t, theta, omega: -c * omega)
        case Quadratic():
            c = load.coefficient
            return Pull(over_speed=Line((0.0,), (lambda w: c * w * w, lambda w: -c * w * w)))
        case TimeTable():
            return Pull(over_time=line_through(load.file.x, load.file.y, held=False))
        case SpeedTable():
            return Pull(over_speed=line_through(load.file.x, load.file.y, held=True))
        case AngleTable():
            return Pull(over_angle=curve_of(turns_of(load)))
        case Load():
            pieces: Pull = load.function.pieces
            return pieces
        case _:
            raise TypeError(f"no oracle for {load.kind}")
