"""Lesson 3: the side thrust, and what a rod of two masses misses of it."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs import lecture
from crankmbs.compare import Budget, budget, compare
from crankmbs.figures.style import STYLE, crank_axis, legend, line_of, panels
from crankmbs.figures.view import last_view
from crankmbs.lessons.parts import Formula, Lesson, Question, Slider, Step, exact, simulated
from crankmbs.lessons.runs import changed, finely, peak, peak_angle
from crankmbs.measures import Estimate, measure
from crankmbs.result import Result
from crankmbs.scene.read import load_scene
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["lesson"]

_SHARES = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1)  # of the two masses' inertia
_SPACING = 0.1  # deg, of the samples
_FORCES = ("net force", "side thrust", "rod force", "torque")


def lesson() -> Lesson:
    """Run the lesson's scene and its variants and put the page together."""
    scene = load_scene("yi_diesel")
    result = finely(scene, _SPACING)
    own = scene.rod.moment_of_inertia / _two_masses(scene)
    shares = sorted((*_SHARES, own))
    runs = [
        simulate(changed(scene, rod={"inertia": share * _two_masses(scene)})) for share in shares
    ]
    split = budget(result)
    return Lesson(
        idea="Gas and inertia push the piston along the cylinder; the tilted rod turns part of it "
        "against the wall. Two masses in place of the rod weigh as much and balance alike, but "
        "are too hard to swing: that spoils the side thrust, and never the mean torque.",
        steps=(
            Step(
                title="Gas against inertia",
                figures=(_along(result),),
                caption="Forces on the piston pin along the cylinder, over one cycle: of the gas, "
                "and of the mass $m_A$ that moves with the piston. At top dead centre inertia "
                "pulls where gas pushes, and the bearings feel the sum.",
                formulas=(
                    Formula(r"F_v = F_p + F_{zp}", lecture.net_force),
                    Formula(r"F_{zp} = -m_A\,a", lecture.inertia_force),
                ),
            ),
            Step(
                title="The rod is not two masses",
                figures=tuple(map(_side, runs)),
                caption="Side thrust of the wall on the piston, with a rigid rod and with the "
                "lecture's two masses. Move the slider: they agree only where the rod has the "
                "inertia of its two masses.",
                slider=Slider(
                    r"rod inertia $I/(m\,a\,b)$",
                    tuple(f"{share:.3g}" for share in shares),
                    shares.index(own),
                ),
                formulas=(
                    Formula(r"N = F_v\,\tan\beta", lecture.side_thrust),
                    Formula(r"I_2 = m\,a\,b,\quad b=l-a", lecture.two_mass_rod_inertia),
                ),
                words=r"A rod with less inertia than $m\,a\,b$ needs a smaller couple "
                r"$I\,\varepsilon$ for its angular acceleration $\varepsilon$. The wall gives it "
                r"with the lever $l\,\cos\beta$, so two masses are wrong by "
                r"$(m\,a\,b-I)\,\varepsilon/(l\,\cos\beta)$.",
            ),
            Step(
                title="What each simplification is worth",
                figures=(_causes(split),),
                caption="Largest error of the truncated lecture, cause by cause, in percent of the "
                "quantity's peak ($k=e/r$ is the offset). Along the cylinder two masses are exact; "
                "across it they are not.",
                formulas=(
                    Formula(r"N \approx F_v\,\lambda\,(\sin\varphi-k)", lecture.side_thrust_series),
                    Formula(r"M_k = F_T\,r", lecture.crank_torque),
                ),
            ),
        ),
        questions=(_greatest(result), _missing(result, split), _torque(result)),
        scene="yi_diesel",
        result=result,
    )


def _two_masses(scene: Scene) -> float:
    """Inertia [kg m2] that the lecture's two masses have about the rod's centre of mass."""
    rod = scene.rod
    return float(
        lecture.two_mass_rod_inertia(
            rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
        )
    )


@rc_context(STYLE)
def _along(result: Result) -> Figure:
    figure, (ax,) = panels(1, 1, 11.0, 4.8)
    view = last_view(result)
    gas = view.values("gas_force")[:, 0] * 1e-3
    net = compare(result).simulated["net force"] * 1e-3
    ax.axhline(0.0, color="0.55", linewidth=1.0)
    ax.plot(view.degrees, gas, **line_of(1), label="gas $F_p$")
    ax.plot(view.degrees, net - gas, **line_of(2), label="inertia $F_{zp}$")
    ax.plot(view.degrees, net, **line_of(0), linewidth=3.0, label="net force $F_v$")
    ax.set_ylabel("force towards\nthe crank [kN]")
    crank_axis([ax], view)
    legend(figure, ax)
    return figure


@rc_context(STYLE)
def _side(result: Result) -> Figure:
    figure, (above, below) = panels(2, 1, 11.0, 5.6)
    view, row = last_view(result), compare(result).row("side thrust", "untruncated lecture")
    for ax in (above, below):
        ax.axhline(0.0, color="0.55", linewidth=1.0)
    thrust = view.values("side_force")[:, 0] * 1e-3
    above.plot(view.degrees, thrust, **line_of(0), label="simulated, rigid rod")
    above.plot(view.degrees, row.values * 1e-3, **line_of(1), label="lecture, two masses")
    above.set_ylabel("side thrust\nalong Y [kN]")
    below.plot(view.degrees, row.error, **line_of(2))
    below.set_ylabel("lecture minus\nsimulated [N]")
    below.set_ylim(-720.0, 720.0)  # one scale for every rod
    crank_axis([above, below], view)
    figure.align_ylabels([above, below])
    legend(figure, above)
    return figure


@rc_context(STYLE)
def _causes(split: Budget) -> Figure:
    figure, (ax,) = panels(1, 1, 11.0, 4.2)
    for k, cause in enumerate(("series", "two-mass rod")):
        shares = [split.split(name).share(split.split(name).cause(cause)) for name in _FORCES]
        places = np.arange(len(_FORCES)) + 0.38 * (k - 0.5)
        label = {"series": "the truncated series", "two-mass rod": "the two-mass rod"}[cause]
        ax.barh(places, shares, height=0.36, color=line_of(k)["color"], label=label)
        for place, share in zip(places, shares, strict=True):
            ax.text(share, place, f" {share:.3g} %", va="center")
    ax.set_yticks(range(len(_FORCES)), _FORCES)
    ax.invert_yaxis()
    ax.margins(x=0.1)
    ax.grid(visible=False, axis="y")
    ax.set_xlabel("largest error [% of the peak]")
    legend(figure, ax)
    return figure


def _greatest(result: Result) -> Question:
    thrust = peak(result, "side_force")
    at = peak_angle(result, "side_force", 0.0, 720.0)
    answers = compare(result)
    two, truncated = (
        answers.row("side thrust", name)
        for name in ("untruncated lecture", "S1 (motion and forces truncated)")
    )
    where = math.degrees(answers.excerpt.size("side thrust", np.maximum(two.values, 0.0)).angle)
    return Question(
        "How hard does the piston press against the wall towards +Y, and when?",
        f"{simulated('side_peak', thrust, 'kN', 1e-3, 5)} at "
        f"{simulated('side_angle', at, '°')}, just after firing. The lecture says "
        f"{exact('side_two_masses', two.values.max(), 'kN', 1e-3, 5)} with two masses, at "
        f"{simulated('side_two_angle', Estimate(where, _SPACING), '°')}, and "
        f"{exact('side_truncated', truncated.values.max(), 'kN', 1e-3, 5)} truncated.",
    )


def _missing(result: Result, split: Budget) -> Question:
    scene = result.scene
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    omega = float(result.data["crank_speed"].values[0])
    row = split.split("side thrust")
    cause = row.cause("two-mass rod")
    found = Estimate(
        cause.size.largest, 2.0 * float(result.data["side_force"].attrs["error_estimate"])
    )
    where = Estimate(math.degrees(cause.size.angle), _SPACING)
    share = Estimate(row.share(cause), 100.0 * found.error / row.peak)
    sine = (r + abs(e)) / l
    cosine = math.sqrt(1.0 - sine**2)
    swing = r / l * omega**2 / cosine  # at 270 degrees, where beta' is 0
    couple = (_two_masses(scene) - scene.rod.moment_of_inertia) * swing
    return Question(
        "How much of the side thrust do the two masses make up, and where?",
        f"At {simulated('missing_angle', where, '°')} the rod swings hardest, "
        rf"$|\varepsilon|=\lambda\omega^2/\cos\beta$, and the couple too much is "
        f"{exact('couple', couple, 'N m')}: {exact('missing_formula', couple / l / cosine, 'N')} "
        f"at the wall. The error budget finds {simulated('missing', found, 'N')}, "
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
    return Question(
        "Does the error reach the power?",
        f"No. The greatest torque is {rigid}, with two masses {two}; the mean is {mean} and "
        f"{mean_two}. Swinging the rod to and fro takes no work over a cycle.",
    )
