"""How far the lectures are off at most, between the samples of a run too."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.compare.excerpt import FOLD, Answer, Excerpt, excerpt_of, vanishing
from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.compare.quantities import QUANTITIES, observed
from crankmbs.errors import InputError
from crankmbs.measures import Estimate
from crankmbs.measures.between import Between
from crankmbs.measures.knots import tops
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["largest_deviations"]

Pair = tuple[str, str]

_RUN = "run"  # beside the lectures, whose answers are held against its


def largest_deviations(result: Result, motions: tuple[Between, ...]) -> dict[Pair, Estimate]:
    """The largest deviation of every lecture in cylinder 1 over the run's last cycle, as a share of
    the largest value of the run [1].

    Both are those of the curves, from the very beginning of the cycle on, but where the rod is
    folded and `compare` has no samples. The error is the run's and what the curves differ by from
    those of the coarser motion; without a motion between the samples it is infinite, and the
    values are those at the samples.

    Parameters
    ----------
    motions : as `crankmbs.measures.between.refined` gives them

    Returns
    -------
    dict over pairs of LECTURES and QUANTITIES, without those that cannot be compared

    Raises
    ------
    InputError : the rod is folded all the time, or the scene has fuel

    >>> from crankmbs.measures.between import refined
    >>> run = simulate(load_scene("propeller"))
    >>> found = largest_deviations(run, refined(run, 0))
    >>> found["untruncated lecture", "side thrust"].error < 1e-6
    True
    """
    excerpt = excerpt_of(motions[-1].result if motions else result, 1)
    window, every = excerpt.window, max(len(motions), 1)
    first = window.first - window.first % every  # a sample of either motion
    variables = _variables(excerpt.result, first)
    pairs = _pairs(_answers(excerpt, variables))
    values = _sizes(excerpt, pairs, variables)
    inside = window.inside - first
    if not motions:
        top, missed = np.max(values[:, inside:], axis=1), np.full(len(pairs), math.inf)
    else:
        coarse = _sizes(excerpt, pairs, _variables(motions[0].result, first // every))
        missed = motions[-1].unsure * np.max(np.abs(values[:, ::every] - coarse), axis=1)

        def at(t: Array) -> Array:
            return _sizes(excerpt, pairs, motions[-1].variables(t))

        samples = variables["time"][inside:], values[:, inside:]
        found = tops(motions[-1], window, samples, at)
        top, missed = found.value, missed + found.beside
    sizes = dict(zip(pairs, np.stack([top, missed], axis=1), strict=True))
    return {
        pair: _share(size, sizes[_RUN, pair[1]], result.error.estimated)
        for pair, size in sizes.items()
        if pair[0] != _RUN and sizes[_RUN, pair[1]][0] > 0.0
    }


def _share(size: Array, whole: Array, relative: float) -> Estimate:
    """One size over another, both with their errors."""
    share = float(size[0] / whole[0])
    missed = float((size[1] + share * whole[1]) / whole[0])
    return Estimate(share, missed + (1.0 + share) * relative)


def _variables(result: Result, first: int) -> Answer:
    """Every variable and coordinate over time, from a sample on."""
    variables = result.data.variables.items()
    return {str(name): one.values[first:] for name, one in variables if "time" in one.dims}


def _answers(excerpt: Excerpt, variables: Answer) -> dict[str, Answer]:
    """What the run and each lecture say of a motion."""
    scene, train = excerpt.result.scene, excerpt.train
    names = ("crank_angle", "crank_speed", "crank_acceleration")
    theta, omega, alpha = (variables[name] for name in names)
    still = np.zeros_like(alpha)
    found = {_RUN: observed(scene, variables, theta, omega, alpha)}
    for name, formulas in LECTURES.items():
        try:
            found[name] = lectured(formulas, train, theta, still + excerpt.mean_speed, still)
        except InputError:  # a rod ratio that it does not know
            continue
    return {name: excerpt.seen(answer) for name, answer in found.items()}


def _pairs(answers: dict[str, Answer]) -> list[Pair]:
    """Of what all say and is more than rounding, who says it."""
    nothing = vanishing(answers.values())
    kept = [name for name in QUANTITIES if name in answers[_RUN] and name not in nothing]
    return [(who, name) for who in answers for name in kept]


def _sizes(excerpt: Excerpt, pairs: list[Pair], variables: Answer) -> Array:
    """How large the run's quantities are, and how far the lectures are off, along a motion, shape
    (pairs, n); nothing beside folds."""
    answers = _answers(excerpt, variables)
    run = answers[_RUN]
    rows = [run[name] if who == _RUN else answers[who][name] - run[name] for who, name in pairs]
    folded = np.min(np.cos(variables["rod_angle"]), axis=1) < FOLD
    return np.where(folded, 0.0, np.abs(rows))
