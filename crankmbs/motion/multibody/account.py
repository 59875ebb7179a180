"""The runs as passes of one motion: cells of a few steps each, from which all else is read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.runs import Motion
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["Kept", "Stretch", "stretches_of"]

_STEPS = 4  # in a cell
_HAIR = 1e-9  # of a stretch: so far from its ends, at which loads jump
_STAGES = 4  # of Gauss in it: polynomials of degree 5, where those of the steps are of degree 3


class Stretch(NamedTuple):
    """A stretch, in which the crank turns one way and nothing jumps."""

    begin: State
    end: State
    decisions: tuple[State, ...]
    cells: Cells


@dataclass(frozen=True, eq=False)
class Kept:
    """What is kept of the runs of a scene.

    passes : motions, the answer first; none where the crank stays at rest
    bound : crank angle [rad] at which the run ends, where it ends at one
    """

    train: CrankTrain
    start: State
    passes: tuple[Motion, ...]
    bound: float | None
    ending: Ending

    @cached_property
    def stretches(self) -> list[list[Stretch]]:
        """Those of each pass."""
        forces = Forces(self.train)
        return [list(stretches_of(forces, each, self.bound)) for each in self.passes]


def stretches_of(forces: Forces, motion: Motion, bound: float | None) -> Iterator[Stretch]:
    """The stretches of a motion that ends at a crank angle [rad], or else with its last state."""
    *states, last = motion.states
    for begin, end in pairwise([*states, last._replace(time=motion.until(bound))]):
        grid = motion.grid[::_STEPS]
        inner = grid[(grid > begin.time) & (grid < end.time)]
        edges = np.concatenate([[begin.time], inner, [end.time]])
        yield Stretch(begin, end, (), _cells(forces, begin, edges, motion))


def _cells(forces: Forces, begin: State, edges: Array, motion: Motion) -> Cells:
    """The cells between times [s], under the torque of the loads that act from a state on."""
    time = edges[:-1, None] + np.diff(edges)[:, None] * ends_and_nodes(_STAGES).places
    time[:, -1] = edges[1:]
    angle, speed = motion.at(time.ravel())
    acts = np.tile(forces.acting(begin.mode.loads), (time.size, 1))
    hair = _HAIR * (edges[-1] - edges[0])
    inside = np.clip(time.ravel(), edges[0] + hair, edges[-1] - hair)
    theta, omega = motion.at(inside)
    outside = forces.torque(inside, theta, omega, acts).reshape(time.shape)
    acting = Acting(float(np.sign(angle[-1] - angle[0])), phases=begin.mode.loads)
    shares = np.tile(begin.mode.shares, (len(time), 1))
    angle, speed = angle.reshape(time.shape), speed.reshape(time.shape)
    return Cells(time, angle, speed, acting, shares, outside=outside)
