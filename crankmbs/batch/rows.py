"""What settled scenes amount to, by the names under which a sweep keeps it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.group import ROUNDING, Group
from crankmbs.batch.machine import OWN
from crankmbs.batch.solve import solved_together
from crankmbs.compare import LECTURES, QUANTITIES
from crankmbs.measures import Estimate, efficiency
from crankmbs.mechanics.peaks import negligible
from crankmbs.motion.ending import Ending
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Rows", "rows_of"]

_ROUNDING = 8 * float(np.finfo(float).eps)  # of either of two speeds
_JOINTS = ("crank_pin", "piston_pin", "side_force")


class Rows(NamedTuple):
    """Of some of the scenes asked for.

    which : shape (n,), their numbers; columns : name -> shape (n, ...); messages : how each ends
    """

    which: NDArray[np.intp]
    columns: dict[str, Array]
    messages: tuple[str, ...]


def rows_of(scenes: Sequence[Scene | None]) -> list[Rows]:
    """The columns of those scenes that are solved together (`crankmbs.batch.solve`): names, units
    and meaning are those of a sweep, what it has of one scene alone agrees within the errors.

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> (found,) = rows_of([scene])
    >>> found.columns["fluctuation"].round(6).tolist()
    [0.137409]
    """
    return [_rows(group) for group in solved_together(scenes)]


def _rows(group: Group) -> Rows:
    machine, scene = group.machine, group.scene
    time, _, _, fast, slow, rods, outside = group.answer.T[2:9]
    late, _, _, of_fast, of_slow, of_rods, of_outside = group.error.T[2:9]
    sense, period = machine.sense, scene.settled_period
    mean, spread = sense * period / time, (fast - slow) * time / period
    pairs = {
        "mean_speed": (mean, np.abs(mean) * late / time),
        "fluctuation": (spread, (of_fast + of_slow) * time / period + spread * late / time),
        "speed_gain": _gained(group),
        "crank_torque": (rods, of_rods),
        "external_torque": (outside, of_outside),
    }
    works, apart = _works(machine.answer.works, machine.check.works)
    gained = Estimate(float(works.sum()), float(apart.sum()))
    if scene.gas is not None:
        pairs["indicated_power"] = _per_time(gained, time, late)
        each = np.tile(works / machine.displaced, (len(time), 1))
        pairs["imep"] = each, np.tile(apart / machine.displaced, (len(time), 1))
    if scene.friction is not None:
        lost, unsure = _works(machine.answer.rubbed, machine.check.rubbed)
        taken = Estimate(-float(lost.sum()), float(unsure.sum()))
        pairs["friction_power"] = _per_time(taken, time, late)
        left = efficiency(gained, taken) or Estimate(np.nan, np.nan)
        pairs["mechanical_efficiency"] = (
            np.full_like(time, left.value),
            np.full_like(time, left.error),
        )
    columns = {"relative_error": group.relative, "energy_closure": group.closure}
    columns |= _of_joints(group, pairs)
    columns |= {name: value for name, (value, _) in pairs.items()}
    columns |= {f"{name}_error": error for name, (_, error) in pairs.items()}
    columns |= _of_lectures(group)
    return Rows(group.which, columns, _messages(group))


def _gained(group: Group) -> tuple[Array, Array]:
    """The speed gained over the period, and its error."""
    begin, gained, _, most, _, fast = group.answer.T[:6]
    if group.scene.settles:
        return np.zeros_like(gained), group.closure * most / begin * fast
    return gained, group.error[:, 1] + _ROUNDING * fast


def _messages(group: Group) -> tuple[str, ...]:
    """How each ends."""
    if not group.scene.settles:
        return (Ending.COMPLETE.said(0.0)[1],) * len(group.which)
    factors = 1.0 + group.answer[:, 1]
    return tuple(f"settled: a period leaves {factor:.4g} of a disturbance" for factor in factors)


def _works(answer: Array, check: Array) -> tuple[Array, Array]:
    """Works on the pistons [J], and by how much they may be off."""
    return answer, np.abs(answer - check) + ROUNDING * np.abs(answer)


def _per_time(work: Estimate, time: Array, late: Array) -> tuple[Array, Array]:
    """The power of a work done in a period, and by how much it may be off."""
    power = work.value / time
    return power, work.error / time + np.abs(power) * late / time


def _of_joints(group: Group, pairs: dict[str, tuple[Array, Array]]) -> dict[str, Array]:
    """The angles of the peaks; peaks and means go into ``pairs``."""
    machine, scene = group.machine, group.scene
    chosen = tuple(dict.fromkeys(machine.alike))
    table = slice(OWN, OWN + 4 * machine.joints)
    value, error = (
        part[:, table].reshape(len(part), machine.joints, 4) for part in (group.answer, group.error)
    )
    angle = np.mod(group.begin[:, None] + machine.sense * value[:, :, 1], scene.period)
    angles = {"main_bearing_peak_angle": angle[:, 0]}
    for what, column in (("peak", 0), ("mean", 2)):
        pairs[f"main_bearing_{what}"] = value[:, 0, column], error[:, 0, column]
    phases = np.array([scene.cylinders[k].phase for k in chosen])
    every = [chosen.index(k) for k in machine.alike]
    for number, joint in enumerate(_JOINTS):
        own = 1 + number * len(chosen) + np.arange(len(chosen))
        for what, column in (("peak", 0), ("mean", 2)):
            of_value, of_error = value[:, own, column], error[:, own, column]
            pairs[f"{joint}_{what}"] = of_value[:, every], of_error[:, every]
        cycle = np.mod(angle[:, own] + phases, scene.period)
        angles[f"{joint}_peak_angle"] = cycle[:, every]
    return angles


def _of_lectures(group: Group) -> dict[str, Array]:
    """Largest deviations over the peaks; of what is zero but for rounding no number."""
    shape = len(group.answer), len(QUANTITIES), 1 + len(LECTURES), 2
    first = OWN + 4 * group.machine.joints
    value, error = (part[:, first:].reshape(shape)[..., 0] for part in (group.answer, group.error))
    peak, deviation = value[:, :, 0], value[:, :, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = deviation / peak[:, :, None]
        apart = (error[:, :, 1:] + share * error[:, :, :1]) / peak[:, :, None]
    units = {name: about.units for name, about in QUANTITIES.items()}
    for k, sizes in enumerate(np.fmax.reduce(value, axis=2).tolist()):  # no lecture is larger
        nothing = negligible(dict(zip(QUANTITIES, sizes, strict=True)), units)
        share[k, [name in nothing for name in QUANTITIES]] = np.nan
    share[~np.isfinite(apart)] = np.nan
    apart[np.isnan(share)] = np.nan
    return {
        "lecture_deviation": np.swapaxes(share, 1, 2),
        "lecture_deviation_error": np.swapaxes(apart, 1, 2),
    }
