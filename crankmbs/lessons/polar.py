"""Lesson 7: how to read a bearing polar."""

from __future__ import annotations

import math

from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact, simulated
from crankmbs.lessons.runs import held, joint, named, speed_knob
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["IDEA", "SCENE", "lesson"]

SCENE = "propeller"
IDEA = (
    "A polar plot of a bearing force is a map: every point is the force at one crank angle, with "
    "its size as the distance from the middle and its direction as it acts. It shows where a "
    "bearing wears and where oil may enter."
)


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene.

    Raises
    ------
    InputError : no gas, or no speed
    """
    scene = held(machine, "polar")
    result = simulate(scene)
    return Lesson(
        idea=IDEA,
        sections=(_bearing(scene), _pin(scene), _turning(scene)),
        questions=(_greatest(result), _where(result), _mean(result)),
        scene=scene,
        about=f"The machine: {named(machine)}, at constant speed.",
        error=result.error.estimated,
    )


def _bearing(scene: Scene) -> Section:
    return Section(
        title="A point is a force",
        before="Drag the crank and watch the dot. The line from the middle to the dot is the force "
        "of the main bearing on the crank, X up along the engine and Y to the left, as in the "
        "mechanism beside it. The other curve is its length over the crank angle.",
        figure=Figure(
            name="bearing",
            caption="The force of the main bearing on the crank over one cycle, as a polar and by "
            "its size; the arrows show the forces on the crank.",
            plots=("Main bearing, polar", "The size of the same force"),
            beside=True,
            forces="crank",
        ),
        after='The force is greatest, <output data-say="bearing.peak"></output>, at a crank angle '
        'of <output data-say="bearing.angle"></output>. The small dots are ten degrees apart: '
        "where they lie far from each other, the force changes quickly; where they crowd, it "
        "stays.",
        formulas=(
            Formula(
                r"F = \sqrt{F_X^2+F_Y^2},\quad \tan\gamma = \frac{F_Y}{F_X}",
                note="Exact: size and direction of a point.",
            ),
        ),
    )


def _pin(scene: Scene) -> Section:
    return Section(
        title="Gas pulls the loop one way, inertia the other",
        before="This is the force of the crank on the rod at the crank pin, X along the cylinder. "
        "The spike is the gas after firing; the round loop is inertia. Turn the speed up: the loop "
        "grows with its square, and the spike shrinks because inertia works against the gas. The "
        'greatest force is <output data-say="pin.peak"></output>, at '
        '<output data-say="pin.angle"></output>.',
        figure=Figure(
            name="pin",
            caption="Force of the crank on the rod, in the frame of the cylinder.",
            plots=("Crank pin, polar",),
            knobs=(speed_knob(scene),),
            forces="rod",
        ),
    )


def _turning(scene: Scene) -> Section:
    return Section(
        title="Seen from the turning pin: where oil may enter",
        before="The same force, now of the rod on the pin, in a frame that turns with the crank: "
        "up is outwards, left is ahead of the crank. The rod's inertia always pulls the pin "
        "outwards, so most of the loop lies there. A force presses on the side from which it "
        "comes. The dotted green line points to where the pin is loaded least over the cycle, "
        '<output data-say="turning.hole"></output> from outwards, counted against the clock: a '
        "good place for the oil hole.",
        figure=Figure(
            name="turning",
            caption="Force of the rod on the crank pin in the frame of the crank; the green line "
            "counts what presses within 60 degrees to either side.",
            plots=("Crank pin, in a frame that turns with it",),
            knobs=(speed_knob(scene),),
            forces="crank",
        ),
        formulas=(
            Formula(
                r"F_r = F_X\cos\varphi + F_Y\sin\varphi,\quad "
                r"F_t = F_Y\cos\varphi - F_X\sin\varphi",
                note="Exact: the same force, outwards along the crank and across it.",
            ),
        ),
    )


def _greatest(result: Result) -> Question:
    solution = simulated("bearing_peak", joint(result, "main bearing").peak, "kN", 1e-3)
    return Question(
        name="ask_peak",
        text="How large is the greatest force of the main bearing?",
        solution=solution,
        hint="The point farthest from the middle, or the peak of the curve of its size.",
        answer=f"{solution}.",
        tolerance=0.015,
    )


def _where(result: Result) -> Question:
    load = joint(result, "crank pin")
    degrees = math.degrees(load.crank_angle)
    solution = exact("pin_angle", degrees, "°")
    peak = simulated("pin_peak", load.peak, "kN", 1e-3)
    return Question(
        name="ask_where",
        text="At which crank angle is the crank pin of the first cylinder loaded most?",
        solution=solution,
        hint="Drag the crank until the dot of the second figure is farthest from the middle.",
        answer=f"At {solution}, with {peak}.",
        tolerance=0.015,
    )


def _mean(result: Result) -> Question:
    load = joint(result, "main bearing")
    solution = simulated("bearing_mean", load.mean, "kN", 1e-3)
    return Question(
        name="ask_mean",
        text="How large is the force of the main bearing on average over time? Guess from the "
        "curve of its size.",
        solution=solution,
        hint="The spike is short: what counts is where the curve stays.",
        answer=f"{solution}, far less than the peak of "
        f"{simulated('bearing_again', load.peak, 'kN', 1e-3)}: a bearing is made for both.",
        tolerance=0.1,
    )
