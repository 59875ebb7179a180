"""Largest values and where and when they are: of joint forces, torque, pressure and speed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from crankmbs.measures.estimate import Estimate, Number, Numbers, estimates
from crankmbs.measures.joints import Joint, joints_of
from crankmbs.measures.nodes import nodes_of
from crankmbs.motion.cells import Cells
from crankmbs.motion.motion import Motion, Passes
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = [
    "SPEEDS",
    "Peak",
    "Quantity",
    "peak_numbers",
    "peaks_from",
    "quantities_of",
    "run_peaks",
    "torque_of_rods",
]

_BLOCK = 512  # cells whose variables are in memory together: some ten cycles


class Quantity(NamedTuple):
    """What may have a peak.

    number : of a cylinder, journal or pin; None of what there is once
    phase : of its cylinder [rad], None where it is none's
    sign : 1, or -1 where its least value is sought
    of : from the variables by name to its values at points, shape (p,)
    """

    name: str
    units: str
    number: int | None
    phase: float | None
    of: Callable[[Mapping[str, Array]], Array]
    sign: float = 1.0


SPEEDS = tuple(
    Quantity(f"{word} speed", "rad/s", None, None, lambda variables: variables["crank_speed"], sign)
    for word, sign in (("highest", 1.0), ("lowest", -1.0))
)
"""The highest speed, and the lowest."""


@dataclass(frozen=True)
class Peak:
    """A largest or least value, in SI units.

    number : of a cylinder, journal or pin; None of what there is once
    time [s], crank_angle [rad], unwrapped, and cycle_angle [rad] of its cylinder say where it is
    """

    name: str
    units: str
    number: int | None
    value: Estimate
    time: float
    crank_angle: float
    cycle_angle: float | None


def quantities_of(scene: Scene) -> tuple[Quantity, ...]:
    """What has peaks in a scene beside the `SPEEDS`: the force of every joint, as
    `crankmbs.measures.joints.joints_of` lists them, the torque of the rods, its largest and least
    value, those of loads and drive where they are not constant; under forces from outside the
    largest on each piston; and with gas the pressure in every cylinder, of a double-acting one at
    either end.

    >>> [quantity.name for quantity in quantities_of(load_scene("propeller"))][8]
    'gauge pressure'
    """
    phases: dict[int | None, float] = {
        number: cylinder.phase for number, cylinder in enumerate(scene.cylinders, start=1)
    }
    quantities = [_of_joint(joint, phases) for joint in joints_of(scene)]
    torques = {torque_of_rods(scene): _torque}
    if not all(load.is_constant for load in scene.torque):
        torques["torque of loads and drive"] = _external_torque
    quantities += [
        Quantity(f"{name}, {word}", "N m", None, None, torque, sign)
        for name, torque in torques.items()
        for word, sign in (("max", 1.0), ("min", -1.0))
    ]
    if scene.force:
        quantities += [
            _of_joint(Joint("applied force", ("applied_force",), "cylinder", number), phases)
            for number in phases
        ]
    ends = {} if scene.gas is None else {"gauge pressure": "gas_pressure"}
    if scene.double_acting:
        ends = {
            "gauge pressure, head end": "gas_pressure",
            "gauge pressure, crank end": "crank_end_pressure",
        }
    quantities += [
        Quantity(words, "Pa", number, phases[number], partial(_pressure, name, number))
        for words, name in ends.items()
        for number in range(1, len(scene.cylinders) + 1)
    ]
    return tuple(quantities)


def torque_of_rods(scene: Scene) -> str:
    """What the torque of the rods on the crank is called.

    >>> torque_of_rods(load_scene("propeller")), torque_of_rods(load_scene("coasting"))
    ('gas and inertia torque', 'torque of the rods')
    """
    return "torque of the rods" if scene.gas is None else "gas and inertia torque"


def run_peaks(result: Result) -> tuple[Peak, ...]:
    """The largest values over all that is kept of a run: highest and lowest speed, joint forces,
    torque and pressures.

    Cells are looked at in blocks, so that memory does not grow with the run. The error of each is
    what the motions that check it have as largest value in the time of its block differs by, and
    the rounding; infinite where nothing checks it.

    >>> run_peaks(simulate(load_scene("torque_driven")))[0].name
    'highest speed'
    """
    scene, passes = result.scene, result.passes
    quantities = (*SPEEDS, *quantities_of(scene))
    read, blocks = partial(peak_numbers, quantities), list(_blocks(passes.answer))
    best = np.argmax([read(block)["peaks"].value for block in blocks], axis=0).tolist()
    peaks = {}
    for b in set(best):
        checks = tuple(_between(check, blocks[b]) for check in passes.checks)
        numbers = estimates(Passes(blocks[b], checks, passes.share), read)
        peaks[b] = peaks_from(numbers, quantities, scene)
    return tuple(peaks[b][k] for k, b in enumerate(best))


def peak_numbers(quantities: Sequence[Quantity], motion: Motion) -> Numbers:
    """Peaks over a motion of quantities times their signs, and the times [s] and crank angles [rad]
    at which they are.

    >>> motion = simulate(load_scene("torque_driven")).passes.answer
    >>> sorted(peak_numbers(SPEEDS, motion))
    ['angles', 'peaks', 'times']
    """
    tops = nodes_of(motion).tops(
        lambda variables: np.array([each.sign * each.of(variables) for each in quantities])
    )
    sizes = tops.sizes
    forces = np.array([each.units == "N" for each in quantities])
    speeds = np.array([each.units == "rad/s" for each in quantities])
    sizes[speeds] = sizes[speeds].max(initial=0.0)
    sums = forces & np.array([each.phase is None for each in quantities])
    sizes[sums] = sizes[forces].max(initial=0.0)  # of the pins' forces
    return {
        "peaks": Number(tops.value, sizes),
        "times": Number(tops.time, sizes),
        "angles": Number(tops.angle, np.abs(tops.angle)),
    }


def peaks_from(
    numbers: Mapping[str, Sequence[Estimate]], quantities: Sequence[Quantity], scene: Scene
) -> tuple[Peak, ...]:
    """The peaks of quantities by the estimates of their `peak_numbers`.

    >>> numbers = {name: (Estimate(1.0, 0.0),) for name in ("peaks", "times", "angles")}
    >>> peaks_from(numbers, SPEEDS[:1], load_scene("torque_driven"))[0].time
    1.0
    """
    peaks = []
    rows = zip(quantities, *(numbers[name] for name in ("peaks", "times", "angles")), strict=True)
    for quantity, (value, error), (time, _), (angle, _) in rows:
        cycle = None if quantity.phase is None else (angle + quantity.phase) % scene.period
        signed, number = Estimate(quantity.sign * value, error), quantity.number
        peaks.append(Peak(quantity.name, quantity.units, number, signed, time, angle, cycle))
    return tuple(peaks)


def _of_joint(joint: Joint, phases: Mapping[int | None, float]) -> Quantity:
    phase = phases.get(joint.cylinder)
    return Quantity(joint.joint, "N", joint.number, phase, partial(_force, joint))


def _torque(variables: Mapping[str, Array]) -> Array:
    return np.asarray(variables["crank_torque"].sum(axis=1))


def _external_torque(variables: Mapping[str, Array]) -> Array:
    return variables["external_torque"]


def _pressure(name: str, cylinder: int, variables: Mapping[str, Array]) -> Array:
    return variables[name][:, cylinder - 1]


def _force(joint: Joint, variables: Mapping[str, Array]) -> Array:
    return np.asarray(np.hypot(*joint.force(variables)))


def _blocks(motion: Motion) -> Iterator[Motion]:
    for cells in motion.cells:
        for k in range(0, len(cells.time), _BLOCK):
            yield Motion(motion.train, [cells.since(k).first(_BLOCK)])


def _between(motion: Motion, block: Motion) -> Motion:
    """The cells of a motion that share some time with a block of another; its last one where none
    does."""
    parts = [part for cells in motion.cells if (part := _shared(cells, block)) is not None]
    last = motion.cells[-1]
    return Motion(motion.train, parts or [last.since(len(last.time) - 1)])


def _shared(cells: Cells, block: Motion) -> Cells | None:
    inside = (cells.time[:, -1] >= block.begin) & (cells.time[:, 0] <= block.end)
    k = np.flatnonzero(inside)
    return cells.since(int(k[0])).first(len(k)) if len(k) else None
