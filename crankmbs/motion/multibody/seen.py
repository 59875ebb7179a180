"""What happens on the way of a multibody run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Piece, State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.driven import Way, begun_at, driven
from crankmbs.motion.multibody.halvings import Halvings
from crankmbs.motion.multibody.problem import Problem
from crankmbs.motion.multibody.samples import monotone, reached
from crankmbs.motion.multibody.step_table import StepTable
from crankmbs.motion.multibody.stepped import Stepped
from crankmbs.motion.prescribed import monotone_stretches
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["Run", "pieces_of_runs"]

_POINTS = 8  # of Gauss in 5 degrees
_STAGES = 3  # of Gauss in a step, whose error is of order 2
_MOTION = ("crank_angle", "crank_speed", "crank_acceleration", "external_torque")


Run = tuple[State, Sequence[Piece]]
"""The state in which a run begins, and its pieces."""


@dataclass(frozen=True)
class _Landed:
    """A stretch, or the part of one in which the crank turns one way."""

    table: StepTable
    begin: State
    end: State
    decisions: tuple[State, ...] = ()

    @property
    def cells(self) -> Cells:
        """The steps as cells of a motion."""
        inside = self.table.times
        inside = inside[(inside > self.begin.time) & (inside < self.end.time)]
        edges = np.concatenate([[self.begin.time], inside, [self.end.time]])
        time = edges[:-1, None] + np.diff(edges)[:, None] * ends_and_nodes(_STAGES).places
        time[:, -1] = edges[1:]
        found = self.table.at(time.ravel())
        rows = {name: found[name].reshape(time.shape) for name in _MOTION}
        sense = float(np.sign(self.end.theta - self.begin.theta))
        angle, speed, rate, outside = rows.values()
        angle[0, 0], angle[-1, -1] = self.begin.theta, self.end.theta
        shares = np.tile(self.begin.mode.shares, (len(time), 1))
        return Cells(time, angle, speed, Acting(sense), shares, None, rate, outside)


@dataclass(frozen=True)
class _Given:
    """A stretch of a prescribed motion with what the run needs to follow it."""

    begin: State
    end: State
    decisions: tuple[State, ...]
    cells: Cells


def pieces_of_runs(train: CrankTrain, runs: Halvings) -> list[Run]:
    """Of the finest run and the one before it, the begin and the pieces. Where the speed is
    prescribed its law says when something happens."""
    if runs.problem.law is not None:
        way = Way(train, runs.problem.law, _POINTS)
        paths = runs.paths[:-3:-1]
        return [(begun_at(way), list(_given(way, path, runs.problem))) for path in paths]
    return [
        (path.landings[0], list(_pieces(path)) if runs.moves else []) for path in runs.paths[:-3:-1]
    ]


def _given(way: Way, path: Stepped, problem: Problem) -> Iterator[_Given]:
    """The stretches of a prescribed speed, with what the run needs to follow it."""
    stretches, _ = monotone_stretches(problem.plan, way.law)
    until = min(problem.end, reached(path)[0])
    passed = [(begin, min(end, until)) for begin, end in stretches if begin < until]
    tables = [table for table in path.tables if table.until > table.after]
    ends = np.array([table.until for table in tables[:-1]])
    for piece in driven(way, passed):
        time = piece.cells.time.ravel()
        which, outside = np.searchsorted(ends, time), np.empty_like(time)
        for k, table in enumerate(tables):
            outside[which == k] = table.at(time[which == k])["external_torque"]
        cells = replace(piece.cells, outside=outside.reshape(piece.cells.time.shape))
        yield _Given(piece.begin, piece.end, piece.decisions, cells)


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
