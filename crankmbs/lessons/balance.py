"""Lesson 5: what several cylinders cancel, and which orders of force and torque remain."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from crankmbs import lecture
from crankmbs.lessons.balance_figures import force_figure, polar_figure, torque_figure
from crankmbs.lessons.parts import Formula, Lesson, Question, Slider, Step, exact, simulated
from crankmbs.lessons.runs import changed
from crankmbs.lessons.shaking import FRAME, amplitude, reciprocating, twin
from crankmbs.result import Result
from crankmbs.scene.parts import Layout
from crankmbs.scene.read import load_scene
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["lesson"]

_FIRING = ((1,), (1, 2), (1, 3, 2), (1, 3, 4, 2), (1, 5, 3, 6, 2, 4))
_FOUR = 3  # of the firing orders: the scene's own
_BANKS = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0)  # deg
_RIGHT_ANGLE = 3  # of the bank angles


def lesson() -> Lesson:
    """Run the lesson's scene and its variants and put the page together."""
    scene = load_scene("grega_lecture")
    inline = [dataclasses.replace(scene, layout=Layout(firing_order=order)) for order in _FIRING]
    shaken = [simulate(reciprocating(engine)) for engine in inline]
    driven = [simulate(engine) for engine in inline]
    twins = [simulate(twin(scene, angle)) for angle in _BANKS]
    most_force = 1.1e-3 * _largest(shaken, FRAME[0])
    most_torque = 1.1 * _largest(driven, "external_torque")
    most_shake = 1.1e-3 * _largest(twins, *FRAME)
    count = tuple(str(len(order)) for order in _FIRING)
    return Lesson(
        idea="Each cylinder shakes the engine and drives it in the same orders. With several, "
        "evenly spaced, most orders cancel; those that are left add up, and are higher.",
        steps=(
            Step(
                title="Four cylinders cancel the first order and add up the second",
                figures=tuple(force_figure(run, most_force) for run in shaken),
                caption="Force of the moving pistons on the engine's frame along the cylinders, "
                "over one cycle, and its orders. Rotating masses are balanced; gas pushes head and "
                "bearing alike. Move the slider.",
                slider=Slider("cylinders in line", count, _FOUR),
                formulas=(
                    Formula(
                        r"F_{I} = -m_A\,r\omega^2\cos\varphi", lecture.first_order_inertia_force
                    ),
                    Formula(
                        r"F_{II} = -m_A\,r\omega^2\,\lambda\cos 2\varphi",
                        lecture.second_order_inertia_force,
                    ),
                ),
            ),
            Step(
                title="The torque keeps every order that n/2 divides",
                figures=tuple(torque_figure(run, most_torque) for run in driven),
                caption="Torque of all cylinders on the crank over one cycle, and its orders. A "
                " four-stroke cylinder has halves too; n of them, evenly fired, "
                "leave n/2, n, 3n/2 and so on.",
                slider=Slider("cylinders in line", count, _FOUR),
                formulas=(Formula(r"M_k = F_T\,r", lecture.crank_torque),),
            ),
            Step(
                title="A V-twin at 90 degrees can be balanced",
                figures=tuple(polar_figure(run, most_shake) for run in twins),
                caption="Two rods on one pin: force of both pistons on the frame over one turn, "
                "and its first order. At 90 degrees that is a circle, a force that turns with the "
                "crank: a counterweight takes it away.",
                slider=Slider(
                    "angle between the cylinders",
                    tuple(f"{angle:g}°" for angle in _BANKS),
                    _RIGHT_ANGLE,
                ),
            ),
        ),
        questions=(
            _second_order(shaken[_FOUR]),
            _lowest_torque(driven[_FOUR]),
            _counterweight(scene),
        ),
        scene="grega_lecture, also with other numbers of cylinders",
        result=driven[_FOUR],
    )


def _largest(runs: list[Result], *names: str) -> float:
    """Largest magnitude of some variables in some runs: one scale for all frames of a figure."""
    return max(float(np.abs(run.data[name].values).max()) for run in runs for name in names)


def _second_order(result: Result) -> Question:
    scene, omega = result.scene, float(result.data["crank_speed"].values[0])
    ratio = float(lecture.rod_ratio(crank_radius=scene.crank.radius, rod_length=scene.rod.length))
    unit = scene.piston.mass * scene.crank.radius * omega**2
    first, second = (amplitude(result, "frame_force_x", order) for order in (1.0, 2.0))
    return Question(
        "How hard do the four pistons shake the frame, and in which order?",
        f"First order: {simulated('first', first, 'N')}. The second orders add up to "
        f"$4\\,m_A r\\omega^2\\lambda$ = "
        f"{exact('second_lecture', 4.0 * unit * ratio, 'kN', 1e-3)}; "
        f"simulated {simulated('second', second, 'kN', 1e-3)}, because the lectures' series drops "
        r"$\lambda^3/4$ and what follows.",
    )


def _lowest_torque(result: Result) -> Question:
    scene = result.scene
    still = changed(scene, rod={"mass": 0.0, "inertia": 0.0}, piston={"mass": 0.0})
    runs = {"both": scene, "gas": still, "inertia": dataclasses.replace(scene, gas=None)}
    both, gas, inertia = (
        simulated(f"torque_{name}", amplitude(simulate(run), "external_torque", 2.0), "N m")
        for name, run in runs.items()
    )
    return Question(
        "The lowest order of the four cylinders' torque is 2. Why is it so small in the figure?",
        f"The gas has {gas} in that order and the moving masses {inertia}, almost opposite to it: "
        f"{both} are left. Inertia grows with the square of the speed, gas does not, so this holds "
        "at this speed only.",
    )


def _counterweight(scene: Scene) -> Question:
    pair = twin(scene, _BANKS[_RIGHT_ANGLE])
    mass, r = pair.piston.mass, scene.crank.radius
    weight = {"mass": mass, "center_of_mass": -r}
    before, after = simulate(pair), simulate(changed(pair, crank=weight))
    omega = float(before.data["crank_speed"].values[0])
    ratio = float(lecture.rod_ratio(crank_radius=r, rod_length=scene.rod.length))
    numbers = (
        simulated("twin_before", amplitude(before, "frame_force_x", 1.0), "kN", 1e-3),
        simulated("twin_after", amplitude(after, "frame_force_x", 1.0), "N"),
        simulated("twin_second", amplitude(after, "frame_force_y", 2.0), "kN", 1e-3),
    )
    left = exact("twin_lecture", math.sqrt(2.0) * mass * r * omega**2 * ratio, "kN", 1e-3)
    return Question(
        "Which counterweight balances the V-twin at 90 degrees, and what is left?",
        f"{exact('counterweight', mass, 'kg')} at the crank radius: one piston with its share of "
        f"the rod. First order before: {numbers[0]}, after: {numbers[1]}. The second order is "
        f"left, across the engine: $\\sqrt{{2}}\\,m_A r\\omega^2\\lambda$ = {left}; simulated "
        f"{numbers[2]}.",
    )
