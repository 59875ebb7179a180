"""Lesson 2: the acceleration has its minimum at bottom dead centre only with a long rod."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crankmbs import lecture
from crankmbs.figures.style import STYLE, crank_axis, legend, line_of, panels
from crankmbs.figures.view import last_view
from crankmbs.lessons.parts import Formula, Lesson, Question, Slider, Step, exact, simulated
from crankmbs.lessons.runs import changed, finely, one_cylinder, peak, peak_angle, sample, turn
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["lesson"]

_LIMIT = lecture.ACCELERATION_MINIMUM_LIMIT
_LIMIT_SERIES = lecture.ACCELERATION_MINIMUM_LIMIT_SERIES
_RATIOS = (0.15, 0.2, _LIMIT_SERIES, _LIMIT, 2.0 / 7.0, 0.3, 0.33, 0.4, 0.45)
_SCENE = 4  # of the ratios: the scene's own


def lesson() -> Lesson:
    """Run the lesson's scene and its variants and put the page together."""
    scene = one_cylinder("grega_lecture")
    runs = [turn(scene, ratio) for ratio in _RATIOS]
    result = finely(scene)
    return Lesson(
        idea="The tilting rod adds a second harmonic to the acceleration. With a long rod it is "
        f"least at bottom dead centre; above $\\lambda$ = {_LIMIT:.4f} the minimum splits in two "
        "and leaves it.",
        steps=(
            Step(
                title="The valley of the acceleration becomes two",
                figures=tuple(map(_motion, runs)),
                caption="Velocity and acceleration at constant speed ($\\alpha = 0$), in parts of "
                "$r\\omega$ and $r\\omega^2$; right: the valley enlarged, with its lowest points. "
                "Move the slider "
                f"across {_LIMIT_SERIES:g} and {_LIMIT:.4f}.",
                slider=Slider(
                    r"rod ratio $\lambda = r/l$", tuple(f"{x:.4g}" for x in _RATIOS), _SCENE
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
            ),
            Step(
                title=f"It leaves at {_LIMIT:.4f}; the truncated formula says 1/4",
                figures=(_fork(scene),),
                caption="Crank angle of the least acceleration over the rod ratio.",
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
                words=r"At bottom dead centre the curvature of the truncated acceleration is "
                r"$1-4\lambda$: it changes sign at 1/4. The exact one is "
                r"$3\lambda^3-4\lambda+1$, so the lectures' &#8220;least at "
                r"bottom dead centre&#8221; holds a little longer than their own formula says, but "
                "not for every engine.",
            ),
        ),
        questions=(_minimum(result), _fastest(result), _shortest(result)),
        scene="one cylinder of grega_lecture",
        result=result,
    )


@rc_context(STYLE)
def _motion(result: Result) -> Figure:
    """Velocity and acceleration over a turn, and the acceleration's valley enlarged."""
    figure = Figure(figsize=(11.0, 5.4), layout="constrained")
    axes = figure.subplot_mosaic([["v", "valley"], ["a", "valley"]], width_ratios=[1.6, 1.0])
    view, scene = last_view(result), result.scene
    gear = {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}
    angle, omega = np.radians(view.degrees), float(view.values("crank_speed")[0])
    unit = scene.crank.radius * omega
    velocity = view.values("piston_velocity")[:, 0] / unit
    acceleration = view.values("piston_acceleration")[:, 0] / (unit * omega)
    rows = (
        ("v", velocity, lecture.piston_velocity_series(angle, omega=omega, **gear) / unit),
        *(
            (
                name,
                acceleration,
                lecture.piston_acceleration_series(angle, omega=omega, **gear) / (unit * omega),
            )
            for name in ("a", "valley")
        ),
    )
    for name, simulated_, series in rows:
        axes[name].plot(view.degrees, simulated_, **line_of(0), label="simulated")
        axes[name].plot(view.degrees, series, **line_of(1), label="truncated formula")
    least = lecture.acceleration_minimum_angle(rod_ratio=scene.crank.radius / scene.rod.length)
    for at in {math.degrees(float(least)), 360.0 - math.degrees(float(least))}:
        depth = np.interp(at, view.degrees, acceleration)
        axes["valley"].plot(at, depth, "o", color="black", markersize=8)
    crank_axis([axes["v"], axes["a"]], view)
    for name, label, limits in (
        ("v", "velocity / $r\\omega$ [1]", (-1.25, 1.25)),
        ("a", "acceleration /\n$r\\omega^2$ [1]", (-1.1, 1.6)),
        ("valley", "", (-0.9, -0.5)),
    ):
        axes[name].set_ylabel(label)
        axes[name].set_ylim(limits)
    axes["a"].set_xlabel("crank angle [deg]")
    valley = axes["valley"]
    valley.set_title("acceleration near BDC", loc="left")
    valley.axvline(180.0, color="0.55", linewidth=1.0, linestyle=(0, (6, 4)), zorder=1)
    valley.set_xlim(110.0, 250.0)
    valley.set_xticks(range(120, 241, 30))
    valley.set_xlabel("crank angle [deg]")
    figure.align_ylabels([axes["v"], axes["a"]])
    legend(figure, axes["v"])
    return figure


@rc_context(STYLE)
def _fork(scene: Scene) -> Figure:
    figure, (ax,) = panels(1, 1, 11.0, 4.6)
    ratio = np.linspace(0.15, 0.45, 1201)
    curves = {
        "exact": lecture.acceleration_minimum_angle(rod_ratio=ratio),
        "truncated formula": lecture.acceleration_minimum_angle_series(rod_ratio=ratio),
    }
    for k, (label, angle) in enumerate(curves.items()):
        ax.plot(ratio, np.degrees(angle), **line_of(k), label=label)
        ax.plot(ratio, 360.0 - np.degrees(angle), **line_of(k))
    for value in np.arange(0.16, 0.45, 0.02):
        run = finely(changed(scene, rod={"length": scene.crank.radius / float(value)}), 0.1)
        first = peak_angle(run, "piston_acceleration", 90.0, 180.0, -1.0).value
        dots = ax.plot([value, value], [first, 360.0 - first], "o", color="black", markersize=6)
    dots[0].set_label("simulated")
    ax.axvline(_LIMIT, color="0.55", linewidth=1.0, linestyle=(0, (6, 4)))
    ax.axvline(_LIMIT_SERIES, color="0.55", linewidth=1.0, linestyle=(0, (6, 4)))
    ax.text(_LIMIT + 0.003, 118.0, f"{_LIMIT:.4f}", color="0.35")
    ax.text(_LIMIT_SERIES - 0.003, 118.0, f"{_LIMIT_SERIES:g}", color="0.35", ha="right")
    ax.set_yticks([120, 150, 180, 210, 240], ["120", "150", "BDC 180", "210", "240"])
    ax.set_ylim(112.0, 248.0)
    ax.set_xlabel(r"rod ratio $\lambda$ [1]")
    ax.set_ylabel("crank angle of the\nleast acceleration [deg]")
    legend(figure, ax)
    return figure


def _minimum(result: Result) -> Question:
    scene = result.scene
    ratio = scene.crank.radius / scene.rod.length
    formula = lecture.acceleration_minimum_angle(rod_ratio=ratio)
    series = lecture.acceleration_minimum_angle_series(rod_ratio=ratio)
    found = peak_angle(result, "piston_acceleration", 90.0, 180.0, -1.0)
    depth = peak(result, "piston_acceleration", sign=-1.0)
    half = sample(result, "piston_acceleration", len(result.data["time"]) // 2)
    return Question(
        f"This engine has λ = {ratio:.4g}. Where is its acceleration least, and how much lower is "
        "it there than at bottom dead centre?",
        f"At {exact('minimum_series', math.degrees(series), '°')} by the truncated formula, "
        f"{exact('minimum_exact', math.degrees(formula), '°')} exactly; simulated "
        f"{simulated('minimum', found, '°', most=5)}, and again as far on the other side. "
        f"{simulated('least', depth, 'm/s²', most=6)} there against "
        f"{simulated('at_bottom', half, 'm/s²', most=6)} at bottom dead centre: "
        "a flat double valley, so the place tells more than the depth.",
    )


def _fastest(result: Result) -> Question:
    scene, omega = result.scene, float(result.data["crank_speed"].values[0])
    gear = {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}
    root = lecture.maximum_piston_speed_sqrt(omega=omega, **gear)
    formula = lecture.maximum_piston_speed(omega=omega, **gear)
    angle = lecture.maximum_speed_angle(**gear)
    fastest = simulated("speed", peak(result, "piston_velocity"), "m/s", most=6)
    found = peak_angle(result, "piston_velocity", 0.0, 180.0)
    return Question(
        "How fast does the piston get, and where?",
        f"{exact('speed_root', root, 'm/s', most=6)} by $r\\omega\\sqrt{{1+\\lambda^2}}$ (S0-F13), "
        "which is the speed where the rod is square to the crank; "
        f"{exact('speed_exact', formula, 'm/s', most=6)} exactly, at "
        f"{exact('speed_angle', math.degrees(angle), '°')}. Simulated: {fastest}, at "
        f"{simulated('fastest_at', found, '°')}.",
    )


def _shortest(result: Result) -> Question:
    scene = result.scene
    r = scene.crank.radius
    run = finely(changed(scene, rod={"length": r / _LIMIT}))
    found = peak_angle(run, "piston_acceleration", 90.0, 180.0, -1.0)
    return Question(
        "What is the shortest rod with which the acceleration is least at bottom dead centre?",
        f"{exact('rod_series', r / _LIMIT_SERIES, 'mm', 1e3)} by the truncated formula, "
        f"{exact('rod_exact', r / _LIMIT, 'mm', 1e3)} truly. With the latter the simulated "
        f"minimum is at {simulated('limit_angle', found, '°', most=5)}.",
    )
