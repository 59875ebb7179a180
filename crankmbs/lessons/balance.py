"""Lesson 6: what several cylinders cancel, and which orders of force, couple and torque remain."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from crankmbs import lecture
from crankmbs.errors import InputError
from crankmbs.lessons.pieces import (
    Figure,
    Formula,
    Lesson,
    Number,
    Question,
    Section,
    exact,
    simulated,
)
from crankmbs.lessons.runs import changed, even, named, rod_ratio, speed_of
from crankmbs.measures import Estimate, orders
from crankmbs.page.knobs import FIRING_ORDERS, Choice, Knob, choices_of
from crankmbs.result import Result
from crankmbs.scene.parts import Cylinder, Layout
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["IDEA", "SCENE", "lesson", "reciprocating"]

_RIGHT_ANGLE = 90.0  # deg between the cylinders of a twin

SCENE = "grega_lecture"
IDEA = (
    "Each cylinder shakes the engine and drives it in the same orders. With several, evenly "
    "spaced, most orders cancel; those that are left add up, and are higher. What cancels as a "
    "force may stay as a couple that rocks the engine."
)


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene.

    Raises
    ------
    InputError : a scene whose cylinders differ
    """
    if not any(choice.name == "cylinders" for choice in choices_of(machine)):
        raise InputError(
            "gas: the lesson balance gives every number of cylinders the same gas, and fuel to "
            "none; a scene with one pressure or fuel for all is needed"
        )
    scene = dataclasses.replace(even(machine), fuel=None, gravity=None)
    spacing = _spacing(scene)
    four = dataclasses.replace(scene, layout=Layout(firing_order=FIRING_ORDERS["4"]))
    questions = [_second_order(four), _rocking(scene, spacing), _counterweight(scene)]
    if scene.gas is not None:
        questions.append(_lowest_torque(four))
    return Lesson(
        idea=IDEA,
        sections=(_shake(), _couple(), _torque(), _twin()),
        questions=tuple(questions),
        scene=scene,
        about=f"The machine: {named(machine)}, at constant speed, also with other cylinders.",
        error=simulate(four).error.estimated,
        more={"spacing": spacing},
    )


def _spacing(scene: Scene) -> float:
    """Axial distance of neighbouring cylinders [m]: the scene's, or a little more than a bore."""
    if scene.layout.spacing is not None:
        return scene.layout.spacing
    area = scene.piston.gas_area
    wide = 2.0 * scene.crank.radius if area is None else math.sqrt(4.0 * area / math.pi)
    return 1.1 * wide


def _cylinders(first: str, words: tuple[str, ...] = tuple(FIRING_ORDERS)) -> Choice:
    return Choice("cylinders", "cylinders in line", words, first)


def _shake() -> Section:
    return Section(
        title="Four cylinders cancel the first order and add up the second",
        before="Only the reciprocating masses shake the engine here: rotating masses are balanced, "
        "and gas pushes head and bearing alike. With these cylinders "
        '<output data-say="shake.first"></output> of the first order are left, and '
        '<output data-say="shake.second"></output> of the second.',
        figure=Figure(
            name="shake",
            caption="Force of the moving pistons on the engine's frame, positive towards the "
            "crank as in the formulas, and the amplitudes of its orders.",
            plots=("Force on the frame, towards the crank", "Its orders"),
            beside=True,
            choices=(_cylinders("4"),),
        ),
        formulas=(
            Formula(
                r"F_{I} = -m_A\,r\omega^2\cos\varphi",
                lecture.first_order_inertia_force,
                note="Approximate: of one cylinder, positive towards the crank.",
            ),
            Formula(
                r"F_{II} = -m_A\,r\omega^2\,\lambda\cos 2\varphi",
                lecture.second_order_inertia_force,
                note="Approximate: of one cylinder, positive towards the crank.",
            ),
        ),
    )


def _couple() -> Section:
    return Section(
        title="What cancels as a force may rock the engine",
        before='<output class="told" data-say="couple.words"></output> The couple is up to '
        '<output data-say="couple.most"></output>. Choose another number of cylinders: those whose '
        "cranks stand as in a mirror have none.",
        figure=Figure(
            name="couple",
            caption="The crank from the side, with the force of each piston on the frame, and "
            "their couple about the middle of the crank.",
            plots=("Rocking couple",),
            choices=(_cylinders("3", ("2", "3", "4", "5", "6")),),
            drawing="the cylinders in a row, and the force of each",
        ),
        formulas=(
            Formula(
                r"M = \sum_k z_k F_k",
                note="Exact: z is how far a cylinder stands from the middle of the crank.",
                source="The balance of moments",
            ),
        ),
    )


def _torque() -> Section:
    return Section(
        title="The torque keeps every order that n/2 divides",
        before="Each cylinder drives the crank in pulses. A four-stroke cylinder has the orders "
        "1/2, 1, 3/2 and so on; n of them, evenly fired, leave only multiples of n/2: here "
        '<output data-say="torque.orders"></output> and so on.',
        figure=Figure(
            name="torque",
            caption="Torque of all cylinders on the crank over one cycle, and its orders.",
            plots=("Torque on the crank", "Its orders"),
            beside=True,
            choices=(_cylinders("4"),),
        ),
        formulas=(Formula(r"M_k = F_T\,r", lecture.crank_torque),),
    )


def _twin() -> Section:
    return Section(
        title="A V-twin at 90 degrees can be balanced",
        before="Two rods on one pin. Open the angle between the cylinders: at 90 degrees the first "
        "order is a circle, a force that turns with the crank. Then a counterweight takes it away: "
        'now <output data-say="twin.first"></output> of the first order is left.',
        figure=Figure(
            name="twin",
            caption="Force on the frame as a curve in the plane, X up and Y to the left as in the "
            "engine beside it, and its first order. The weight is in percent of one piston with "
            "its share of the rod, at the crank radius.",
            plots=("Force on the frame, in the plane",),
            knobs=(
                Knob("bank", "angle between the cylinders", "°", 0.0, 160.0, 60.0, 0),
                Knob("weight", "counterweight", "%", 0.0, 120.0, 0.0, 0),
            ),
        ),
    )


def _second_order(four: Scene) -> Question:
    run = simulate(reciprocating(four))
    scene, omega = run.scene, speed_of(run.scene)
    ratio = rod_ratio(scene)
    unit = scene.piston.mass * scene.crank.radius * omega**2
    first, second = (amplitude(run, "frame_force_x", order) for order in (1.0, 2.0))
    solution = simulated("second", second, "kN", 1e-3)
    return Question(
        name="ask_second",
        text="How hard do four pistons shake the frame in the second order? Each has "
        f"{exact('mass', scene.piston.mass, 'kg')} with its share of the rod; the crank radius is "
        f"{exact('radius', scene.crank.radius, 'mm', 1e3)}, the rod ratio {exact('ratio', ratio)}, "
        f"the speed {exact('turning', omega, 'rad/s')}.",
        solution=solution,
        hint="All four are alike in the second order, so their forces add up.",
        answer=f"First order: {_force('first', first.value)}. The second orders add up to "
        f"$4\\,m_A r\\omega^2\\lambda$ = "
        f"{exact('second_lecture', 4.0 * unit * ratio, 'kN', 1e-3)}; simulated {solution}, because "
        r"the lectures' series drops $\lambda^3/4$ and what follows.",
        tolerance=0.03,
    )


def _force(name: str, value: float) -> str:
    """A force that is nothing but rounding reads as nothing."""
    return str(exact(name, value if value > 1e-6 else 0.0, "N"))


def _rocking(scene: Scene, spacing: float) -> Question:
    layout = Layout(firing_order=FIRING_ORDERS["3"], spacing=spacing)
    run = simulate(reciprocating(dataclasses.replace(scene, layout=layout)))
    omega = speed_of(run.scene)
    unit = run.scene.piston.mass * scene.crank.radius * omega**2
    formula = exact("couple_lecture", math.sqrt(3.0) * unit * spacing, "N m")
    solution = simulated("couple_first", amplitude(run, "rocking_moment_y", 1.0), "N m")
    return Question(
        name="ask_couple",
        text=f"How large is the first order of the couple of three cylinders, "
        f"{exact('spacing', spacing, 'mm', 1e3)} apart?",
        solution=solution,
        hint="Only the outer two have a lever. Their forces stand 120 degrees apart, and so does "
        "one lever from minus the other: the root of 3 comes in.",
        answer=f"$\\sqrt{{3}}\\,m_A r\\omega^2 z$ = {formula}; simulated {solution}. No "
        "counterweight that turns with the crank takes all of it away.",
        tolerance=0.02,
    )


def _counterweight(scene: Scene) -> Question:
    pair = twin(scene, _RIGHT_ANGLE)
    mass, r = pair.piston.mass, scene.crank.radius
    weight = {"mass": mass, "center_of_mass": -r}
    before, after = simulate(pair), simulate(changed(pair, crank=weight))
    omega = speed_of(before.scene)
    ratio = rod_ratio(scene)
    solution = exact("counterweight", mass, "kg")
    first = simulated("twin_before", amplitude(before, "frame_force_x", 1.0), "kN", 1e-3)
    second = simulated("twin_second", amplitude(after, "frame_force_y", 2.0), "kN", 1e-3)
    left = exact("twin_lecture", math.sqrt(2.0) * mass * r * omega**2 * ratio, "kN", 1e-3)
    return Question(
        name="ask_weight",
        text="Which counterweight, at the crank radius, balances the V-twin at 90 degrees?",
        solution=solution,
        hint="At 90 degrees the two pistons together are like one that turns with the pin.",
        answer=f"{solution}: one piston with its share of the rod. First order before: {first}, "
        f"after: {_force('twin_after', amplitude(after, 'frame_force_x', 1.0).value)}. The second "
        f"order is left, across the engine: $\\sqrt{{2}}\\,m_A r\\omega^2\\lambda$ = {left}; "
        f"simulated {second}.",
    )


def _lowest_torque(four: Scene) -> Question:
    still = changed(four, rod={"mass": 0.0, "inertia": 0.0}, piston={"mass": 0.0})
    runs = {"both": four, "gas": still, "inertia": dataclasses.replace(four, gas=None)}
    estimates = {
        name: amplitude(simulate(run), "external_torque", 2.0) for name, run in runs.items()
    }
    both, gas, inertia = (
        simulated(f"torque_{name}", value, "N m") for name, value in estimates.items()
    )
    return Question(
        name="ask_torque",
        text="In the second order the torque of four cylinders' gas has "
        f"{Number('gas_asked', gas.value, 'N m')}, their moving masses "
        f"{Number('inertia_asked', inertia.value, 'N m')}. They work against one another. What is "
        "left?",
        solution=both,
        hint="The second stick in the figure of the torque, with four cylinders.",
        answer=f"The gas has {gas} in that order and the moving masses {inertia}, almost opposite "
        f"to it: {both} are left. Inertia grows with the square of the speed, gas does not, so "
        "this holds at this speed only.",
        tolerance=0.1,
    )


def reciprocating(scene: Scene) -> Scene:
    """The machine without gas, its rotating masses balanced, m_A with the piston."""
    rod = {"mass": 0.0, "inertia": 0.0}
    crank = {"mass": 0.0, "center_of_mass": 0.0, "inertia": None}
    lumped = changed(scene, crank=crank, rod=rod, piston={"mass": _moving_mass(scene)})
    return dataclasses.replace(lumped, gas=None)


def twin(scene: Scene, angle: float) -> Scene:
    """Two cylinders this many degrees apart, both rods on the pin at the crank's reference line."""
    half = math.radians(0.5 * angle)
    pair = (Cylinder(phase=half, bank=-half), Cylinder(phase=-half, bank=half))
    return dataclasses.replace(reciprocating(scene), layout=Layout(cylinders=pair))


def amplitude(result: Result, name: str, order: float) -> Estimate:
    """Amplitude of one order of a variable."""
    split = orders(result, name)
    at = int(np.argmin(np.abs(split.order - order)))
    return Estimate(float(split.amplitude[at]), split.error)


def _moving_mass(scene: Scene) -> float:
    """The lectures' reciprocating mass m_A [kg]."""
    rod = scene.rod
    share = lecture.two_mass_rod(
        rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
    ).piston_pin
    return float(
        lecture.reciprocating_mass(piston_mass=scene.piston.mass, rod_piston_pin_mass=share)
    )
