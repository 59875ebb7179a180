"""Settled motions of one machine, in two passes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.group import NUDGE, Cases, Group, clear, group_of, room, together
from crankmbs.batch.lanes import laid, taken
from crankmbs.batch.machine import OWN, Machine
from crankmbs.batch.tables import LINEAR, Pass
from crankmbs.compare import QUANTITIES
from crankmbs.numerics.arrays import Array

__all__ = ["solved"]

_NONE = 1e-11  # 1 - factor: nothing but rounding


def solved(machine: Machine, which: NDArray[np.intp], cases: Cases) -> Group:
    """Both passes over some scenes; relative is no number where there is no periodic motion, or it
    is not sure that the run comes to it.

    Of the columns the first two are the energy [J] where the period begins, and by how much the
    factor by which a disturbance shrinks in it differs from 1.
    """
    (answer, places), (check, _) = room(machine, len(which)), room(machine, len(which))
    passes = (
        (answer, _passed(machine, machine.answer, cases, 0.0, (answer, places))),
        (check, _passed(machine, machine.check, cases, NUDGE, (check, places))),
    )
    begin, growth, least = answer[:, 0], answer[:, 1], answer[:, 4]
    started = 0.5 * (cases.inertias + machine.inertias[0]) * cases.starts**2
    needed = clear(machine, cases.loads[:, :1])
    reached = np.minimum(started - begin, 0.0) + least > needed
    sure = (growth < -_NONE) & (least > needed) & reached
    at = np.full_like(begin, machine.begin)
    return group_of(machine, cases, which, at, sure, passes)


def _passed(
    machine: Machine, tables: Pass, cases: Cases, nudge: float, found: tuple[Array, Array]
) -> Array:
    """Energies of a pass over cases, whose columns are filled, and for the check from places."""
    # numba is loaded only when it is used
    from crankmbs.batch.periodic import find_periodic
    from crankmbs.batch.walk import walk

    width, inertia, _, torque = tables.of_angle
    starts, shared = cases.starts, (width, inertia, torque)
    given = np.column_stack([cases.inertias, cases.loads, starts, np.full_like(starts, nudge)])
    (columns, places), ends = found, np.empty((len(starts), len(width)))
    about = machine.sense, list(QUANTITIES).index(LINEAR), OWN, tables is machine.answer
    for some in together(len(starts), inertia.size):
        own = laid(given[some])
        (groups, _, lanes), count = own.shape, len(given[some])
        energy = np.empty((groups, *inertia.shape, lanes))
        at_ends, begin = np.empty((groups, len(width), lanes)), np.empty((groups, 2, lanes))
        find_periodic(machine.sense, tables.rule, shared, own, (energy, at_ends, begin))
        columns[some, :2], ends[some] = taken(begin, count), taken(at_ends, count)
        walk(about, *tables[:3], (own, energy), (columns[some], places[some]))
    return ends
