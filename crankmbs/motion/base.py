"""What every formulation takes and gives."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from crankmbs.motion.account import Keep
from crankmbs.motion.cells import Cells
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode
from crankmbs.numerics.arrays import Array

__all__ = [
    "NOWHERE",
    "Decay",
    "Samples",
    "Segment",
    "Solution",
    "State",
    "Stretched",
]


@dataclass(frozen=True)
class Samples:
    """The motion at the output samples.

    time, theta, omega, alpha : shape (n,) [s, rad, rad/s, rad/s2]; time strictly increases
    energy_residual : shape (n,) [J], kinetic energy gained minus work done
    computed : variables of the result, by name, that the formulation computed by itself, shape (n,)
        or (n, cylinders); everything else follows from theta, omega, alpha
    """

    time: Array
    theta: Array
    omega: Array
    alpha: Array
    energy_residual: Array
    computed: Mapping[str, Array] = field(default_factory=dict)

    def select(self, which: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Samples:
        """Some of the samples."""
        return Samples._mapped(lambda parts: np.asarray(parts[0][which]), [self])

    @staticmethod
    def joined(blocks: Sequence[Samples]) -> Samples:
        """Blocks of samples, one after the other."""
        return Samples._mapped(np.concatenate, blocks)

    @staticmethod
    def _mapped(function: Callable[[list[Array]], Array], blocks: Sequence[Samples]) -> Samples:
        return Samples(
            time=function([b.time for b in blocks]),
            theta=function([b.theta for b in blocks]),
            omega=function([b.omega for b in blocks]),
            alpha=function([b.alpha for b in blocks]),
            energy_residual=function([b.energy_residual for b in blocks]),
            computed={
                name: function([b.computed[name] for b in blocks]) for name in blocks[0].computed
            },
        )


@dataclass(frozen=True)
class Decay:
    """The factor by which a disturbance of a periodic motion is smaller after each period, and an
    estimate of its error."""

    factor: float
    error: float


@dataclass(frozen=True)
class Solution:
    """What a run returns.

    samples : the answer
    better : a second answer of higher order at the same samples; the difference is the error
    errors : instead of ``better``: an absolute error per variable of the result
    status, message : 0 reached the end; 1 a physical end; -1 a numerical one; and a sentence
    evaluations, steps : what it cost
    reasons : sentences about what the run had to do, beside the choice of the formulation
    decay : of a settled motion; unsettled : why there is none
    keep : makes the account of what happened on the way
    """

    samples: Samples
    status: int
    message: str
    evaluations: int
    steps: int
    better: Samples | None = None
    errors: Mapping[str, float] = field(default_factory=dict)
    reasons: tuple[str, ...] = ()
    decay: Decay | None = None
    unsettled: Ending | None = None
    keep: Keep | None = None


class State(NamedTuple):
    """Time [s], crank angle [rad], speed [rad/s], energy residual so far [J], and what has been
    decided on the way."""

    time: float
    theta: float
    omega: float
    residual: float
    mode: Mode = Mode()


NOWHERE = State(math.nan, math.nan, math.nan, math.nan)


class Stretched(Protocol):
    """A stretch of a motion, in which the sense of rotation does not change."""

    @property
    def begin(self) -> State:
        """The state where it begins."""

    @property
    def decisions(self) -> tuple[State, ...]:
        """The states inside at which something is decided, each with the mode after."""

    @property
    def end(self) -> State:
        """The state where it ends."""


class Segment(Stretched, Protocol):
    """A stretch of a motion that can be read anywhere."""

    @property
    def cells(self) -> Cells:
        """Its cells or steps, from its begin to its end."""
