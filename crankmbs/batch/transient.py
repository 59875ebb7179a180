"""Runs of one machine from their starts to their ends, period after period: loops over cases,
compiled by numba (`crankmbs.numerics.kernels`).

In a cell the energy obeys dE/dtheta = T + c0 + c1 omega + c2 omega^2. Without c1 that is an affine
map of the energy where the cell begins, the same in every period, and found once for cases beside
one another and for those after them that have the same inertia and loads; with c1 it is made linear
in E about the last iterate, cell by cell. Time is the integral of sqrt(J / 2 E) over the angle.
"""

from __future__ import annotations

import math

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

__all__ = ["carry", "land"]

Rule = tuple[Array, Array, Array, Array]  # as `crankmbs.batch.machine.Pass` has it
Scratch = tuple[Array, Array]  # push and rate at the nodes, and a linear system of them

_ROUNDS, _SETTLED = 12, 1e-9  # of Newton's method; a change of the energies whose square is nothing
_LEAST = 0.1  # of the energy where a cell begins: no guess is lower
_LANDINGS, _THERE = 12, 1e-13  # of Newton's method towards a time; of a cell


@kernel
def carry(
    about: tuple[float, int, float, bool],
    rule: Rule,
    of_angle: tuple[Array, Array, Array],
    cases: Array,
    found: tuple[Array, Array, Array],
) -> None:
    """Carry every case through whole periods to its end, and fill what its last period is.

    about : sense of rotation; number of the cell at whose beginning they start; by what part of
        itself every period raises the energy besides; whether they end at times
    of_angle : width [rad] of the m cells of a period, and at their s nodes J without the crank's
        and the torque, shape (m, s)
    cases : beside one another as `crankmbs.batch.lanes` lays them, shape (groups, 6, lanes):
        inertia of the crank [kg m2]; c0, c1 and c2 of the loads; the energy at the start [J]; how
        many whole periods to pass, or the time [s] from which on none begins
    found : filled; the energies of the last period [J] at its nodes, shape (groups, m, s, lanes),
        and at the ends of its cells, shape (groups, m, lanes); energy and time [s] where it begins,
        the energy a period before, NaN where none was, and the least at a node on the way, shape
        (groups, 4, lanes), time only where they end at times. No numbers, or an energy below zero,
        where it is used up
    """
    (sense, first, off, in_time), (m, s), lanes = about, of_angle[1].shape, cases.shape[2]
    of_loads, maps = np.empty((m, 3, s, lanes)), np.empty((m, 2, s, lanes))
    cells, guess = np.empty((m, 2, lanes)), np.empty((s, lanes))
    scratch = np.empty((2, s, lanes)), np.empty((s, s, lanes))
    state, left, entered = np.empty((6, lanes)), np.empty(lanes), np.empty((m, lanes))
    at, time, least, of_cells = state[0], state[1], state[2], (of_loads, maps, cells)
    for g in range(len(cases)):
        own, energy, seen, passed = cases[g], found[0][g], found[2][g], 0
        viscous, known = own[2].any(), g > 0
        for l in range(lanes):
            for i in range(4):
                known = known and own[i, l] == cases[g - 1, i, l]
        if not known:
            _prepare(sense, rule, of_angle, (own, guess, scratch), of_cells)
        along = sense, in_time, rule, of_angle[0]
        inside = own, guess, scratch, entered, left
        into = energy, found[1][g]
        state[:], at[:], least[:], seen[:], left[:] = 0.0, own[4], math.inf, math.nan, 1.0
        if first > 0:
            _pass((first, False), along, inside, of_cells, (state, into))
        while left.any() and (viscous or in_time):
            for l in range(lanes):
                if left[l] > 0.0:
                    at[l] += off * at[l]
                    seen[2, l], seen[0, l], seen[1, l] = seen[0, l], at[l], time[l]
            if viscous:
                _pass((0, passed > 0), along, inside, of_cells, (state, into))
            else:
                _advance((0, m), in_time, of_cells, state)
            passed += 1
            for l in range(lanes):
                goes_on = time[l] < own[5, l] if in_time else passed < own[5, l]
                if left[l] > 0.0 and not (goes_on and at[l] > 0.0):
                    left[l], seen[3, l] = 0.0, least[l]
        if left.any():
            _leap(off, own[5], of_cells, state, seen)
        for l in range(lanes):
            at[l], state[3, l], left[l] = seen[0, l], 0.0, 1.0
        _pass((0, passed > 0), along, inside, of_cells, (state, into))
        for l in range(lanes):
            seen[3, l] = min(seen[3, l], least[l]) if at[l] > 0.0 else math.nan


@kernel
def _prepare(
    sense: float,
    rule: Rule,
    of_angle: tuple[Array, Array, Array],
    cases: tuple[Array, Array, Scratch],
    of_cells: tuple[Array, Array, Array],
) -> None:
    """Fill what all periods of some cases share: of every cell J / 2, the torque with c0, and J / 2
    times the square of the node's weight and the width, shape (m, 3, s, lanes); without c1 its
    maps, too. cases : inertia and loads, guess and scratch, as `_linear` takes them."""
    (width, inertia, torque), (of_loads, maps, cells) = of_angle, of_cells
    (own, guess, scratch), lanes, weights = cases, of_loads.shape[3], rule[1]
    for c in range(len(width)):
        for j in range(len(weights)):
            part = width[c] * weights[j]
            for l in range(lanes):
                half = 0.5 * (inertia[c, j] + own[0, l])
                of_loads[c, 0, j, l], of_loads[c, 2, j, l] = half, part * part * half
                of_loads[c, 1, j, l] = torque[c, j] + own[1, l]
        if not own[2].any():
            here = of_loads[c], own, guess
            _linear(sense * width[c], rule, here, scratch, (maps[c], cells[c]))


@kernel
def _pass(
    which: tuple[int, bool],
    along: tuple[float, bool, Rule, Array],
    inside: tuple[Array, Array, Scratch, Array, Array],
    of_cells: tuple[Array, Array, Array],
    found: tuple[Array, tuple[Array, Array]],
) -> None:
    """Pass the cells of a period from one on, and keep the energies at nodes and ends of cells.

    which : number of that cell; whether energies are kept of the period before, near which these
        are; along : sense of rotation, whether time counts, rule and width
    inside : inertia and loads, guess and scratch as `_linear` takes them, the energies with which
        cells were entered last, and which lanes count
    """
    (first, near), (sense, in_time, rule, width) = which, along
    (own, guess, scratch, entered, left), (of_loads, maps, cells) = inside, of_cells
    state, (energy, ends) = found
    at, lanes, viscous = state[0], len(left), own[2].any()
    for c in range(first, len(width)):
        if viscous:
            for j in range(len(guess)):
                for l in range(lanes):
                    here = at[l] + (energy[c, j, l] - entered[c, l] if near else 0.0)
                    guess[j, l] = max(here, _LEAST * at[l])
            begin, given = (sense * width[c], at, left), (of_loads[c], own, guess)
            _solve(begin, rule, given, scratch, (maps[c], cells[c]))
        entered[c] = at
        for j in range(len(guess)):
            for l in range(lanes):
                energy[c, j, l] = maps[c, 0, j, l] * at[l] + maps[c, 1, j, l]
        _advance((c, c + 1), in_time, of_cells, state)
        ends[c] = at


@kernel
def _leap(
    off: float, periods: Array, of_cells: tuple[Array, Array, Array], state: Array, seen: Array
) -> None:
    """Raise energies by whole periods, all but the last one, whose map is affine: the energies
    where periods begin rise or fall throughout, and so does the least of each, which is lowest in
    the first period or the last."""
    at, least, lost, (_, maps, cells) = state[0], state[2], state[3], of_cells
    begun, carried, lanes = at.copy(), lost.copy(), len(at)
    growth, rise, late = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
    for l in range(lanes):
        at[l] += off * at[l]
    _advance((0, len(maps)), False, of_cells, state)
    for c in range(len(cells)):
        for l in range(lanes):
            more = cells[c, 0, l]
            step = cells[c, 1, l] + more * rise[l] - late[l]
            after = rise[l] + step
            late[l], rise[l] = (after - rise[l]) - step, after
            growth[l] += more + growth[l] * more
    at[:], lost[:] = begun, carried
    for l in range(lanes):
        at[l] += off * at[l]
        for _ in range(1, int(periods[l])):
            step = growth[l] * at[l] + rise[l] - lost[l]
            after = at[l] + step
            lost[l] = (after - at[l]) - step
            at[l] = after + off * after
        seen[0, l], seen[3, l] = at[l], least[l]


@kernel
def _advance(
    which: tuple[int, int], in_time: bool, of_cells: tuple[Array, Array, Array], state: Array
) -> None:
    """Pass some cells: raise energy and time, lower the least energy, and carry what both sums
    lose by rounding, which in all periods alike would go unseen.

    of_cells : as `_prepare` fills them; state : energy, time, the least energy, what both sums
    lose, and room, shape (6, lanes)
    """
    (of_loads, maps, cells), (begin, end), s = of_cells, which, of_cells[0].shape[2]
    at, time, least = state[0], state[1], state[2]
    lost, late, spent, lanes = state[3], state[4], state[5], len(state[0])
    for c in range(begin, end):
        gain, shift, share = maps[c, 0], maps[c, 1], of_loads[c, 2]
        for l in range(lanes):  # a range that is known would be unrolled, and not made vectors
            spent[l] = -late[l]
        for j in range(s):
            if in_time:
                for l in range(lanes):
                    e = gain[j, l] * at[l] + shift[j, l]
                    least[l] = e if e < least[l] else least[l]
                    spent[l] += math.sqrt(share[j, l] / e)
            else:
                for l in range(lanes):
                    e = gain[j, l] * at[l] + shift[j, l]
                    least[l] = e if e < least[l] else least[l]
        for l in range(lanes):
            before, step = at[l], cells[c, 0, l] * at[l] + cells[c, 1, l] - lost[l]
            at[l] = before + step
            lost[l] = (at[l] - before) - step
            before = time[l]
            time[l] = before + spent[l]
            late[l] = (time[l] - before) - spent[l]


@kernel
def land(
    sense: float,
    rule: Rule,
    of_angle: tuple[Array, Array, Array],
    cases: Array,
    carried: tuple[Array, Array, Array],
    found: tuple[Index, Array, Array],
) -> None:
    """Find where in its last period every case has its end in time, as the end of a cell: inside
    one its solution is of lower order.

    cases, carried : as `carry` takes and fills them
    found : filled; the cell, shape (k,), where none is asked for (-1); the place in it, 0 to 1, and
        J without the crank's there, shape (k, 2); and what makes of the values at the nodes of the
        cell those at the nodes of its parts before and after, shape (k, 2, s, s)
    """
    (width, inertia, torque), (energies, ends, seen) = of_angle, carried
    (_, weights, nodes, _), (cell, places, parts), s = rule, found, len(rule[2])
    of_loads, guess, begin = np.empty((2, s, 1)), np.empty((s, 1)), np.empty(1)
    scratch, to = (np.empty((2, s, 1)), np.empty((s, s, 1))), np.empty(s)
    maps, cells, one = np.empty((2, s, 1)), np.empty((2, 1)), np.ones(1)
    own, lanes = np.empty((4, 1)), cases.shape[2]
    for k in range(len(cell)):
        g, l, c = k // lanes, k % lanes, 0
        for i in range(4):
            own[i] = cases[g, i, l]
        mass, end, at, t = own[0, 0], cases[g, 5, l], seen[g, 0, l], seen[g, 1, l]
        while True:
            spent = 0.0
            for j in range(s):
                half = 0.5 * (inertia[c, j] + mass)
                spent += weights[j] * math.sqrt(half / energies[g, c, j, l])
            ends_here = not t + width[c] * spent < end if cell[k] < 0 else c == cell[k]
            if ends_here or c + 1 == len(width):
                break
            at, t, c = ends[g, c, l], t + width[c] * spent, c + 1
        cell[k], x, there = c, (end - t) / (width[c] * spent), 0.0
        begin[:] = at
        for _ in range(_LANDINGS):
            for j in range(s):
                _basis(x * nodes[j], rule, to)
                of_loads[0, j], of_loads[1, j], guess[j] = 0.5 * mass, own[1, 0], at
                for i in range(s):
                    of_loads[0, j] += 0.5 * to[i] * inertia[c, i]
                    of_loads[1, j] += to[i] * torque[c, i]
            here = of_loads, own, guess
            _solve((sense * x * width[c], begin, one), rule, here, scratch, (maps, cells))
            _basis(x, rule, to)
            there, spent = 0.0, 0.0
            for j in range(s):
                there += to[j] * inertia[c, j]
                new = maps[0, j, 0] * at + maps[1, j, 0]
                spent += weights[j] * math.sqrt(of_loads[0, j, 0] / new)
            final = at + (cells[0, 0] * at + cells[1, 0])
            slow = math.sqrt(0.5 * (there + mass) / final)
            move = (end - t - x * width[c] * spent) / (width[c] * slow)
            x += move
            if not abs(move) > _THERE:
                break
        places[k, 0], places[k, 1] = x, there
        for j in range(s):
            _basis(x * nodes[j], rule, to)
            parts[k, 0, j] = to
            _basis(x + (1.0 - x) * nodes[j], rule, to)
            parts[k, 1, j] = to


@kernel
def _solve(
    begin: tuple[float, Array, Array],
    rule: Rule,
    here: tuple[Array, Array, Array],
    scratch: Scratch,
    found: tuple[Array, Array],
) -> None:
    """The maps of a cell about its own solution, by Newton's method from the guess, which it
    becomes.

    begin : signed width [rad], the energies where the cell begins, and which lanes count;
    here, scratch, found : as `_linear` takes them
    """
    (h, at, left), (_, own, guess), (maps, _) = begin, here, found
    viscous, lanes, change = own[2].any(), len(at), np.empty(len(at))
    for _ in range(_ROUNDS):
        _linear(h, rule, here, scratch, found)
        if not viscous:
            break
        change[:] = 0.0
        for j in range(len(guess)):
            for l in range(lanes):
                moved = abs(maps[0, j, l] * at[l] + maps[1, j, l] - guess[j, l])
                change[l] = moved if moved > change[l] else change[l]
        goes_on = False
        for l in range(lanes):  # one that is found stays as it is, whatever the others need
            if left[l] > 0.0 and change[l] > _SETTLED * at[l]:
                goes_on = True
                for j in range(len(guess)):
                    guess[j, l] = maps[0, j, l] * at[l] + maps[1, j, l]
        if not goes_on:
            break


@kernel
def _linear(
    h: float,
    rule: Rule,
    here: tuple[Array, Array, Array],
    scratch: Scratch,
    found: tuple[Array, Array],
) -> None:
    """Fill the maps of a cell of signed width h [rad], loads linear in E about a guess: gain and
    shift at its nodes, shape (2, s, lanes), growth and rise at its end, shape (2, lanes).

    here : J / 2 and the torque with c0 at the nodes, shape (2, s, lanes); inertia of the crank, c0,
    c1 and c2, shape (4, lanes); the guess of the energies, shape (s, lanes), not used without c1
    """
    (matrix, weights, _, _), (of_loads, own, guess) = rule, here
    (both, system), (maps, cells) = scratch, found
    push, rate, half, given = both[0], both[1], of_loads[0], of_loads[1]
    gain, shift, more, gained = maps[0], maps[1], cells[0], cells[1]
    s, sense, viscous = len(weights), math.copysign(1.0, h), own[2].any()
    lanes = own.shape[1]
    factor = np.empty(lanes)
    for j in range(s):
        for l in range(lanes):
            push[j, l], rate[j, l] = given[j, l], own[3, l] / half[j, l]
            gain[j, l], shift[j, l] = 1.0, 0.0
        if viscous:
            for l in range(lanes):
                w = sense * math.sqrt(guess[j, l] / half[j, l])
                push[j, l] += 0.5 * own[2, l] * w
                rate[j, l] += 0.5 * own[2, l] / (half[j, l] * w)
    for j in range(s):
        for i in range(s):
            part, one = h * matrix[j, i], 1.0 if i == j else 0.0
            for l in range(lanes):
                shift[j, l] += part * push[i, l]
                system[j, i, l] = one - part * rate[i, l]
    for k in range(s):  # nearly the unit matrix, which needs no pivots
        for j in range(k + 1, s):
            for l in range(lanes):
                factor[l] = system[j, k, l] / system[k, k, l]
                gain[j, l] -= factor[l] * gain[k, l]
                shift[j, l] -= factor[l] * shift[k, l]
            for i in range(k + 1, s):
                for l in range(lanes):
                    system[j, i, l] -= factor[l] * system[k, i, l]
    for k in range(s - 1, -1, -1):
        for i in range(k + 1, s):
            for l in range(lanes):
                gain[k, l] -= system[k, i, l] * gain[i, l]
                shift[k, l] -= system[k, i, l] * shift[i, l]
        for l in range(lanes):
            gain[k, l] /= system[k, k, l]
            shift[k, l] /= system[k, k, l]
    more[:], gained[:] = 0.0, 0.0
    for j in range(s):
        part = h * weights[j]
        for l in range(lanes):
            more[l] += part * rate[j, l] * gain[j, l]
            gained[l] += part * (push[j, l] + rate[j, l] * shift[j, l])


@kernel
def _basis(x: float, rule: Rule, basis: Array) -> None:
    """Fill the Lagrange polynomials of the nodes at a place in a cell, from 0 to 1."""
    _, _, nodes, barycentric = rule
    total = 0.0
    for j in range(len(nodes)):
        apart = x - nodes[j]
        if apart == 0.0:
            basis[:] = 0.0
            basis[j] = 1.0
            return
        basis[j] = barycentric[j] / apart
        total += basis[j]
    for j in range(len(nodes)):
        basis[j] /= total
