"""A free motion followed once more, for what happens on its way."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.motion.account import Account
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.cycles import MOST_CYCLES
from crankmbs.motion.observer import Observer, account_of
from crankmbs.numerics.arrays import Array

if TYPE_CHECKING:
    from crankmbs.motion.free.passes import Pass, Trail, Way

__all__ = ["Leg", "recount"]


class Leg(NamedTuple):
    """What a pass was made with: its grid, what it might err locally, the state it began in, and
    the trail that it betters."""

    grid: Grid
    local: float
    state: State
    first: Trail | None = None


class _Travel(Protocol):
    def __call__(self, grid: Grid, way: Way, local: float, *, first: Trail | None) -> Pass: ...


def recount(travel: _Travel, way: Way, legs: tuple[Leg, ...], share: float) -> Account:
    """The account of a motion, from the passes over it: the first is the answer, and a share of
    what the others differ from it by its error."""
    return account_of([_observed(travel, way, leg) for leg in legs], share)


def _observed(travel: _Travel, way: Way, leg: Leg) -> Observer:
    """What is seen of one pass; it is not sampled."""
    scene = leg.grid.train.scene

    def kinetic(samples: Samples) -> Array:
        return np.asarray(0.5 * inertia_alone(scene, samples.theta) * samples.omega**2)

    observer = Observer(leg.grid.train, kinetic, finer=leg.first is not None)
    observer.start(leg.state)
    plan = replace(way.plan, last=(MOST_CYCLES + 1) * scene.period)
    shown = way._replace(begin=partial(_given, leg.state), plan=plan, watch=observer.add)
    found = travel(leg.grid, shown, leg.local, first=leg.first)
    observer.close(found.ending, found.path.state or leg.state)
    return observer


def _given(state: State, _grid: Grid, _local: float) -> State:
    return state
