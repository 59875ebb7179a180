"""Free runs of one machine from their starts to their ends, in two passes; of each its last period
is summed up."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.group import NUDGE, Cases, Group, clear, group_of, room, together
from crankmbs.batch.lanes import laid, taken
from crankmbs.batch.machine import OWN, Machine, ahead_of
from crankmbs.batch.tables import LINEAR, Pass
from crankmbs.compare import QUANTITIES
from crankmbs.numerics.arrays import Array

__all__ = ["solved"]


class _Way(NamedTuple):
    """How runs go over the tables of a pass: of which machine, from the beginning of which cell on;
    J without the crank's where the period ends [kg m2]; by what part of itself a period raises the
    energy; and whether peaks are sought, or looked at where they are."""

    machine: Machine
    tables: Pass
    first: int
    inertia: float
    off: float
    sought: bool


class _Passed(NamedTuple):
    """Columns, where peaks are, energies at the ends of cells [J], and whether a run keeps clear of
    rest."""

    columns: Array
    places: Array
    ends: Array
    sure: NDArray[np.bool_]


class _Landed(NamedTuple):
    """Where runs end at their times: cell, places and parts as `crankmbs.batch.transient.land`
    fills them; the energy a period before the last one begins [J]; whether they keep clear of rest.
    """

    cell: NDArray[np.intp]
    places: Array
    parts: Array
    before: Array
    sure: NDArray[np.bool_]


def solved(machine: Machine, which: NDArray[np.intp], cases: Cases) -> Group:
    """Both passes over some scenes; relative is no number where one comes near rest, or turns
    through less than a period.

    Of the columns the first two are the energy [J] where the last period begins, and the speed
    gained in it [rad/s].
    """
    order = np.lexsort((*cases.loads.T, cases.inertias))  # equal maps one after the other
    given = _given(machine, cases)[order]
    by_time = cases.scenes[0].end[1]
    ways = [
        _Way(machine, tables, machine.first, machine.inertias[1], off, sought)
        for tables, off, sought in ((machine.answer, 0.0, True), (machine.check, NUDGE, False))
    ]
    begin = np.full(len(order), machine.begin)
    if by_time:
        answer, check, turned = _to_times(ways[0], ways[1], given)
        begin += machine.sense * turned
    else:
        answer = _to_angles(ways[0], given, room(machine, len(given))[1])
        check = _to_angles(ways[1], given, answer.places)
    back = np.argsort(order)
    sure = (answer.sure & check.sure)[back]
    passes = tuple((one.columns[back], one.ends[back]) for one in (answer, check))
    return group_of(machine, cases, which, begin[back], sure, (passes[0], passes[1]))


def _given(machine: Machine, cases: Cases) -> Array:
    """As `crankmbs.batch.transient.carry` takes cases, shape (n, 6)."""
    scenes, inertias = cases.scenes, cases.inertias
    energy = 0.5 * (inertias + machine.inertias[0]) * cases.starts**2
    ends = np.array([scene.end[0] for scene in scenes])
    if not scenes[0].end[1]:
        ends = np.round((ends - ahead_of(scenes[0])) / scenes[0].period)
    return np.column_stack([inertias, cases.loads, energy, ends])


def _to_angles(way: _Way, given: Array, places: Array) -> _Passed:
    """A pass over runs that end at an angle, where the tables do."""
    from crankmbs.batch.walk import walk  # numba is loaded only when it is used

    machine, tables, count = way.machine, way.tables, len(given)
    columns, ends = room(machine, count)[0], np.empty((count, len(tables.of_angle[0])))
    sure = np.empty(count, dtype=np.bool_)
    about = machine.sense, list(QUANTITIES).index(LINEAR), OWN, way.sought
    for some in together(count, tables.of_angle[1].size):
        own, (energy, at_ends, seen), sure[some] = _carried(way, given[some], in_time=False)
        ends[some] = taken(at_ends, len(given[some]))
        begun = taken(seen, len(given[some]))[:, 0]
        total = given[some][:, 0] + way.inertia
        with np.errstate(invalid="ignore"):  # where the energy is used up
            faster = np.sqrt(2.0 * ends[some][:, -1] / total) - np.sqrt(2.0 * begun / total)
        columns[some, 0], columns[some, 1] = begun, machine.sense * faster
        walk(about, *tables[:3], (own, energy), (columns[some], places[some]))
    return _Passed(columns, places, ends, sure)


def _to_times(way: _Way, other: _Way, given: Array) -> tuple[_Passed, _Passed, Array]:
    """Both passes over runs that end at a time, each over tables cut where it ends; and the angle
    turned to there from where the tables begin [rad], less whole periods, shape (n,)."""
    landed = _landed(way, given, np.full(len(given), -1))
    checked = _landed(other, given, landed.cell.copy())
    sure = landed.sure & checked.sure
    width = way.tables.of_angle[0]
    turned = (
        np.append(0.0, np.cumsum(width))[landed.cell] + landed.places[:, 0] * width[landed.cell]
    )
    answer = _over_cut(way, landed, given, sure, room(way.machine, len(given))[1])
    return answer, _over_cut(other, checked, given, sure, answer.places), turned


def _over_cut(
    way: _Way, landed: _Landed, given: Array, sure: NDArray[np.bool_], places: Array
) -> _Passed:
    """The last period of each run that is sure, over tables that end where it does."""
    count, m = len(given), len(way.tables.of_angle[0])
    columns, ends = room(way.machine, count)[0], np.empty((count, m + 1))
    columns[:], ends[:], passed = np.nan, np.nan, sure.copy()
    for k in np.flatnonzero(sure).tolist():
        cell, (place, inertia) = int(landed.cell[k]), landed.places[k].tolist()
        cut = way._replace(
            tables=way.tables.cut(cell, place, landed.parts[k]), first=m - cell, inertia=inertia
        )
        rest = np.array([[*given[k, :4], landed.before[k], 1.0]])
        one = slice(k, k + 1)
        columns[one], _, ends[one], passed[one] = _to_angles(cut, rest, places[one])
    return _Passed(columns, places, ends, passed)


def _landed(way: _Way, given: Array, cell: NDArray[np.intp]) -> _Landed:
    """Where the runs of a pass end at their times; cell : asked for, or -1."""
    from crankmbs.batch.transient import land

    (width, inertia, _, torque), s = way.tables.of_angle, way.tables.of_angle[1].shape[1]
    places, parts = np.empty((len(given), 2)), np.empty((len(given), 2, s, s))
    before, sure = np.empty(len(given)), np.empty(len(given), dtype=np.bool_)
    for some in together(len(given), inertia.size):
        own, carried, sure[some] = _carried(way, given[some], in_time=True)
        before[some] = taken(carried[2], len(given[some]))[:, 2]
        found, shared = (cell[some], places[some], parts[some]), (width, inertia, torque)
        land(way.machine.sense, way.tables.rule, shared, own, carried, found)
    return _Landed(cell, places, parts, before, sure & ~np.isnan(before))


def _carried(
    way: _Way, given: Array, *, in_time: bool
) -> tuple[Array, tuple[Array, Array, Array], NDArray[np.bool_]]:
    """The cases beside one another; what `crankmbs.batch.transient.carry` fills, without energies
    where one of a run is not clear of rest; and whether all of a run are."""
    from crankmbs.batch.transient import carry

    (width, inertia, _, torque), own = way.tables.of_angle, laid(given)
    groups, _, lanes = own.shape
    energy = np.empty((groups, *inertia.shape, lanes))
    ends, seen = np.empty((groups, len(width), lanes)), np.empty((groups, 4, lanes))
    about = way.machine.sense, way.first, way.off, in_time
    carry(about, way.tables.rule, (width, inertia, torque), own, (energy, ends, seen))
    least = taken(seen, len(given))[:, 3]
    slow = np.sqrt(2.0 * np.maximum(least, 0.0) / (given[:, 0] + float(np.min(inertia))))
    sure = least > clear(way.machine, given[:, 1:3] * np.stack([np.ones_like(slow), slow], axis=1))
    energy += laid(np.where(sure, 0.0, np.nan)[:, None])[:, :, None, :]
    return own, (energy, ends, seen), sure
