"""The error budget: the error of a formula, split into causes that add up to it."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from crankmbs.compare.between import RUN, Curves, with_tops
from crankmbs.compare.chain import REST, Idealized, checked_chain
from crankmbs.compare.excerpt import Answer, Excerpt, LeftOut, excerpt_of, vanishing
from crankmbs.compare.formula import Formula, formulas_of, variables_of
from crankmbs.compare.lectured import LECTURES, S1
from crankmbs.compare.quantities import QUANTITIES
from crankmbs.compare.split import Budget, Cause, Split
from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["budget"]

_UNTRUNCATED, _, _TRUNCATED = LECTURES
_TOTAL = "total"
_Curve = tuple[str, str, str]  # reference or RUN, quantity, cause or _TOTAL
_NO_BUDGET = "the causes are of forces and of the piston's motion at the run's own speed"


class _Evaluation(NamedTuple):
    """A formula's values by quantity, and what it idealizes.

    errors : its values minus the closed form under these idealizations, at constant speed (True)
        and at the run's; empty where it is the closed form
    """

    reference: str
    values: Answer
    idealized: frozenset[str]
    errors: dict[bool, Answer]


def budget(
    result: Result,
    formulas: Mapping[str, Callable[..., Any]] | None = None,
    *,
    cylinder: int = 1,
    chain: Sequence[str] | None = None,
) -> Budget:
    """Split the error of the lectures' truncated formulas (S1's), and of others, into named causes.

    At every sample of the run's last whole cycle, each cause is the difference of two neighbours
    in this list, unless ``chain`` gives another order:

        truncated formula
            series          exact closed form, lecture's datum, mean speed, two-mass rod
            datum           the same, displacement from the true top dead centre
            constant speed  the same, at the run's omega and alpha
            two-mass rod    with the rigid rod, whose couple (m a b - I) beta'' two masses lack
            gravity         with gravity
            friction        with the pistons' friction, where the scene has any
            forces          with the run's forces from outside on the pistons, where it has any
            solver          the run

    so that they add up to formula minus run, to rounding. The mean speed is the time mean.

    A formula of the user idealizes what it does not ask for: the constant speed without omega and
    alpha, the two-mass rod without rod_inertia (or the reduced inertia, or its slope), gravity
    without gravity_x and gravity_y (or the generalized force), friction without friction_force,
    forces without applied_force;
    the datum where ``chain`` names it. Its "series" is what it differs by from the closed form
    under just these idealizations.

    Parameters
    ----------
    result : any formulation; cylinder : number of the one compared; the main bearing carries all
    formulas : as in `compare`; those that stand for a single number have no budget
    chain : the causes in the order in which they are lifted, each at most once; what it does not
        name is lifted last, together, as "rest"

    Returns
    -------
    Budget : in SI units, shares in percent of the run's peak, as in `compare`; with a rod ratio of
        1 the lectures' starts from their closed form, without "series"

    Raises
    ------
    InputError : no such cylinder or cause; a formula that `compare` refuses too

    >>> split = budget(simulate(load_scene("yi_diesel"))).split("side thrust")
    >>> f"{split.share(split.cause('two-mass rod')):.1f} % of the peak"
    '17.7 % of the peak'
    """
    curves = [formula for formula in formulas_of(formulas) if not formula.is_number]
    causes = checked_chain(chain, result.scene)
    excerpt = excerpt_of(result, cylinder, variables_of(curves))
    from_datum = "datum" in (chain or ())
    ideal = Idealized(excerpt)
    evaluations, left_out = _evaluations(ideal, curves, from_datum)
    zero = vanishing([ideal.run, ideal.closed_form, *(e.values for e in evaluations)])
    left_out += [LeftOut(name, "", reason) for name, reason in zero.items()]
    by_angle = [formula for formula in curves if formula.depends_on_angle_alone(excerpt)]

    def between(points: Excerpt) -> dict[_Curve, Array]:
        there = Idealized(points)
        return _curves(there, causes, _evaluations(there, by_angle, from_datum)[0], zero)

    sampled = _curves(ideal, causes, evaluations, zero)
    found = with_tops(excerpt, sampled, between)
    splits = tuple(
        _split(evaluation, name, found)
        for evaluation in evaluations
        for name in evaluation.values
        if name not in zero
    )
    return Budget(excerpt, causes, splits, tuple(dict.fromkeys(left_out)))


def _evaluations(
    ideal: Idealized, formulas: Sequence[Formula], from_datum: bool
) -> tuple[list[_Evaluation], list[LeftOut]]:
    """The lectures' formulas, then the user's for quantities that the closed form has too; and what
    has no budget."""
    excerpt = ideal.excerpt
    left_out = [LeftOut(name, "", reason) for name, reason in excerpt.left_out().items()]
    try:
        values = ideal.excerpt.lecture(S1, constant_speed=True)
        errors = {constant: ideal.series(constant_speed=constant) for constant in (True, False)}
        evaluations = [_Evaluation(_TRUNCATED, values, ideal.all, errors)]
    except InputError as error:  # the series diverge: the lectures' closed form
        exact, names = ideal.exact(ideal.all), [name for name in ideal.run if name in QUANTITIES]
        left_out += [LeftOut(name, "series", str(error)) for name in names]
        values = {name: exact[name] for name in names}
        evaluations = [_Evaluation(_UNTRUNCATED, values, ideal.all - {"series"}, {})]
    for formula in formulas:
        name = formula.quantity
        if name not in ideal.run:
            left_out.append(LeftOut(name, formula.label, excerpt.lacks(name)))
        elif name not in ideal.closed_form:
            left_out.append(LeftOut(name, f"the budget of {formula.label}", _NO_BUDGET))
        else:
            idealized = formula.idealized | {"series", "solver"}
            idealized = (idealized | {"datum"} if from_datum else idealized) & ideal.all
            values = {name: formula.curve(excerpt)}
            series = {name: values[name] - ideal.exact(idealized)[name]}  # the same at either speed
            errors = {True: series, False: series}
            evaluations.append(_Evaluation(formula.label, values, idealized, errors))
    return evaluations, left_out


def _curves(
    ideal: Idealized,
    chain: Sequence[str],
    evaluations: Sequence[_Evaluation],
    zero: Container[str],
) -> dict[_Curve, Array]:
    """The run, and the errors of formulas with their causes, of quantities that are not zero."""
    curves = {(RUN, name, _TOTAL): curve for name, curve in ideal.run.items() if name not in zero}
    for evaluation in evaluations:
        for name, values in evaluation.values.items():
            if name not in zero:
                for cause, curve in _causes(ideal, chain, evaluation, name):
                    curves[evaluation.reference, name, cause] = curve
                curves[evaluation.reference, name, _TOTAL] = values - ideal.run[name]
    return curves


def _causes(
    ideal: Idealized, chain: Sequence[str], evaluation: _Evaluation, name: str
) -> Iterator[tuple[str, Array]]:
    """What each cause of a chain adds, from a formula's values to the run: they add up to formula
    minus run, to rounding, whatever their order."""
    _, values, remaining, errors = evaluation
    before = values[name]
    for cause in chain:
        if cause == "series" and not errors:
            continue
        lifted = frozenset[str]() if cause == REST else remaining - {cause}
        after = before
        if lifted != remaining:
            after = ideal.exact(lifted)[name]
            if "series" in lifted:
                after = after + errors["constant speed" in lifted][name]
        yield cause, before - after
        remaining, before = lifted, after


def _split(evaluation: _Evaluation, name: str, found: Curves[_Curve]) -> Split:
    """One quantity of a formula."""
    reference, run = evaluation.reference, (RUN, name, _TOTAL)
    *causes, total = (
        Cause(
            name=key[2],
            curve=curve,
            size=found.size(key),
            at_largest=found.at_largest(key, (reference, name, _TOTAL)),
        )
        for key, curve in found.sampled.items()
        if key[:2] == (reference, name)
    )
    return Split(
        quantity=name,
        reference=reference,
        values=evaluation.values[name],
        simulated=found.sampled[run],
        causes=tuple(causes),
        total=total,
        peak=found.peak(run),
    )
