"""Lesson 4: why the speed is not constant: the balance of energy over a cycle."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from crankmbs.lessons.freed import flywheel_knob, free, settled, textbook
from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact, simulated
from crankmbs.lessons.runs import changed, named, speed_of
from crankmbs.measures import Estimate, measure
from crankmbs.measures.summary import largest
from crankmbs.numerics.arrays import Array
from crankmbs.page.knobs import Knob, speed_label
from crankmbs.result import Result
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

__all__ = ["IDEA", "SCENE", "lesson"]

SCENE = "yi_diesel_free"
IDEA = (
    "The gas gives its work in pulses, the load takes it evenly. What is given and not yet taken "
    "is kinetic energy of everything that moves; the crank speeds up only where pistons and rods "
    "leave some of it. A flywheel cannot stop the swing, only make it small."
)
_ENERGY = "The balance of energy"
_SLOW = 0.24  # coefficient of fluctuation by energy with which the first figure begins


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene.

    Raises
    ------
    InputError : a machine that does not settle
    """
    scene = free(machine, "omega")
    every = Extent(value=math.radians(0.1), unit="rad")
    result = settled(changed(scene, run={"every": every}))
    return Lesson(
        idea=IDEA,
        sections=(_moment(scene, result), _energy(scene, result), _speed(scene)),
        questions=(_swing(result), _fluctuation(result), _inertia(result)),
        scene=scene,
        about=f"The machine: {named(machine)}; its settled motion.",
        error=result.error.estimated,
    )


def _moment(scene: Scene, result: Result) -> Section:
    return Section(
        title="The gas gives in pulses, the load takes evenly",
        before="Turn the crank through a cycle at "
        '<output data-say="moment.mean"></output>. The load takes '
        '<output data-say="moment.load"></output> on average, the gas gives up to '
        '<output data-say="moment.most"></output>. Where the gas gives more than the load takes, '
        "the moving parts gain energy; whether the crank speeds up depends on what the pistons and "
        "rods take of it. It does so over "
        '<output data-say="moment.share"></output> of the angles with such a surplus: '
        '<output class="told" data-say="moment.verdict"></output>. Now move the rated speed of the '
        "load: the load then has its torque there, and the crank settles near it.",
        figure=Figure(
            name="moment",
            caption="Work per radian: what the gas gives to all pistons, what the load takes, and "
            "what load, pistons and rods take together. The crank speeds up where the first is "
            "above the last.",
            plots=("What is given and taken", "Crank speed"),
            knobs=(_speed_knob(scene, result),),
            ring=True,
        ),
        after="Pistons and rods have to be thrown and caught again twice a turn, which takes a "
        "torque that grows with the square of the speed; the gas and the load do not know the "
        "speed. Over the whole cycle all areas are equal, or the next cycle would be faster than "
        "this one.",
        formulas=(
            Formula(
                r"\frac{dT}{d\varphi} = M_{\text{gas}} - M_{\text{load}}",
                note="Exact, without weights and friction: T is the kinetic energy of all parts.",
                source=_ENERGY,
            ),
        ),
    )


def _speed_knob(scene: Scene, result: Result) -> Knob:
    """A slider of the load's rated speed that begins where the crank follows the gas: so slow that
    the energy makes the speed swing a lot."""
    speed = speed_of(scene) / RPM
    slow = speed * min(1.0, math.sqrt(_energy_swing(result) / _SLOW))
    first = math.copysign(float(f"{abs(slow):.2g}"), speed)
    low, high = sorted((0.85 * first, 1.25 * speed))
    return Knob("speed", speed_label(scene), "rpm", low, high, first, 0)


def _energy(scene: Scene, result: Result) -> Section:
    work = exact("textbook_work", textbook(result).work, "J")
    return Section(
        title="The difference is stored as kinetic energy",
        before="Summed over the angle, the difference is the kinetic energy. It swings by "
        '<output data-say="energy.swing"></output> around '
        '<output data-say="energy.stored"></output>. Make the flywheel heavier: far more is '
        "stored, but the swing hardly changes, because gas and load do not know of the flywheel.",
        figure=Figure(
            name="energy",
            caption="Kinetic energy of crank, flywheel, rods and pistons over one settled cycle.",
            plots=("Kinetic energy",),
            knobs=(flywheel_knob(scene),),
            ring=True,
        ),
        after=f"The next lesson sizes a flywheel with $W$ = {work} for the engine as it is: its "
        "$W$ also counts the inertia torque, which is what pistons and rods take from the crank "
        "and give back at constant speed. Here their energy is part of the store.",
    )


def _speed(scene: Scene) -> Section:
    return Section(
        title="From the energy to the speed",
        before="The speed follows from the energy and the inertia. The same swing of energy is a "
        'small swing of a large store: the speed now fluctuates by <output data-say="speed.delta">'
        "</output>. Even with constant energy it would not stand still: pistons and rods that "
        "move fast near mid-stroke and stop at its ends make the inertia swing between "
        '<output data-say="speed.least"></output> and <output data-say="speed.most"></output>.',
        figure=Figure(
            name="speed",
            caption="Crank speed, and what it would be if the inertia were constant at its mean.",
            plots=("Crank speed",),
            knobs=(flywheel_knob(scene),),
            machine=False,
        ),
        formulas=(
            Formula(
                r"\omega = \sqrt{\frac{2\,T(\varphi)}{J(\varphi)}}",
                note="Exact: J is the inertia of all parts as the crank feels it.",
                source=_ENERGY,
            ),
            Formula(
                r"\delta \approx \frac{\Delta T}{J\,\omega_m^2}",
                note="Approximate: what the swing of energy alone would do, were J constant.",
                source=_ENERGY,
            ),
        ),
    )


def _range(result: Result, quantity: Callable[[Mapping[str, Array]], Array]) -> Estimate:
    """The greatest less the least value of a quantity."""
    high, low = largest(result, quantity), largest(result, lambda v: -quantity(v))
    return Estimate(high.value + low.value, high.error + low.error)


def _energy_swing(result: Result) -> float:
    """The coefficient of fluctuation by the energy: its swing over twice its mean."""
    energy = result.data["kinetic_energy"].values
    return float(np.ptp(energy) / (2.0 * energy.mean()))


def _swing(result: Result) -> Question:
    solution = simulated("swing", _range(result, lambda v: v["kinetic_energy"]), "J")
    return Question(
        name="ask_swing",
        text="By how many joules does the kinetic energy swing over a cycle?",
        solution=solution,
        hint="Read the greatest and the least value with the cursor of the second figure.",
        answer=f"By {solution}, between the angles at which the torque of the gas crosses that of "
        "the load.",
        tolerance=0.02,
    )


def _fluctuation(result: Result) -> Question:
    measures = measure(result)
    solution = exact("from_energy", _energy_swing(result), "%", 100.0)
    return Question(
        name="ask_fluctuation",
        text="How much would the speed fluctuate by that swing alone, if the inertia were "
        "constant?",
        solution=solution,
        hint="Twice the mean kinetic energy is J times the square of the speed; the second figure "
        "shows both energies.",
        answer=f"By {solution}, the swing over twice the mean energy. The run has "
        f"{simulated('fluctuation', measures.fluctuation, '%', 100.0)}: what the inertia of rods "
        "and pistons adds, or takes away, is no small part.",
        tolerance=0.03,
    )


def _inertia(result: Result) -> Question:
    def inertia(variables: Mapping[str, Array]) -> Array:
        return 2.0 * variables["kinetic_energy"] / variables["crank_speed"] ** 2

    solution = simulated("inertia_swing", _range(result, inertia), "kg m²")
    least = -largest(result, lambda variables: -inertia(variables)).value
    return Question(
        name="ask_inertia",
        text="By how much does the inertia that the crank feels change over a turn?",
        solution=solution,
        hint="The text above the last figure gives its least and its greatest value.",
        answer=f"By {solution}, above a least of {least:.4g} kg m².",
        tolerance=0.03,
    )
