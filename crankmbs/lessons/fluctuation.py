"""Lesson 5: the speed swings with the torque; a flywheel makes the swing small, never zero."""

from __future__ import annotations

from crankmbs import lecture
from crankmbs.design.flywheel import flywheel
from crankmbs.lessons.freed import (
    Textbook,
    flywheel_knob,
    free,
    settled,
    textbook,
)
from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact, simulated
from crankmbs.lessons.runs import changed, joint, named, peak
from crankmbs.measures import measure
from crankmbs.page.knobs import Choice
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

__all__ = ["IDEA", "SCENE", "lesson"]

_WANTED = 0.01  # coefficient of fluctuation asked for in a question
_QUANTITIES = (
    "piston acceleration",
    "side thrust",
    "crank pin force, axial",
    "torque of the cylinder",
)

SCENE = "yi_diesel_free"
IDEA = (
    "The torque of the cylinders comes in pulses, the load takes it evenly: the speed "
    "swings. A formula for constant speed errs by what the flywheel does not smooth out."
)


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene.

    Raises
    ------
    InputError : a machine that does not settle
    """
    scene = free(machine, "fluctuation")
    result = settled(scene)
    formula = textbook(result)
    return Lesson(
        idea=IDEA,
        sections=(_swing(scene), _fall(scene), _cost(scene)),
        questions=(_coefficient(result, formula), _flywheel(scene, result), _lightest(scene)),
        scene=scene,
        about=f"The machine: {named(machine)}; its settled motion.",
        error=result.error.estimated,
        more={"textbook": {"work": formula.work, "moving": formula.moving}},
    )


def _swing(scene: Scene) -> Section:
    return Section(
        title="A heavier flywheel swings less",
        before="The ring around the flywheel turns evenly; the crank runs ahead of it and falls "
        "behind. Make the flywheel heavier by the slider, or drag its rim: the coefficient of "
        'fluctuation is now <output data-say="swing.delta"></output>, at a mean of '
        '<output data-say="swing.mean"></output>.',
        figure=Figure(
            name="swing",
            caption="Crank speed over one settled cycle, and the constant speed that the lectures "
            "assume.",
            plots=("Crank speed",),
            knobs=(flywheel_knob(scene),),
            ring=True,
        ),
        formulas=(
            Formula(
                r"\delta=\frac{\omega_{\max}-\omega_{\min}}{\omega_m}",
                note="Exact: this defines the coefficient of fluctuation.",
            ),
        ),
    )


def _fall(scene: Scene) -> Section:
    return Section(
        title="Twice the flywheel, half the swing",
        before="Each point of the curve is a separate run until it settles. The textbook needs "
        "only $W$, the greatest excess of work in a cycle at constant speed. At the dot the run "
        'has <output data-say="fall.delta"></output>.',
        figure=Figure(
            name="fall",
            caption="Coefficient of fluctuation over the inertia of crank and flywheel.",
            plots=("The fluctuation over the flywheel",),
            knobs=(flywheel_knob(scene),),
            machine=False,
            plays=False,
        ),
        after="$W$ is the work of gas, load and inertia torque, which is what pistons and rods "
        "take from the crank and give back. The energy of all moving parts together, as in the "
        "lesson before, swings by gas and load alone.",
        formulas=(
            Formula(
                r"\delta \approx \frac{W}{J\,\omega_m^2}",
                note="Approximate: W is the greatest excess of work in a cycle at constant speed, "
                "J the mean inertia of crank, rods and pistons.",
                source="The balance of energy, as textbooks have it",
            ),
        ),
    )


def _cost(scene: Scene) -> Section:
    return Section(
        title="What constant speed costs",
        before="The lectures calculate at constant speed. The same formula with the true speed and "
        "acceleration differs from that by "
        '<output data-say="cost.share"></output> of the peak; a heavier flywheel brings it down.',
        figure=Figure(
            name="cost",
            caption="The lecture's formula with the true speed and at constant speed; below, their "
            "difference.",
            plots=("A quantity, and what constant speed makes of it",),
            knobs=(flywheel_knob(scene),),
            choices=(Choice("quantity", "quantity", _QUANTITIES, _QUANTITIES[0]),),
            machine=False,
        ),
        after=r"Constant speed drops $s'\alpha$ and takes $\omega_m^2$ for $\omega^2$. "
        "Every inertia force follows the acceleration, and every bearing the force.",
        formulas=(
            Formula(
                r"a = s''\,\omega^2 + s'\,\alpha,\quad s'=\frac{ds}{d\varphi}",
                lecture.piston_acceleration,
            ),
        ),
    )


def _coefficient(result: Result, formula: Textbook) -> Question:
    measures = measure(result)
    inertia = result.scene.crank.moment_of_inertia
    solution = simulated("fluctuation", measures.fluctuation, "%", 100.0)
    return Question(
        name="ask_own",
        text=f"This engine has {inertia:.4g} kg m². What is its coefficient of fluctuation by the "
        f"textbook, when W is {exact('work', formula.work, 'J')}, rods and pistons add "
        f"{exact('moving', formula.moving, 'kg m²')} on average, and the speed is "
        f"{simulated('mean_speed', measures.mean_speed, 'rpm', 1.0 / RPM, 6)}?",
        solution=solution,
        hint="W over J times the square of the speed, which is in radians per second there.",
        answer=f"The run has {solution}; $W/(J\\omega_m^2)$ gives "
        f"{exact('formula', formula.fluctuation(inertia), '%', 100.0)}.",
        tolerance=0.03,
    )


def _flywheel(scene: Scene, result: Result) -> Question:
    present = measure(result).fluctuation.value
    limit = _WANTED if present > 1.2 * _WANTED else float(f"{0.5 * present:.1g}")
    wheel = flywheel(scene, limit)
    solution = simulated("inertia", wheel.inertia, "kg m²")
    return Question(
        name="ask_flywheel",
        text=f"Which inertia of crank and flywheel keeps the speed within {100.0 * limit:g} %?",
        solution=solution,
        hint="The fluctuation falls as the inverse of the whole inertia; rods and pistons help.",
        answer=f"$J=W/(\\delta\\omega_m^2)$, less what rods and pistons have, is "
        f"{exact('inertia_formula', wheel.lecture_crank.value, 'kg m²')}. "
        f"Found by runs: {solution}.",
        tolerance=0.03,
    )


def _lightest(scene: Scene) -> Question:
    inertia = float(f"{flywheel_knob(scene).low:.2g}")
    run = settled(changed(scene, crank={"inertia": inertia}))
    numbers = {}
    for name, variable in (("free", run), ("held", textbook(run).even)):
        numbers[name] = (
            simulated(f"acceleration_{name}", peak(variable, "piston_acceleration"), "m/s²"),
            simulated(f"crank_pin_{name}", joint(variable, "crank pin").peak, "kN", 1e-3),
        )
    (fastest, pin), (even, even_pin) = numbers["free"], numbers["held"]
    return Question(
        name="ask_lightest",
        text=f"With {inertia:g} kg m² only, constant speed says {even} for the greatest piston "
        "acceleration. How large is it in fact?",
        solution=fastest,
        hint="Put the slider of the last figure there, and read the peak as it swings.",
        answer=f"{fastest}. The greatest load of the crank pin is {pin}, at constant speed "
        f"{even_pin}: where the crank runs faster than its mean, inertia is greater than constant "
        "speed says.",
    )
