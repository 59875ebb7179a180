"""What happens on the way of a free run, from its stretches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from crankmbs.motion.account import Account
from crankmbs.motion.base import Nodes, Points, Samples, State
from crankmbs.motion.driven import own_energy
from crankmbs.motion.multibody.answer import Answers
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.motion.observer import Observer, account_of
from crankmbs.motion.plan import Wanted

__all__ = ["account_of_runs"]

_GAUSS = np.polynomial.legendre.leggauss(3)  # in a step, whose error is of order 2


@dataclass(frozen=True)
class _Piece:
    """A stretch, or the part of one in which the crank turns one way."""

    motion: Motion
    answers: Answers
    begin: State
    end: State
    decisions: tuple[State, ...] = ()

    def nodes(self) -> Nodes:
        """The steps, and Gauss points in them."""
        grid, (begin, end) = self.motion.grid, (self.begin.time, self.end.time)
        edges = np.concatenate([[begin], grid[(grid > begin) & (grid < end)], [end]])
        width = np.diff(edges)[:, None]
        time = edges[:-1, None] + 0.5 * width * (1.0 + _GAUSS[0])
        theta, omega = self.motion.at(time)
        turned = 0.5 * width * _GAUSS[1] * omega
        return Nodes(edges, self.motion.at(edges)[1], Points(time, theta, omega, turned))

    def sample(self, plan: Wanted) -> Samples:
        """Its samples where they are wanted."""
        between = self.begin.time, self.end.time
        if plan.in_time:
            time = plan.between(*between)
        else:
            time = self.motion.times(plan.between(self.begin.theta, self.end.theta), *between)
        theta, omega = self.motion.at(time)
        found = self.answers.at(time, theta, omega)
        own = {name: found[name] for name in ("kinetic_energy", "external_torque")}
        rest = np.zeros_like(time)
        return Samples(time, theta, omega, found["crank_acceleration"], rest, own)


def account_of_runs(runs: Runs) -> Account:
    """The account of the finest run; its error is what it differs by from the two before."""
    train, seen = runs.forces.train, []
    for finer, path in enumerate(runs.paths[:-4:-1] or [None]):
        observer = Observer(train, own_energy, finer=not finer)
        observer.start(runs.start)
        last = runs.start
        if path is not None and runs.moves:
            answers = Answers(runs.model, runs.forces, path.states)
            for piece in _pieces(Motion((path,), (1.0,)), answers, path.states):
                observer.add(piece)
                last = piece.end
        observer.close(runs.ending, last)
        seen.append(observer)
    return account_of(seen, 1.0)


def _pieces(motion: Motion, answers: Answers, states: tuple[State, ...]) -> Iterator[_Piece]:
    """The stretches of a run, each cut where the crank turns back."""
    turns = np.array([end for _, end in motion.stretches[:-1]])
    for begin, end in pairwise(states):
        inside = turns[(turns > begin.time) & (turns < end.time)]
        angles = motion.at(inside)[0].tolist() if len(inside) else []
        turned = [
            State(t, a, 0.0, 0.0, begin.mode) for t, a in zip(inside.tolist(), angles, strict=True)
        ]
        for first, last in pairwise([begin, *turned, end]):
            yield _Piece(motion, answers, first, last)
