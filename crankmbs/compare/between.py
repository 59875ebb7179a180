"""Curves of a comparison at its samples, and between them where they are largest."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from crankmbs.compare.excerpt import Answer, Excerpt, at_fold
from crankmbs.compare.size import TIE, Size, top_of, within
from crankmbs.measures.nodes import nodes_of
from crankmbs.measures.span import passes_over
from crankmbs.mechanics.peaks import peak
from crankmbs.motion.states import variables_at
from crankmbs.numerics.arrays import Array

__all__ = ["RUN", "Curves", "curves_of", "magnitudes", "with_tops"]

RUN = "run"  # among references, the run itself

Key = TypeVar("Key", bound=tuple[str, ...])
Name = TypeVar("Name", bound=Hashable)
Evaluate = Callable[[Excerpt], dict[Key, Array]]


@dataclass(frozen=True)
class Curves(Generic[Key]):
    """Curves by reference, quantity and what else.

    sampled : at the samples of an excerpt, shape (n,) each; between : those that are known
        elsewhere, too, at points that are the samples and others
    """

    excerpt: Excerpt
    sampled: dict[Key, Array]
    points: Excerpt
    between: dict[Key, Array]

    def size(self, key: Key) -> Size:
        """RMS of a curve over the samples; its maximum over all points, where that is more than
        rounding above the samples'."""
        sampled = self.excerpt.size(key[1], self.sampled[key])
        if key not in self.between:
            return sampled
        more = self.points.size(key[1], self.between[key])
        above = more.largest > sampled.largest * (1.0 + TIE)
        return more._replace(rms=sampled.rms) if above else sampled

    def peak(self, key: Key) -> float:
        """The largest magnitude of a curve."""
        return peak(self.between.get(key, self.sampled[key]))

    def at_largest(self, key: Key, other: Key) -> float:
        """A curve where another, known at as many points, is largest."""
        known = key in self.between
        points, curves = (self.points, self.between) if known else (self.excerpt, self.sampled)
        top = top_of(curves[other], points.angles(key[1]), points.result.scene.period)
        return float(curves[key][top])


def curves_of(answers: dict[str, Answer], names: Iterable[str]) -> dict[tuple[str, str], Array]:
    """The run, and how far every reference is off it, of some quantities."""
    run = answers[RUN]
    return {
        (reference, name): run[name] if reference == RUN else answer[name] - run[name]
        for reference, answer in answers.items()
        for name in names
        if name in answer
    }


def with_tops(excerpt: Excerpt, sampled: dict[Key, Array], evaluate: Evaluate[Key]) -> Curves[Key]:
    """Curves at the samples of an excerpt, and where each of them is largest between these, as
    `crankmbs.measures.nodes.Nodes.tops` finds it in the motion as it was solved; without one the
    samples are all there is.

    evaluate : those of the curves that are known at any points
    """
    if excerpt.result.motion is None:
        return Curves(excerpt, sampled, excerpt, {})
    motion = passes_over(excerpt.result, excerpt.window).answer
    motion = motion.after(float(excerpt.variables["time"][0]))  # a cycle may begin before them
    known, period = evaluate(excerpt), excerpt.result.scene.period

    def first_of_ties(points: Excerpt) -> dict[Key, Array]:
        """Of tops as large as one another the first in the period counts, as among samples."""
        return {
            key: curve * (1.0 - TIE * within(points.angles(key[1]), period) / period)
            for key, curve in evaluate(points).items()
        }

    tops = nodes_of(motion).tops(partial(magnitudes, excerpt, first_of_ties))
    variables = variables_at(motion.train, motion.at(np.unique(tops.time), in_time=True))
    more = _unfolded(excerpt, variables)
    return Curves(
        excerpt,
        sampled,
        replace(excerpt, variables=_joined(excerpt.variables, more.variables)),
        _joined(known, evaluate(more)),
    )


def magnitudes(excerpt: Excerpt, evaluate: Evaluate[Key], variables: Answer) -> Array:
    """Magnitudes of curves along a motion, shape (curves, points); 0 where a rod is folded.

    variables : of the motion, by name
    """
    curves = list(evaluate(_unfolded(excerpt, variables)).values())
    sizes = np.zeros((len(curves), len(variables["time"])))
    sizes[:, ~at_fold(variables["rod_angle"])] = np.abs(curves)
    return sizes


def _unfolded(excerpt: Excerpt, variables: Answer) -> Excerpt:
    """The excerpt at other points, without those at which a rod is folded."""
    unfolded = ~at_fold(variables["rod_angle"])
    rows = {name: variables[name][unfolded] for name in excerpt.variables}
    return replace(excerpt, variables=rows)


def _joined(some: dict[Name, Array], more: dict[Name, Array]) -> dict[Name, Array]:
    return {name: np.concatenate([rows, more[name]]) for name, rows in some.items()}
