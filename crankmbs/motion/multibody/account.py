"""The stretches of runs, from which their accounts are made."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.motion.base import State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.answer import Answers
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["Run", "Stretch", "runs_of"]

_STAGES = 3  # of Gauss in a step, whose error is of order 2


class Stretch(NamedTuple):
    """A stretch, or the part of one in which the crank turns one way."""

    begin: State
    end: State
    decisions: tuple[State, ...]
    cells: Cells


Run = tuple[State, list[Stretch], Ending]
"""How a run begins, its stretches, how it ends."""


def runs_of(runs: Runs) -> list[Run]:
    """The finest run and the one before it."""
    found, begin = list[Run](), runs.start
    if not (runs.moves and runs.paths):
        return [(begin, [], runs.ending)]
    for path in runs.paths[:-3:-1]:
        answers = Answers(runs.model, runs.forces, path.states)
        stretches = list(_stretches(Motion((path,), (1.0,)), answers, path.states))
        found.append((begin, stretches, runs.ending))
    return found


def _stretches(motion: Motion, answers: Answers, states: tuple[State, ...]) -> Iterator[Stretch]:
    """The stretches of a run, each cut where the crank turns back."""
    turns = np.array([end for _, end in motion.stretches[:-1]])
    for begin, end in pairwise(states):
        inside = turns[(turns > begin.time) & (turns < end.time)]
        angles = motion.at(inside)[0].tolist() if len(inside) else []
        turned = [
            State(t, a, 0.0, 0.0, begin.mode) for t, a in zip(inside.tolist(), angles, strict=True)
        ]
        for first, last in pairwise([begin, *turned, end]):
            yield Stretch(first, last, (), _cells(motion, answers, first, last))


def _cells(motion: Motion, answers: Answers, begin: State, end: State) -> Cells:
    """The steps between two states as cells of a motion."""
    grid = motion.grid
    inside = grid[(grid > begin.time) & (grid < end.time)]
    edges = np.concatenate([[begin.time], inside, [end.time]])
    time = edges[:-1, None] + np.diff(edges)[:, None] * ends_and_nodes(_STAGES).places
    time[:, -1] = edges[1:]
    at = motion.at(time.ravel())
    found = answers.at(time.ravel(), *at)
    rows = *at, found["crank_acceleration"], found["external_torque"]
    angle, speed, rate, outside = (row.reshape(time.shape) for row in rows)
    angle[0, 0], angle[-1, -1] = begin.theta, end.theta
    acting = Acting(float(np.sign(end.theta - begin.theta)))
    shares = np.tile(begin.mode.shares, (len(time), 1))
    return Cells(time, angle, speed, acting, shares, None, rate, outside)
