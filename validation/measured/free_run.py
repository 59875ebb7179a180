"""The free crank under the pressures of a record: crankmbs' own run, from tooth to tooth."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from crankmbs import Constant, Crank, Extent, Gas, Piston, Rod, Run, Scene, Start, Table, simulate
from validation.measured.logged import Array, Logged

__all__ = ["Engine", "FreeRun", "Unknown", "free_run"]

_STEP = 1.0  # degrees, of the pressure's table
_AMBIENT = 1e5  # Pa, in the crankcase: it has no half orders
_SAMPLE = 2.0  # degrees: the time between is a cubic's to a nanosecond
_ROUNDS = 12
_CLOSE = 1e-7  # s, of the times at which cycles end: a tenth of what an edge is known to


class Engine(NamedTuple):
    """Lengths [m]; masses [kg], the rod's as two masses, whose share stays out of half orders."""

    bore: float
    stroke: float
    rod_length: float
    piston_mass: float
    rod_mass: float

    @property
    def swept(self) -> float:
        """Swept volume [m^3]."""
        return 0.25 * math.pi * self.bore**2 * self.stroke


class Unknown(NamedTuple):
    """What the record does not say.

    inertia : of crank and rotor [kg m^2]; dead_centre : wheel angle [deg] of the dead centres,
        modulo 360; delay : of the sensor [s]; offset : of the sensor [Pa]
    """

    inertia: float
    dead_centre: float
    delay: float
    offset: float = 0.0


class FreeRun(NamedTuple):
    """A solved run.

    times : of the edges [s] from the first one, as `Logged.edge_times` has them
    load : the constant torque against the crank [N m]; speed : at the first edge [rad/s]
    work : of the gas, over all cycles [J]
    """

    times: Array
    load: float
    speed: float
    work: float


def free_run(
    logged: Logged,
    engine: Engine,
    unknown: Unknown,
    first: int,
    count: int,
    guess: FreeRun | None = None,
) -> FreeRun:
    """Cycles ``first`` to ``first + count - 1`` as a free run under a constant load.

    Load and initial speed are those with which, in least squares, the cycles end when the record's
    do: the balance of energy. Nothing else of the wheel enters.
    """
    ends = logged.edge_times(first, count)[:: 2 * logged.edges]
    ends = ends[1:] - ends[0]
    turned = 4.0 * math.pi * np.arange(1.0, count + 1.0)
    speed, load = turned[-1] / ends[-1], 0.0
    if guess is not None:
        speed, load = guess.speed, guess.load
    slopes = np.column_stack([-turned / speed**2, turned**2 / (2.0 * unknown.inertia * speed**3)])
    scene = _scene(logged, engine, unknown, first, count)
    for _ in range(_ROUNDS):
        times, gain = _solved(scene, logged, speed, load)
        change, *_ = np.linalg.lstsq(slopes, ends - times[2 * logged.edges :: 2 * logged.edges])
        if np.max(np.abs(slopes @ change)) < _CLOSE:
            return FreeRun(times, load, speed, gain + load * turned[-1])
        speed, load = speed + change[0], load + change[1]
    raise ValueError(f"{logged.name}: no constant load has its cycles end when they do")


def _scene(logged: Logged, engine: Engine, unknown: Unknown, first: int, count: int) -> Scene:
    """From the first edge of the first cycle on; cycle angle 360 degrees is the firing dead centre,
    which lies in a cycle's second revolution."""
    firing = 360.0 + unknown.dead_centre % 360.0
    begin = (360.0 - firing) % 720.0
    angle = np.arange(0.0, 720.0 * (count + 1), _STEP)
    wheel = logged.begin + 720.0 * first + angle - begin
    pressure = logged.pressures(wheel, unknown.delay) - unknown.offset - _AMBIENT
    table = Table(tuple(np.radians(angle).tolist()), tuple(pressure.tolist()), "measured")
    return Scene(
        crank=Crank(radius=0.5 * engine.stroke, inertia=unknown.inertia),
        rod=Rod(
            length=engine.rod_length,
            mass=engine.rod_mass,
            center_of_mass=engine.rod_length / 3.0,
            inertia="two-mass",
        ),
        piston=Piston(mass=engine.piston_mass, bore=engine.bore),
        gas=Gas(pressure=table, absolute=False, cycles="sequence"),
        start=Start(angle=math.radians(begin), speed=300.0),
        torque=(Constant(torque=0.0),),
        run=Run(
            until=Extent(value=4.0 * math.pi * count, unit="rad"),
            every=Extent(value=math.radians(_SAMPLE), unit="rad"),
            formulation="crank_angle",
        ),
    )


def _solved(scene: Scene, logged: Logged, speed: float, load: float) -> tuple[Array, float]:
    """Times of the edges [s], and the gain of kinetic energy [J]."""
    assert scene.start is not None
    start = Start(angle=scene.start.angle, speed=speed)
    result = simulate(scene.with_(start=start, torque=(Constant(torque=-load),)))
    if result.status != 0:
        raise ValueError(f"{logged.name}: {result.message}")
    time, energy = (np.asarray(result.data[name].values) for name in ("time", "kinetic_energy"))
    turned = _SAMPLE * np.arange(len(time))
    passed = CubicSpline(turned, time)(logged.edge_angles(0, round(turned[-1] / 720.0)))
    return np.asarray(passed), float(energy[-1] - energy[0])
