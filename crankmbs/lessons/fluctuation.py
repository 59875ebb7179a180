"""Lesson 4: the speed swings with the torque; a flywheel makes the swing small, never zero."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from crankmbs import lecture
from crankmbs.compare import budget
from crankmbs.design.flywheel import excess
from crankmbs.figures.style import STYLE, crank_axis, legend, line_of, panels
from crankmbs.figures.view import last_view
from crankmbs.lessons.flywheel import estimate, held, with_inertia
from crankmbs.lessons.parts import Formula, Lesson, Question, Slider, Step, exact, simulated
from crankmbs.measures import Estimate, measure
from crankmbs.measures.peak import rise
from crankmbs.result import Result
from crankmbs.scene.read import load_scene
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM
from crankmbs.simulate import simulate

__all__ = ["lesson"]

_INERTIAS = (0.02, 0.05, 0.1, 0.15, 0.3, 0.6, 1.2)  # kg m^2
_SCENE = 3  # of the inertias: the scene's own
_WANTED = 0.01  # coefficient of fluctuation asked for in a question
_QUANTITIES = (
    "torque",
    "side thrust",
    "piston acceleration",
    "crank pin force x",
    "main bearing force x",
)
_NOTE = (
    "Approximate: W is the greatest excess of work in a cycle at constant speed, J the mean "
    "inertia of crank, rods and pistons. Source: the balance of energy."
)


def lesson() -> Lesson:
    """Run the lesson's scene and its variants and put the page together."""
    scene = load_scene("yi_diesel_free")
    runs = [simulate(with_inertia(scene, inertia)) for inertia in _INERTIAS]
    result = runs[_SCENE]
    return Lesson(
        idea="The torque of the cylinders comes in pulses, the load takes it evenly: the speed "
        "swings. A formula for constant speed is wrong by what the flywheel lets through.",
        steps=(
            Step(
                title="A heavier flywheel swings less",
                figures=tuple(_speed(run, runs[0]) for run in runs),
                caption="Crank speed over the last of twenty cycles against the same load. Dashed: "
                "the constant speed that the lectures assume. Move the slider.",
                slider=Slider(
                    "inertia of crank and flywheel",
                    tuple(f"{inertia:g} kg m²" for inertia in _INERTIAS),
                    _SCENE,
                ),
                formulas=(
                    Formula(
                        r"\delta=\frac{\omega_{\max}-\omega_{\min}}{\omega_m}",
                        note="Exact: what is called coefficient of fluctuation. Source: textbooks.",
                    ),
                    Formula(r"\delta \approx \frac{W}{J\,\omega_m^2}", note=_NOTE),
                ),
            ),
            Step(
                title="Twice the flywheel, half the swing",
                figures=(_fall(runs),),
                caption="Coefficient of fluctuation over the inertia, both logarithmic. With the "
                "torque of constant speed the formula is within "
                f"{simulated('formula_error', _off(runs), '%', 100.0, 2)} of the simulation here.",
            ),
            Step(
                title="What constant speed costs",
                figures=(_cost(runs),),
                caption="Largest error that the constant speed puts into the lecture's answer, in "
                "percent of the quantity's peak. It falls with the inertia, like the fluctuation.",
                formulas=(
                    Formula(
                        r"a = s''\,\omega^2 + s'\,\alpha,\quad s'=\frac{ds}{d\varphi}",
                        lecture.piston_acceleration,
                    ),
                ),
                words=r"Constant speed drops $s'\alpha$ and takes $\omega_m^2$ for $\omega^2$. "
                "Every inertia force follows the acceleration, and every bearing the force.",
            ),
        ),
        questions=(_own(result), _flywheel(scene), _lightest(runs[0])),
        scene="yi_diesel_free",
        result=result,
    )


def _off(runs: list[Result]) -> Estimate:
    """Largest relative error of the textbook formula."""
    found = [measure(run).fluctuation for run in runs]
    return max(
        Estimate(abs(estimate(run) / value - 1.0), error / value)
        for run, (value, error) in zip(runs, found, strict=True)
    )


@rc_context(STYLE)
def _speed(result: Result, widest: Result) -> Figure:
    figure, (ax,) = panels(1, 1, 11.0, 4.6)
    view, measures = last_view(result), measure(result)
    mean = measures.mean_speed.value / RPM
    ax.plot(view.degrees, view.values("crank_speed") / RPM, **line_of(0), label="simulated")
    ax.axhline(mean, color="0.5", linestyle=(0, (4, 2)), label="constant speed")
    limits = widest.data["crank_speed"].values[-721:] / RPM  # one scale for every flywheel
    ax.set_ylim(limits.min() - 10.0, limits.max() + 60.0)
    ax.text(
        0.99,
        0.97,
        rf"$\delta$ = {100.0 * measures.fluctuation.value:.3g} %",
        transform=ax.transAxes,
        ha="right",
        va="top",
        fontsize=16,
        bbox={"facecolor": "white", "edgecolor": "none"},
    )
    ax.set_ylabel("crank speed [rpm]")
    crank_axis([ax], view)
    legend(figure, ax)
    return figure


@rc_context(STYLE)
def _fall(runs: list[Result]) -> Figure:
    figure, (ax,) = panels(1, 1, 11.0, 4.4)
    simulated_ = [measure(run).fluctuation.value for run in runs]
    ax.loglog(_INERTIAS, [estimate(run) for run in runs], **line_of(1), label="$W/(J\\omega_m^2)$")
    ax.loglog(_INERTIAS, simulated_, "o", color="black", label="simulated")
    _inertia_axis(ax)
    ax.set_ylabel(r"coefficient of fluctuation $\delta$ [1]")
    legend(figure, ax)
    return figure


@rc_context(STYLE)
def _cost(runs: list[Result]) -> Figure:
    figure, (ax,) = panels(1, 1, 11.0, 5.0)
    splits = [budget(run) for run in runs]
    for k, name in enumerate(_QUANTITIES):
        rows = [split.split(name) for split in splits]
        shares = [row.share(row.cause("constant speed")) for row in rows]
        ax.loglog(_INERTIAS, shares, **line_of(k), marker="o", markersize=5, label=name)
    _inertia_axis(ax)
    ticks = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
    ax.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.set_ylabel("error of constant speed\n[% of the peak]")
    legend(figure, ax)
    return figure


def _inertia_axis(ax: Axes) -> None:
    ax.set_xticks(_INERTIAS, [f"{inertia:g}" for inertia in _INERTIAS])
    ax.minorticks_off()
    ax.set_xlabel("inertia of crank and flywheel [kg m$^2$]")


def _own(result: Result) -> Question:
    measures = measure(result)
    return Question(
        f"This engine has {result.scene.crank.moment_of_inertia:g} kg m². What is its coefficient "
        "of fluctuation?",
        f"{simulated('fluctuation', measures.fluctuation, '%', 100.0)} at a mean of "
        f"{simulated('mean_speed', measures.mean_speed, 'rpm', 1.0 / RPM, 6)}; "
        f"$W/(J\\omega_m^2)$ gives {exact('formula', estimate(result), '%', 100.0)}.",
    )


def _flywheel(scene: Scene) -> Question:
    def swing(inertia: float) -> float:
        return measure(simulate(with_inertia(scene, inertia))).fluctuation.value - _WANTED

    found = brentq(swing, 0.3, 0.6, xtol=1e-6)
    result = simulate(with_inertia(scene, found))
    error = measure(result).fluctuation.error + abs(swing(found))
    work, energy = excess(held(result))
    omega = measure(result).mean_speed.value
    moving = energy / omega**2 - found  # rods and pistons
    formula = work / (_WANTED * omega**2) - moving
    return Question(
        f"Which inertia keeps the speed within {100.0 * _WANTED:g} %?",
        f"$J=W/(\\delta\\omega_m^2)$, less the {exact('moving', moving, 'kg m²', most=3)} of rods "
        f"and pistons, is {exact('inertia_formula', formula, 'kg m²')}. Found by runs: "
        f"{simulated('inertia', Estimate(found, found * error / _WANTED), 'kg m²')}.",
    )


def _lightest(result: Result) -> Question:
    even_run = held(result)
    numbers = []
    for name, variable in (("free", result), ("held", even_run)):
        joint = next(j for j in measure(variable).joints if j.joint == "crank pin")
        acceleration = variable.data["piston_acceleration"]
        last = acceleration.values[-721:, 0]
        error = float(acceleration.attrs["error_estimate"]) + rise(last, int(np.argmax(last)))
        numbers += [
            simulated(f"acceleration_{name}", Estimate(float(last.max()), error), "m/s²"),
            simulated(f"crank_pin_{name}", joint.peak, "kN", 1e-3),
        ]
    fastest, pin, even, even_pin = numbers
    return Question(
        f"With {_INERTIAS[0]:g} kg m² only: how wrong is constant speed about the greatest piston "
        "acceleration and the greatest crank pin load?",
        f"Piston acceleration {fastest}, at constant mean speed {even}. Crank pin {pin}, at "
        f"constant speed {even_pin}. The crank is fastest near the dead centres: inertia is "
        "greater there than constant speed says, and relieves the pin of more of the gas force.",
    )
