"""Largest errors of the lectures' formulas, over the motion as solved."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np

from crankmbs.compare.excerpt import Answer, Excerpt, at_fold, excerpt_of, vanishing
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

_RUN = "run"  # the source that the lectures are compared with


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
    pairs = _pairs(_answers(excerpt, nodes_of(passes.answer).variables))
    shares = estimates(passes, partial(_shares, excerpt, pairs))["shares"]
    by_pair = zip(pairs, shares, strict=True)
    return {pair: share for pair, share in by_pair if pair[0] != _RUN and np.isfinite(share.value)}


def _shares(excerpt: Excerpt, pairs: list[Pair], motion: Motion) -> Numbers:
    """The largest deviations over a motion, as shares of the run's largest values."""
    duration = motion.end - motion.begin
    mean = excerpt.window.angle / duration if duration > 0.0 else excerpt.mean_speed
    cycle = replace(excerpt, train=motion.train, mean_speed=mean)
    peaks = nodes_of(motion).tops(partial(_magnitudes, cycle, pairs))
    run_rows = [k for k, (source, _) in enumerate(pairs) if source == _RUN]
    rows = np.array([next(k for k in run_rows if pairs[k][1] == name) for _, name in pairs])
    run_peaks = peaks.value[rows]
    share = np.full(len(pairs), np.nan)
    np.divide(peaks.value, run_peaks, out=share, where=run_peaks > 0.0)
    units = np.array([QUANTITIES[name][0] for _, name in pairs])
    # a force or torque is rounded like the largest force or torque that it is a sum of
    sizes = np.array([np.max(peaks.sizes[run_rows][units[run_rows] == unit]) for unit in units])
    rounding = np.divide((1.0 + share) * sizes, run_peaks, out=1.0 + share, where=run_peaks > 0.0)
    periods = motion.end / duration if duration > 0.0 else 0.0  # units of rounding of the duration
    return {"shares": Number(share, (1.0 + periods) * (1.0 + share + rounding))}


def _answers(excerpt: Excerpt, variables: Answer) -> dict[str, Answer]:
    """The quantities along a motion, by the run and by each lecture."""
    curves = replace(excerpt, variables=variables)
    answers = {_RUN: curves.simulated()}
    for name, formulas in LECTURES.items():
        with suppress(InputError):  # of a rod ratio for which its series diverge
            answers[name] = curves.lecture(formulas, constant_speed=True)
    return answers


def _pairs(answers: dict[str, Answer]) -> list[Pair]:
    """Source and quantity, for quantities that are more than rounding."""
    zero = vanishing(answers.values())
    quantities = [name for name in QUANTITIES if name in answers[_RUN] and name not in zero]
    return [(source, name) for source in answers for name in quantities]


def _magnitudes(excerpt: Excerpt, pairs: list[Pair], variables: Answer) -> Array:
    """Magnitudes of the run's quantities and of the lectures' errors along a motion, shape
    (pairs, n); 0 at folds."""
    answers = _answers(excerpt, variables)
    run = answers[_RUN]
    curves = [
        run[name] if source == _RUN else answers[source][name] - run[name] for source, name in pairs
    ]
    return np.where(at_fold(variables["rod_angle"]), 0.0, np.abs(curves))
