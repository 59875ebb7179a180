"""Lesson 2: the acceleration has its minimum at bottom dead centre only with a long rod."""

from __future__ import annotations

import math

from crankmbs import lecture
from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact, simulated
from crankmbs.lessons.runs import (
    changed,
    finely,
    named,
    one_cylinder,
    peak,
    peak_angle,
    ratio_knob,
    rod_ratio,
    sample,
    speed_of,
)
from crankmbs.page.knobs import Knob
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["IDEA", "SCENE", "lesson"]

_LIMIT = lecture.ACCELERATION_MINIMUM_LIMIT
_LIMIT_SERIES = lecture.ACCELERATION_MINIMUM_LIMIT_SERIES

SCENE = "grega_lecture"
IDEA = (
    "The tilting rod adds a second harmonic to the acceleration. With a long rod it is "
    f"least at bottom dead centre; above a rod ratio of {_LIMIT:.4f} the minimum splits in two "
    "and leaves it."
)


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene."""
    scene = one_cylinder(machine)
    result = finely(scene)
    return Lesson(
        idea=IDEA,
        sections=(_motion(scene), _valley(scene), _fork(scene)),
        questions=(_minimum(result), _fastest(result), _shortest(result)),
        scene=scene,
        about=f"One cylinder of {named(machine)}: no gas, no offset, constant speed.",
        error=result.error.estimated,
    )


def _motion(scene: Scene) -> Section:
    return Section(
        title="The piston starts fast and stops slowly",
        before="Turn the crank: near the top the piston is thrown back and forth within a narrow "
        "angle, near the bottom it takes its time. Velocity and acceleration are shown in parts of "
        r"$r\omega$ and $r\omega^2$, so the curves depend on the rod ratio alone.",
        figure=Figure(
            name="motion",
            caption="Velocity and acceleration at constant speed, and what two harmonics say.",
            plots=(r"Velocity over $r\omega$", r"Acceleration over $r\omega^2$"),
            knobs=(ratio_knob(scene),),
            angle=60.0,
        ),
        formulas=(
            Formula(
                r"v = r\omega\,(\sin\varphi+\cos\varphi\,\tan\beta)",
                lecture.piston_velocity,
            ),
            Formula(
                r"a = r\omega^2\,(\cos\varphi-\sin\varphi\,\tan\beta)"
                r"+r\omega^2\,\frac{\lambda\,\cos^2\varphi}{\cos^3\beta}"
                r"+\frac{v}{\omega}\,\alpha",
                lecture.piston_acceleration,
            ),
        ),
    )


def _valley(scene: Scene) -> Section:
    return Section(
        title="The valley of the acceleration becomes two",
        before="This is the same acceleration near bottom dead centre, much enlarged and counted "
        "from its value there. Shorten the rod by the slider: the floor of the valley flattens, "
        "then rises in the middle. With a rod ratio of "
        '<output data-say="valley.ratio"></output> the acceleration is least '
        '<output data-say="valley.least"></output>, at the filled dots.',
        figure=Figure(
            name="valley",
            caption=f"Move the slider across {_LIMIT_SERIES:g}, where the truncated formula says "
            f"that the valley splits, and {_LIMIT:.4f}, where it does.",
            plots=("Acceleration near bottom dead centre",),
            knobs=(ratio_knob(scene, 0.2, 0.36, first=0.22),),
            angle=150.0,
            machine=False,
        ),
    )


def _fork(scene: Scene) -> Section:
    return Section(
        title=f"The valley splits at {_LIMIT:.4f}; the truncated formula says 1/4",
        before="For every rod ratio, where is the acceleration least? One line becomes two: the "
        'fork is at <output data-say="fork.limit"></output>. This rod has '
        '<output data-say="fork.ratio"></output>.',
        figure=Figure(
            name="fork",
            caption="Crank angle of the least acceleration over the rod ratio; the dot is the rod "
            "of the slider.",
            plots=("Where the acceleration is least",),
            knobs=(Knob("rod_ratio", "rod ratio r/l", "", 0.15, 0.45, _within(scene), 3),),
            machine=False,
            plays=False,
        ),
        after=r"At bottom dead centre the curvature of the truncated acceleration is "
        r"$1-4\lambda$: it changes sign at 1/4. The exact one is $3\lambda^3-4\lambda+1$, so the "
        "lectures' &#8220;least at bottom dead centre&#8221; holds a little longer than their own "
        "formula says, but not for every engine.",
        formulas=(
            Formula(
                r"a \approx r\omega^2\,(\cos\varphi+\lambda\,\cos 2\varphi)",
                lecture.piston_acceleration_series,
            ),
            Formula(
                r"3\lambda^3-4\lambda+1=0 \quad\Rightarrow\quad "
                r"\lambda=\frac{\sqrt{21}-3}{6}\approx 0.2638",
                lecture.acceleration_minimum_angle,
            ),
        ),
    )


def _within(scene: Scene) -> float:
    """The rod ratio, where the fork's plot has it."""
    return min(max(rod_ratio(scene), 0.15), 0.45)


def _minimum(result: Result) -> Question:
    ratio = rod_ratio(result.scene)
    formula = lecture.acceleration_minimum_angle(rod_ratio=ratio)
    series = lecture.acceleration_minimum_angle_series(rod_ratio=ratio)
    lowest = peak_angle(result, "piston_acceleration", 90.0, 180.0, -1.0)
    depth = peak(result, "piston_acceleration", sign=-1.0)
    half = sample(result, "piston_acceleration", len(result.data["time"]) // 2)
    solution = exact("minimum_exact", math.degrees(formula), "°")
    split = (
        ", and again as far on the other side. "
        f"{simulated('least', depth, 'm/s²', most=6)} there against "
        f"{simulated('at_bottom', half, 'm/s²', most=6)} at bottom dead centre: a flat double "
        "valley, so its place says more than its depth."
    )
    return Question(
        name="ask_minimum",
        text=f"This engine has a rod ratio of {ratio:.4g}. At which crank angle before or at "
        "bottom dead centre is its acceleration least?",
        solution=solution,
        hint=f"Put the slider of the fork at {ratio:.4g}, or look at the dots in the valley.",
        answer=f"At {exact('minimum_series', math.degrees(series), '°')} by the truncated formula, "
        f"{solution} exactly; simulated {simulated('minimum', lowest, '°', most=5)}"
        + (split if ratio > _LIMIT else "."),
        tolerance=0.005,
    )


def _fastest(result: Result) -> Question:
    scene, omega = result.scene, speed_of(result.scene)
    gear = {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}
    root = lecture.maximum_piston_speed_sqrt(omega=omega, **gear)
    formula = lecture.maximum_piston_speed(omega=omega, **gear)
    angle = lecture.maximum_speed_angle(**gear)
    fastest = simulated("speed", peak(result, "piston_velocity"), "m/s", most=6)
    angle_of_run = peak_angle(result, "piston_velocity", 0.0, 180.0)
    solution = exact("speed_exact", formula, "m/s", most=6)
    return Question(
        name="ask_speed",
        text="What is the greatest speed of the piston? The crank radius is "
        f"{exact('radius', gear['crank_radius'], 'mm', 1e3)}, the speed "
        f"{exact('turning', omega, 'rad/s')}, the rod ratio "
        f"{exact('ratio', rod_ratio(scene))}.",
        solution=solution,
        hint="Near the crank angle at which the rod is square to the crank.",
        answer=f"{exact('speed_root', root, 'm/s', most=6)} by "
        r"$r\omega\sqrt{1+\lambda^2}$, which is the speed where the rod is square to the crank; "
        f"{solution} exactly, at {exact('speed_angle', math.degrees(angle), '°')}. Simulated: "
        f"{fastest}, at {simulated('fastest_at', angle_of_run, '°')}.",
        tolerance=0.004,
    )


def _shortest(result: Result) -> Question:
    scene = result.scene
    r = scene.crank.radius
    run = finely(changed(scene, rod={"length": r / _LIMIT}))
    lowest = peak_angle(run, "piston_acceleration", 90.0, 180.0, -1.0)
    solution = exact("rod_exact", r / _LIMIT, "mm", 1e3)
    return Question(
        name="ask_rod",
        text="What is the shortest rod with which the acceleration is least at bottom dead centre?",
        solution=solution,
        hint="The fork gives the rod ratio; the truncated formula would say four crank radii.",
        answer=f"{exact('rod_series', r / _LIMIT_SERIES, 'mm', 1e3)} by the truncated formula, "
        f"{solution} by the exact one. With the latter the simulated minimum is at "
        f"{simulated('limit_angle', lowest, '°', most=5)}.",
    )
