"""Loops over cells of the crank angle, compiled by numba (`crankmbs.numerics.kernels`).

Kernels of one file call none of another, so that they stand together here, over 300 lines.
"""

from __future__ import annotations

import math

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

_SETTLED, _GOOD = 1e-14, 1e-11  # relative change of the energy in Newton's last step


__all__ = [
    "affine",
    "along",
    "compose",
    "fire",
    "fire_each",
    "fired",
    "lasting",
    "maps",
    "missed",
    "newton",
    "worst",
]

Loads = tuple[Array, Array, Array, Array]  # the tables of a course of `crankmbs.mechanics.torque`
Solved = tuple[Array, Array, Array, Array]  # edges, time, torque and slowness of cells, filled
Fuel = tuple[
    tuple[Array, Array, float],
    tuple[Index, Array, Array, Array],
    tuple[float, ...],
    tuple[Array, Array],
]  # as `fired` says
_MOST_NEWTON = 20  # steps; where they do not suffice the motion goes on over time
# of the energy, by the slopes of a cell's loads: without them a step gains two digits, and if it
# gains less than one, at kinks, with them
_WEAK, _FAST = 0.01, 0.1


@kernel
def affine(
    alike: int,
    cells: tuple[Array, Array, Array],
    loads: tuple[float, float, float],
    rule: tuple[Array, Array],
    ends: tuple[float, float, float],
    solved: Solved,
) -> int:
    """Solve cells by affine maps, dE/du = sense (T + c0) + 2 sense c2 E / J, up to the end in time;
    count them.

    alike : after so many cells they come again, but for the first and the last, which may be parts
    cells : width, and J and T at the nodes; loads : c0, c2 and sense; rule : matrix and weights;
    ends : energy and time at the start, last time
    """
    (width, inertia, rest), (c0, c2, sense), (_, weights) = cells, loads, rule
    (energy, t, t_end), (edges, time, torque, slowness) = ends, solved
    m, stages = len(width), len(weights)
    once = min(m - 1, alike + 1)
    signed, growth, rise = np.empty((3, once + 1))
    push, rate, gain, shift = np.empty((4, once + 1, stages))
    for c in range(once + 1):
        k = c if c < once else m - 1
        signed[c] = sense * width[k]
        for j in range(stages):
            push[c, j] = rest[k, j] + c0
            rate[c, j] = 2.0 * c2 / inertia[k, j]
    maps((signed, push, rate), rule, (gain, shift, growth, rise))
    edges[0], time[0] = energy, t
    lost, late = 0.0, 0.0  # of E and t by rounding: all passes over the cells lose it alike, unseen
    for k in range(m):
        c = once if k == m - 1 else k if k < once else 1 + (k - 1) % alike
        spent = 0.0
        for j in range(stages):
            e = gain[c, j] * energy + shift[c, j]
            torque[k, j] = push[c, j] + rate[c, j] * e
            slowness[k, j] = math.sqrt(0.5 * inertia[k, j] / e) if e > 0.0 else math.nan
            spent += weights[j] * slowness[k, j]
        before, step = energy, growth[c] * energy + rise[c] - lost
        energy = before + step
        lost = (energy - before) - step
        before, step = t, width[k] * spent - late
        t = before + step
        late = (t - before) - step
        edges[k + 1], time[k + 1] = energy, t
        if not t < t_end:
            return k + 1
    return m


@kernel
def maps(loads: tuple[Array, Array, Array], rule: tuple[Array, Array], found: Solved) -> None:
    """Fill gain, shift, growth and rise of `crankmbs.numerics.collocation.Maps`, cell by cell.

    loads : signed width, and push and rate at the nodes, as `Rule.maps` there takes them
    """
    (signed, push, rate), (matrix, weights), (gain, shift, growth, rise) = loads, rule, found
    s = len(weights)
    system, both = np.empty((s, s)), np.empty((s, 2))
    for c in range(len(signed)):
        h, growth[c], rise[c], bound = signed[c], 0.0, 0.0, False
        for j in range(len(weights)):
            bound = bound or rate[c, j] != 0.0
            both[j, 0], both[j, 1] = 1.0, 0.0
            for i in range(len(weights)):
                both[j, 1] += h * matrix[j, i] * push[c, i]
                system[j, i] = (1.0 if i == j else 0.0) - h * matrix[j, i] * rate[c, i]
        if bound:  # else each node has its own equation
            _eliminate(system, both)
        for j in range(len(weights)):
            gain[c, j], shift[c, j] = both[j, 0], both[j, 1]
            growth[c] += h * weights[j] * rate[c, j] * gain[c, j]
            rise[c] += h * weights[j] * (push[c, j] + rate[c, j] * shift[c, j])


@kernel
def compose(
    cells: tuple[Array, Array, Array, Array, Array],
    rule: tuple[Array, Array],
    found: tuple[Array, Array, Array, Array, Array],
) -> None:
    """Fill gain, shift and weight of `crankmbs.motion.crank_angle.periods.Period` at the nodes of
    one period's cells, and at their ends growth of the period so far, and the rise of each.

    cells : signed width, width, and push, rate and inertia at the nodes
    """
    (signed, width, push, rate, inertia), (_, weights) = cells, rule
    gain, shift, weight, grown, rise = found
    growth, risen, before = np.empty(len(signed)), 0.0, 0.0
    maps((signed, push, rate), rule, (gain, shift, growth, rise))
    for c in range(len(signed)):
        for j in range(len(weights)):
            shift[c, j] += gain[c, j] * risen
            gain[c, j] *= 1.0 + before
            weight[c, j] = math.sqrt(0.5 * inertia[c, j]) * width[c] * weights[j]
        risen += growth[c] * risen + rise[c]
        before += growth[c] + before * growth[c]
        grown[c] = before


@kernel
def newton(
    loads: Loads,
    bounds: tuple[float, float, float],
    start: tuple[float, float, float],
    rule: tuple[Array, Array],
    cells: tuple[Array, Array, Array, Array],
    solved: Solved,
) -> int:
    """Solve cells by Newton's method, to the end of the loads' course.

    loads : their tables; bounds : their end in time, lowest and highest speed; start : energy, time
    and sense; rule : matrix and weights; cells : width, and inertia, torque and, if there is any,
    drag at the nodes

    Returns
    -------
    cells solved, the last one across a bound; fewer where Newton's method does not converge
    """
    t_end, low, high = bounds
    begin, t, sense = start
    matrix, weights = rule
    width, inertia, rest, drag = cells
    edges, time, torque, slowness = solved
    energy, room = np.empty(len(weights)), np.empty((len(weights) + 1, len(weights)))
    steps = np.empty(matrix.shape)
    row = np.zeros(2, np.intp)
    edges[0], time[0] = begin, t
    lost, late = 0.0, 0.0  # as in `affine`
    for k in range(len(width)):
        load = torque[k - 1, -1] - rest[k - 1, -1] if k > 0 else 0.0
        for j in range(len(weights)):
            energy[j] = begin
            for i in range(len(weights)):
                steps[j, i] = width[k] * matrix[j, i]
                energy[j] += sense * steps[j, i] * (rest[k, i] + load)
        at, of_angle, out = (
            (begin, t, sense),
            (inertia[k], rest[k], drag[k]),
            (torque[k], slowness[k]),
        )
        if not _solve((energy, room, steps, row), at, loads, of_angle, out):
            return k
        inside, work, spent = True, 0.0, 0.0
        for j in range(len(weights)):
            work += weights[j] * torque[k, j]
            spent += weights[j] * slowness[k, j]
            inside = inside and low <= sense / slowness[k, j] <= high
        before, step = begin, sense * width[k] * work - lost
        begin = before + step
        lost = (begin - before) - step
        before, step = t, width[k] * spent - late
        t = before + step
        late = (t - before) - step
        edges[k + 1], time[k + 1] = begin, t
        if not (inside and t < t_end):
            return k + 1
    return len(width)


@kernel
def _solve(
    scratch: tuple[Array, Array, Array, Index],
    start: tuple[float, float, float],
    loads: Loads,
    of_angle: tuple[Array, Array, Array],
    out: tuple[Array, Array],
) -> bool:
    """Newton's method in one cell, from a guess; whether it converges. Where the loads hardly
    change with the speed it takes them as constant in each step.

    scratch : the guess of the energy, room for a linear system, the rule times the width, and the
    numbers of the last rows of the loads, kept from cell to cell; of_angle : inertia, torque and
    drag at the nodes; out : torque and slowness, filled
    """
    (_, _, speeds, in_speed), (torque, slowness) = loads, out
    (energy, room, steps, row), (inertia, _, drag) = scratch, of_angle
    drags = len(drag) > 0
    begin, _, sense = start
    stages = len(energy)
    new, system = room[0].reshape(stages, 1), room[1:]
    before = change = left = math.inf
    weak, stiffness = False, 0.0
    for n in range(_MOST_NEWTON):
        last, stiffness = stiffness, _load(scratch, start, loads, of_angle, out)
        g = row[1]
        if n > 0:
            left = change * max(stiffness, last, change / before) if weak else change
        if not left >= _SETTLED:
            break
        weak = stiffness < _WEAK if n == 0 else weak and change < _FAST * before
        new[:] = begin
        for j in range(stages):
            push, rate = sense * torque[j], 0.0
            if not weak:
                omega = sense / slowness[j]
                g = _row(speeds, omega, g)
                rate = sense * (in_speed[g, 1] + 2.0 * in_speed[g, 2] * omega)
                if drags:
                    rate -= sense * drag[j]
                rate /= inertia[j] * omega
                push -= rate * energy[j]
            for i in range(stages):
                new[i, 0] += steps[i, j] * push
                if not weak:
                    system[i, j] = (1.0 if i == j else 0.0) - steps[i, j] * rate
        if not weak:
            _eliminate(system, new)
        before, change = change, 0.0
        for j in range(stages):
            change += abs(new[j, 0] / energy[j] - 1.0)
            energy[j] = new[j, 0]
    return left <= _GOOD


@kernel
def _load(
    scratch: tuple[Array, Array, Array, Index],
    start: tuple[float, float, float],
    loads: Loads,
    of_angle: tuple[Array, Array, Array],
    out: tuple[Array, Array],
) -> float:
    """Fill torque and slowness at the nodes of a cell from the energies there; how much of the
    energy changes of them change it, through the loads. As in `_solve`."""
    (energy, _, steps, row), (begun, sense) = scratch, (start[1], start[2])
    (times, in_time, speeds, in_speed), (torque, slowness) = loads, out
    (inertia, rest, drag), stages = of_angle, len(energy)
    stiffness, f, g, drags = 0.0, row[0], row[1], len(drag) > 0
    timed = len(times) > 0 or in_time[0, 1] != 0.0
    for j in range(stages):
        slowness[j] = math.sqrt(0.5 * inertia[j] / energy[j]) if energy[j] > 0.0 else math.nan
    for j in range(stages):
        omega, at = sense / slowness[j], begun
        if timed:
            for i in range(stages):
                at += steps[j, i] * slowness[i]
            f = _row(times, at, f)
            stiffness += abs(steps[stages - 1, j] * in_time[f, 1] * (at - begun) / energy[j])
        g = _row(speeds, omega, g)
        slope = in_speed[g, 1] + 2.0 * in_speed[g, 2] * omega
        if drags:
            slope -= drag[j]
        stiffness += abs(steps[stages - 1, j] * slope / (inertia[j] * omega))
        torque[j] = rest[j] + in_time[f, 0] + in_time[f, 1] * at
        torque[j] += in_speed[g, 0] + (in_speed[g, 1] + in_speed[g, 2] * omega) * omega
        if drags:
            torque[j] -= drag[j] * omega
    row[0], row[1] = f, g
    return stiffness


@kernel
def fired(
    affinely: bool,
    course: tuple[Loads, tuple[float, float, float], tuple[float, float, float]],
    rule: tuple[Array, Array],
    cells: tuple[Array, Array, Array, Array],
    fuel: Fuel,
    solved: Solved,
) -> tuple[int, int]:
    """Solve cells as `affine` or `newton` do, from decision to decision on the fuel; count both.

    course : loads, bounds and start, as `newton` takes them; cells : width, and inertia, torque
    and, if there is any, drag at the nodes; the torque gets what is fired
    fuel : of the gas, as `fire` takes it; of the decisions, the cell before which each falls, one
    more than those, crank angle and inertia there, and what is left of the cylinders' shares, NaN
    where they do not decide; the law, as `crankmbs.mechanics.firing.FuelLaw.numbers` gives it; and
    of what is decided, time, angle, integral, speed where the fuel set in or NaN, and 1 where it is
    over, and the shares, each of the last decision and, filled, of the next ones
    """
    (width, inertia, rest, drag), (edges, time, torque, slowness) = cells, solved
    (loads, bounds, start), (of_gas, decisions, law, (kept, shares)) = course, fuel
    combustion, rubbed, against = of_gas
    at, theta, there, parts = decisions
    t_end, sense, n, k = bounds[0], start[2], 0, 0
    edges[0], time[0] = start[0], start[1]
    while k < len(width):
        if at[n] <= k:
            omega = sense * math.sqrt(2.0 * edges[k] / there[n])
            share = _decide(law, (time[k], theta[n], omega), kept[n], kept[n + 1])
            for i in range(shares.shape[1]):
                decides = parts[n, i] == parts[n, i]
                shares[n + 1, i] = share * parts[n, i] if decides else shares[n, i]
            n += 1
            continue
        m = min(at[n], len(width))
        push, h, inside, stretch = rest[k:m], width[k:m], inertia[k:m], edges[k : m + 1]
        fire(push, combustion[k:m], rubbed[k:m], against, shares[n])
        out = stretch, time[k : m + 1], torque[k:m], slowness[k:m]
        if affinely:
            begin = (edges[k], time[k], t_end)
            of_loads = (loads[1][0, 0], loads[3][0, 2], sense)
            found = affine(m - k, (h, inside, push), of_loads, rule, begin, out)
        else:
            now = (edges[k], time[k], sense)
            found = newton(loads, bounds, now, rule, (h, inside, push, drag[k:m]), out)
        k += found
        if k < m or not edges[k] > 0.0 or time[k] >= t_end:
            break
    return k, n


@kernel
def fire(torque: Array, combustion: Array, rubbed: Array, against: float, shares: Array) -> None:
    """Add to the torque at the nodes that of the combustion of each cylinder with these shares,
    and of the rings that the gas presses, where it does.

    combustion, rubbed, against : of `crankmbs.motion.crank_angle.grid.Strip`
    """
    for k in range(len(torque)):
        for j in range(torque.shape[1]):
            more = 0.0
            for i in range(len(shares)):
                more += combustion[k, j, i] * shares[i]
            for i in range(rubbed.shape[2]):
                more -= against * abs(rubbed[k, j, i] + combustion[k, j, i] * shares[i])
            torque[k, j] += more


@kernel
def fire_each(
    torque: Array, of_gas: tuple[Array, Array, float], modes: tuple[Index, Array]
) -> None:
    """The same where other shares hold from some cells on: the cells' numbers, and the shares."""
    (combustion, rubbed, against), (begins, shares) = of_gas, modes
    for n in range(len(begins)):
        low, high = begins[n], begins[n + 1] if n + 1 < len(begins) else len(torque)
        fire(torque[low:high], combustion[low:high], rubbed[low:high], against, shares[n])


@kernel
def along(
    sense: float,
    inside: Array,
    cells: tuple[Array, Array],
    solved: Solved,
    found: tuple[Array, Array],
) -> None:
    """Fill time and slowness at places in solved cells.

    inside : shape (s, n), integrals up to the places of the nodes' polynomials; cells : width, and
    inertia at the places
    """
    (width, inertia), (edges, time, torque, slowness), (t, slow) = cells, solved, found
    gained, spent = np.empty((2, inside.shape[1]))
    for k in range(len(width)):
        gained[:] = 0.0
        spent[:] = 0.0
        for j in range(len(inside)):
            for i in range(inside.shape[1]):
                gained[i] += torque[k, j] * inside[j, i]
                spent[i] += slowness[k, j] * inside[j, i]
        for i in range(inside.shape[1]):
            energy = edges[k] + sense * width[k] * gained[i]
            t[k, i] = time[k] + width[k] * spent[i]
            slow[k, i] = math.sqrt(0.5 * inertia[k, i] / max(energy, 0.0))


@kernel
def missed(
    loads: Loads,
    sense: float,
    rules: tuple[Array, Array],
    cells: tuple[Array, Array, Array, Array, Array],
    finer: tuple[Array, Array, Array, Array],
    found: tuple[Array, Array, Array],
) -> None:
    """Fill what solved cells miss of the energy they gain, and the worst of energy and time,
    relative, at their ends and inside: at the nodes of a finer rule, by the loads there.

    rules : integrals up to the finer nodes and the end of the nodes' polynomials, of the rule and
    the finer one; cells : width, and as `Solved`; finer : torque over the angle, drag, if there is
    any, time and slowness at the finer nodes
    """
    (width, edges, time, torque, slowness), (rest, drag, t, slow) = cells, finer
    (own, to_nodes), (energy, at_end, inside) = rules, found
    stages, f, g, drags = len(to_nodes), 0, 0, drag.shape[1] > 0
    gained, less, late, early = np.empty((4, stages + 1))
    for k in range(len(width)):
        slowest = math.inf
        gained[:], less[:], late[:], early[:] = 0.0, 0.0, 0.0, 0.0
        for j in range(len(own)):
            slowest = min(slowest, 1.0 / slowness[k, j])
            for i in range(stages + 1):
                less[i] += torque[k, j] * own[j, i]
                early[i] += slowness[k, j] * own[j, i]
        for j in range(stages):
            omega = sense / slow[k, j]
            load, f, g = _loaded(loads, t[k, j], omega, (f, g))
            push = rest[k, j] + load - (drag[k, j] * omega if drags else 0.0)
            for i in range(stages + 1):
                gained[i] += push * to_nodes[j, i]
                late[i] += slow[k, j] * to_nodes[j, i]
        inside[k] = both = 0.0
        per_time = max(slowest, 1.0 / time[k + 1])
        for i in range(stages + 1):
            energy[k] = sense * width[k] * (gained[i] - less[i])
            both = abs(energy[k]) / edges[k + 1] + abs(width[k] * (late[i] - early[i])) * per_time
            inside[k] = inside[k] if both <= inside[k] or inside[k] != inside[k] else both
        at_end[k] = both


@kernel
def lasting(
    slow: float,
    sense: float,
    course: tuple[Loads, Array],
    grid: tuple[Array, Array],
    cells: tuple[Index, Array],
    solved: Solved,
) -> int:
    """How many solved cells come before one whose energy would be gone within an angle ``slow``
    [rad], or that has none.

    course : tables of the loads, and beside them the torque at each cell's end of those that are
    functions, of none where none are; grid : of each of its cells largest torque over the angle and
    least J; cells : number in the grid, and drag, if there is any, at the nodes
    """
    (loads, more), (scale, least), (cell, drag) = course, grid, cells
    (energy, time, _, slowness), f, g = solved, 0, 0
    drags, end = drag.shape[1] > 0, slowness.shape[1] - 1
    for k in range(len(slowness)):
        omega = sense / slowness[k, end]
        torque, f, g = _loaded(loads, time[k + 1], omega, (f, g))
        if drags:
            torque -= drag[k, end] * omega
        if len(more) > 0:
            torque += more[k]
        enough = slow * (scale[cell[k]] + abs(torque))
        if not (energy[k] > enough and energy[k + 1] > enough):
            return k
        for j in range(end + 1):
            if not 0.5 * least[cell[k]] > enough * slowness[k, j] ** 2:  # nor where it is NaN
                return k
    return len(slowness)


@kernel
def worst(cell: Index, at_end: Array, inside: Array, most: Array) -> None:
    """Raise the largest errors so far of each cell of a grid, shape (2, n), to those of cells that
    have been passed; NaN where one is."""
    for k in range(len(cell)):
        a, b = most[0, cell[k]], most[1, cell[k]]
        most[0, cell[k]] = a if at_end[k] <= a or a != a else at_end[k]
        most[1, cell[k]] = b if inside[k] <= b or b != b else inside[k]


@kernel
def _loaded(
    loads: Loads, time: float, omega: float, near: tuple[int, int]
) -> tuple[float, int, int]:
    """The loads' torque at a time and a speed, and the rows in use there, sought from near ones."""
    (times, in_time, speeds, in_speed), (f, g) = loads, near
    f, g = _row(times, time, f), _row(speeds, omega, g)
    load = in_time[f, 0] + in_time[f, 1] * time
    return load + in_speed[g, 0] + (in_speed[g, 2] * omega + in_speed[g, 1]) * omega, f, g


@kernel
def _decide(
    law: tuple[float, ...], now: tuple[float, float, float], before: Array, after: Array
) -> float:
    """The share decided at a time, crank angle and speed, as by `crankmbs.mechanics.firing`."""
    speed, kp, ki, least, most, since, until, from_speed, until_speed, at_start = law
    (time, theta, omega), (last, turned, integral, set_in, over) = now, before
    spent = time - last
    error = speed - ((theta - turned) / spent if spent > 0.0 else omega)
    more = integral + ki * error * spent
    wanted = kp * error + more
    share = min(max(wanted, least), most)
    if (wanted > most and error > 0.0) or (wanted < least and error < 0.0):
        more = integral
    if time >= until or (set_in - until_speed) * (omega - until_speed) <= 0.0:
        over = 1.0
    met = from_speed != from_speed or (at_start - from_speed) * (omega - from_speed) <= 0.0
    if set_in != set_in and met and time >= since:
        set_in = omega
    after[0], after[1], after[2], after[3], after[4] = time, theta, more, set_in, over
    return share if set_in == set_in and over == 0.0 else 0.0


@kernel
def _row(rows: Array, value: float, near: int) -> int:
    """How many of the increasing rows are not above a value, counted from a number near it."""
    while near < len(rows) and rows[near] <= value:
        near += 1
    while near > 0 and rows[near - 1] > value:
        near -= 1
    return near


@kernel
def _eliminate(system: Array, right: Array) -> None:
    """Solve a small linear system in place, with pivoting; the answers are the columns of
    ``right``."""
    n = len(right)
    for j in range(n):
        p = j
        for i in range(j + 1, n):
            p = i if abs(system[i, j]) > abs(system[p, j]) else p
        for k in range(right.shape[1]):
            right[j, k], right[p, k] = right[p, k], right[j, k]
        for i in range(j, n):
            system[j, i], system[p, i] = system[p, i], system[j, i]
        for i in range(j + 1, n):
            factor = system[i, j] / system[j, j]
            for k in range(j + 1, n):
                system[i, k] -= factor * system[j, k]
            for k in range(right.shape[1]):
                right[i, k] -= factor * right[j, k]
    for j in range(n - 1, -1, -1):
        for m in range(right.shape[1]):
            for k in range(j + 1, n):
                right[j, m] -= system[j, k] * right[k, m]
            right[j, m] /= system[j, j]
