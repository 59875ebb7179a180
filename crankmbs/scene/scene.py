"""The scene: one machine, how it moves, and for how long. Nothing here says how to solve it.

Frame and signs: X along the cylinder from the crank axis to the head, Y is X turned by +90
degrees, angles counter-clockwise.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

from pydantic import StrictStr

import crankmbs.scene.forces
import crankmbs.scene.loads
import crankmbs.scene.python_force
import crankmbs.scene.python_load  # noqa: F401  (all make their kinds known)
from crankmbs.errors import InputError, shown
from crankmbs.numerics.cycle import common_period
from crankmbs.scene.bearings import Bearings, Throws, throws_of
from crankmbs.scene.change import changed
from crankmbs.scene.cycles import cycles_in
from crankmbs.scene.drives import Motion, Start
from crankmbs.scene.force import AnyForce
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.gas import Gas
from crankmbs.scene.parts import (
    Crank,
    Cylinder,
    Friction,
    Gravity,
    Layout,
    Piston,
    Rod,
    RunningGear,
)
from crankmbs.scene.run import SETTLED, Run
from crankmbs.scene.schema import part
from crankmbs.scene.tables import tables_of
from crankmbs.scene.torque import AnyTorque
from crankmbs.scene.whole import check_whole

__all__ = ["Scene", "check_scene"]


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
    bearings: Bearings | None = None
    motion: Motion | None = None
    start: Start | None = None
    torque: tuple[AnyTorque, ...] = ()
    force: tuple[AnyForce, ...] = ()
    title: StrictStr = ""
    source: StrictStr = ""

    def __post_init__(self) -> None:
        check_whole(self)

    @property
    def period(self) -> float:
        """The engine's period [rad]; without gas 4 pi."""
        return 4.0 * math.pi if self.gas is None else self.gas.period

    @property
    def double_acting(self) -> bool:
        """Whether gas presses on both sides of the pistons."""
        return self.gas is not None and self.gas.crank_end is not None

    @property
    def settles(self) -> bool:
        """Whether the motion asked for is the one that the run comes to."""
        return self.run.until == SETTLED

    @cached_property
    def load_period(self) -> float:
        """The angle [rad] after which the engine and the loads over the angle come again: the least
        common multiple of their periods.

        >>> load_scene("propeller").load_period / math.pi
        2.0
        """
        periods = [load.parts.period for load in self.torque]
        periods += [force.law.period for force in self.force]
        return common_period([self.period, *(period for period in periods if period)])

    @cached_property
    def settled_period(self) -> float:
        """The angle [rad] after which a settled motion repeats itself: the least common multiple
        of the periods of the engine, of a sequence of cycles, of misfires "every n" and of loads
        over the angle."""
        periods = [self.load_period]
        if self.gas is not None and self.gas.cycles == "sequence":
            cycle = self.gas.period
            tables = self.gas.tables + tables_of(self.gas.crank_end)
            periods += [cycles_in(table, cycle) * cycle for table in tables]
        misfires = (self.fuel.misfire if self.fuel else None) or ()
        periods += [self.period * misfire.every for misfire in misfires if misfire.every]
        return common_period(periods)

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
    def running_gear(self) -> tuple[RunningGear, ...]:
        """Throw, rod and piston of every cylinder.

        >>> load_scene("propeller").running_gear[0].rod.length
        0.1533333
        """
        common = self.crank.radius, self.rod, self.piston
        return tuple(cylinder.running_gear(*common) for cylinder in self.cylinders)

    @cached_property
    def unlike(self) -> bool:
        """Whether a cylinder has another throw, rod or piston than the scene's."""
        return set(self.running_gear) != {RunningGear(self.crank.radius, self.rod, self.piston)}

    @property
    def two_mass(self) -> Scene:
        """The scene with rods of two masses at their pins."""
        layout, rod = self.layout, replace(self.rod, inertia="two-mass")
        if layout.cylinders is not None:
            cylinders = [
                c if c.rod is None else replace(c, rod=replace(c.rod, inertia=None))
                for c in layout.cylinders
            ]
            layout = replace(layout, cylinders=tuple(cylinders))
        return replace(self, rod=rod, layout=layout)

    @cached_property
    def levers(self) -> tuple[float, ...] | None:
        """How far each cylinder's throw stands beyond the middle of the crank, halfway between the
        first and the last [m]; None where no positions are given."""
        places = [c.position for c in self.cylinders if c.position is not None]
        if not places:
            return None
        middle = 0.5 * (min(places) + max(places))
        return tuple(place - middle for place in places)

    @cached_property
    def throws(self) -> Throws | None:
        """The throws of the crank and how its main journals hold them; None without bearings, and
        where the throws have no places."""
        return throws_of(self)

    def with_(self, *unnamed: object, **values: object) -> Scene:
        """The scene with other values, each named by where it stands, with ``__`` between.

        Lists count from 1, as in every message: ``torque__1__coefficient``,
        ``layout__cylinders__2__phase``. A number is in SI units, or text with its unit, as in a
        file; a whole part may be given, or None. All values change at once.

        Raises
        ------
        InputError : no such place, or a value that cannot be; begins with the name as given

        >>> load_scene("propeller").with_(rod__length="160 mm", crank__inertia=0.2).rod.length
        0.16
        """
        if unnamed:
            raise InputError(
                'with_ takes its values by name, such as with_(rod__length="160 mm"); '
                f"{shown(unnamed[0])} came without"
            )
        return changed(self, values)

    def __repr__(self) -> str:
        count = len(self.cylinders)
        how = "free" if self.motion is None else "prescribed speed"
        return (
            f"<Scene {shown(self.title or 'without a title')}: {count} "
            f"cylinder{'s' if count > 1 else ''}, crank {self.crank.radius * 1e3:.6g} mm, rod "
            f"{self.rod.length * 1e3:.6g} mm, {how}>"
        )

    def _repr_html_(self) -> str:
        from crankmbs.report.html import scene_html

        return scene_html(self)


def check_scene(scene: object) -> None:
    """Refuse what is no scene.

    Raises
    ------
    InputError : begins with the argument, ``scene``
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a Scene, such as load_scene reads; {shown(scene)} came")
