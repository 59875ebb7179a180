"""Lesson 3: the side thrust, and what a rod of two masses misses of it."""

from __future__ import annotations

import math

import numpy as np

from crankmbs import lecture
from crankmbs.compare import Budget, budget, compare
from crankmbs.errors import InputError
from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact, simulated
from crankmbs.lessons.runs import (
    changed,
    finely,
    held,
    named,
    peak,
    peak_angle,
    ratio_knob,
    speed_knob,
    speed_of,
)
from crankmbs.measures import Estimate, measure
from crankmbs.page.knobs import Choice, Knob
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["IDEA", "SCENE", "lesson"]

_SPACING = 0.1  # deg, of the samples
_QUANTITIES = (
    "side force on the piston",
    "torque of the cylinder",
    "crank pin force, axial",
    "crank pin force, across",
)

SCENE = "yi_diesel"
IDEA = (
    "Gas and inertia push the piston along the cylinder; the tilted rod turns part of it "
    "against the wall. Two masses in place of the rod weigh as much and have the same centre of "
    "mass, but too much inertia: the side thrust is then wrong, the mean torque never is."
)


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene.

    Raises
    ------
    InputError : a rod without mass, or no gas
    """
    scene = held(machine, "forces")
    if not _two_masses(scene) > 0.0:
        raise InputError(
            "rod.mass: the lesson forces swings a rod that has mass, its center_of_mass between "
            f"the pins; {scene.rod.mass:g} kg with {scene.rod.center_of_mass:g} m came"
        )
    result = finely(scene, _SPACING)
    return Lesson(
        idea=IDEA,
        sections=(_along(scene), _side(scene), _worth(scene)),
        questions=(_greatest(result), _missing(result, budget(result)), _torque(result)),
        scene=scene,
        about=f"The machine: {named(machine)}, at constant speed.",
        error=result.error.estimated,
    )


def _along(scene: Scene) -> Section:
    return Section(
        title="Gas against inertia",
        before="Along the cylinder two forces meet on the piston pin: that of the gas, and that of "
        "the mass $m_A$ that moves with the piston. Where the gas pushes most, with "
        '<output data-say="along.gas"></output>, inertia has '
        '<output data-say="along.inertia"></output>. Turn the speed up: inertia grows with its '
        "square, the gas does not.",
        figure=Figure(
            name="along",
            caption="Forces towards the crank over one cycle; the arrows are those on the piston.",
            plots=("Gas, inertia, and their sum",),
            knobs=(speed_knob(scene),),
            forces="piston",
        ),
        formulas=(
            Formula(r"F_v = F_p + F_{zp}", lecture.net_force),
            Formula(r"F_{zp} = -m_A\,a", lecture.inertia_force),
        ),
    )


def _side(scene: Scene) -> Section:
    share = scene.rod.moment_of_inertia / _two_masses(scene)
    label = "rod inertia / that of two masses"
    return Section(
        title="The rod is not two masses",
        before="The tilted rod presses the piston against the wall. The lectures put two masses in "
        "place of the rod, with the right mass and centre but too much inertia. Move the slider: "
        "both agree only where the rod has the inertia of its two masses. At present they differ "
        'by <output data-say="side.off"></output> at most.',
        figure=Figure(
            name="side",
            caption="Side thrust of the wall on the piston with a rigid rod and with the lecture's "
            "two masses; below, their difference.",
            plots=("Side thrust on the piston",),
            knobs=(Knob("share", label, "", min(0.6, share), max(1.2, share), share, 3),),
            forces="piston",
        ),
        after=r"A rod with less inertia than $m\,a\,b$ needs a smaller couple "
        r"$I\,\varepsilon$ for its angular acceleration $\varepsilon$. The wall gives it "
        r"with the lever $l\,\cos\beta$, so two masses are wrong by "
        r"$(m\,a\,b-I)\,\varepsilon/(l\,\cos\beta)$.",
        formulas=(
            Formula(r"N = F_v\,\tan\beta", lecture.side_thrust),
            Formula(r"I_2 = m\,a\,b,\quad b=l-a", lecture.two_mass_rod_inertia),
        ),
    )


def _worth(scene: Scene) -> Section:
    return Section(
        title="What each simplification costs",
        before="The truncated lecture errs twice: by its two masses, here at most "
        '<output data-say="worth.masses"></output> of the peak, and by its two harmonics, '
        '<output data-say="worth.series"></output>. Choose a force: along the cylinder two masses '
        "are exact, across it they are not.",
        figure=Figure(
            name="worth",
            caption="Simulated, by the untruncated formulas for two masses, and by the truncated "
            "lecture; below, what each step leaves out.",
            plots=("A force, and its errors by cause",),
            knobs=(ratio_knob(scene), speed_knob(scene)),
            choices=(Choice("quantity", "force", _QUANTITIES, _QUANTITIES[0]),),
            machine=False,
        ),
        formulas=(
            Formula(
                r"N \approx F_v\,\lambda\,(\sin\varphi-k),\quad k=e/r", lecture.side_thrust_series
            ),
            Formula(r"M_k = F_T\,r", lecture.crank_torque),
        ),
    )


def _two_masses(scene: Scene) -> float:
    """Inertia [kg m2] that the lecture's two masses have about the rod's centre of mass."""
    rod = scene.rod
    return float(
        lecture.two_mass_rod_inertia(
            rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
        )
    )


def _greatest(result: Result) -> Question:
    thrust = peak(result, "side_force")
    at = peak_angle(result, "side_force", 0.0, 720.0)
    answers = compare(result)
    two, truncated = (
        answers.row("side thrust", name)
        for name in ("untruncated lecture", "S1 (motion and forces truncated)")
    )
    angle = math.degrees(answers.excerpt.size("side thrust", np.maximum(two.values, 0.0)).angle)
    solution = simulated("side_peak", thrust, "kN", 1e-3, 5)
    return Question(
        name="ask_thrust",
        text="How hard does the piston press against the wall, at most, on the side on which it "
        "does so after firing?",
        solution=solution,
        hint="Drag the cursor of the side thrust to its peak, and read the rigid rod's value.",
        answer=f"{solution} at "
        f"{simulated('side_angle', at, '°')}, just after firing. The lecture says "
        f"{exact('side_two_masses', two.values.max(), 'kN', 1e-3, 5)} with two masses, at "
        f"{simulated('side_two_angle', Estimate(angle, _SPACING), '°')}, and "
        f"{exact('side_truncated', truncated.values.max(), 'kN', 1e-3, 5)} truncated.",
    )


def _missing(result: Result, split: Budget) -> Question:
    scene = result.scene
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    omega = speed_of(result.scene)
    row = split.split("side thrust")
    cause = row.cause("two-mass rod")
    missing = Estimate(
        cause.size.largest, 2.0 * float(result.data["side_force"].attrs["error_estimate"])
    )
    angle = Estimate(math.degrees(cause.size.angle), _SPACING)
    share = Estimate(row.share(cause), 100.0 * missing.error / row.peak)
    sine = (r + abs(e)) / l
    cosine = math.sqrt(1.0 - sine**2)
    swing = r / l * omega**2 / cosine  # at 270 degrees, where beta' is 0
    couple = (_two_masses(scene) - scene.rod.moment_of_inertia) * swing
    solution = simulated("missing", missing, "N")
    return Question(
        name="ask_missing",
        text="By how many newtons, at most, is the side thrust wrong because of the two masses?",
        solution=solution,
        hint="The strip below the side thrust shows it, with the slider where the rod has it.",
        tolerance=0.02,
        answer=f"At {simulated('missing_angle', angle, '°')} the rod swings hardest, "
        rf"$|\varepsilon|=\lambda\omega^2/\cos\beta$, and the couple too much is "
        f"{exact('couple', couple, 'N m')}: {exact('missing_formula', couple / l / cosine, 'N')} "
        f"at the wall. The error budget finds {solution}, "
        f"{simulated('missing_share', share, '%', most=3)} of the peak.",
    )


def _torque(result: Result) -> Question:
    lumped = simulate(changed(result.scene, rod={"inertia": "two-mass"}))
    names = ("torque_peak", "mean"), ("torque_two", "mean_two")
    (rigid, mean), (two, mean_two) = (
        (
            simulated(greatest, peak(run, "crank_torque"), "N m", most=5),
            simulated(average, measure(run).crank_torque, "N m", most=5),
        )
        for (greatest, average), run in zip(names, (result, lumped), strict=True)
    )
    number = measure(result).crank_torque
    return Question(
        name="ask_torque",
        text="Does the error reach the power? What is the mean torque of one cylinder with two "
        f"masses, when it is {simulated('mean_asked', number, 'N m', most=5)} with the rigid rod?",
        solution=simulated("mean_wanted", number, "N m", most=5),
        hint="How much work does it take to swing a rod to and fro, over a cycle?",
        answer=f"The same, so no. The greatest torque is {rigid}, with two masses {two}; "
        f"the mean is {mean} and {mean_two}. Swinging the rod to and fro takes no work over a "
        "cycle.",
    )
