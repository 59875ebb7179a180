"""Largest errors of the lectures' formulas, over the motion as solved."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from crankmbs.compare.between import RUN, curves_of, magnitudes
from crankmbs.compare.excerpt import Answer, Excerpt, excerpt_of, vanishing
from crankmbs.compare.lectured import LECTURES
from crankmbs.compare.quantities import QUANTITIES
from crankmbs.errors import InputError
from crankmbs.measures import Estimate
from crankmbs.measures.estimate import Number, Numbers, estimates
from crankmbs.measures.nodes import nodes_of
from crankmbs.measures.span import passes_over
from crankmbs.motion.motion import Motion
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["largest_deviations"]

Pair = tuple[str, str]


def largest_deviations(result: Result) -> dict[Pair, Estimate]:
    """The largest deviation of every lecture in cylinder 1 over the run's last cycle, as a share of
    the largest value of the run [1].

    Both are maxima of the continuous curves over the whole cycle, except where the rod is folded
    and `compare` has no samples. The error is their difference from those of the motions that
    check the run.

    Returns
    -------
    dict over pairs of LECTURES and QUANTITIES, without those that cannot be compared

    Raises
    ------
    InputError : the rod is folded all the time, or the scene has fuel

    >>> deviations = largest_deviations(simulate(load_scene("propeller")))
    >>> deviations["untruncated lecture", "side thrust"].error < 1e-6
    True
    """
    excerpt = excerpt_of(result, 1)
    passes = passes_over(result, excerpt.window)
    answers = _answers(replace(excerpt, variables=nodes_of(passes.answer).variables))
    zero = vanishing(answers.values())
    names = [name for name in answers[RUN] if name not in zero]
    shares = estimates(passes, partial(_shares, excerpt, names))["shares"]
    pairs = product([source for source in answers if source != RUN], names)
    by_pair = zip(pairs, shares, strict=True)
    return {pair: share for pair, share in by_pair if np.isfinite(share.value)}


def _shares(excerpt: Excerpt, names: list[str], motion: Motion) -> Numbers:
    """The largest deviations of every lecture over a motion, as shares of the run's largest
    values."""
    duration = motion.end - motion.begin
    mean = excerpt.window.angle / duration if duration > 0.0 else excerpt.mean_speed
    cycle = replace(excerpt, train=motion.train, mean_speed=mean)

    def curves(points: Excerpt) -> dict[Pair, Array]:
        return curves_of(_answers(points), names)

    peaks = nodes_of(motion).tops(partial(magnitudes, cycle, curves))
    run, *errors = peaks.value.reshape(-1, len(names))
    share = np.full(np.shape(errors), np.nan)
    np.divide(errors, run, out=share, where=run > 0.0)
    units, of_run = np.array([QUANTITIES[name].units for name in names]), peaks.sizes[: len(names)]
    # a force or torque is rounded like the largest force or torque that it is a sum of
    sizes = np.array([np.max(of_run[units == unit]) for unit in units])
    rounding = np.divide((1.0 + share) * sizes, run, out=1.0 + share, where=run > 0.0)
    periods = motion.end / duration if duration > 0.0 else 0.0  # units of rounding of the duration
    size = (1.0 + periods) * (1.0 + share + rounding)
    return {"shares": Number(share.ravel(), size.ravel())}


def _answers(excerpt: Excerpt) -> dict[str, Answer]:
    """The quantities at points of a motion, by the run and by each lecture."""
    answers = {RUN: excerpt.simulated()}
    for name, formulas in LECTURES.items():
        with suppress(InputError):  # of a rod ratio for which its series diverge
            answers[name] = excerpt.lecture(formulas, constant_speed=True)
    return answers
