"""Largest values and where and when they are: of joint forces, torque, pressure and speed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from crankmbs.measures.estimate import ROUNDING, Estimate
from crankmbs.measures.joints import Joint, joints_of
from crankmbs.measures.nodes import Tops, nodes_of
from crankmbs.motion.cells import Cells
from crankmbs.motion.motion import Motion
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["Peak", "Quantity", "extremes_of", "run_peaks", "torque_of_rods"]

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

    def peak(self, value: Estimate, time: float, angle: float, scene: Scene) -> Peak:
        """Its peak, at a time [s] and crank angle [rad], of its value times the sign."""
        cycle = None if self.phase is None else (angle + self.phase) % scene.period
        signed = Estimate(self.sign * value.value, value.error)
        return Peak(self.name, self.units, self.number, signed, time, angle, cycle)


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


def extremes_of(scene: Scene) -> tuple[Quantity, ...]:
    """What has peaks beside the joints: the torque of the rods, its largest and least value, and
    with gas the pressure in every cylinder, of a double-acting one at either end.

    >>> [one.name for one in extremes_of(load_scene("propeller"))][2]
    'gauge pressure'
    """
    quantities = [
        Quantity(f"{torque_of_rods(scene)}, {word}", "N m", None, None, _torque, sign)
        for word, sign in (("max", 1.0), ("min", -1.0))
    ]
    ends = {} if scene.gas is None else {"gauge pressure": "gas_pressure"}
    if scene.double_acting:
        ends = {
            "gauge pressure, head end": "gas_pressure",
            "gauge pressure, crank end": "crank_end_pressure",
        }
    quantities += [
        Quantity(words, "Pa", k, cylinder.phase, partial(_pressure, name, k))
        for words, name in ends.items()
        for k, cylinder in enumerate(scene.cylinders, start=1)
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
    quantities = (*_speeds(), *_joints(scene), *extremes_of(scene))
    blocks = list(_blocks(passes.answer))
    tops = [_tops(block, quantities) for block in blocks]
    best = np.argmax([top.value for top in tops], axis=0).tolist()
    checks = {
        b: [_tops(_between(check, blocks[b]), quantities) for check in passes.checks]
        for b in set(best)
    }
    peaks = []
    for k, (quantity, b) in enumerate(zip(quantities, best, strict=True)):
        value, error = float(tops[b].value[k]), np.inf
        if checks[b]:
            difference = max(abs(float(check.value[k]) - value) for check in checks[b])
            error = passes.share * difference + ROUNDING * float(tops[b].sizes[k])
        where = float(tops[b].time[k]), float(tops[b].angle[k])
        peaks.append(quantity.peak(Estimate(value, error), *where, scene))
    return tuple(peaks)


def _torque(variables: Mapping[str, Array]) -> Array:
    return np.asarray(variables["crank_torque"].sum(axis=1))


def _pressure(name: str, cylinder: int, variables: Mapping[str, Array]) -> Array:
    return variables[name][:, cylinder - 1]


def _speed(variables: Mapping[str, Array]) -> Array:
    return variables["crank_speed"]


def _force(joint: Joint, variables: Mapping[str, Array]) -> Array:
    return np.asarray(np.hypot(*joint.force(variables)))


def _speeds() -> list[Quantity]:
    words = (("highest", 1.0), ("lowest", -1.0))
    return [Quantity(f"{word} speed", "rad/s", None, None, _speed, sign) for word, sign in words]


def _joints(scene: Scene) -> list[Quantity]:
    phases = [cylinder.phase for cylinder in scene.cylinders]
    return [
        Quantity(
            joint.joint,
            "N",
            joint.number,
            phases[joint.number - 1] if joint.number and joint.of == "cylinder" else None,
            partial(_force, joint),
        )
        for joint in joints_of(scene)
    ]


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


def _tops(motion: Motion, quantities: tuple[Quantity, ...]) -> Tops:
    return nodes_of(motion).tops(
        lambda variables: np.array([each.sign * each.of(variables) for each in quantities])
    )
