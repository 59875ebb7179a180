"""What can be turned on the page: knobs with their ends, and choices among words."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

from crankmbs.design.flywheel import excess_at
from crankmbs.design.freed import mean_prescribed
from crankmbs.scene.drives import Oscillation
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable
from crankmbs.scene.units import RPM

__all__ = [
    "AS_GIVEN",
    "FIRING_ORDERS",
    "Choice",
    "Knob",
    "choices_of",
    "first_of",
    "knobs_of",
    "rated_part",
    "speed_label",
]

AS_GIVEN = "given"
_EVEN = 0.01  # coefficient of fluctuation with the heaviest flywheel of a prescribed speed
FIRING_ORDERS = {
    "1": (1,),
    "2": (1, 2),
    "3": (1, 3, 2),
    "4": (1, 3, 4, 2),
    "5": (1, 2, 4, 5, 3),
    "6": (1, 5, 3, 6, 2, 4),
}
"""Usual firing orders, evenly spaced, in line."""


@dataclasses.dataclass(frozen=True)
class Knob:
    """A slider: its name, its label and unit, its ends, the scene's value, the digits shown after
    the point, and what it does to the rest."""

    name: str
    label: str
    unit: str
    low: float
    high: float
    value: float
    decimals: int
    about: str = ""


@dataclasses.dataclass(frozen=True)
class Choice:
    """A choice among words; value : the scene's."""

    name: str
    label: str
    words: tuple[str, ...]
    value: str


@dataclasses.dataclass(frozen=True)
class First:
    """What the page begins with: a question, what to look at and turn, and the names of knobs."""

    question: str
    sentence: str
    knobs: tuple[str, ...]


def first_of(scene: Scene) -> First:
    """The question of a scene, free or of prescribed speed, and the knobs that answer it.

    >>> first_of(load_scene("propeller")).question
    'Why does the speed swing?'
    """
    there = [knob.name for knob in knobs_of(scene)]
    names: tuple[str, ...]
    if scene.motion is None:
        question = "Why does the speed swing?"
        heavier = "Make the flywheel heavier: the swing becomes small, never zero."
        sentence = f"{_why_it_swings(scene)} {heavier}"
        names = ("flywheel", "load", "speed", "rod_mass", "rod_ratio")
    elif scene.unlike:
        question = "What do the forces become at another speed?"
        sentence = (
            "The forces of inertia grow with the square of the speed, those of the gas do not. "
            "Turn the crank faster: in each cylinder they take over at another speed."
        )
        names = ("speed", "pressure", "counterweight")
    else:
        question = "What does the length of the rod change?"
        sentence = (
            "A short rod tilts more: the piston is thrown harder at the top than at the bottom, "
            "and pressed harder against the wall. Make the rod ratio larger and watch both."
        )
        names = ("rod_ratio", "speed", "rod_mass", "offset", "pressure")
    return First(question, sentence, tuple(name for name in names if name in there)[:3])


def _why_it_swings(scene: Scene) -> str:
    """What comes in pulses, by who drives: the pistons, or the torques from outside that do not
    depend on the crank angle."""
    assert scene.start is not None
    stored = "crank, rods and pistons store the difference."
    if not scene.torque and scene.gas is None:
        return "Pistons and rods speed up and slow down twice a turn; their energy is the crank's."
    if _driven_from_outside(scene):
        return f"The torque of the drive is even, the work comes in pulses; {stored}"
    return f"The torque comes in pulses, the load takes it evenly; {stored}"


def _driven_from_outside(scene: Scene) -> bool:
    """Whether the torques that do not depend on the crank angle drive the crank at its start."""
    assert scene.start is not None
    angle, speed = scene.start.angle, scene.start.speed
    even = [load for load in scene.torque if load.parts.over_angle is None]
    return sum(float(load(0.0, angle, speed)) for load in even) * speed > 0.0


def rated_part(scene: Scene) -> str:
    """Whose torque the knob of the speed stretches over the speed, "load" or "drive"; "" where no
    torque from outside depends on the speed.

    >>> rated_part(load_scene("propeller")), rated_part(load_scene("two_stage_compressor"))
    ('load', 'drive')
    """
    if scene.start is None or all(load.parts.over_speed is None for load in scene.torque):
        return ""
    return "drive" if _driven_from_outside(scene) else "load"


def speed_label(scene: Scene) -> str:
    """What the knob of the speed sets; a free crank finds its mean speed by itself.

    >>> speed_label(load_scene("propeller"))
    'rated speed of load'
    """
    part = rated_part(scene)
    return f"rated speed of {part}" if part else "speed"


def knobs_of(scene: Scene) -> tuple[Knob, ...]:
    """The sliders that mean something for a scene; the scene's value lies between their ends. Where
    cylinders are unlike, none turns their geometry and masses.

    >>> [knob.name for knob in knobs_of(load_scene("grega_lecture"))]
    ['speed', 'pressure', 'flywheel', 'rod_ratio', 'offset', 'rod_mass']
    """
    gear = () if scene.unlike else _gear(scene)
    return (*_drive(scene), *gear, *_counterweight(scene))


def choices_of(scene: Scene) -> tuple[Choice, ...]:
    """The choices that mean something for a scene.

    >>> [choice.name for choice in choices_of(load_scene("yi_diesel"))]
    ['rod', 'cylinders', 'speed_is']
    """
    choices = []
    if not scene.unlike:
        rod = "two-mass" if scene.rod.inertia == "two-mass" else "rigid"
        choices.append(Choice("rod", "rod", ("rigid", "two-mass"), rod))
    if _is_of_any_number(scene):
        words = (AS_GIVEN, *FIRING_ORDERS)
        choices.append(Choice("cylinders", "cylinders", words, AS_GIVEN))
    if _can_be_free(scene):
        kind = "free" if scene.motion is None else "prescribed"
        choices.append(Choice("speed_is", "speed", ("free", "prescribed"), kind))
    return tuple(choices)


def _drive(scene: Scene) -> list[Knob]:
    """The knobs of what turns the crank."""
    knobs = []
    speed = _speed(scene)
    if speed:
        rpm = speed / RPM
        low, high = sorted((0.25 * rpm, _above(1.75 * abs(rpm)) * math.copysign(1.0, rpm)))
        about = "the loads give their torque at this speed" if scene.torque else ""
        knobs.append(Knob("speed", speed_label(scene), "rpm", low, high, rpm, 0, about))
    if scene.torque:
        about = "of what the scene gives"
        knobs.append(Knob("load", "load", "%", 0.0, 200.0, 100.0, 0, about))
    if scene.gas is not None:
        about = "absolute, of what the scene gives"
        knobs.append(Knob("pressure", "pressure", "%", 20.0, 200.0, 100.0, 0, about))
    if _can_be_free(scene):
        about = "inertia of all that turns with the crank"
        value, most = scene.crank.moment_of_inertia, _heaviest(scene)
        low, digits = min(most / 100.0, value), _decimals(most)
        knobs.append(Knob("flywheel", "flywheel", "kg m²", low, most, value, digits, about))
    return knobs


def _can_be_free(scene: Scene) -> bool:
    """Whether the crank is free, or a constant load can balance it as `crankmbs.freed` does."""
    return scene.start is not None or scene.fuel is None


def _heaviest(scene: Scene) -> float:
    """The heaviest flywheel [kg m2]: a few times the scene's; of a prescribed speed, whose
    scene may have none, at least the one with which it would swing by a hundredth."""
    most = 4.0 * scene.crank.moment_of_inertia
    if scene.motion is not None:
        speed = mean_prescribed(scene)
        work, _ = excess_at(scene, speed)
        most = max(most, work.value / (_EVEN * speed**2))
    return _above(most or 4e-3)


def _gear(scene: Scene) -> tuple[Knob, ...]:
    """The knobs of what moves in the cylinders."""
    r, rod = scene.crank.radius * 1e3, scene.rod
    ratio = scene.crank.radius / rod.length
    heaviest = _above(3.0 * rod.mass or scene.piston.mass or 1.0)
    offset = scene.piston.offset * 1e3
    far = max(_above(0.5 * r), abs(offset))
    about = "pressures keep to the swept fraction of each stroke" if scene.gas is not None else ""
    return (
        Knob("rod_ratio", "rod ratio r/l", "", min(0.1, ratio), 0.9, ratio, 3, about),
        Knob("offset", "offset", "mm", -far, far, offset, 1, about),
        Knob("rod_mass", "rod mass", "kg", 0.0, heaviest, rod.mass, 2),
    )


def _counterweight(scene: Scene) -> Iterator[Knob]:
    if scene.crank.mass > 0.0:
        center = scene.crank.center_of_mass * 1e3
        wide = max(_above(1e3 * scene.crank.radius), abs(center))
        about = "the crank's centre of mass from its axis; below 0 a counterweight"
        yield Knob("counterweight", "crank mass centre", "mm", -wide, wide, center, 1, about)


def _is_of_any_number(scene: Scene) -> bool:
    """Whether other cylinders than the scene's can have its parts, pressure, fuel and loads: a
    table over the crank angle is of the cylinders that it was made of."""
    if scene.unlike or any(force.cylinder is not None for force in scene.force):
        return False
    if any(load.parts.over_angle is not None for load in scene.torque):
        return False
    gas = scene.gas
    if scene.fuel is not None or gas is None:
        return scene.fuel is None
    every = (gas.pressure, gas.motored, gas.crank_end)
    return not any(isinstance(each, CylinderTable | tuple) for each in every)


def _speed(scene: Scene) -> float:
    """The speed [rad/s] that the knob turns; 0 where there is none to turn."""
    if scene.start is not None:
        return scene.start.speed
    assert scene.motion is not None
    speed = scene.motion.speed
    if isinstance(speed, Oscillation):
        return speed.mean
    return speed if isinstance(speed, float) else 0.0


def _above(value: float) -> float:
    """The next number of one or two digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(math.ceil(value / step - 1e-9) * step, 12)


def _decimals(most: float) -> int:
    return max(1, 2 - math.floor(math.log10(most)))
