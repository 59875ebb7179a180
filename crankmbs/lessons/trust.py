"""Lesson 8: how far to trust a number: step size, order, error."""

from __future__ import annotations

from crankmbs.lessons.freed import free, settled
from crankmbs.lessons.pieces import Figure, Formula, Lesson, Question, Section, exact
from crankmbs.lessons.runs import named
from crankmbs.page.knobs import Choice, Knob
from crankmbs.scene.scene import Scene

__all__ = ["IDEA", "SCENE", "lesson"]

SCENE = "yi_diesel_free"
IDEA = (
    "A computer always gives a number. How many of its digits are correct depends on the step "
    "and on the order of the method. Two runs with different steps show it, and a number without "
    "its error is only half an answer."
)

_METHODS = ("Euler", "Heun", "Runge-Kutta")
_ERRORS = "Numerical analysis, as textbooks have it"


def lesson(machine: Scene) -> Lesson:
    """The lesson about a scene.

    Raises
    ------
    InputError : a machine that does not settle
    """
    scene = free(machine, "trust")
    return Lesson(
        idea=IDEA,
        sections=(_step(), _order(), _stated()),
        questions=(_halved(), _digits(), _richardson()),
        scene=scene,
        about=f"The machine: {named(machine)}; its settled motion.",
        error=settled(scene).error.estimated,
    )


def _size(value: float) -> Knob:
    return Knob("size", "step", "°", 0.5, 20.0, value, 2)


def _method(name: str) -> Choice:
    return Choice("method", "method", _METHODS, name)


def _step() -> Section:
    return Section(
        title="Every step makes a small error",
        before="A settled cycle ends with the speed with which it began. A method that goes in "
        "steps does not get there: here it takes "
        '<output data-say="step.count"></output> steps and is wrong by up to '
        '<output data-say="step.off"></output>. Make the steps smaller, then try a '
        "better method.",
        figure=Figure(
            name="step",
            caption="Crank speed over one settled cycle, exact and in steps; below, the error.",
            plots=("Crank speed, exact and in steps",),
            knobs=(_size(10.0),),
            choices=(_method("Euler"),),
        ),
        formulas=(
            Formula(
                r"T_{n+1} = T_n + h\,M(\varphi_n, T_n)",
                note="Euler's method: the torque at its beginning holds for the whole step.",
                source=_ERRORS,
            ),
        ),
    )


def _order() -> Section:
    return Section(
        title="The order says what a smaller step is worth",
        before="Each point is a run. With ten times the steps a method of order p gains p digits, "
        "so its line is that steep. The run of the slider has "
        '<output data-say="order.digits"></output> correct digits; half the step makes its '
        'error <output data-say="order.times"></output> times smaller. Where the pressure has '
        "kinks, or the steps are too large to see its peak, a line bends: an order is a promise "
        "for small steps and smooth curves only.",
        figure=Figure(
            name="order",
            caption="Correct digits of the speed, where it is worst in the cycle, over the number "
            "of steps: work and precision.",
            plots=("Digits over steps",),
            knobs=(_size(5.0),),
            choices=(_method("Heun"),),
            machine=False,
            plays=False,
        ),
        formulas=(
            Formula(
                r"\varepsilon \approx C\,h^{p}",
                note="Approximate: for small steps; p is the order, C depends on the problem.",
                source=_ERRORS,
            ),
        ),
    )


def _stated() -> Section:
    return Section(
        title="Two runs show how large the error is",
        before="Nobody knows the true error, but two runs give a good estimate. With half as many "
        "steps the error is about $2^p$ times as large, so the two runs differ by $2^p-1$ times "
        "the error of the finer one. The error stated is "
        '<output data-say="stated.ratio"></output> times the true one here. An honest program '
        "states one that is close to it, and never far below.",
        figure=Figure(
            name="stated",
            caption="Correct digits: the true number, and as estimated from two runs.",
            plots=("True and stated",),
            knobs=(_size(5.0),),
            choices=(_method("Heun"),),
            machine=False,
            plays=False,
        ),
        formulas=(
            Formula(
                r"\varepsilon_{h} \approx \frac{|x_{h}-x_{2h}|}{2^{p}-1}",
                note="Approximate: where the order holds.",
                source="Richardson's extrapolation",
            ),
        ),
    )


def _halved() -> Question:
    return Question(
        name="ask_halved",
        text="By how many times does half the step reduce the error of a method of order 4?",
        solution=exact("halved", 16.0),
        hint="The error goes with the step to the power of the order.",
        answer="By 2 to the power of 4, sixteen times, at twice the cost.",
        tolerance=0.001,
    )


def _digits() -> Question:
    return Question(
        name="ask_digits",
        text="Heun's method has three correct digits with 200 steps. How many steps does it take "
        "for five?",
        solution=exact("steps", 2000.0),
        hint="It has order 2, and two digits are a factor of 100 in the error.",
        answer="A hundredth of the error takes a tenth of the step: 2000 steps.",
        tolerance=0.02,
    )


def _richardson() -> Question:
    return Question(
        name="ask_richardson",
        text="Two runs of order 2 with steps of 2° and 1° end at 3196.4 and 3199.1 rpm. How "
        "large, about, is the error of the second?",
        solution=exact("off", (3199.1 - 3196.4) / 3.0, "rpm"),
        hint="The error of the first is four times that of the second.",
        answer="Their difference is three times the error of the second: 2.7 / 3 = 0.9 rpm.",
        tolerance=0.03,
    )
