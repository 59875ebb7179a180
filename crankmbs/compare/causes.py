"""The error budget: the error of a formula, split into causes that add up to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from crankmbs.compare.between import with_points_between
from crankmbs.compare.chain import REST, Idealized, checked_chain
from crankmbs.compare.excerpt import Answer, Excerpt, LeftOut, excerpt_of, vanishing
from crankmbs.compare.formula import Formula, formulas_of, variables_of
from crankmbs.compare.lectured import LECTURES, S1
from crankmbs.compare.quantities import QUANTITIES
from crankmbs.compare.split import Budget, Cause, Split
from crankmbs.errors import InputError
from crankmbs.mechanics.peaks import peak
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["budget"]

_UNTRUNCATED, _, _TRUNCATED = LECTURES
_RUN, _TOTAL = "run", "total"
_Curve = tuple[str, str, str]  # reference or _RUN, quantity, cause or _TOTAL
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
    ideal = Idealized(excerpt)
    left_out = [LeftOut(name, "", reason) for name, reason in excerpt.left_out().items()]
    from_datum = "datum" in (chain or ())
    evaluations = [_lecture(ideal, left_out), *_users(curves, ideal, from_datum, left_out)]
    zero = vanishing([ideal.run, ideal.closed_form, *(e.values for e in evaluations)])
    left_out += [LeftOut(name, "", reason) for name, reason in zero.items()]
    nonzero = [name for name in ideal.run if name not in zero]
    by_angle = [formula for formula in curves if formula.depends_on_angle_alone(excerpt)]

    def evaluate(points: Excerpt) -> dict[_Curve, Array]:
        there = Idealized(points)
        known = [_lecture(there, []), *_users(by_angle, there, from_datum, [])]
        return _curves(there, causes, known, nonzero)

    at_samples = _curves(ideal, causes, evaluations, nonzero)
    labels = {_RUN, *LECTURES, *(formula.label for formula in by_angle)}
    known = {key: curve for key, curve in at_samples.items() if key[0] in labels}
    points, between = with_points_between(excerpt, known, evaluate)
    splits = tuple(
        _split(evaluation, name, (excerpt, at_samples), (points, between))
        for evaluation in evaluations
        for name in evaluation.values
        if name in nonzero
    )
    return Budget(excerpt, causes, splits, tuple(dict.fromkeys(left_out)))


def _lecture(ideal: Idealized, left_out: list[LeftOut]) -> _Evaluation:
    """S1's formulas; where their series diverge, the lectures' closed form, noted in left_out."""
    names = [name for name in ideal.run if name in QUANTITIES]
    try:
        values = ideal.excerpt.lecture(S1, constant_speed=True)
        return _Evaluation(_TRUNCATED, values, ideal.all, ideal.truncated)
    except InputError as error:
        left_out += [LeftOut(name, "series", str(error)) for name in names]
    idealized = ideal.all - {"series"}
    exact = ideal.exact(idealized)
    return _Evaluation(_UNTRUNCATED, {name: exact[name] for name in names}, idealized, {})


def _users(
    formulas: Sequence[Formula], ideal: Idealized, from_datum: bool, left_out: list[LeftOut]
) -> list[_Evaluation]:
    """A user's formulas, those for quantities that the closed form has too."""
    evaluations = []
    for formula in formulas:
        name = formula.quantity
        if name not in ideal.run:
            reason = ideal.excerpt.left_out().get(name, "the run has none")
            left_out.append(LeftOut(name, formula.label, reason))
            continue
        if name not in ideal.closed_form:
            left_out.append(LeftOut(name, f"the budget of {formula.label}", _NO_BUDGET))
            continue
        idealized = formula.idealized | {"series", "solver"} | ({"datum"} if from_datum else set())
        values = formula.curve(ideal.excerpt)
        error = {name: values - ideal.exact(idealized)[name]}  # the same at either speed
        errors = {True: error, False: error}
        evaluations.append(
            _Evaluation(formula.label, {name: values}, idealized & ideal.all, errors)
        )
    return evaluations


def _curves(
    ideal: Idealized,
    chain: Sequence[str],
    evaluations: Sequence[_Evaluation],
    quantities: Sequence[str],
) -> dict[_Curve, Array]:
    """The run, and the errors of formulas with their causes, of some quantities."""
    curves: dict[_Curve, Array] = {(_RUN, name, _TOTAL): ideal.run[name] for name in quantities}
    for evaluation in evaluations:
        for name in evaluation.values:
            if name in quantities:
                for cause, curve in _causes(ideal, chain, evaluation, name).items():
                    curves[evaluation.reference, name, cause] = curve
    return curves


def _causes(
    ideal: Idealized, chain: Sequence[str], evaluation: _Evaluation, name: str
) -> dict[str, Array]:
    """What each cause of a chain adds, from a formula's values to the run: they add up to formula
    minus run, the last, to rounding, whatever their order."""
    _, values, remaining, errors = evaluation
    simulated, before, causes = ideal.run[name], values[name], {}
    for cause in chain:
        if cause == "series" and not errors:
            continue
        lifted = frozenset[str]() if cause == REST else remaining - {cause}
        after = before
        if not lifted:
            after = simulated
        elif lifted != remaining:
            after = ideal.exact(lifted)[name]
            if "series" in lifted:
                after = after + errors["constant speed" in lifted][name]
        causes[cause] = before - after
        remaining, before = lifted, after
    return {**causes, _TOTAL: values[name] - simulated}


def _split(
    evaluation: _Evaluation,
    name: str,
    sampled: tuple[Excerpt, dict[_Curve, Array]],
    between: tuple[Excerpt, dict[_Curve, Array]],
) -> Split:
    """One quantity of a formula; the sizes of curves that are known between the samples are those
    there, too."""
    reference, run = evaluation.reference, (_RUN, name, _TOTAL)
    (excerpt, at_samples), (_, everywhere) = sampled, between
    points, curves = between if (reference, name, _TOTAL) in everywhere else sampled
    top = points.top(name, curves[reference, name, _TOTAL])
    *causes, total = (
        Cause(
            name=key[2],
            curve=curve,
            size=excerpt.size_with(points, name, curve, curves[key]),
            at_largest=float(curves[key][top]),
        )
        for key, curve in at_samples.items()
        if key[:2] == (reference, name)
    )
    return Split(
        quantity=name,
        reference=reference,
        values=evaluation.values[name],
        simulated=at_samples[run],
        causes=tuple(causes),
        total=total,
        peak=peak(everywhere[run]),
    )
