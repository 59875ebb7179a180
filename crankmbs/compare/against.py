"""A run against the exact closed form, the lectures' formulas and the user's."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crankmbs.compare.between import RUN, curves_of, with_tops
from crankmbs.compare.excerpt import Answer, Excerpt, LeftOut, excerpt_of, vanishing
from crankmbs.compare.formula import CLOSED_FORM, Formula, formulas_of, variables_of
from crankmbs.compare.lectured import LECTURES, row_of
from crankmbs.compare.numbers import NUMBERS, Number
from crankmbs.compare.quantities import QUANTITIES
from crankmbs.compare.size import Size, percent
from crankmbs.digits import digits
from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Comparison", "Deviation", "compare"]

_Curve = tuple[str, str]  # reference and quantity


@dataclass(frozen=True)
class Deviation:
    """One quantity of a run against one reference, over the samples compared.

    values : shape (n,) [unit], of the reference; error : shape (n,) [unit], reference minus run
    size : maximum and RMS of the error [unit], and the angle of the maximum: the cylinder's cycle
        angle, for the main bearing the crank angle
    peak [unit] : largest magnitude in the run; both maxima between the samples, too, but for those
        of the closed form, and of a formula of the user whose value at an angle depends on others
    """

    quantity: str
    reference: str
    values: Array
    error: Array
    size: Size
    peak: float

    def __repr__(self) -> str:
        return (
            f"<Deviation of the {self.quantity} by {self.reference}: "
            f"{digits(percent(self.size.largest, self.peak), most=3)} % of the peak at most, at "
            f"{math.degrees(self.size.angle):.0f} deg, {len(self.values)} samples>"
        )


@dataclass(frozen=True)
class Comparison:
    """A run against every reference.

    simulated : quantity -> shape (n,), values of the run in SI units
    rows : deviations, reference by reference; numbers : formulas for one number of the run
    left_out : what could not be compared, and why
    """

    excerpt: Excerpt
    simulated: Answer
    rows: tuple[Deviation, ...]
    numbers: tuple[Number, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def references(self) -> tuple[str, ...]:
        """The references that could be evaluated, in their order."""
        return tuple(dict.fromkeys(row.reference for row in self.rows))

    def __repr__(self) -> str:
        return (
            f"<Comparison over the {self.excerpt.window.kind}: {len(self.simulated)} quantities "
            f"with {', '.join(self.references)}>"
        )

    def to_dataframe(self) -> pd.DataFrame:
        """A line for each quantity and reference, as a pandas table in the units of its index, rpm,
        bar, mm, N, N m: the run's peak, the largest and the RMS difference from the run, both also
        in percent of that peak, and the angle of the largest one as `Deviation` has it. Single
        numbers have the run's value in place of the peak, no RMS and no angle.

        >>> table = compare(simulate(load_scene("yi_diesel"))).to_dataframe()
        >>> table.loc[("side thrust [N]", "untruncated lecture"), "difference [%]"].round(1).item()
        17.7
        """
        from crankmbs.report.readings import comparison_frame

        return comparison_frame(self)

    def _repr_html_(self) -> str:
        from crankmbs.report.html import comparison_html

        return comparison_html(self)

    def row(self, quantity: str, reference: str = CLOSED_FORM) -> Deviation:
        """The deviation of one quantity from one reference, as tables, figures or files call it.

        Raises
        ------
        InputError : there is none
        """
        return row_of(self.rows, quantity, reference)


def compare(
    result: Result,
    formulas: Mapping[str, Callable[..., Any]] | None = None,
    *,
    cylinder: int = 1,
) -> Comparison:
    """Compare a run with the closed form, with the lectures and with formulas of the user, over
    its last whole cycle.

    Every reference is evaluated at the crank angles of the run. "closed form" is Newton-Euler at
    its theta, omega and alpha, with the rigid rod and gravity: exact, so that the error
    is the run's. The lectures take the time mean of the speed, the two-mass rod and no gravity,
    and count displacement from l + r: the error is theirs (`budget` splits it into causes). S0
    and S1, the sources of `crankmbs.lecture`, truncate the motion after the second harmonic; S1
    truncates the forces on rod and crank too.
    Only "multibody" computes joint forces itself; other formulations take them from the closed form
    and agree with it to rounding.

    A formula of the user is a function that asks, by the names of its parameters, for what it
    needs of `crankmbs.compare.WORDS`: theta, phi, omega, alpha, gas_force, crank_radius,
    rod_length, ..., in SI units, curves of shape (n,); for a quantity of the whole engine phi and
    what acts on the pistons have shape (n, cylinders). It stands for the quantity that its name
    begins with, such as piston_acceleration_series, or else its label: one of
    `crankmbs.compare.OBSERVABLES`, a piston's also without "piston", or of
    `crankmbs.compare.NUMBERS`. It answers n numbers, or a single one.

    Parameters
    ----------
    result : any formulation; cylinder : number of the one compared; the main bearing carries all
    formulas : functions by the labels under which they are shown

    Returns
    -------
    Comparison : in SI units; what cannot be compared is listed with its reason

    Raises
    ------
    InputError : no such cylinder; a formula that names no quantity, asks for what there is not,
        raises, or answers anything but finite numbers

    >>> comparison = compare(simulate(load_scene("yi_diesel")))
    >>> comparison.row("side thrust", "untruncated lecture").size.largest > 290.0
    True

    >>> def piston_acceleration_harmonic(phi, omega, crank_radius):
    ...     return crank_radius * omega**2 * np.cos(phi)
    >>> mine = compare(simulate(load_scene("yi_diesel")), {"mine": piston_acceleration_harmonic})
    >>> row = mine.row("piston acceleration", "mine")
    >>> f"{100.0 * row.size.largest / row.peak:.1f} %"
    '24.9 %'
    """
    user_formulas = formulas_of(formulas)
    curves = [formula for formula in user_formulas if not formula.is_number]
    excerpt = excerpt_of(result, cylinder, variables_of(curves))
    answers, left_out = _answers(excerpt, curves)
    zero = vanishing(answers.values())
    left_out += [LeftOut(name, "", reason) for name, reason in zero.items()]
    names = [name for name in answers[RUN] if name not in zero]
    by_angle = [formula for formula in curves if formula.depends_on_angle_alone(excerpt)]

    def between(points: Excerpt) -> dict[_Curve, Array]:
        answers, _ = _answers(points, by_angle)
        del answers[CLOSED_FORM]  # by which the run itself is read there
        return curves_of(answers, names)

    found = with_tops(excerpt, curves_of(answers, names), between)
    rows = tuple(
        Deviation(
            quantity=name,
            reference=reference,
            values=answers[reference][name],
            error=error,
            size=found.size((reference, name)),
            peak=found.peak((RUN, name)),
        )
        for (reference, name), error in found.sampled.items()
        if reference != RUN
    )
    numbers = _numbers([f for f in user_formulas if f.is_number], excerpt, left_out)
    simulated = {name: answers[RUN][name] for name in names}
    return Comparison(excerpt, simulated, rows, numbers, tuple(left_out))


def _answers(excerpt: Excerpt, formulas: list[Formula]) -> tuple[dict[str, Answer], list[LeftOut]]:
    """What the run and every reference give, and what they lack."""
    answers = {RUN: excerpt.simulated(), CLOSED_FORM: excerpt.newton_euler(excerpt.result.scene)}
    left_out = [LeftOut(name, "", reason) for name, reason in excerpt.left_out().items()]
    for reference, truncation in LECTURES.items():
        try:
            answers[reference] = excerpt.lecture(truncation, constant_speed=True)
        except InputError as error:
            names = [name for name in answers[RUN] if name in QUANTITIES]
            left_out += [LeftOut(name, reference, str(error)) for name in names]
    for formula in formulas:
        if formula.quantity in answers[RUN]:
            answers[formula.label] = {formula.quantity: formula.curve(excerpt)}
        else:
            left_out.append(
                LeftOut(formula.quantity, formula.label, excerpt.lacks(formula.quantity))
            )
    return answers, left_out


def _numbers(
    formulas: list[Formula], excerpt: Excerpt, left_out: list[LeftOut]
) -> tuple[Number, ...]:
    """Formulas for single numbers against the run's; numbers that it lacks are left out."""
    if not formulas:
        return ()
    numbers, measures = [], excerpt.result.measures()
    for formula in formulas:
        definition = NUMBERS[formula.quantity]
        simulated = definition.estimate(measures, excerpt.cylinder)
        if simulated is None:
            left_out.append(LeftOut(formula.quantity, formula.label, definition.lacking))
        else:
            value = formula.number(excerpt)
            numbers.append(Number(formula.quantity, formula.label, value, simulated))
    return tuple(numbers)
