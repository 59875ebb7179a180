"""Motions of a machine in two passes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.machine import Machine, Pass, ahead_of
from crankmbs.batch.motion import (
    Cases,
    Courses,
    Cuts,
    over_periods,
    part_of,
    settled,
    to_times,
)
from crankmbs.batch.serves import loads_of
from crankmbs.numerics.arrays import Array, Index
from crankmbs.scene.scene import Scene

__all__ = ["Pairs", "Solved", "cases_of", "pairs_of"]

_NONE = 1e-11  # 1 - factor: nothing but rounding
_NUDGE = 4 * float(np.finfo(float).eps)  # what a period rounds, of the greatest energy
_CLEAR = 0.05  # rad: an energy that the largest torque does not take within it is clear of rest


class Solved(NamedTuple):
    """The motions of a pass; cuts : of periods that end in time."""

    tables: Pass
    courses: Courses
    cuts: Cuts | None = None

    def part(self, tables: Pass, which: NDArray[np.bool_]) -> Solved:
        """Some of them, with the tables of these."""
        cuts = None if self.cuts is None else part_of(self.cuts, which)
        return Solved(tables, part_of(self.courses, which), cuts)


class Pairs(NamedTuple):
    """Motions over their last periods, k cases: what they share, their numbers, shape (k,), and
    what they have of their own; answer and check."""

    machine: Machine
    which: Index
    cases: Cases
    passes: tuple[Solved, Solved]


def cases_of(scenes: Sequence[Scene]) -> Cases:
    """What scenes that are solved together have of their own.

    >>> cases_of([load_scene("propeller").with_(run__until="settled")]).c2
    array([-9.5e-05])
    """
    return Cases(*np.array([_case_of(scene) for scene in scenes]).T)


def _case_of(scene: Scene) -> tuple[float, ...]:
    loads = loads_of(scene)
    assert loads is not None
    assert scene.start is not None
    end, in_time = scene.end
    if not scene.settles and not in_time:
        end = round((end - ahead_of(scene)) / scene.period)
    return (scene.crank.moment_of_inertia, *loads, scene.start.speed, end, scene.run.rtol)


def pairs_of(machine: Machine, which: Index, cases: Cases) -> Pairs:
    """The motions of cases; without those that have none, come near rest, or of which it is not
    sure that the run comes to them."""
    energy = 0.5 * (cases.mass + machine.at_start) * cases.speed**2
    with np.errstate(all="ignore"):  # where the energy is used up there are no numbers
        passes = _passes(machine, cases, energy)
    answer, check = (one.courses for one in passes)
    least = np.minimum(answer.least, check.least)
    if machine.scene.settles:
        needed = _CLEAR * (_most(machine) + np.abs(cases.c0))
        slowest = np.minimum(energy - answer.begin, 0.0) + answer.least
        sure = (answer.growth < -_NONE) & (answer.least > needed) & (slowest > needed)
        sure &= check.least > 0.0
    else:
        sure = _keeps_clear(machine, cases, least)
    of = machine.part(sure)
    both = passes[0].part(of.answer, sure), passes[1].part(of.check, sure)
    return Pairs(of, which[sure], part_of(cases, sure), both)


def _passes(machine: Machine, cases: Cases, energy: Array) -> tuple[Solved, Solved]:
    """Answer and check, from energies at the start [J]."""
    one, other, sense = machine.answer, machine.check, machine.sense
    if machine.in_time:
        cuts, answer = to_times(one, cases, sense, energy, 0.0)
        ends, check = to_times(other, cases, sense, energy, _NUDGE, cuts.cell)
        return Solved(one, answer, cuts), Solved(other, check, ends)
    if machine.scene.settles:
        answer, check = settled(one, cases, sense, 0.0), settled(other, cases, sense, _NUDGE)
    else:
        start = machine.first, energy
        answer = over_periods(one, cases, sense, start, 0.0)
        check = over_periods(other, cases, sense, start, _NUDGE)
    return Solved(one, answer), Solved(other, check)


def _keeps_clear(machine: Machine, cases: Cases, least: Array) -> NDArray[np.bool_]:
    """Whether runs with those least energies [J] keep clear of rest."""
    total = cases.mass + machine.answer.inertia.min(axis=(1, 2))
    slow = np.sqrt(2.0 * np.maximum(np.nan_to_num(least), 0.0) / total)
    loads = np.abs(cases.c0) + np.abs(cases.c1) * slow
    return np.asarray(least > _CLEAR * (_most(machine) + loads))


def _most(machine: Machine) -> Array:
    """The largest torque without loads [N m], shape (machines,)."""
    return np.asarray(np.abs(machine.answer.torque).max(axis=(1, 2)))
