"""Lesson 1: the piston is past half its stroke when the crank is at 90 degrees."""

from __future__ import annotations

import math

from crankmbs import lecture
from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact, simulated
from crankmbs.lessons.runs import changed, named, one_cylinder, ratio_knob, rod_ratio, sample
from crankmbs.measures import Estimate
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["IDEA", "SCENE", "lesson"]

SCENE = "grega_lecture"
IDEA = (
    "The rod tilts while the crank turns, so the piston is ahead of a plain cosine: at 90 "
    "degrees it is already past half its stroke. The lead is the Brix correction."
)

_SHARE = 0.02  # of the stroke: the correction asked for in the last question


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene."""
    scene = one_cylinder(machine)
    result = simulate(scene)
    return Lesson(
        idea=IDEA,
        sections=(_half(scene), _series(scene)),
        questions=(_lead(result), _middle(result), _long_rod(result)),
        scene=scene,
        about=f"One cylinder of {named(machine)}: no gas, no offset, constant speed.",
        error=result.error.estimated,
    )


def _half(scene: Scene) -> Section:
    return Section(
        title="At 90 degrees the piston is past the middle",
        before="Turn the crank to 90 degrees, by its pin or by the slider. The dashed line is half "
        "the stroke, and the piston pin has passed it: by "
        '<output data-say="half.lead"></output> with this rod. The rod leans most there, and '
        "because it leans it does not reach as high.",
        figure=Figure(
            name="half",
            caption="The mechanism to scale, and the piston over one turn with the cosine of an "
            "infinitely long rod. A shorter rod leads more.",
            plots=("The piston, and an infinitely long rod",),
            knobs=(ratio_knob(scene),),
            angle=90.0,
        ),
        after="It passes the middle earlier, at "
        '<output data-say="half.angle"></output>, where crank and rod make a triangle of two '
        "equal sides.",
        formulas=(
            Formula(
                r"s = r\,(1-\cos\varphi)+\frac{r}{\lambda}\,(1-\cos\beta),\quad "
                r"\sin\beta=\lambda\,\sin\varphi",
                lecture.piston_displacement,
            ),
            Formula(
                r"\Delta s = s(90^\circ)-r = r\,\frac{1-\sqrt{1-\lambda^2}}{\lambda}",
                lecture.brix_correction,
            ),
        ),
    )


def _series(scene: Scene) -> Section:
    return Section(
        title="Two harmonics are nearly enough",
        before="The lectures replace the tilt by one cosine of twice the angle. Both curves "
        "coincide to the eye; the strip below shows the error. It vanishes at 0 and 180 "
        "degrees and is largest at 90, where the formula is short by "
        '<output data-say="series.short"></output>, '
        r"about $r\lambda^3/8$, at any speed.",
        figure=Figure(
            name="series",
            caption="The piston and the truncated formula; below, their difference.",
            plots=("What two harmonics leave out",),
            knobs=(ratio_knob(scene),),
            angle=90.0,
            machine=False,
        ),
        formulas=(
            Formula(
                r"s \approx r\,(1-\cos\varphi)+r\,\frac{\lambda}{4}\,(1-\cos 2\varphi)",
                lecture.piston_displacement_series,
                note="Approximate, order 3 in λ: short of the exact by r λ³ sin⁴ φ / 8.",
            ),
            Formula(r"\Delta s \approx r\,\frac{\lambda}{2}", lecture.brix_correction_series),
        ),
    )


def _gear(scene: Scene) -> dict[str, float]:
    return {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}


def _lead(result: Result) -> Question:
    gear, r = _gear(result.scene), result.scene.crank.radius
    at = sample(result, "piston_displacement", 90)
    truth = simulated("brix_simulated", Estimate(at.value - r, at.error), "mm", 1e3, 5)
    formula = exact("brix_exact", lecture.brix_correction(**gear), "mm", 1e3, 5)
    series = exact("brix_series", lecture.brix_correction_series(**gear), "mm", 1e3, 5)
    return Question(
        name="ask_lead",
        text="How far past half its stroke is the piston at 90 degrees? The crank radius is "
        f"{exact('radius_asked', r, 'mm', 1e3)}, the rod "
        f"{exact('rod_asked', result.scene.rod.length, 'mm', 1e3)} long.",
        solution=truth,
        hint="Half of r times the rod ratio is a good start; the exact one has a root.",
        answer=rf"$r\lambda/2$ = {series} by the truncated formula, {formula} by the exact one. "
        f"The simulated piston is {truth} past it.",
        tolerance=0.025,
    )


def _middle(result: Result) -> Question:
    r, ratio = result.scene.crank.radius, rod_ratio(result.scene)
    angle = math.acos(0.5 * ratio)
    there = simulate(changed(result.scene, motion={"angle": angle}))
    at = simulated("half_stroke", sample(there, "piston_displacement", 0), "mm", 1e3, 6)
    solution = exact("half_angle", math.degrees(angle), "°")
    return Question(
        name="ask_middle",
        text="At which crank angle is the piston at half its stroke?",
        solution=solution,
        also=(360.0 - solution.value,),
        hint="The piston pin is then one rod's length from the crank axis: crank, rod and that "
        "distance make a triangle with two equal sides.",
        answer=r"Where the crank and the rod make an isosceles triangle, $\cos\varphi=\lambda/2$: "
        f"at {solution}, not at 90°, and again on the way up. A run that starts there has the "
        f"piston at {at}, and half the stroke is {exact('radius', r, 'mm', 1e3)}.",
        tolerance=0.003,
    )


def _long_rod(result: Result) -> Question:
    r = result.scene.crank.radius
    lead = 2.0 * r * _SHARE
    length = (r**2 + lead**2) / (2.0 * lead)
    run = simulate(changed(result.scene, rod={"length": length}))
    at = sample(run, "piston_displacement", 90)
    share = Estimate((at.value - r) / (2.0 * r), at.error / (2.0 * r))
    solution = exact("rod_exact", length, "mm", 1e3, 5)
    return Question(
        name="ask_rod",
        text="How long must the rod be to keep the Brix correction at "
        f"{100.0 * _SHARE:g} % of the stroke?",
        solution=solution,
        hint="The correction is about a quarter of the rod ratio, of the stroke.",
        answer=rf"$\lambda/4$ = {_SHARE:g} gives "
        f"{exact('rod_series', r / (4.0 * _SHARE), 'mm', 1e3)}; exactly it is {solution}, twelve "
        "and a half crank radii, where an engine has three to four. "
        f"Simulated with it: {simulated('share', share, '%', 100.0, 6)} of the stroke.",
    )
