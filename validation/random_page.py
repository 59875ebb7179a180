"""Valid scenes that the page can run, or says why not, drawn from a seed: settled motions, motions
from a start under every load, fuel and window, and prescribed ones."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs import Scene
from crankmbs.scene.drives import Motion, Oscillation, Ramp, SpeedFile, Start
from crankmbs.scene.fuel import Fuel, Misfire
from crankmbs.scene.gas import Gas
from crankmbs.scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Friction
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from crankmbs.scene.units import DEGREE
from validation.random_settled import random_settled

__all__ = ["random_page"]

_TURN = 2.0 * math.pi
_RUBS = 0.4  # of the scenes


def random_page(seed: int) -> Scene:
    """The scene of a seed: two of four settle, one starts, in one the speed is prescribed; in two
    of five the pistons rub."""
    rng, base = np.random.default_rng([15, seed]), random_settled(seed)
    base = _rubbing(np.random.default_rng([16, seed]), base)
    if seed % 4 == 2:
        return _started(rng, base)
    if seed % 4 == 3:
        return _driven(rng, base)
    if rng.random() < 0.3:
        return replace(base, torque=(*base.torque, _over_angle(rng, base)))
    return base


def _torque(scene: Scene) -> float:
    """What the loads of a settled scene are worth [N m]."""
    drive = scene.torque[0]
    assert isinstance(drive, Constant)
    return abs(drive.torque) + 1e-3 * _energy(scene)


def _energy(scene: Scene) -> float:
    assert scene.start is not None
    swung = scene.rod.mass * scene.crank.radius**2 + scene.piston.mass * scene.crank.radius**2
    inertia = scene.crank.moment_of_inertia + swung
    return 0.5 * inertia * scene.start.speed**2


def _rubbing(rng: np.random.Generator, base: Scene) -> Scene:
    """Friction of some kinds, each of which takes up to a twentieth of the energy in a cycle."""
    if rng.random() > _RUBS:
        return base
    assert base.start is not None
    share = np.exp(rng.uniform(math.log(1e-4), math.log(0.05), 3)) * (rng.random(3) < 0.7)
    way = 8.0 * base.crank.radius * len(base.cylinders)
    mean = 4.0 * base.crank.radius * abs(base.start.speed) / _TURN
    friction = Friction(
        ring_force=float(share[0]) * _energy(base) / way,
        ring_pressure=float(share[1]) if base.gas is not None else 0.0,
        viscous=float(share[2]) * _energy(base) / (way * mean),
    )
    return replace(base, friction=friction)


def _over_angle(rng: np.random.Generator, scene: Scene) -> AngleTable:
    """A small load over the angle that takes nothing on the whole."""
    rows = int(rng.integers(6, 40))
    span = _TURN * int(rng.integers(1, 3))
    angle = np.linspace(0.0, span, rows, endpoint=False) + rng.uniform(-1.0, 1.0)
    value = rng.uniform(-1.0, 1.0, rows)
    value *= 0.3 * _torque(scene)
    kind = ("linear", "pchip", "cubic")[int(rng.integers(3))]
    table = Table(angle.tolist(), (value - value.mean()).tolist())
    return AngleTable(file=table, interpolation=kind)  # type: ignore[arg-type]


def _started(rng: np.random.Generator, base: Scene) -> Scene:
    """A run over some turns, with loads that set in and end, a table over time, misfires."""
    assert base.start is not None
    speed, turns = base.start.speed, float(rng.uniform(3.0, 12.0))
    duration = turns * _TURN / abs(speed)
    torque, small = list(base.torque), 0.2 * _torque(base)
    torque.append(_kicks(rng, small, duration))
    if rng.random() < 0.5:
        torque.append(_over_angle(rng, base))
    torque.append(_windowed(rng, small, speed, duration))
    every = Extent(value=float(rng.uniform(20.0, 60.0)) * DEGREE, unit="rad")
    run = Run(until=Extent(value=duration, unit="s"), every=every, rtol=1e-10)
    scene = replace(base, torque=tuple(torque), run=run)
    return _fuelled(rng, scene, duration) if rng.random() < 0.4 else scene


def _kicks(rng: np.random.Generator, size: float, duration: float) -> TimeTable:
    """A torque over time with a jump, which outlasts the run."""
    when = duration * np.sort(rng.uniform(0.0, 1.0, 3))
    times = np.concatenate([[0.0], when[[0, 1, 1, 2]], [1.5 * duration]])
    return TimeTable(file=Table(times.tolist(), (size * rng.uniform(-1.0, 1.0, 6)).tolist()))


def _windowed(rng: np.random.Generator, size: float, speed: float, duration: float) -> Torque:
    begin, end = (float(t) for t in duration * np.sort(rng.uniform(0.0, 1.2, 2)))
    kind = int(rng.integers(4))
    if kind == 0:
        return Constant(torque=size, after=begin, until=end)
    if kind == 1:
        return Viscous(coefficient=size / abs(speed), from_speed=float(speed * rng.uniform(0.7, 1)))
    if kind == 2:
        ended = float(speed * rng.uniform(0.6, 1.0))
        return Quadratic(coefficient=size / speed**2, after=begin, until_speed=ended)
    at = (np.sort(rng.uniform(0.3, 1.6, 3)) * speed).tolist()
    rows = (at[0], at[1], at[1], at[2]) if speed > 0.0 else (at[2], at[1], at[1], at[0])
    falling = size * np.sort(rng.uniform(-1.0, 1.0, 4))[::-1]
    return SpeedTable(file=Table(rows, tuple(falling.tolist())), until=end)


def _fuelled(rng: np.random.Generator, scene: Scene, duration: float) -> Scene:
    """Some of its firings miss, and the fuel may come late."""
    gas = scene.gas
    if gas is None:
        return scene
    if gas.indicator is None:
        assert isinstance(gas.pressure, Table)
        # less in all rows, and alike where compression begins: no firing decides on a jump
        gas = replace(gas, motored=gas.pressure.scaled(0.5))
        gas = Gas(**{name: getattr(gas, name) for name in gas.__dataclass_fields__})
    cycles = ("1", "2-3", "every 2")[int(rng.integers(3))]
    number = int(rng.integers(len(scene.cylinders))) + 1
    after = float(duration * rng.uniform(0.0, 0.5)) if rng.random() < 0.5 else 0.0
    misfire = (Misfire(cylinder=number, cycles=cycles),)
    return replace(scene, gas=gas, fuel=Fuel(misfire=misfire, after=after))


def _driven(rng: np.random.Generator, base: Scene) -> Scene:
    """A prescribed speed of every kind."""
    assert isinstance(base.start, Start)
    mean, turns = base.start.speed, float(rng.uniform(2.2, 5.0))
    duration = turns * _TURN / abs(mean)
    kind = int(rng.integers(4))
    speed: float | Oscillation | Ramp | SpeedFile = mean
    if kind == 1:
        swing = abs(mean) * float(rng.uniform(0.0, 0.9))
        order = float(rng.uniform(0.3, 4.0))
        speed = Oscillation(mean=mean, amplitude=swing, order=order, phase=float(rng.uniform(0, 6)))
    elif kind == 2:
        over = duration * float(rng.uniform(0.2, 2.0))
        speed = Ramp(start=mean, to=mean * float(rng.uniform(0.3, 3.0)), over=over)
    elif kind == 3:
        times = np.linspace(0.0, 1.2 * duration, int(rng.integers(3, 9)))
        values = mean * rng.uniform(0.5, 1.5, len(times))
        speed = SpeedFile(file=Table(times.tolist(), values.tolist()))
    run = Run(
        until=Extent(value=0.8 * duration, unit="s"),
        every=Extent(value=float(rng.uniform(10.0, 40.0)) * DEGREE, unit="rad"),
    )
    motion = Motion(speed=speed, angle=base.start.angle)
    return replace(base, start=None, torque=(), motion=motion, run=run)
