"""What motions of one machine over a period amount to: numbers of one pass, and their errors from
those of two."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.batch.machine import Machine, Pass
from crankmbs.batch.means import impulses
from crankmbs.batch.motion import Cases, Courses
from crankmbs.batch.passes import Pairs
from crankmbs.batch.peaks import Curves, Peaks, Which, find_peaks, sizes_at, sparse_nodes
from crankmbs.numerics.arrays import Array

__all__ = ["ROUNDING", "Numbers", "measure"]

ROUNDING = 64 * float(np.finfo(float).eps)
"""Of a value."""

Numbers = dict[str, Array]
"""By name, of k cases, shape (k, ...)."""


class _Motions(NamedTuple):
    """At the nodes: omega^2, alpha, omega and 1 / |omega|, shape (k, m, s); the torque of the
    loads."""

    square: Array
    alpha: Array
    omega: Array
    slow: Array
    load: Array


def measure(machine: Machine, pairs: Pairs) -> tuple[Numbers, Numbers]:
    """The numbers of k motions of a machine, which have the same tables, and by how much they may
    be off: what those of both passes differ by, their rounding, and what polynomials may miss of
    peaks.

    Returns
    -------
    those of `_numbers`; angles, turned from where the tables begin to the peaks of joints [rad];
    energy where the period begins [J]; gained, the speed [rad/s]; growth of a disturbance, less 1;
    closure, the largest difference of the energies of both passes over the greatest energy;
    relative, the largest error of the speed and of the peaks of joints, relative
    """
    passes, peaks = [], None
    for tables, courses in zip(pairs.tables, pairs.courses, strict=True):
        numbers, peaks = _numbers(machine, tables, pairs.cases, courses.energy, peaks)
        passes.append(numbers | _over_period(machine, tables, pairs.cases, courses))
    assert peaks is not None
    answer, check = passes
    errors = {
        name: np.abs(value - check[name]) + ROUNDING * np.abs(value)
        for name, value in answer.items()
    }
    missed = peaks["vectors"].missed
    errors["fast"] += missed[:, -2]
    errors["slow"] += missed[:, -1]
    errors["peaks"] += missed[:, :-2]
    errors["lectures"] += peaks["lectures"].missed
    ends, others = (courses.edges[:, 1:] for courses in pairs.courses)
    answer["closure"] = np.abs(ends - others).max(axis=1) / answer["greatest"] + ROUNDING
    shown = ("duration", "fast", "slow", "peaks")
    with np.errstate(invalid="ignore"):  # a joint without a force
        apart = [np.nan_to_num(errors[name] / np.abs(answer[name])).T for name in shown]
    answer["relative"] = np.vstack(apart).max(axis=0)
    (starts, width), of = pairs.tables[0].places, peaks["vectors"]
    case, cell = np.minimum(np.arange(len(of.cell)), len(width) - 1)[:, None], of.cell[:, :-2]
    answer["angles"] = starts[case, cell] + of.place[:, :-2] * width[case, cell]
    return answer, errors


def _over_period(machine: Machine, tables: Pass, cases: Cases, courses: Courses) -> Numbers:
    """What a period does to the energy, by either pass."""
    begin, end = courses.edges[:, 0], courses.edges[:, -1]
    total = cases.mass + tables.at_begin
    gained = machine.sense * (np.sqrt(2.0 * end / total) - np.sqrt(2.0 * begin / total))
    return {"energy": begin, "gained": gained, "growth": courses.growth}


def _numbers(
    machine: Machine,
    tables: Pass,
    cases: Cases,
    energy: Array,
    known: dict[str, Peaks] | None,
) -> tuple[Numbers, dict[str, Peaks]]:
    """The numbers of a pass over k cases, and where its peaks are.

    energy : shape (k, m, s) [J]; known : the peaks of another pass, which are looked at where they
    are, and not sought

    Returns
    -------
    duration [s] of a period; greatest energy [J]; highest and lowest speed [rad/s], without sense;
    mean torque of all rods and from outside [N m]; of every joint's force the peak and the mean
    over time, shape (k, joints) [N]; the largest size of every quantity of the lectures and of what
    it is more than each of them says, shape (k, curves)
    """
    of = _motions(tables, machine.sense, cases, energy)
    width, turned = tables.width[..., None], float(machine.answer.width.sum())
    share = width * tables.rule.weights
    time = (share * of.slow).sum(axis=(1, 2))
    on_square, on_alpha, on_one = np.moveaxis(tables.rods, -3, 0)
    rods = on_square * of.square + on_alpha * of.alpha + on_one
    fastest = np.abs(of.omega).max(axis=(1, 2))
    vectors = _vectors(tables, of, 2.0 * fastest)
    sizes = np.sqrt(np.einsum("krcms,krcms->krms", vectors, vectors))
    curves = {
        "vectors": _curves(tables, vectors, sizes),
        "lectures": _of_lectures(machine, tables, of, machine.sense * turned / time),
    }
    peaks = known or {name: find_peaks(each) for name, each in curves.items()}
    if known is None:
        largest, lectures = peaks["vectors"].size, peaks["lectures"].size
    else:
        largest, lectures = (sizes_at(each, known[name]) for name, each in curves.items())
    pairs = sizes.shape[1] - len(tables.works) - 2  # all joints but side forces
    return {
        "duration": machine.shares * time,
        "greatest": energy.max(axis=(1, 2)),
        "fast": largest[:, -2],
        "slow": 2.0 * fastest - largest[:, -1],
        "rods": (share * rods).sum(axis=(1, 2)) / turned,
        "outside": (share * of.load).sum(axis=(1, 2)) / turned,
        "peaks": largest[:, :-2],
        "means": impulses(vectors[:, :-2], sizes[:, :-2], width * of.slow, pairs) / time[:, None],
        "lectures": lectures,
    }, peaks


def _of_lectures(machine: Machine, tables: Pass, of: _Motions, mean: Array) -> Curves:
    """Over the whole period; mean : speed, shape (k,)."""
    square, alpha, omega = (
        np.tile(each, (1, machine.shares, 1)) for each in (of.square, of.alpha, of.omega)
    )
    return tables.lectures.curves(square, alpha, omega, mean, tables.cuts)


def _curves(tables: Pass, vectors: Array, sizes: Array) -> Curves:
    """Of vectors at all nodes, shape (k, r, components, m, s), and their sizes."""
    k, r, m, s = sizes.shape
    nodes = np.arange(m * s) if tables.cuts else sparse_nodes(tables.width, s)

    def some_sizes(some: slice) -> Array:
        return np.asarray(sizes[some].reshape(-1, r, m * s)[..., nodes])

    def rows(which: Which) -> Array:
        return np.asarray(vectors[which.case, which.curve, :, which.cell])

    return Curves((k, r), 1, some_sizes, nodes // s, rows)


def _motions(tables: Pass, sense: float, cases: Cases, energy: Array) -> _Motions:
    mass, c0, c1, c2 = (each[:, None, None] for each in cases[:4])
    total = tables.inertia + mass
    square = 2.0 * energy / total
    speed = np.sqrt(square)
    omega = sense * speed
    load = c0 + c1 * omega + c2 * square
    alpha = (tables.torque + load - 0.5 * tables.slope * square) / total
    return _Motions(square, alpha, omega, 1.0 / speed, load)


def _vectors(tables: Pass, of: _Motions, level: Array) -> Array:
    """The forces of the joints at the nodes, the speed, and what it is less than a level of shape
    (k,): shape (k, joints + 2, 2, m, s)."""
    on_square, on_alpha, on_one = np.moveaxis(tables.forces, -3, 0)
    k, m, s = of.square.shape
    vectors = np.zeros((k, on_one.shape[-4] + 2, 2, m, s))
    forces = vectors[:, :-2]
    np.multiply(on_square, of.square[:, None, None], out=forces)
    forces += on_alpha * of.alpha[:, None, None]
    forces += on_one
    vectors[:, -2, 0] = np.abs(of.omega)
    vectors[:, -1, 0] = level[:, None, None] - vectors[:, -2, 0]
    return vectors
