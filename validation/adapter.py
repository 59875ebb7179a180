"""From a scene to the oracles' machine, in the very floats of the scene, and back to its names.

The oracles share nothing with crankmbs: rows of a table go over as the scene stores them, and the
oracle interpolates them anew. Only an indicator diagram goes over as crankmbs' own cubic pieces;
those are held against the polytropes in a claim of their own.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.pressure import crank_ends_of as crank_ends_at
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.motion.plan import plan_of
from crankmbs.result import Result
from crankmbs.scene.drives import Motion as Prescribed
from crankmbs.scene.drives import Oscillation, Ramp, SpeedFile
from crankmbs.scene.parts import Piston, RunningGear
from crankmbs.scene.scene import Scene
from validation.oracles.arithmetic import LONG, Arithmetic, Array
from validation.oracles.energy import kinetic_energy
from validation.oracles.frame import frame_loads
from validation.oracles.free_motion import Motion, series_path
from validation.oracles.indicator import Diagram
from validation.oracles.loads import torque_at
from validation.oracles.machine import Machine, PressureTable
from validation.oracles.newton_euler import newton_euler
from validation.oracles.path import Path
from validation.oracles.prescribed import (
    motion_over_angle,
    oscillating_motion,
    pchip,
    polynomial_motion,
    spline,
)
from validation.oracles.pressure import pressure_pieces
from validation.rows import SAME_ANGLE, crank_ends_of, loads_of, pressure_of

__all__ = [
    "at_jumps",
    "diagram_of",
    "load_torque",
    "machine_of",
    "reference_motion",
    "reference_variables",
]

_TOWARDS_CRANK = ("piston_velocity", "piston_acceleration")  # the oracle's point away from it
_SLIGHT = 0.1  # so much of the speed at most may change on the way to a sample's angle
_SAME_PRESSURE = 1e-9


def machine_of(scene: Scene) -> Machine:
    """The machine of a scene, with the loads of its free crank."""
    gears = [RunningGear(scene.crank.radius, scene.rod, scene.piston)]
    gears += scene.running_gear if scene.unlike else ()
    common, *each = (_machine(scene, gear) for gear in gears)
    return replace(common, each=tuple(each))


def _machine(scene: Scene, gear: RunningGear) -> Machine:
    """With one throw, rod and piston for all cylinders."""
    crank, (radius, rod, piston) = scene.crank, gear
    gx = gy = 0.0
    if scene.gravity is not None:
        gx = scene.gravity.acceleration * math.cos(scene.gravity.angle)
        gy = scene.gravity.acceleration * math.sin(scene.gravity.angle)
    return Machine(
        crank_radius=radius,
        crank_inertia=crank.moment_of_inertia,
        crank_mass=crank.mass,
        crank_center_of_mass=crank.center_of_mass,
        rod_length=rod.length,
        rod_mass=rod.mass,
        rod_center_of_mass=rod.center_of_mass,
        rod_inertia=rod.moment_of_inertia,
        piston_mass=piston.mass,
        piston_area=piston.gas_area or 0.0,
        offset=piston.offset,
        cylinders=tuple((c.phase, c.bank) for c in scene.cylinders),
        levers=scene.levers or (),
        pressure=pressure_of(scene),
        gravity=(gx, gy),
        loads=loads_of(scene.torque),
        crank_ends=crank_ends_of(scene),
        crank_end_area=_crank_end_area(scene, piston),
    )


def _crank_end_area(scene: Scene, piston: Piston) -> float:
    if not scene.double_acting:
        return 0.0
    area, rod = piston.gas_area or 0.0, piston.rod_diameter or 0.0
    return area - math.pi / 4.0 * rod**2


def reference_motion(
    result: Result,
    scene: Scene | None = None,
    arithmetic: Arithmetic = LONG,
    path: Path | None = None,
) -> Motion:
    """The oracle's motion at the samples of a result, of its own scene or of a given one.

    Samples that lie on crank angles are compared at equal angles: a free motion is looked up at
    the result's times and once more at those moved by the angle that is still missing; where it
    turns beside the angle, at equal times.

    path : of the free crank, where it is known already
    """
    scene = scene or result.scene
    if scene.motion is not None:
        return _prescribed(result, scene.motion)
    times = arithmetic.array(result.data["time"].values)
    path = path or _path(scene, arithmetic)
    if times[-1] == 0:
        return _first(path.at_times(arithmetic.array([0, 2.0**-60])))
    motion = path.at_times(times)
    missing = arithmetic.array(result.data["crank_angle"].values) - motion.theta
    turning = abs(motion.alpha * missing) >= _SLIGHT * motion.omega**2  # it may not reach the angle
    moving = _on_angles(result, scene) & ~turning.astype(bool)
    if moving.any():
        omega, alpha = motion.omega[moving], motion.alpha[moving]
        late = missing[moving] / omega
        late = late - alpha * late * late / (2 * omega)  # to second order: once is enough
        times[moving] = times[moving] + late
        motion = path.at_times(times)
    return motion


@lru_cache(maxsize=1)  # formulations are held against it one after the other
def _path(scene: Scene, arithmetic: Arithmetic) -> Path:
    """Of a free crank, from the start of a scene."""
    assert scene.start is not None
    machine, start = machine_of(scene), scene.start
    return series_path(machine, start.angle, start.speed, arithmetic=arithmetic)


def _on_angles(result: Result, scene: Scene) -> NDArray[np.bool_]:
    """Which samples lie on crank angles: those of a grid of angles, and an end in angle or at a
    fold."""
    time, theta = (result.data[name].values for name in ("time", "crank_angle"))
    if scene.run.every is None:
        return np.zeros(len(time), dtype=bool)
    plan = plan_of(scene)
    on = (time > 0.0) & (not plan.in_time)
    last = time[-1] if plan.in_time else theta[-1] - plan.start
    if not plan.is_end(round(last / plan.every) * plan.every, last):  # the end, off the grid
        reached = result.status == 0 and not plan.until_time
        on[-1] = reached or plan.folds_at(theta[-1])
    return on


def reference_variables(
    scene: Scene, theta: Array, omega: Array, alpha: Array, arithmetic: Arithmetic = LONG
) -> dict[str, Array]:
    """Every force and every motion of the parts at a given motion, named and signed as in a result.

    theta [rad], omega [rad/s], alpha [rad/s2] : shape (n,). Returns shape (n,) or (n, cylinders).
    """
    machine = machine_of(scene)
    reactions = newton_euler(machine, theta, omega, alpha, arithmetic)
    variables = dict(vars(reactions))
    if not scene.double_acting:
        del variables["crank_end_pressure"]
    for name in _TOWARDS_CRANK:
        variables[name] = -variables[name]
    variables |= frame_loads(machine, theta, omega, alpha, arithmetic)
    variables["kinetic_energy"] = kinetic_energy(machine, theta, omega, arithmetic)
    return variables


def load_torque(scene: Scene, motion: Motion, arithmetic: Arithmetic = LONG) -> Array:
    """The torque of all loads on a free crank. Inverse dynamics give it too, but with a heavy
    flywheel or near a fold as the small difference of large numbers."""
    loads = loads_of(scene.torque)
    return torque_at(loads, motion.time, motion.theta, motion.omega, arithmetic)


def diagram_of(scene: Scene) -> Diagram:
    """The indicator diagram of a scene, for its oracle."""
    assert scene.gas is not None
    given = scene.gas.indicator
    assert given is not None
    return Diagram(
        crank_radius=scene.crank.radius,
        rod_length=scene.rod.length,
        offset=scene.piston.offset,
        compression_ratio=given.compression_ratio,
        n_compression=given.n_compression,
        n_expansion=given.n_expansion,
        intake=given.intake_pressure,
        peak=given.peak_pressure,
        exhaust=given.exhaust_pressure if scene.gas.stroke == 4 else None,
        pre_expansion=given.pre_expansion,
    )


def at_jumps(scene: Scene, theta: Array) -> NDArray[np.bool_]:
    """Which crank angles lie on a jump of a cylinder's pressure or of a load: there two values are
    right."""
    on = np.zeros(len(theta), dtype=bool)
    for load in scene.torque:
        if load.parts.over_angle is not None:
            beside = SAME_ANGLE * np.array([[-3.0], [3.0]])
            below, above = load.parts.over_angle(np.asarray(theta, dtype=np.float64) + beside)
            on |= np.abs(above - below) > 1e-6 * load.parts.over_angle.largest
    ends = (pressures_of(scene) or (), crank_ends_at(scene) or ())
    pairs = [pair for end in ends for pair in zip(scene.cylinders, end, strict=False)]
    for cylinder, pressure in pairs:
        width = np.diff(pressure.knots)
        before = np.roll(pressure.piece(np.arange(len(width)), width), 1)
        after = pressure.coefficients[-1]
        jumps = np.abs(after - before) > _SAME_PRESSURE * np.abs(after).max()
        for knot in pressure.knots[:-1][jumps]:
            beside = (np.asarray(theta, dtype=np.float64) + cylinder.phase - knot) % pressure.period
            on |= np.minimum(beside, pressure.period - beside) < SAME_ANGLE
    return on


def _prescribed(result: Result, motion: Prescribed) -> Motion:
    """At the result's angles; of a ramp or a table over time, at its times."""
    angles, speed = result.data["crank_angle"].values, motion.speed
    match speed:
        case Oscillation():
            law = (speed.mean, speed.amplitude, speed.order, speed.phase)
            return oscillating_motion(angles, *law)
        case Ramp():
            breaks: tuple[float, ...] = (0.0, speed.over)
            rise = (LONG.number(speed.to) - speed.start) / LONG.number(speed.over)
            pieces = [LONG.array([speed.start, rise]), LONG.array([speed.to])]
        case SpeedFile(kind="angle_table"):
            return _over_angle(angles, speed)
        case SpeedFile():
            between = spline if speed.interpolation == "cubic" else pchip
            breaks, pieces = speed.file.x[:-1], between(speed.file.x, speed.file.y)
        case _:
            breaks, pieces = (0.0,), [LONG.array([speed])]
    return polynomial_motion(result.data["time"].values, breaks, pieces, motion.angle)


def _over_angle(angles: NDArray[np.float64], speed: SpeedFile) -> Motion:
    """Rows that span whole turns and close within 1 % of their range repeat, the last one left
    out."""
    x, y = speed.file.x, speed.file.y
    turns = round((x[-1] - x[0]) / (2.0 * math.pi))
    whole = turns in (1, 2) and abs(x[-1] - x[0] - 2.0 * math.pi * turns) < SAME_ANGLE
    if whole and abs(y[-1] - y[0]) <= 0.01 * (max(y) - min(y)):
        period = 2.0 * math.pi * turns
        cycle = pressure_pieces(PressureTable(x[:-1], y[:-1], period, speed.interpolation))
        return motion_over_angle(angles, cycle.knots, list(cycle.coefficients), period)
    between = spline if speed.interpolation == "cubic" else pchip
    return motion_over_angle(angles, x[:-1], between(x, y))


def _first(motion: Motion) -> Motion:
    """The first sample alone."""
    return Motion(
        motion.time[:1], motion.theta[:1], motion.omega[:1], motion.alpha[:1], motion.steps
    )
