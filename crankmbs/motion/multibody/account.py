"""The runs as passes of one motion: cells of a few steps each, from which all else is read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phase
from crankmbs.motion.base import State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.runs import Motion
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["Kept", "Stretch"]

_STEPS = 4  # in a cell
_HAIR = 1e-9  # of a stretch: so far from its ends, at which loads jump
_STAGES = 4  # of Gauss in it: polynomials of degree 5, where those of the steps are of degree 3


class Stretch(NamedTuple):
    """A stretch, or the part of one in which the crank turns one way."""

    begin: State
    end: State
    decisions: tuple[State, ...]
    cells: Cells


@dataclass(frozen=True, eq=False)
class Kept:
    """What is kept of the runs of a scene.

    passes : motions, the answer first, each with the states where its stretches begin, and the last
        one ends; none where the crank stays at rest
    bound : crank angle [rad] at which the run ends, where it ends at one
    """

    train: CrankTrain
    start: State
    passes: tuple[tuple[Motion, tuple[State, ...]], ...]
    bound: float | None
    ending: Ending

    @cached_property
    def stretches(self) -> list[list[Stretch]]:
        """Those of each pass, cut where the crank turns back."""
        forces = Forces(self.train)
        return [list(self._of(forces, *each)) for each in self.passes]

    def _of(self, forces: Forces, motion: Motion, states: tuple[State, ...]) -> Iterator[Stretch]:
        until = motion.until(states[-1].time, self.bound)
        states = (*states[:-1], states[-1]._replace(time=until))
        turns = np.array([end for _, end in motion.stretches[:-1]])
        for begin, end in pairwise(states):
            inside = turns[(turns > begin.time) & (turns < end.time)]
            angles = motion.at(inside)[0].tolist() if len(inside) else []
            turned = [
                State(t, a, 0.0, 0.0, begin.mode)
                for t, a in zip(inside.tolist(), angles, strict=True)
            ]
            for first, last in pairwise([begin, *turned, end]):
                grid = motion.grid[::_STEPS]
                inner = grid[(grid > first.time) & (grid < last.time)]
                edges = np.concatenate([[first.time], inner, [last.time]])
                yield Stretch(first, last, (), _cells(forces, first, edges, motion.at))


def _cells(
    forces: Forces, begin: State, edges: Array, at: Callable[[Array], tuple[Array, Array]]
) -> Cells:
    """The cells between times [s], under the torque of the loads that act from a state on."""
    time = edges[:-1, None] + np.diff(edges)[:, None] * ends_and_nodes(_STAGES).places
    time[:, -1] = edges[1:]
    angle, speed = at(time.ravel())
    loads = [phase is Phase.ACTING for phase in begin.mode.loads]
    acts = np.tile(loads or [True] * len(forces.train.loads), (time.size, 1))
    hair = _HAIR * (edges[-1] - edges[0])
    inside = np.clip(time.ravel(), edges[0] + hair, edges[-1] - hair)
    outside = forces.torque(inside, *at(inside), acts).reshape(time.shape)
    acting = Acting(float(np.sign(angle[-1] - angle[0])), phases=begin.mode.loads)
    shares = np.tile(begin.mode.shares, (len(time), 1))
    angle, speed = angle.reshape(time.shape), speed.reshape(time.shape)
    return Cells(time, angle, speed, acting, shares, outside=outside)
