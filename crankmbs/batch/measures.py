"""What motions over a period amount to: numbers of one pass, and their errors from
those of two."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.batch.lectures import CURVES, EACH, LINEAR
from crankmbs.batch.machine import Machine, Pass, at_cell
from crankmbs.batch.motion import Cases, Cuts
from crankmbs.batch.passes import Pairs, Solved
from crankmbs.batch.peaks import Curves, Peaks, Which, find_peaks, sizes_at, sparse_nodes
from crankmbs.measures.estimate import ROUNDING, Number
from crankmbs.measures.summary import Works, powers
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import at_nodes
from crankmbs.numerics.magnitudes import impulses

__all__ = ["Numbers", "by_turns", "measure"]

Numbers = dict[str, Array]
"""By name, of k cases, shape (k, ...)."""


class _Motions(NamedTuple):
    """At the nodes: omega^2, alpha, omega and 1 / |omega|, shape (k, m, s); the torque of the
    loads. With cuts the cells are whole, with one more."""

    square: Array
    alpha: Array
    omega: Array
    slow: Array
    load: Array


def measure(pairs: Pairs) -> tuple[Numbers, Numbers]:
    """The numbers of k motions, and by how much they may be off: what those of both passes differ
    by, their rounding, and what polynomials may miss of peaks.

    Returns
    -------
    those of `_numbers`; angles, turned from where the tables begin to the peaks of joints [rad];
    closure, the largest difference of the energies of both passes over the greatest energy;
    relative, the largest error of the speed and of the peaks of joints, relative
    """
    machine, (one, other) = pairs.machine, pairs.passes
    answer, peaks = _numbers(machine, one, pairs.cases, None)
    check, _ = _numbers(machine, other, pairs.cases, peaks)
    rounded = {"speed_gain": answer["fast"], "fluctuation": answer["fast"] / answer["mean_speed"]}
    rounded["kinetic_power"] = answer["greatest"] / answer["duration"]
    rounded |= dict.fromkeys(("torque_max", "torque_min"), answer.pop("level"))
    errors = {
        name: np.abs(value - check[name]) + ROUNDING * np.abs(rounded.get(name, value))
        for name, value in answer.items()
    }
    missed = peaks["vectors"].missed
    for name, column in zip(
        ("torque_max", "torque_min", "fast", "slow"), missed.T[-4:], strict=True
    ):
        errors[name] += column
    errors["fluctuation"] += missed[:, -2:].sum(axis=1) / np.abs(answer["mean_speed"])
    steepest = np.abs(pairs.cases.c1) + 2.0 * np.abs(pairs.cases.c2) * answer["fast"]
    for name in ("external_torque_max", "external_torque_min"):
        errors[name] += steepest * missed[:, -2:].sum(axis=1)
    errors["peaks"] += missed[:, :-4]
    for numbers, sense in ((answer, machine.sense), (errors, 1.0)):
        extremes = [sense * numbers[name] for name in ("fast", "slow")]
        numbers["highest_speed"], numbers["lowest_speed"] = extremes[:: int(machine.sense)]
    errors["lectures"] += peaks["lectures"].missed
    apart = np.abs(one.courses.ends - other.courses.ends).max(axis=1)
    answer["closure"] = apart / answer["greatest"] + ROUNDING
    shown = ("duration", "fast", "slow", "peaks")
    with np.errstate(invalid="ignore"):  # a joint without a force
        parts = [np.nan_to_num(errors[name] / np.abs(answer[name])).T for name in shown]
    answer["relative"] = np.vstack(parts).max(axis=0)
    of, (begin, width) = peaks["vectors"], _places(one)
    case = np.minimum(np.arange(len(of.cell)), len(width) - 1)[:, None]
    answer["angles"] = (begin[case, of.cell] + of.place * width[case, of.cell])[:, :-4]
    return answer, errors


def _places(solved: Solved) -> tuple[Array, Array]:
    """Angles turned [rad] to where cells begin, and their widths, shape (1 or k, cells)."""
    width, cuts = solved.tables.width, solved.cuts
    begin = np.cumsum(width, axis=1) - width
    if cuts is None:
        return begin, width
    cell, place = cuts
    begin, width = (
        np.append(row + 0.0 * place[:, None], at_cell(row[..., None], cell), axis=1)
        for row in (begin, width)
    )
    before = place * width[:, -1]
    begin[:, -1] += before
    width[:, -1] -= before
    width[np.arange(len(cell)), cell] = before
    return begin, width


def _numbers(
    machine: Machine, solved: Solved, cases: Cases, known: dict[str, Peaks] | None
) -> tuple[Numbers, dict[str, Peaks]]:
    """The numbers of a pass over k cases, and where its peaks are; known : the peaks of another
    pass, which are looked at where they are, and not sought.

    Returns
    -------
    duration [s] of a period; greatest energy, and that where the period begins [J]; growth of a
    disturbance, less 1; highest and lowest speed [rad/s], without sense; of every joint's force the
    peak and the mean over time, shape (k, joints) [N]; the level that the torque's extremes are
    measured from [N m]; the largest size of every quantity of the
    lectures and of what it is more than each of them says, shape (k, curves); and what
    `crankmbs.measures.Measures` has by these names
    """
    (tables, courses, cuts), of = solved, _motions(solved, machine.sense, cases)
    width, turned = _places(solved)[1][..., None], float(machine.answer.width[0].sum())
    share, rods = width * tables.rule.weights, _combined(tables.rods, of, cuts)
    slow, load = of.slow, of.load
    fastest, strongest = (np.abs(each).max(axis=(1, 2)) for each in (of.omega, rods))
    forces = _combined(tables.forces, of, cuts)
    top = 2.0 * strongest
    extremes = _extremes((rods, top, top), (np.abs(of.omega), 0.0, 2.0 * fastest))
    vectors = np.concatenate([forces, extremes], axis=1)
    if cuts is not None:
        slow, load, rods, vectors = (_cut(each, cuts) for each in (slow, load, rods, vectors))
    time = (share * slow).sum(axis=(1, 2))
    mean = machine.sense * turned / time
    sizes = np.sqrt(np.einsum("krcms,krcms->krms", vectors, vectors))
    curves = {
        "vectors": _curves(tables, vectors, sizes, cuts),
        "lectures": _of_lectures(tables, of, mean, cuts),
    }
    peaks = known or {name: find_peaks(each) for name, each in curves.items()}
    if known is None:
        largest, lectures = peaks["vectors"].size, peaks["lectures"].size
    else:
        largest, lectures = (sizes_at(each, known[name]) for name, each in curves.items())
    fast, slowest = largest[:, -2], 2.0 * fastest - largest[:, -1]
    polynomials = at_nodes(sizes.shape[-1])
    means = impulses(polynomials, vectors[:, :-4], sizes[:, :-4], width * slow) / time[:, None]
    strokes = np.array([[gear.stroke for gear in one.running_gear] for one in machine.scenes])
    numbers = {
        "duration": machine.shares * time,
        "greatest": courses.energy.max(axis=(1, 2)),
        "energy": courses.begin,
        "growth": courses.growth,
        "fast": fast,
        "slow": slowest,
        "peaks": largest[:, :-4],
        "means": means,
        "lectures": lectures,
        "level": top,
        "torque_max": largest[:, -4] - top,
        "torque_min": top - largest[:, -3],
        "mean_speed": mean,
        "piston_speed": np.abs(mean)[:, None] * strokes / math.pi,
        "fluctuation": (fast - slowest) / np.abs(mean),
        "speed_gain": _gained(solved, machine.sense, cases.mass),
        "crank_torque": (share * rods).sum(axis=(1, 2)) / turned,
        "external_torque": (share * load).sum(axis=(1, 2)) / turned,
    }
    numbers |= _torques_between(cases, machine.sense, (slowest, fast))
    numbers["kinetic_power"] = (courses.ends[:, -1] - courses.begin) / time
    numbers["brake_power"] = -numbers["external_torque"] * mean
    return numbers | _powers(machine, tables, numbers["duration"]), peaks


def _torques_between(cases: Cases, sense: float, ends: tuple[Array, Array]) -> Numbers:
    """The largest and the least torque [N m] of loads c0 + c1 omega + c2 omega^2 between two
    speeds [rad/s], without sense, each of shape (k,)."""
    c0, c1, c2 = cases.c0, sense * cases.c1, cases.c2
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = np.nan_to_num(-0.5 * c1 / c2)
    speeds = np.stack([*ends, np.clip(vertex, *ends)])
    torques = c0 + (c1 + c2 * speeds) * speeds
    return {"external_torque_max": torques.max(axis=0), "external_torque_min": torques.min(axis=0)}


def _gained(solved: Solved, sense: float, mass: Array) -> Array:
    """The speed gained over the period [rad/s]."""
    (tables, courses, cuts), inertia = solved, solved.tables.at_begin + mass
    if cuts is not None:
        rows, place = at_cell(tables.inertia, cuts.cell).T, cuts.place
        inertia = at_nodes(len(rows)).part(rows, place, place)[0] + mass
    begin, end = (np.sqrt(2.0 * each / inertia) for each in (courses.begin, courses.ends[:, -1]))
    return np.asarray(sense * (end - begin))


def _powers(machine: Machine, tables: Pass, time: Array) -> Numbers:
    """Of gas and friction on the pistons, over periods of these durations [s]."""
    shares, every = machine.shares, []
    for scene, of_scene, period in zip(
        machine.scenes, tables.works, np.split(time, len(tables.works)), strict=True
    ):
        gas, rubbed, *ends = (
            Number(shares * by_turns(works, shares), 0.0 * works) for works in of_scene
        )
        works = Works(gas, rubbed, (ends[0], ends[1]) if ends else None)
        numbers = {
            name: np.tile(number.value, (len(period), 1))
            if name.startswith("imep")
            else number.value + 0.0 * period
            for name, number in powers(scene, works, 1.0, period).items()
        }
        if scene.friction is not None:
            numbers.setdefault("mechanical_efficiency", np.full_like(period, np.nan))
        every.append(numbers)
    return {name: np.concatenate([numbers[name] for numbers in every]) for name in every[0]}


def by_turns(values: Array, shares: int) -> Array:
    """The mean over the whole period of what cylinders have in a share of it, shape (...,
    cylinders): what one has there another has in the next one."""
    return values if shares == 1 else values.mean(axis=-1, keepdims=True) + 0.0 * values


def _motions(solved: Solved, sense: float, cases: Cases) -> _Motions:
    (tables, courses, cuts), (mass, c0, c1, c2) = solved, (x[:, None, None] for x in cases[:4])
    energy, rows = courses.energy, [tables.inertia, tables.slope, tables.torque]
    if cuts is not None:
        rows = [
            np.append(row + 0.0 * mass, at_cell(row, cuts.cell)[:, None], axis=1) for row in rows
        ]
    inertia, slope, torque = rows
    total = inertia + mass
    square = 2.0 * energy / total
    speed = np.sqrt(square)
    omega = sense * speed
    load = c0 + c1 * omega + c2 * square
    alpha = (torque + load - 0.5 * slope * square) / total
    return _Motions(square, alpha, omega, 1.0 / speed, load)


def _combined(table: Array, of: _Motions, cuts: Cuts | None) -> Array:
    """What a table, shape (machines, ..., 3, m, s), makes of omega^2, alpha and 1, shape (k, ...,
    m, s)."""
    lead, (k, _, s), m = table.shape[1:-3], of.square.shape, table.shape[-2]
    square, alpha = (each.reshape(k, *np.ones_like(lead), -1, s) for each in of[:2])
    values = np.empty((k, *lead, square.shape[-2], s))

    def fill(at: slice, parts: Array) -> None:
        some = values[..., at, :]
        np.multiply(parts[0], square[..., at, :], out=some)
        some += parts[1] * alpha[..., at, :]
        some += parts[2]

    fill(slice(m), np.moveaxis(table, -3, 0))
    if cuts is not None:
        fill(slice(m, None), np.moveaxis(at_cell(table, cuts.cell), -2, 0)[..., None, :])
    return values


def _extremes(*quantities: tuple[Array, Array | float, Array]) -> Array:
    """Vectors along a line whose sizes are largest where quantities are largest, then least, shape
    (k, 2 for each, 2, m, s).

    quantities : values, shape (k, m, s), what is added to them, and what they are taken from, shape
        (k,), so that neither is negative
    """
    rows = []
    for values, added, level in quantities:
        rows += [values + np.reshape(added, (-1, 1, 1)), level[:, None, None] - values]
    sizes = np.stack(rows, axis=1)[:, :, None]
    return np.concatenate([sizes, np.zeros_like(sizes)], axis=2)


def _cut(values: Array, cuts: Cuts) -> Array:
    """Values at the nodes of whole cells, shape (k, ..., m + 1, s), in those of which parts count
    at the nodes of these."""
    each, (cell, place), last = np.arange(len(values)), cuts, values.shape[-2] - 1
    polynomials = at_nodes(values.shape[-1])
    for at, low, high in ((cell, 0.0, place), (last, place, 1.0)):
        values[each, ..., at, :] = polynomials.part(values[each, ..., at, :].T, low, high).T
    return values


def _curves(tables: Pass, vectors: Array, sizes: Array, cuts: Cuts | None) -> Curves:
    """Of vectors at all nodes, shape (k, r, components, m, s), and their sizes."""
    k, r, m, s = sizes.shape
    nodes = np.arange(m * s) if cuts else sparse_nodes(tables.width.max(axis=0), s)

    def some_sizes(some: slice) -> Array:
        seen = sizes[some].reshape(-1, r, m * s)[..., nodes]
        return np.ascontiguousarray(np.moveaxis(seen, 2, 0))

    def rows(which: Which) -> Array:
        return vectors[which.case, which.curve, :, which.cell].T.copy()

    return Curves((k, r), 1, some_sizes, nodes // s, rows)


def _of_lectures(tables: Pass, of: _Motions, mean: Array, cuts: Cuts | None) -> Curves:
    """Of the lectures over the whole period: A (u - p) + B alpha + C + D p; mean : speed, shape
    (k,)."""
    (k, m, s), lectures, mean = of.omega.shape, tables.lectures, mean[:, None, None]
    powers = np.empty((k, m, 2, 4, s))  # of what goes with the square of the speed, or with it
    for line, (u, p) in enumerate(((of.square, mean**2), (of.omega, mean))):
        each = np.broadcast_arrays(u - p, of.alpha, np.ones(1), p)
        powers[:, :, line] = np.stack(each, axis=2)
    cells, nodes = np.divmod(lectures.sparse, s)

    def sizes(some: slice) -> Array:
        seen, table = powers[some, cells % m, :, :, nodes], lectures.at_sparse
        if table.shape[1] > 1:
            table = table[:, lectures.of_case[some]]
        shape = len(cells), table.shape[1], -1
        square, linear = (seen[:, :, line].reshape(*shape, 4) for line in range(2))
        values = square @ table
        values[..., LINEAR] = linear @ table[..., LINEAR]
        values = values.reshape(len(cells), -1, CURVES)
        if cuts is not None:  # of other nodes
            values[cells[:, None] == cuts.cell[some]] = 0.0
        return np.asarray(np.abs(values, out=values))

    def rows(which: Which) -> Array:
        case, curve, cell = which
        line = ((curve >= LINEAR.start) & (curve < LINEAR.stop)).astype(np.intp)
        whole = cell if cuts is None else np.where(cell == m - 1, cuts.cell[case], cell)
        table, power = lectures.at(case, whole, curve), powers[case, cell % m, line]
        values = np.einsum("pcs,cps->cs", table, power).T[:, None].copy()
        if cuts is not None:
            low = np.where(cell == m - 1, cuts.place[case], 0.0)
            high = np.where(cell == cuts.cell[case], cuts.place[case], 1.0)
            part = high - low < 1.0
            values[..., part] = at_nodes(s).part(values[..., part], low[part], high[part])
        return np.asarray(values)

    always = None
    if cuts is not None:
        always = np.stack([cuts.cell, np.full_like(cuts.cell, m - 1)], axis=1)
    return Curves((k, CURVES), EACH, sizes, cells, rows, always)
