"""What happens on the way of a multibody run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.account import Account
from crankmbs.motion.base import Nodes, Points, Samples, State
from crankmbs.motion.driven import Way, driven, driven_observer, own_energy
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.halvings import Halvings
from crankmbs.motion.multibody.problem import Problem
from crankmbs.motion.multibody.samples import monotone, reached, times_of
from crankmbs.motion.multibody.step_table import StepTable
from crankmbs.motion.multibody.stepped import Stepped
from crankmbs.motion.observer import Observer, account_of
from crankmbs.motion.plan import Wanted
from crankmbs.motion.prescribed import monotone_stretches
from crankmbs.numerics.arrays import Array

__all__ = ["account_of_runs"]

_SAFETY = 1.5  # as in `crankmbs.motion.multibody.error`
_POINTS = 8  # of Gauss in 5 degrees
_GAUSS = np.polynomial.legendre.leggauss(3)  # in a step, whose error is of order 2


@dataclass(frozen=True)
class _Landed:
    """A stretch, or the part of one in which the crank turns one way."""

    table: StepTable
    begin: State
    end: State
    decisions: tuple[State, ...] = ()

    def nodes(self) -> Nodes:
        """The steps, and Gauss points in them."""
        inside = self.table.times
        inside = inside[(inside > self.begin.time) & (inside < self.end.time)]
        edges = np.concatenate([[self.begin.time], inside, [self.end.time]])
        width = np.diff(edges)[:, None]
        time = edges[:-1, None] + 0.5 * width * (1.0 + _GAUSS[0])
        found = self.table.with_rate("crank_angle", "crank_speed", time.ravel())
        theta, omega = (values.reshape(time.shape) for values in found)
        speeds = self.table.one_at("crank_speed", edges)
        return Nodes(edges, speeds, Points(time, theta, omega, 0.5 * width * _GAUSS[1] * omega))

    def sample(self, plan: Wanted) -> Samples:
        """Its samples where they are wanted."""
        between = self.begin.time, self.end.time
        if plan.in_time:
            time = plan.between(*between)
        else:
            time = times_of(self.table, plan.between(self.begin.theta, self.end.theta), *between)
        return _samples(self.table, time)


def _samples(table: StepTable, time: Array) -> Samples:
    found = table.at(time)
    return Samples(
        time=time,
        theta=found["crank_angle"],
        omega=found["crank_speed"],
        alpha=found["crank_acceleration"],
        energy_residual=found["energy_residual"],
        own={name: found[name] for name in ("kinetic_energy", "external_torque")},
    )


def account_of_runs(train: CrankTrain, runs: Halvings) -> Account:
    """The account of the finest run; its error is what the last halving changed, half as large
    again. Where the speed is prescribed its law says when something happens."""
    paths = runs.paths[:-3:-1]
    seen = [_observed(train, path, runs, finer=k > 0) for k, path in enumerate(paths)]
    return account_of(seen, _SAFETY)


def _observed(train: CrankTrain, path: Stepped, runs: Halvings, *, finer: bool) -> Observer:
    if runs.problem.law is not None:
        return _driven(train, path, runs.problem, finer=finer, ending=runs.ending)
    observer, last = Observer(train, own_energy, finer=finer), path.landings[0]
    observer.start(last)
    for piece in _pieces(path) if runs.moves else ():
        observer.add(piece)
        last = piece.end
    observer.close(runs.ending, last)
    return observer


def _driven(
    train: CrankTrain, path: Stepped, problem: Problem, *, finer: bool, ending: Ending
) -> Observer:
    """Of a run with a prescribed speed: its law, and what the run needs to follow it."""
    law = problem.law
    assert law is not None
    stretches, _ = monotone_stretches(problem.plan, law)
    until = min(problem.end, reached(path)[0])
    passed = [(begin, min(end, until)) for begin, end in stretches if begin < until]
    tables = [table for table in path.tables if table.until > table.after]
    ends = np.array([table.until for table in tables[:-1]])

    def moving(time: Array, _shares: Array | None) -> Samples:
        which = np.searchsorted(ends, time)
        parts = [_samples(table, time[which == k]) for k, table in enumerate(tables)]
        return Samples.joined([part for part in parts if len(part.time)] or parts[:1])

    pieces = driven(Way(train, law, moving, _POINTS), passed)
    return driven_observer(train, pieces, finer=finer, rests=ending is Ending.LAW_RESTS)


def _pieces(path: Stepped) -> Iterator[_Landed]:
    """The stretches of a run, each cut where the crank turns back."""
    tables = [table for table in path.tables if table.until > table.after]
    for table, (begin, end) in zip(tables, pairwise(path.landings), strict=True):
        if end.time > table.until:  # a run that was called off ends before its last landing
            last = np.array([table.until])
            at = table.with_rate("crank_angle", "crank_speed", last)
            theta, omega = (float(values[0]) for values in at)
            end = State(table.until, theta, omega, 0.0, begin.mode)
        turns = [until for _, until in monotone(table)[:-1]]
        angles = table.one_at("crank_angle", np.array(turns)).tolist() if turns else []
        turned = [State(t, a, 0.0, 0.0, begin.mode) for t, a in zip(turns, angles, strict=True)]
        yield from (_Landed(table, *pair) for pair in pairwise([begin, *turned, end]))
