"""Lesson 1: the piston is past half its stroke when the crank is at 90 degrees."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs import lecture
from crankmbs.figures.mechanism import Drawing
from crankmbs.figures.outline import mechanism
from crankmbs.figures.style import STYLE, crank_axis, legend, line_of, panels
from crankmbs.figures.view import last_view
from crankmbs.lessons.parts import Formula, Lesson, Question, Slider, Step, exact, simulated
from crankmbs.lessons.runs import changed, one_cylinder, sample, turn
from crankmbs.measures import Estimate
from crankmbs.result import Result
from crankmbs.simulate import simulate

__all__ = ["lesson"]

_RATIOS = (0.2, 0.25, 2.0 / 7.0, 0.33, 0.4, 0.5)
_SCENE = 2  # of the ratios: the scene's own
_SHARE = 0.02  # of the stroke: the correction asked for in the last question


def lesson() -> Lesson:
    """Run the lesson's scene and its variants and put the page together."""
    scene = one_cylinder("grega_lecture")
    runs = [turn(scene, ratio) for ratio in _RATIOS]
    result = simulate(scene)
    return Lesson(
        idea="The rod tilts while the crank turns, so the piston is ahead of a plain cosine: at 90 "
        "degrees it is already past half its stroke. The lead is the Brix correction.",
        steps=(
            Step(
                title="At 90 degrees the piston is past the middle",
                figures=tuple(map(_half_way, runs)),
                caption="Left: the mechanism at 90 degrees, to scale; the dashed line is half the "
                "stroke. Right: the piston over one turn, and the cosine of an endless rod. Move "
                "the slider: a shorter rod leads more.",
                slider=Slider(
                    r"rod ratio $\lambda = r/l$", tuple(f"{x:.3g}" for x in _RATIOS), _SCENE
                ),
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
            ),
            Step(
                title="Two harmonics are nearly enough",
                figures=(_series(result),),
                caption="Above: the truncated formula on the simulated piston. Below: what it is "
                r"short of, in micrometres. It is right at 0 and 180 degrees and worst at 90: "
                r"there it lacks $r\lambda^3/8$, at any speed.",
                formulas=(
                    Formula(
                        r"s \approx r\,(1-\cos\varphi)"
                        r"+r\,\frac{\lambda}{4}\,(1-\cos 2\varphi)",
                        lecture.piston_displacement_series,
                    ),
                    Formula(
                        r"\Delta s \approx r\,\frac{\lambda}{2}", lecture.brix_correction_series
                    ),
                ),
            ),
        ),
        questions=(_lead(result), _middle(result), _long_rod(result)),
        scene="one cylinder of grega_lecture",
        result=result,
    )


def _gear(result: Result) -> dict[str, float]:
    return {
        "crank_radius": result.scene.crank.radius,
        "rod_length": result.scene.rod.length,
    }


@rc_context(STYLE)
def _half_way(result: Result) -> Figure:
    figure, (left, right) = panels(1, 2, 11.0, 5.0, ratios=(1.0, 2.6))
    view, r = last_view(result), result.scene.crank.radius * 1e3
    quarter = int(np.argmin(np.abs(view.degrees - 90.0)))
    travel = view.values("piston_displacement")[:, 0] * 1e3
    scene = result.scene
    Drawing(left, mechanism(scene, np.radians([90.0])), [0])
    left.set_ylim(-1.3 * r, r * (1.0 / min(_RATIOS) + 2.2))  # one scale for every rod
    middle = scene.rod.length * 1e3
    left.plot([-1.3 * r, 1.3 * r], [middle, middle], color="black", linestyle=(0, (4, 3)))
    right.plot(
        view.degrees,
        r * (1.0 - np.cos(np.radians(view.degrees))),
        color="0.5",
        linestyle=(0, (4, 2)),
        label="endless rod, a cosine",
    )
    right.plot(view.degrees, travel, **line_of(0), label="simulated")
    right.plot(90.0, travel[quarter], "o", color="black", markersize=8)
    right.annotate(
        f"{travel[quarter] - r:.2f} mm past the middle",
        (90.0, travel[quarter]),
        (150.0, 0.5 * r),
        arrowprops={"arrowstyle": "-", "color": "black"},
        va="center",
    )
    right.axhline(r, color="black", linewidth=1.0, linestyle=(0, (4, 3)))
    right.set_ylabel("displacement from TDC [mm]")
    crank_axis([right], view)
    right.set_xlabel("crank angle [deg]")
    legend(figure, right)
    return figure


@rc_context(STYLE)
def _series(result: Result) -> Figure:
    figure, (above, below) = panels(2, 1, 11.0, 5.6)
    view = last_view(result)
    travel = view.values("piston_displacement")[:, 0]
    series = lecture.piston_displacement_series(np.radians(view.degrees), **_gear(result))
    above.plot(view.degrees, travel * 1e3, **line_of(0), label="simulated")
    above.plot(view.degrees, series * 1e3, **line_of(1), label="truncated formula")
    above.set_ylabel("displacement\nfrom TDC [mm]")
    below.plot(view.degrees, (travel - series) * 1e6, **line_of(2))
    below.set_ylabel("simulated minus\nformula [µm]")
    crank_axis([above, below], view)
    below.set_xlabel("crank angle [deg]")
    figure.align_ylabels([above, below])
    legend(figure, above)
    return figure


def _lead(result: Result) -> Question:
    r = result.scene.crank.radius
    at = sample(result, "piston_displacement", 90)
    truth = simulated("brix_simulated", Estimate(at.value - r, at.error), "mm", 1e3, 5)
    formula = exact("brix_exact", lecture.brix_correction(**_gear(result)), "mm", 1e3, 5)
    series = exact("brix_series", lecture.brix_correction_series(**_gear(result)), "mm", 1e3, 5)
    return Question(
        "How far past half its stroke is the piston at 90 degrees?",
        rf"$r\lambda/2$ = {series} by the truncated formula, {formula} by the exact one. The "
        f"simulated piston is {truth} past it.",
    )


def _middle(result: Result) -> Question:
    r, ratio = result.scene.crank.radius, float(lecture.rod_ratio(**_gear(result)))
    angle = math.acos(0.5 * ratio)
    there = simulate(changed(result.scene, motion={"angle": angle}))
    at = simulated("half_stroke", sample(there, "piston_displacement", 0), "mm", 1e3, 6)
    return Question(
        "At which crank angle is the piston at half its stroke?",
        r"Where the crank and the rod make an isosceles triangle, $\cos\varphi=\lambda/2$: at "
        f"{exact('half_angle', math.degrees(angle), '°')}, not at 90°. A run that starts there has "
        f"the piston at {at}, and half the stroke is {exact('radius', r, 'mm', 1e3)}.",
    )


def _long_rod(result: Result) -> Question:
    r = result.scene.crank.radius
    lead = 2.0 * r * _SHARE
    length = (r**2 + lead**2) / (2.0 * lead)
    run = simulate(changed(result.scene, rod={"length": length}))
    at = sample(run, "piston_displacement", 90)
    share = Estimate((at.value - r) / (2.0 * r), at.error / (2.0 * r))
    return Question(
        "How long must the rod be to keep the Brix correction at "
        f"{100.0 * _SHARE:g} % of the stroke?",
        rf"$\lambda/4$ = {_SHARE:g} gives "
        f"{exact('rod_series', r / (4.0 * _SHARE), 'mm', 1e3)}; exactly it is "
        f"{exact('rod_exact', length, 'mm', 1e3, 5)}, twelve and a half crank radii, "
        "where an engine has three to four. "
        f"Simulated with it: {simulated('share', share, '%', 100.0, 6)} of the stroke.",
    )
