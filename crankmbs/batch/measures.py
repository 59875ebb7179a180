"""What motions over a period amount to: numbers of one pass, and their errors from
those of two."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from crankmbs.batch.curves import Motions
from crankmbs.batch.machine import Machine
from crankmbs.batch.motion import Cases, Energies
from crankmbs.batch.peaks import Peaks, find_peaks, sizes_at
from crankmbs.batch.pressures import highest_pressures
from crankmbs.measures.estimate import ROUNDING
from crankmbs.measures.joints import joints_of, kinds_of, shell_area
from crankmbs.measures.summary import Works, powers
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.lagrange import at_nodes
from crankmbs.numerics.magnitudes import impulses
from crankmbs.scene.scene import Scene

__all__ = ["Numbers", "measure"]

Numbers = dict[str, Array]
"""By name, of k cases, shape (k, ...)."""


def measure(machine: Machine, cases: Cases, passes: Sequence[Energies]) -> tuple[Numbers, Numbers]:
    """The numbers of k motions, and by how much they may be off: what those of both passes differ
    by, their rounding, and what polynomials may miss of peaks.

    Returns
    -------
    duration [s] of a period; energy where it begins [J]; growth of a disturbance, less 1; fast and
    slow, highest and lowest speed [rad/s] without sense; lectures, the largest size of every
    quantity of theirs and of what it is more than each of them says, shape (k, curves); closure,
    the largest difference of the energies of both passes over the greatest energy; relative, the
    largest error of the speed and of the peaks of joints, relative; of each joint where its peak
    is [rad]; and what `crankmbs.measures.names.names_of` has but pressures
    """
    one, other = (
        Motions(machine, *each, cases)
        for each in zip((machine.answer, machine.check), passes, strict=True)
    )
    answer, check = _integrals(one), _integrals(other)
    curves = [one.curves, one.of_lectures(answer["mean_speed"])]
    again = [other.curves, other.of_lectures(check["mean_speed"])]
    peaks = [find_peaks(each) for each in curves]
    there = [sizes_at(each, of) for each, of in zip(again, peaks, strict=True)]
    best, mean = _best(machine, peaks[0].size), answer["mean_speed"]
    answer |= _of_peaks(one, [of.size for of in peaks], best, mean)
    check |= _of_peaks(other, there, best, check["mean_speed"])
    missed = _of_peaks(one, [of.size + of.missed for of in peaks], best, mean)
    greatest, fast = one.energies.energy.max(axis=(1, 2)), answer["fast"]
    rounded = {"speed_gain": fast, "fluctuation": fast / mean}
    rounded["kinetic_power"] = greatest / answer["duration"]
    rounded |= dict.fromkeys(("torque_max", "torque_min"), one.levels[0])
    errors = {
        name: np.abs(value - check[name]) + ROUNDING * np.abs(rounded.get(name, value))
        for name, value in answer.items()
    }
    for name, value in missed.items():
        errors[name] += np.abs(value - answer[name])
    apart = np.abs(one.energies.ends - other.energies.ends).max(axis=1)
    answer["closure"] = apart / greatest + ROUNDING
    angles = _angles(one, peaks[0], best)
    shown = ("duration", "fast", "slow", *(name.removesuffix("_angle") for name in angles))
    parts = [np.nan_to_num(errors[name] / np.abs(answer[name])).T for name in shown]
    answer["relative"] = np.vstack(parts).max(axis=0)
    highest = [highest_pressures(scene) for scene in machine.scenes]
    for name in highest[0]:
        both = np.stack([of[name] for of in highest], axis=1)
        answer[name], errors[name] = (each + 0.0 * fast[:, None] for each in both)
    return answer | angles, errors


def _integrals(motions: Motions) -> Numbers:
    """What does not depend on peaks; means of the forces of all joints, shape (k, joints)."""
    machine, tables, energies = motions.machine, motions.tables, motions.energies
    width, turned = motions.places[1][..., None], float(tables.width[0].sum())
    share, joints = width * tables.rule.weights, len(joints_of(machine.scene))
    of_nodes = 1.0 / np.abs(motions.omega), motions.rods, motions.load
    slow, rods, load = (motions.cut(each) for each in of_nodes)
    time = (share * slow).sum(axis=(1, 2))
    mean = machine.sense * turned / time
    forces, sizes = motions.vectors[:, :joints], motions.sizes[:, :joints]
    means = impulses(at_nodes(slow.shape[-1]), forces, sizes, width * slow) / time[:, None]
    if machine.shares > 1:
        for kind in kinds_of(machine.scene):
            means[:, kind.rows] = means[:, kind.rows].mean(axis=1, keepdims=True)
    strokes = np.array([[gear.stroke for gear in one.running_gear] for one in machine.scenes])
    numbers = {
        "duration": machine.shares * time,
        "energy": energies.begin,
        "growth": energies.growth,
        "mean_speed": mean,
        "piston_speed": np.abs(mean)[:, None] * strokes / math.pi,
        "speed_gain": _gained(motions),
        "crank_torque": (share * rods).sum(axis=(1, 2)) / turned,
        "external_torque": (share * load).sum(axis=(1, 2)) / turned,
        "kinetic_power": (energies.ends[:, -1] - energies.begin) / time,
    }
    numbers["brake_power"] = -numbers["external_torque"] * mean
    numbers |= _powers(machine, tables.works, numbers["duration"])
    return numbers | _loads(machine.scene, "mean", means)


def _of_peaks(motions: Motions, largest: Sequence[Array], best: Index, mean: Array) -> Numbers:
    """What depends on the largest sizes of the vectors, of which some joints stand for others, and
    of the lectures; mean : speed [rad/s]."""
    vectors, lectures = largest
    sense, (torque, speed) = motions.machine.sense, motions.levels
    forward, backward = vectors[:, -2] - speed, speed - vectors[:, -1]
    fast, slow = (forward, backward) if sense > 0.0 else (-backward, -forward)
    peaks = np.take_along_axis(vectors, best, axis=1)
    return {
        "fast": fast,
        "slow": slow,
        "highest_speed": forward,
        "lowest_speed": backward,
        "fluctuation": (fast - slow) / np.abs(mean),
        "torque_max": vectors[:, -4] - torque,
        "torque_min": torque - vectors[:, -3],
        "lectures": lectures,
        **_torques_between(motions.cases, backward, forward),
        **_loads(motions.machine.scene, "peak", peaks),
    }


def _torques_between(cases: Cases, low: Array, high: Array) -> Numbers:
    """The largest and the least torque [N m] of loads c0 + c1 omega + c2 omega^2 between two
    speeds [rad/s], each of shape (k,)."""
    vertex = np.nan_to_num(-0.5 * cases.c1 / cases.c2)
    speeds = np.stack([low, high, np.clip(vertex, low, high)])
    torques = cases.c0 + (cases.c1 + cases.c2 * speeds) * speeds
    return {"external_torque_max": torques.max(axis=0), "external_torque_min": torques.min(axis=0)}


def _gained(motions: Motions) -> Array:
    """The speed gained over the period [rad/s]."""
    tables, energies, mass = motions.tables, motions.energies, motions.cases.mass
    inertia = tables.at_begin + mass
    if energies.cuts is not None:
        rows, place = energies.cuts.of(tables.inertia).T, energies.cuts.place
        inertia = at_nodes(len(rows)).part(rows, place, place)[0] + mass
    begin, end = (np.sqrt(2.0 * each / inertia) for each in (energies.begin, energies.ends[:, -1]))
    return np.asarray(motions.machine.sense * (end - begin))


def _powers(machine: Machine, works: Sequence[Works], time: Array) -> Numbers:
    """Of gas and friction on the pistons, over periods of these durations [s]."""
    every = []
    for scene, of_scene, period in zip(
        machine.scenes, works, np.split(time, len(works)), strict=True
    ):
        numbers = {
            name: np.tile(number.value, (len(period), 1))
            if name.startswith("imep")
            else number.value + 0.0 * period
            for name, number in powers(scene, of_scene, 1.0, period).items()
        }
        if scene.friction is not None:
            numbers.setdefault("mechanical_efficiency", np.full_like(period, np.nan))
        every.append(numbers)
    return {name: np.concatenate([numbers[name] for numbers in every]) for name in every[0]}


def _by_kind(scene: Scene, word: str, values: Array) -> Numbers:
    """What joints have, shape (k, joints), by the names of their kinds and of what it is."""
    return {
        f"{kind.key}_{word}": values[:, kind.rows if kind.of else kind.rows.start]
        for kind in kinds_of(scene)
    }


def _loads(scene: Scene, word: str, values: Array) -> Numbers:
    """The same of forces, and over the areas of the shells."""
    loads = _by_kind(scene, word, values)
    for kind in kinds_of(scene):
        area = shell_area(scene, kind.joint)
        if area is not None:
            loads[f"{kind.key}_specific_{word}"] = loads[f"{kind.key}_{word}"] / area
    return loads


def _best(machine: Machine, peaks: Array) -> Index:
    """The joint whose peak each one has in the end, shape (k, joints): its own, or where cylinders
    differ in shares of the period alone the largest of its kind."""
    kinds = kinds_of(machine.scene)
    best = np.tile(np.arange(kinds[-1].rows.stop), (len(peaks), 1))
    for kind in kinds if machine.shares > 1 else ():
        best[:, kind.rows] = kind.rows.start + peaks[:, kind.rows].argmax(axis=1)[:, None]
    return best


def _angles(motions: Motions, peaks: Peaks, best: Index) -> Numbers:
    """Where the peaks of joints are: crank angle, or cycle angle of their cylinder [rad]."""
    machine, (begin, width), of = motions.machine, motions.places, peaks
    scene, case = machine.scene, np.minimum(np.arange(len(best)), len(width) - 1)[:, None]
    turned = begin[case, of.cell] + of.place * width[case, of.cell]
    phases = [
        0.0 if joint.cylinder is None else scene.cylinders[joint.cylinder - 1].phase
        for joint in joints_of(scene)
    ]
    places = machine.begin + machine.sense * turned[:, : len(phases)] + phases
    places = np.mod(np.take_along_axis(places, best, axis=1), scene.period)
    return _by_kind(scene, "peak_angle", places)
