"""What the machine is made of: crank, rod, piston, cylinders, gravity, friction.

Frozen dataclasses in SI units, each checking itself. Every quantity is a float in SI units, or a
string with its unit (``"46 mm"``), which is converted on the way in.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Ge, Gt, Le, Len
from pydantic import Discriminator, StrictInt, Tag

from crankmbs.errors import InputError, shown
from crankmbs.scene.schema import Angle, Float, part, si

__all__ = [
    "LIGHT_CRANK",
    "Crank",
    "Cylinder",
    "Friction",
    "Gravity",
    "Layout",
    "OwnPiston",
    "OwnRod",
    "Piston",
    "Rod",
    "RunningGear",
]

LIGHT_CRANK = (
    "inertia about the crank axis must be at least mass * center_of_mass^2 = {least:.6g} kg m^2; "
    "{came:.6g} came"
)

Length = Annotated[Float, Gt(0), si("length")]
Distance = Annotated[Float, si("length")]
Mass = Annotated[Float, Ge(0), si("mass")]
Inertia = Annotated[Float, Ge(0), si("inertia")]
Area = Annotated[Float, Gt(0), si("area")]


def _number_or_word(value: object) -> str:
    return "Word" if isinstance(value, str) and value[:1].isalpha() else "Number"


RodInertia = Annotated[
    Annotated[Inertia, Tag("Number")] | Annotated[Literal["two-mass"], Tag("Word")],
    Discriminator(_number_or_word),
]


@part
class Crank:
    """Everything that turns with the crank, flywheel included.

    radius [m]; inertia about the crank axis [kg m2], which a prescribed speed does without; mass
    [kg]; center_of_mass [m] from the axis along the reference line, negative for a counterweight.
    """

    radius: Length
    inertia: Inertia | None = None
    mass: Mass = 0.0
    center_of_mass: Distance = 0.0

    def __post_init__(self) -> None:
        least = self.mass * self.center_of_mass**2
        if self.moment_of_inertia < least * (1.0 - 1e-12):
            raise InputError(LIGHT_CRANK.format(least=least, came=self.inertia))

    @property
    def moment_of_inertia(self) -> float:
        """Inertia about the crank axis [kg m2]; left out, that of a mass at its center_of_mass."""
        return self.mass * self.center_of_mass**2 if self.inertia is None else self.inertia


@part
class Rod:
    """The connecting rod.

    length [m] between the pins; mass [kg]; center_of_mass [m] from the crank pin towards the
    piston pin; inertia [kg m2] about the centre of mass, or "two-mass": m a (l - a), the inertia
    of the lecture's two lumped masses.
    """

    length: Length
    mass: Mass = 0.0
    center_of_mass: Distance = 0.0
    inertia: RodInertia = 0.0

    @property
    def moment_of_inertia(self) -> float:
        """Inertia about the centre of mass [kg m2], the word "two-mass" resolved."""
        if self.inertia == "two-mass":
            return self.mass * self.center_of_mass * (self.length - self.center_of_mass)
        return float(self.inertia)


@part
class Piston:
    """mass [kg]; bore [m] or area [m2], needed with gas; offset [m] of the cylinder axis in +Y;
    rod_diameter [m] of a piston rod, on whose area a crank end does not press."""

    mass: Mass
    bore: Length | None = None
    area: Area | None = None
    offset: Distance = 0.0
    rod_diameter: Length | None = None

    def __post_init__(self) -> None:
        if self.bore is not None and self.area is not None:
            raise InputError("give bore or area, not both; both came")
        if self.gas_area is not None and self.rod_area >= self.gas_area:
            bore = math.sqrt(4.0 * self.gas_area / math.pi)
            raise InputError(
                f"rod_diameter must be less than the bore, {bore:.6g} m; "
                f"{self.rod_diameter:.6g} m came"
            )

    @property
    def gas_area(self) -> float | None:
        """Piston area [m2], or None when neither bore nor area is given."""
        return self.area if self.bore is None else math.pi / 4.0 * self.bore**2

    @property
    def rod_area(self) -> float:
        """Area of the piston rod [m2]; 0 without."""
        return math.pi / 4.0 * (self.rod_diameter or 0.0) ** 2

    @property
    def crank_end_area(self) -> float:
        """What the gas of a crank end presses on [m2]: the piston's area less the rod's."""
        return (self.gas_area or 0.0) - self.rod_area

    @property
    def crank_end_share(self) -> float:
        """The same of the piston's area [1]; 0 without bore and area."""
        return self.crank_end_area / self.gas_area if self.gas_area else 0.0


@part
class OwnRod:
    """What the rod of one cylinder has otherwise than `Rod`, in the same units."""

    length: Length | None = None
    mass: Mass | None = None
    center_of_mass: Distance | None = None
    inertia: RodInertia | None = None


@part
class OwnPiston:
    """What the piston of one cylinder has otherwise than `Piston`, in the same units; bore and area
    replace each other."""

    mass: Mass | None = None
    bore: Length | None = None
    area: Area | None = None
    offset: Distance | None = None
    rod_diameter: Length | None = None


class RunningGear(NamedTuple):
    """What moves in one cylinder: the radius of its throw [m], its rod and its piston."""

    radius: float
    rod: Rod
    piston: Piston

    @property
    def shape(self) -> tuple[float, float, float]:
        """Radius of the throw, length of the rod and offset of the cylinder [m]: all that its
        motion depends on."""
        return self.radius, self.rod.length, self.piston.offset

    @property
    def stroke(self) -> float:
        """Between the true dead centres [m]: sqrt((l + r)^2 - e^2) - sqrt((l - r)^2 - e^2)."""
        r, l, e = self.shape
        low = (l - r - e) * (l - r + e)
        return math.sqrt((l + r - e) * (l + r + e)) - math.sqrt(max(low, 0.0))


@part
class Cylinder:
    """phase [rad]: its cycle angle at crank angle 0; bank [rad]: its axis from the engine's X;
    position [m]: of its rod along the crank, in the sense of X turned into Y; throw: number of the
    throw on whose pin its rod is, from 1; left out, each has another.

    radius [m] of its throw, rod and piston: where they are unlike those of [crank], [rod] and
    [piston], key by key.
    """

    phase: Angle = 0.0
    bank: Angle = 0.0
    position: Distance | None = None
    throw: Annotated[StrictInt, Ge(1)] | None = None
    radius: Length | None = None
    rod: OwnRod | None = None
    piston: OwnPiston | None = None

    def running_gear(self, radius: float, rod: Rod, piston: Piston) -> RunningGear:
        """What moves in this cylinder, of a machine with these where the cylinder has no others.

        Raises
        ------
        InputError : a rod or a piston that cannot be
        """
        if self.rod is not None:
            rod = replace(rod, **_values_of(self.rod))
        if self.piston is not None:
            values = _values_of(self.piston)
            if {"bore", "area"} & values.keys():
                values = {"bore": None, "area": None} | values
            piston = replace(piston, **values)
        return RunningGear(radius if self.radius is None else self.radius, rod, piston)


def _values_of(part: OwnRod | OwnPiston) -> dict[str, Any]:
    """The values that one cylinder sets."""
    return {name: value for name, value in vars(part).items() if value is not None}


@part
class Layout:
    """Where the cylinders stand: a firing order (even, in line) or a list of cylinders.

    spacing [m]: axial distance of neighbouring throws, one for each cylinder, in the order of
    their numbers.
    """

    firing_order: Annotated[tuple[StrictInt, ...], Len(1)] | None = None
    cylinders: Annotated[tuple[Cylinder, ...], Len(1)] | None = None
    spacing: Length | None = None

    def __post_init__(self) -> None:
        if (self.firing_order is None) == (self.cylinders is None):
            came = "neither" if self.cylinders is None else "both"
            raise InputError(f"give firing_order or cylinders, exactly one of the two; {came} came")
        order = self.firing_order
        if order is not None and sorted(order) != list(range(1, len(order) + 1)):
            raise InputError(
                f"firing_order must name each of the cylinders 1 to {len(order)} once; "
                f"{shown(list(order))} came"
            )
        self._check_positions()

    def resolve(self, period: float) -> tuple[Cylinder, ...]:
        """The cylinders, in the order of their numbers; the k-th to fire lags k period / n, and the
        spacing places the k-th by number."""
        if self.cylinders is not None:
            cylinders = self.cylinders
        else:
            assert self.firing_order is not None
            n = len(self.firing_order)
            lag = {number: k for k, number in enumerate(self.firing_order)}
            cylinders = tuple(
                Cylinder(phase=(n - lag[number]) % n * period / n) for number in range(1, n + 1)
            )
        if self.spacing is None:
            return cylinders
        return tuple(replace(c, position=k * self.spacing) for k, c in enumerate(cylinders))

    def _check_positions(self) -> None:
        """Every cylinder has its place along the crank, or none has."""
        cylinders = self.cylinders or ()
        placed = sum(cylinder.position is not None for cylinder in cylinders)
        if 0 < placed < len(cylinders):
            raise InputError(
                "position: give it for every cylinder or for none; "
                f"{placed} of {len(cylinders)} came with one"
            )
        if self.spacing is None:
            return
        if placed:
            raise InputError("give spacing or each cylinder's position, not both; both came")
        if len({cylinder.bank for cylinder in cylinders}) > 1:
            raise InputError(
                "spacing: cylinders of different banks may share a throw; give each cylinder's "
                "position instead"
            )


@part
class Gravity:
    """acceleration [m/s2] and the direction in which it pulls, angle [rad] from the engine's X."""

    acceleration: Annotated[Float, Ge(0), si("acceleration")]
    angle: Angle = math.pi


@part
class Friction:
    """Of each piston on its wall: ring_force [N] and ring_pressure, a share of |gas force|, against
    the sense in which it slides; viscous [N s/m] against its velocity."""

    ring_force: Annotated[Float, Ge(0), si("force")] = 0.0
    ring_pressure: Annotated[Float, Ge(0), Le(1)] = 0.0
    viscous: Annotated[Float, Ge(0), si("viscous friction")] = 0.0
