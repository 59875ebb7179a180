"""What must hold between the parts of a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from crankmbs.errors import InputError
from crankmbs.scene.cycles import SAME_ANGLE
from crankmbs.scene.drives import Oscillation, Ramp, SpeedFile
from crankmbs.scene.force import PistonForce
from crankmbs.scene.forces import TravelTable
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.parts import RunningGear
from crankmbs.scene.speed_rows import repeats
from crankmbs.scene.tables import CylinderTable, Table, tables_of
from crankmbs.scene.torque import Torque
from crankmbs.scene.units import DEGREE, EXAMPLES

if TYPE_CHECKING:
    from crankmbs.scene.scene import Scene

__all__ = ["MOTION_OR_START", "NO_INERTIA", "OPEN_LOOP", "UNCOVERED", "check_whole"]

OPEN_LOOP = (
    "rod.length must be at least crank.radius + |piston.offset| = {least:.12g} m, or the crank "
    "cannot turn; {came:.12g} m came"
)
NO_INERTIA = (
    "crank.inertia: a free crank needs an inertia above 0, or nothing resists it at the dead "
    "centres; 0 came"
)
MOTION_OR_START = (
    "give [motion] (the speed is prescribed) or [start] (the crank is free), exactly one of the two"
)
UNCOVERED = (
    "the rows must cover the stroke, 0 to {stroke:.6g} mm; they go from {low:.6g} to {high:.6g} mm"
)

_SPARE = 1e-3  # of the stroke, over which the ends of a table over the travel are held
_LARGE_RADIUS = 2.5  # m: no machine has a longer stroke than 5 m
_FARTHEST = 1e9  # rad or s: its last digit is 1e-7
_MOST_CYCLES = 1000  # of the engine, after which its loads over the angle come again
_MOST_SAMPLES = 2e7  # the memory of a machine may hold less: `crankmbs.motion.plan`


def check_whole(scene: Scene) -> None:
    """Refuse parts that each may be, but not together.

    Raises
    ------
    InputError : the rule, what came and the way out
    """
    for check in (
        _check_loop,
        _check_gas,
        _check_friction,
        _check_forces,
        _check_bearings,
        _check_motion,
        _check_periods,
        _check_settled,
        _check_tables,
        _check_size,
    ):
        check(scene)


def _passing(load: Torque | PistonForce) -> str:
    """What in a load happens once or depends on time, so that nothing settles under it, if any."""
    if load.has_window:
        return f"a {load.kind} with a window acts once"
    if load.is_steady:
        return ""
    way_out = "; where it does not, say so by its period" if load.kind == "function" else ""
    return f"a {load.kind} depends on time{way_out}"


def _uneven(fuel: Fuel) -> str:
    """What in the fuel happens once or at random, so that nothing settles with it, if any."""
    if fuel.scatter > 0.0:
        return "scatter makes every share another"
    if fuel.after > 0.0 or (fuel.until, fuel.from_speed, fuel.until_speed) != (None, None, None):
        return "a window acts once"
    if any(misfire.every is None for misfire in fuel.misfire or ()):
        return "a listed misfire happens once"
    return ""


def _check_loop(scene: Scene) -> None:
    """Refuse cylinders whose crank cannot turn, or whose gas has nothing to press on."""
    for number, cylinder in enumerate(scene.cylinders, start=1):
        special = (cylinder.radius, cylinder.rod, cylinder.piston) != (None, None, None)
        prefix = f"layout.cylinders[{number}]: " if special else ""
        try:
            gear = cylinder.running_gear(scene.crank.radius, scene.rod, scene.piston)
            _check_gear(gear, gas=scene.gas is not None)
        except InputError as error:
            raise InputError(f"{prefix}{error}") from None


def _check_gear(gear: RunningGear, *, gas: bool) -> None:
    radius, rod, piston = gear
    least = radius + abs(piston.offset)
    if rod.length < least * (1.0 - 1e-15):
        in_metres = ""
        if radius > _LARGE_RADIUS and least - radius + 1e-3 * radius <= rod.length:
            in_metres = f'; a bare number is in metres, give "{radius:g} mm" where that is meant'
        raise InputError(OPEN_LOOP.format(least=least, came=rod.length) + in_metres)
    if rod.moment_of_inertia < 0.0:  # after its length, which may be what is wrong
        raise InputError(
            'rod: two masses at its pins, by inertia = "two-mass" and in the lectures, need a '
            f"center_of_mass between the pins, 0 to {rod.length:.6g} m; {rod.center_of_mass:.6g} m "
            "came"
        )
    if gas and piston.gas_area is None:
        raise InputError(
            "piston.bore: with [gas] the piston needs its bore, or its area; neither came"
        )


def _check_gas(scene: Scene) -> None:
    """Refuse as many pressures as there are not cylinders, and fuel that cannot burn."""
    gas, cylinders = scene.gas, len(scene.cylinders)
    for key in ("pressure", "motored", "crank_end"):
        source = gas and getattr(gas, key)
        if isinstance(source, CylinderTable | tuple):
            count = len(tables_of(source))
            kind = "columns" if isinstance(source, CylinderTable) else "files"
            if count != cylinders:
                raise InputError(
                    f"gas.{key}: as many {kind} as cylinders are needed, {cylinders}, or one "
                    f"for all; {count} came"
                )
    if scene.fuel is None:
        return
    if gas is None:
        raise InputError("fuel: without [gas] nothing burns; add [gas], or remove [fuel]")
    if gas.indicator is None and gas.motored is None:
        raise InputError(
            "gas.motored: with [fuel] the pressure without combustion is needed, of which a "
            'firing takes its share; give motored = "motored.csv", or an indicator'
        )
    if scene.motion is not None and scene.fuel.governor is not None:
        raise InputError(
            "fuel.governor: with [motion] the speed is prescribed, and there is nothing to "
            "govern; remove the governor, or free the crank with [start]"
        )
    for number, misfire in enumerate(scene.fuel.misfire or (), start=1):
        if misfire.cylinder > cylinders:
            raise InputError(
                f"fuel.misfire[{number}].cylinder: must be from 1 to {cylinders}; "
                f"{misfire.cylinder} came"
            )


def _check_friction(scene: Scene) -> None:
    if scene.gas is None and scene.friction is not None and scene.friction.ring_pressure > 0.0:
        raise InputError(
            "friction.ring_pressure: without [gas] there is no gas force to press the rings; "
            f"leave it out, or add [gas]; {scene.friction.ring_pressure:g} came"
        )


def _check_forces(scene: Scene) -> None:
    """Refuse forces on pistons that are not there, over a travel that is left, and windows of speed
    where the speed is prescribed."""
    for number, force in enumerate(scene.force, start=1):
        key = f"force[{number}]"
        if force.cylinder is not None and force.cylinder > len(scene.cylinders):
            raise InputError(
                f"{key}.cylinder: must be from 1 to {len(scene.cylinders)}; {force.cylinder} came"
            )
        if scene.motion is not None and (force.from_speed, force.until_speed) != (None, None):
            raise InputError(
                f"{key}: with [motion] the speed is prescribed, and a window is one of time; "
                "give after and until, or free the crank with [start]"
            )
        if isinstance(force, TravelTable):
            low, high = 1e3 * force.file.x[0], 1e3 * force.file.x[-1]
            on = scene.running_gear
            on = on if force.cylinder is None else on[force.cylinder - 1 : force.cylinder]
            stroke = max(gear.stroke for gear in on)
            spare = _SPARE * stroke
            if force.file.x[0] > spare or force.file.x[-1] < stroke - spare:
                said = UNCOVERED.format(stroke=1e3 * stroke, low=low, high=high)
                raise InputError(f"{key}.file: {force.file.source}: {said}")


def _check_bearings(scene: Scene) -> None:
    _ = scene.throws


def _check_motion(scene: Scene) -> None:
    if (scene.motion is None) == (scene.start is None):
        came = "neither" if scene.motion is None else "both"
        raise InputError(f"{MOTION_OR_START}; {came} came")
    if scene.motion is not None and scene.torque:
        raise InputError(
            "torque: with [motion] the drive is an answer, not a load; remove [[torque]], or "
            "free the crank with [start]"
        )
    if scene.motion is not None and scene.motion.speed == 0.0 and not scene.end[1]:
        raise InputError("motion.speed: at speed 0 no angle is ever reached; until must be a time")
    rod_turns = any(
        rod.moment_of_inertia > 0.0 or (rod.mass > 0.0 and rod.center_of_mass != rod.length)
        for _, rod, _ in scene.running_gear
    )
    if scene.start is not None and scene.crank.inertia is None:
        raise InputError(
            "crank.inertia: this key is missing; a free crank needs it, only a prescribed "
            "speed, [motion], does without"
        )
    if scene.start is not None and scene.crank.inertia == 0.0 and not rod_turns:
        raise InputError(NO_INERTIA)


def _check_settled(scene: Scene) -> None:
    if not scene.settles:
        return
    if scene.motion is not None:
        raise InputError(
            'run.until: "settled" is the periodic motion that a free crank comes to; with '
            '[motion] give an end such as "2 cycles", or free the crank with [start]'
        )
    if scene.fuel is not None and _uneven(scene.fuel):
        raise InputError(
            f'run.until: "settled" needs firings that are alike in every cycle, and in [fuel], '
            f"{_uneven(scene.fuel)}; give an end such as {EXAMPLES['extent']}, or remove [fuel]"
        )
    every: tuple[tuple[Torque | PistonForce, ...], ...] = (scene.torque, scene.force)
    for loads in every:
        for number, load in enumerate(loads, start=1):
            if _passing(load):
                raise InputError(
                    f'run.until: "settled" needs loads that act alike in every cycle, and '
                    f"{load.heading}[{number}], {_passing(load)}; give an end such as "
                    f"{EXAMPLES['extent']}, or another load"
                )


def _check_periods(scene: Scene) -> None:
    """Refuse periods of loads that come together after too many cycles."""
    cycles = round(scene.load_period / scene.period)
    if cycles > _MOST_CYCLES:
        raise InputError(
            f"torque: the loads and the engine come again together after {cycles} cycles, and "
            f"{_MOST_CYCLES} are the most; give periods with a smaller common multiple"
        )


def _check_tables(scene: Scene) -> None:
    until, until_time = scene.end
    end = until if until_time else 0.0
    if scene.motion is not None and isinstance(scene.motion.speed, SpeedFile):
        _check_speed(scene, scene.motion.speed, end)
    for load in (*scene.torque, *scene.force):
        if load.table_over_time is None:
            continue
        if load.until_speed is None and (load.after or 0.0) < end:
            last = end if load.until is None else min(end, load.until)
        else:
            last = 0.0  # where it ends shows on the way
        span = "its window" if load.has_window else "the run"
        begin = load.after or 0.0
        _check_times(load.table_over_time, begin, max(begin, last), span)


def _check_speed(scene: Scene, speed: SpeedFile, end: float) -> None:
    """Refuse a speed that does not cover the run, to a time [s] or to its end in angle."""
    assert scene.motion is not None
    table, begin = speed.file, scene.motion.angle
    if speed.kind == "time_table":
        _check_times(table, 0.0, end, "the run")
    elif not repeats(table):
        until, until_time = scene.end
        reach = 0.0 if until_time else math.copysign(until, table.y[0])
        _check_angles(table, *sorted((begin, begin + reach)))


def _check_times(table: Table, begin: float, end: float, span: str) -> None:
    """Refuse a table over time that does not reach from one time to another [s]."""
    if table.x[0] > begin or table.x[-1] < end:
        raise InputError(
            f"{table.source}: the table must cover {span}, {begin:g} to {end:g} s; it goes from "
            f"{table.x[0]:g} to {table.x[-1]:g} s"
        )


def _check_angles(table: Table, low: float, high: float) -> None:
    """Refuse a table over the angle that does not reach from one to another [rad]."""
    first, last = table.x[0], table.x[-1]
    if first - SAME_ANGLE > low or last + SAME_ANGLE < high:
        raise InputError(
            f"{table.source}: the table must cover the run, {low / DEGREE:g} to {high / DEGREE:g} "
            f"degrees, or be 360 or 720 degrees whose last row repeats the first; it goes from "
            f"{first / DEGREE:g} to {last / DEGREE:g} degrees"
        )


def _check_size(scene: Scene) -> None:
    """Refuse what no memory holds and what double precision cannot tell apart."""
    until, until_time = scene.end
    if until_time and until > _FARTHEST:
        raise InputError(
            f"run.until: beyond {_FARTHEST:.0e} s a time has too few digits left; give a nearer "
            f"end; {until:.3g} s came"
        )
    turned, at = (_speed_known(scene) * until, " at its speed") if until_time else (until, "")
    if turned > _FARTHEST:
        raise InputError(
            f"run.until: beyond {_FARTHEST / (2 * math.pi):.2g} rev an angle has too few "
            f"digits left; give a nearer end; {turned / (2 * math.pi):.3g} rev{at} came"
        )
    if scene.run.every is None:
        return
    every, in_time = scene.run.every.resolve(scene.period)
    if in_time == until_time:
        samples = until / every
        if samples > _MOST_SAMPLES:
            raise InputError(
                f"run.every: {samples:.3g} samples came, more than {_MOST_SAMPLES:.0e}; give a "
                'wider spacing, or every = "none" to keep the last cycle alone'
            )


def _speed_known(scene: Scene) -> float:
    """How fast the crank turns [rad/s], as far as that is known before the run: as prescribed, or
    at the start."""
    if scene.motion is None:
        return 0.0 if scene.start is None else abs(scene.start.speed)
    match scene.motion.speed:
        case Oscillation(mean=mean):
            return abs(mean)
        case Ramp(to=to):
            return abs(to)
        case SpeedFile(file=rows):
            return max(map(abs, rows.y))
        case speed:
            return abs(speed)
