"""Motions of a machine in two passes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.machine import Machine, periods_of
from crankmbs.batch.motion import Cases, Energies, Setup, run, settled
from crankmbs.batch.serves import loads_of
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["cases_of", "passes_of"]

_NONE = 1e-11  # 1 - factor: nothing but rounding
_NUDGE = 4 * float(np.finfo(float).eps)  # what a period rounds, of the greatest energy
_CLEAR = 0.05  # rad: an energy that the largest torque does not take within it is clear of rest


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
    end = scene.end[0] if scene.end[1] else periods_of(scene)
    return (scene.crank.moment_of_inertia, *loads, scene.start.speed, end, scene.run.rtol)


def passes_of(machine: Machine, cases: Cases) -> tuple[Energies, Energies, NDArray[np.bool_]]:
    """The motions of cases, answer and check; and of which it is sure that there is one, that the
    run comes to it, and that it keeps clear of rest."""
    one, other = machine.answer, machine.check
    energy = 0.5 * (cases.mass + one.at_begin) * cases.speed**2
    plain, raised = (Setup(machine.sense, machine.scene.end[1], nudge) for nudge in (0.0, _NUDGE))
    if not machine.scene.settles:
        answer = run(one, cases, plain, energy)
        cell = None if answer.cuts is None else answer.cuts.cell
        check = run(other, cases, raised, energy, cell)
        return answer, check, _keeps_clear(machine, cases, np.minimum(answer.least, check.least))
    answer, check = settled(one, cases, plain), settled(other, cases, raised)
    needed = _CLEAR * (_most(machine) + np.abs(cases.c0))
    slowest = np.minimum(energy - answer.begin, 0.0) + answer.least
    sure = (answer.growth < -_NONE) & (answer.least > needed) & (slowest > needed)
    return answer, check, sure & (check.least > 0.0)


def _keeps_clear(machine: Machine, cases: Cases, least: Array) -> NDArray[np.bool_]:
    """Whether runs with those least energies [J] keep clear of rest."""
    total = cases.mass + machine.answer.inertia.min(axis=(1, 2))
    slow = np.sqrt(2.0 * np.maximum(np.nan_to_num(least), 0.0) / total)
    loads = np.abs(cases.c0) + np.abs(cases.c1) * slow
    return np.asarray(least > _CLEAR * (_most(machine) + loads))


def _most(machine: Machine) -> Array:
    """The largest torque without loads [N m], shape (machines,)."""
    return np.asarray(np.abs(machine.answer.torque).max(axis=(1, 2)))
