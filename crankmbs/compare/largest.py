"""How far the lectures are off at most, over the motion as it was solved."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from crankmbs.compare.excerpt import FOLD, Answer, Excerpt, excerpt_of, vanishing
from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.compare.quantities import QUANTITIES, observed
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

_RUN = "run"  # beside the lectures, whose answers are held against its


def largest_deviations(result: Result) -> dict[Pair, Estimate]:
    """The largest deviation of every lecture in cylinder 1 over the run's last cycle, as a share of
    the largest value of the run [1].

    Both are those of the curves, from the very beginning of the cycle on, but where the rod is
    folded and `compare` has no samples. The error is what they differ by from those of the motions
    that check the run.

    Returns
    -------
    dict over pairs of LECTURES and QUANTITIES, without those that cannot be compared

    Raises
    ------
    InputError : the rod is folded all the time, or the scene has fuel

    >>> found = largest_deviations(simulate(load_scene("propeller")))
    >>> found["untruncated lecture", "side thrust"].error < 1e-6
    True
    """
    excerpt = excerpt_of(result, 1)
    passes = passes_over(result, excerpt.window)
    pairs = _pairs(_answers(excerpt, nodes_of(passes.answer).variables))
    shares = estimates(passes, partial(_shares, excerpt, pairs))["shares"]
    rows = zip(pairs, shares, strict=True)
    return {pair: share for pair, share in rows if pair[0] != _RUN and np.isfinite(share.value)}


def _shares(excerpt: Excerpt, pairs: list[Pair], motion: Motion) -> Numbers:
    """The largest deviations over a motion, as shares of the run's largest values."""
    duration = motion.end - motion.begin
    mean = excerpt.window.angle / duration if duration > 0.0 else excerpt.mean_speed
    seen = replace(excerpt, train=motion.train, mean_speed=mean)
    tops = nodes_of(motion).tops(partial(_sizes, seen, pairs))
    runs = [k for k, (who, _) in enumerate(pairs) if who == _RUN]
    of = np.array([next(k for k in runs if pairs[k][1] == name) for _, name in pairs])
    whole = tops.value[of]
    share = np.full(len(pairs), np.nan)
    np.divide(tops.value, whole, out=share, where=whole > 0.0)
    units = np.array([QUANTITIES[name][0] for _, name in pairs])
    # what is rounded of a force or a torque is the largest that it is made of
    sizes = np.array([np.max(tops.sizes[runs][units[runs] == unit]) for unit in units])
    size = np.divide((1.0 + share) * sizes, whole, out=1.0 + share, where=whole > 0.0)
    late = motion.end / duration if duration > 0.0 else 0.0  # units of rounding of the duration
    return {"shares": Number(share, (1.0 + late) * (1.0 + share + size))}


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
