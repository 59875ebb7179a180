"""The scene: one machine, how it moves, and for how long. Nothing here says how to solve it.

Frame and signs: X along the cylinder from the crank axis to the head, Y is X turned by +90
degrees, angles counter-clockwise.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated

from pydantic import Strict

from crankmbs.errors import InputError
from crankmbs.scene.cover import check_angles, check_times
from crankmbs.scene.cycles import cycles_in
from crankmbs.scene.drives import Motion, SpeedFile, Start
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.gas import Gas, tables_of
from crankmbs.scene.parts import Crank, Cylinder, Friction, Gravity, Layout, Piston, Rod
from crankmbs.scene.run import SETTLED, Run
from crankmbs.scene.schema import part
from crankmbs.scene.speed_rows import repeats
from crankmbs.scene.tables import CylinderTable
from crankmbs.scene.torque import AnyTorque, Torque
from crankmbs.scene.units import EXAMPLES

__all__ = ["OPEN_LOOP", "Scene"]

OPEN_LOOP = (
    "rod.length must be at least crank.radius + |piston.offset| = {least:.12g} m, or the crank "
    "cannot turn; {came:.12g} m came"
)

_FARTHEST = 1e9  # rad: its last digit is 1e-7
_MOST_SAMPLES = 2e7  # the memory of a machine may hold less: `crankmbs.motion.memory`


def _passing(load: Torque) -> str:
    """What in a load happens once or depends on time, so that nothing settles under it, if any."""
    if load.has_window:
        return f"a {load.kind} with a window acts once"
    return "" if load.is_steady else f"a {load.kind} depends on time"


def _uneven(fuel: Fuel) -> str:
    """What in the fuel happens once or at random, so that nothing settles with it, if any."""
    if fuel.scatter > 0.0:
        return "scatter makes every share another"
    if fuel.after > 0.0 or (fuel.until, fuel.from_speed, fuel.until_speed) != (None, None, None):
        return "a window acts once"
    if any(misfire.every is None for misfire in fuel.misfire or ()):
        return "a listed misfire happens once"
    return ""


@part
class Scene:
    """One machine, how it moves, and for how long.

    Exactly one of ``motion`` (the speed is prescribed) and ``start`` (the crank is free) is given.
    """

    crank: Crank
    rod: Rod
    piston: Piston
    run: Run
    layout: Layout = Layout(cylinders=(Cylinder(),))
    gas: Gas | None = None
    fuel: Fuel | None = None
    gravity: Gravity | None = None
    friction: Friction | None = None
    motion: Motion | None = None
    start: Start | None = None
    torque: tuple[AnyTorque, ...] = ()
    title: Annotated[str, Strict()] = ""
    source: Annotated[str, Strict()] = ""

    def __post_init__(self) -> None:
        self._check_loop()
        self._check_gas()
        self._check_friction()
        self._check_motion()
        self._check_settled()
        self._check_tables()
        self._check_size()

    @property
    def period(self) -> float:
        """The engine's period [rad]; without gas 4 pi."""
        return 4.0 * math.pi if self.gas is None else self.gas.period

    @property
    def settles(self) -> bool:
        """Whether the motion asked for is the one that the run comes to."""
        return self.run.until == SETTLED

    @property
    def settled_period(self) -> float:
        """The angle [rad] after which a settled motion repeats itself: the least common multiple
        of the periods of the engine, of a sequence of cycles, of misfires "every n" and of loads
        over the angle."""
        loads = (load.parts.over_angle for load in self.torque)
        own = [self.period, *(part.period for part in loads if part is not None)]
        if self.gas is not None and self.gas.cycles == "sequence":
            one = self.gas.period
            own += [cycles_in(table, one) * one for table in self.gas.tables]
        misfires = (self.fuel.misfire if self.fuel else None) or ()
        own += [self.period * one.every for one in misfires if one.every]
        turns = (round(period / (2.0 * math.pi)) for period in own)
        return math.lcm(*turns) * 2.0 * math.pi

    @property
    def end(self) -> tuple[float, bool]:
        """Where the run ends, and whether that is a time: [s], else |theta - start| [rad].

        A settled motion is shown over one of its periods.

        >>> load_scene("coasting").end
        (0.5, True)
        """
        if self.run.until == SETTLED:
            return self.settled_period, False
        return self.run.until.resolve(self.period)

    @cached_property
    def cylinders(self) -> tuple[Cylinder, ...]:
        """The cylinders in the order of their numbers, firing order resolved."""
        return self.layout.resolve(self.period)

    @cached_property
    def levers(self) -> tuple[float, ...] | None:
        """How far each cylinder's throw stands beyond the middle of the crank, halfway between the
        first and the last [m]; None where no positions are given."""
        places = [c.position for c in self.cylinders if c.position is not None]
        if not places:
            return None
        middle = 0.5 * (min(places) + max(places))
        return tuple(place - middle for place in places)

    def _check_loop(self) -> None:
        least = self.crank.radius + abs(self.piston.offset)
        if self.rod.length < least * (1.0 - 1e-15):
            raise InputError(OPEN_LOOP.format(least=least, came=self.rod.length))
        if self.rod.moment_of_inertia < 0.0:  # after its length, which may be what is wrong
            raise InputError(
                'rod: the inertia "two-mass" needs a center_of_mass between the pins, 0 to '
                f"{self.rod.length:.6g} m; {self.rod.center_of_mass:.6g} m came"
            )
        if self.gas is not None and self.piston.gas_area is None:
            raise InputError(
                "piston.bore: with [gas] the piston needs its bore, or its area; neither came"
            )

    def _check_gas(self) -> None:
        """Refuse as many pressures as there are not cylinders, and fuel that cannot burn."""
        gas, cylinders = self.gas, len(self.cylinders)
        for key, source in (("pressure", gas and gas.pressure), ("motored", gas and gas.motored)):
            if isinstance(source, CylinderTable | tuple):
                count = len(tables_of(source))
                given = "columns" if isinstance(source, CylinderTable) else "files"
                if count != cylinders:
                    raise InputError(
                        f"gas.{key}: as many {given} as cylinders are needed, {cylinders}, or one "
                        f"for all; {count} came"
                    )
        if self.fuel is None:
            return
        if gas is None:
            raise InputError("fuel: without [gas] nothing burns; add [gas], or remove [fuel]")
        if gas.indicator is None and gas.motored is None:
            raise InputError(
                "gas.motored: with [fuel] the pressure without combustion is needed, of which a "
                'firing takes its share; give motored = "motored.csv", or an indicator'
            )
        if self.motion is not None and self.fuel.governor is not None:
            raise InputError(
                "fuel.governor: with [motion] the speed is prescribed, and there is nothing to "
                "govern; remove the governor, or free the crank with [start]"
            )
        for number, misfire in enumerate(self.fuel.misfire or (), start=1):
            if misfire.cylinder > cylinders:
                raise InputError(
                    f"fuel.misfire[{number}].cylinder: must be from 1 to {cylinders}; "
                    f"{misfire.cylinder} came"
                )

    def _check_friction(self) -> None:
        if self.gas is None and self.friction is not None and self.friction.ring_pressure > 0.0:
            raise InputError(
                "friction.ring_pressure: without [gas] there is no gas force to press the rings; "
                f"leave it out, or add [gas]; {self.friction.ring_pressure:g} came"
            )

    def _check_motion(self) -> None:
        if (self.motion is None) == (self.start is None):
            came = "neither" if self.motion is None else "both"
            raise InputError(
                "give [motion] (the speed is prescribed) or [start] (the crank is free), "
                f"exactly one of the two; {came} came"
            )
        if self.motion is not None and self.torque:
            raise InputError(
                "torque: with [motion] the drive is an answer, not a load; remove [[torque]], or "
                "free the crank with [start]"
            )
        if self.motion is not None and self.motion.speed == 0.0 and not self.end[1]:
            raise InputError(
                "motion.speed: at speed 0 no angle is ever reached; until must be a time"
            )
        rod_turns = self.rod.moment_of_inertia > 0.0 or (
            self.rod.mass > 0.0 and self.rod.center_of_mass != self.rod.length
        )
        if self.start is not None and self.crank.inertia is None:
            raise InputError(
                "crank.inertia: this key is missing; a free crank needs it, only a prescribed "
                "speed, [motion], does without"
            )
        if self.start is not None and self.crank.inertia == 0.0 and not rod_turns:
            raise InputError(
                "crank.inertia: a free crank needs an inertia above 0, or nothing resists it at "
                "the dead centres; 0 came"
            )

    def _check_settled(self) -> None:
        if not self.settles:
            return
        if self.motion is not None:
            raise InputError(
                'run.until: "settled" is the periodic motion that a free crank comes to; with '
                '[motion] give an end such as "2 cycles", or free the crank with [start]'
            )
        if self.fuel is not None and _uneven(self.fuel):
            raise InputError(
                f'run.until: "settled" needs firings that are alike in every cycle, and in [fuel], '
                f"{_uneven(self.fuel)}; give an end such as {EXAMPLES['extent']}, or remove [fuel]"
            )
        for number, load in enumerate(self.torque, start=1):
            if _passing(load):
                raise InputError(
                    f'run.until: "settled" needs loads that act alike in every cycle, and '
                    f"torque[{number}], {_passing(load)}; give an end such as "
                    f"{EXAMPLES['extent']}, or another load"
                )

    def _check_tables(self) -> None:
        until, until_time = self.end
        end = until if until_time else 0.0
        if self.motion is not None and isinstance(self.motion.speed, SpeedFile):
            self._check_speed(self.motion.speed, end)
        for load in self.torque:
            if load.table_over_time is None:
                continue
            if load.until_speed is None and (load.after or 0.0) < end:
                last = end if load.until is None else min(end, load.until)
            else:
                last = 0.0  # where it ends shows on the way
            what = "its window" if load.has_window else "the run"
            begin = load.after or 0.0
            check_times(load.table_over_time, begin, max(begin, last), what)

    def _check_speed(self, speed: SpeedFile, end: float) -> None:
        """Refuse a speed that does not cover the run, to a time [s] or to its end in angle."""
        assert self.motion is not None
        table, begin = speed.file, self.motion.angle
        if speed.kind == "time_table":
            check_times(table, 0.0, end, "the run")
        elif not repeats(table):
            until, until_time = self.end
            reach = 0.0 if until_time else math.copysign(until, table.y[0])
            check_angles(table, *sorted((begin, begin + reach)))

    def _check_size(self) -> None:
        """Refuse what no memory holds and what double precision cannot tell apart."""
        until, until_time = self.end
        if not until_time and until > _FARTHEST:
            raise InputError(
                f"run.until: beyond {_FARTHEST / (2 * math.pi):.2g} rev an angle has too few "
                f"digits left; {until / (2 * math.pi):.3g} rev came"
            )
        if self.run.every is None:
            return
        every, in_time = self.run.every.resolve(self.period)
        if in_time == until_time:
            _check_count(until / every)


def _check_count(samples: float) -> None:
    if samples > _MOST_SAMPLES:
        raise InputError(
            f"run.every: {samples:.3g} samples came, more than {_MOST_SAMPLES:.0e}; give a wider "
            'spacing, or every = "none" to keep the last cycle alone'
        )
