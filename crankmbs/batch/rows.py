"""What settled scenes amount to, by the names under which a sweep keeps it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.measures import by_turns
from crankmbs.batch.solve import Group, solved_together
from crankmbs.compare import LECTURES, QUANTITIES
from crankmbs.measures.estimate import ROUNDING
from crankmbs.measures.joints import joints_of, shell_area
from crankmbs.measures.names import names_of
from crankmbs.mechanics.peaks import negligible
from crankmbs.mechanics.pressure import PeriodicPressure, pressures_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.ending import Ending
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Rows", "rows_of"]


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
    >>> (rows,) = rows_of([scene])
    >>> rows.columns["fluctuation"].round(6).tolist()
    [0.137409]
    """
    return [_rows(group) for group in solved_together(scenes)]


def _rows(group: Group) -> Rows:
    of, error = group.numbers, group.errors
    columns = {"relative_error": of["relative"], "energy_closure": of["closure"]}
    pairs = {name: (of[name], error[name]) for name in names_of(group.machine.scene) if name in of}
    pairs |= _of_pressures(group)
    columns |= _of_joints(group, pairs)
    columns |= {name: value for name, (value, _) in pairs.items()}
    columns |= {f"{name}_error": error for name, (_, error) in pairs.items()}
    columns |= _of_lectures(group)
    return Rows(group.which, columns, _messages(group))


def _messages(group: Group) -> tuple[str, ...]:
    """How each ends."""
    if not group.machine.scene.settles:
        return (Ending.COMPLETE.said(0.0)[1],) * len(group.which)
    factors = (1.0 + group.numbers["growth"]) ** group.machine.shares
    return tuple(
        f"settled: a disturbance decays to {100.0 * factor:.4g} % per period" for factor in factors
    )


def _of_joints(group: Group, pairs: dict[str, tuple[Array, Array]]) -> dict[str, Array]:
    """The angles of the peaks; peaks, means and specific loads go into ``pairs``."""
    machine, of, error = group.machine, group.numbers, group.errors
    scene, shares, joints = machine.scene, machine.shares, joints_of(machine.scene)
    turned, angles = machine.begin + machine.sense * of["angles"], {}
    phases = np.array([cylinder.phase for cylinder in scene.cylinders])
    for name, each in {joint.joint: joint.of for joint in joints}.items():
        every = [k for k, joint in enumerate(joints) if joint.joint == name]
        places = turned[:, every] + (phases if each == "cylinder" else 0.0)
        peaks, best = of["peaks"][:, every], np.tile(np.arange(len(every)), (len(turned), 1))
        if shares > 1:
            best[:] = np.argmax(peaks, axis=1)[:, None]
        values = peaks, error["peaks"][:, every], np.mod(places, scene.period)
        peak, apart, place = (np.take_along_axis(one, best, axis=1) for one in values)
        means = (by_turns(one["means"][:, every], shares) for one in (of, error))
        key, area = name.replace(" ", "_"), shell_area(scene, name)
        alone = ... if each else (..., 0)
        angles[f"{key}_peak_angle"] = place[alone]
        for what, pair in (("peak", (peak, apart)), ("mean", means)):
            value, unsure = (one[alone] for one in pair)
            pairs[f"{key}_{what}"] = value, unsure
            if area is not None:
                pairs[f"{key}_specific_{what}"] = value / area, unsure / area
    return angles


def _of_pressures(group: Group) -> dict[str, tuple[Array, Array]]:
    """The largest pressures of every cylinder, which are alike in all motions of a machine."""
    every = [_highest(scene) for scene in group.machine.scenes]
    pairs, cases = {}, np.zeros((len(group.which), 1))
    for name in every[0]:
        peaks = np.array([highest[name] for highest in every])
        pairs[name] = peaks[..., 0] + cases, peaks[..., 1] + cases
    return pairs


def _highest(scene: Scene) -> dict[str, list[tuple[float, float]]]:
    """The peak of each pressure and its error."""
    train = crank_train(scene)
    ends = {"gauge_pressure": train.pressure} if train.pressure else {}
    if train.crank_end is not None:
        ends = {"gauge_pressure_head_end": pressures_of(scene) or ()}
        ends["gauge_pressure_crank_end"] = train.crank_end
    once = {each: _peak_of(each) for each in dict.fromkeys(sum(ends.values(), ()))}
    return {name: [once[each] for each in pressures] for name, pressures in ends.items()}


def _peak_of(pressure: PeriodicPressure) -> tuple[float, float]:
    """The highest pressure and its error."""
    (_, value), (_, perturbed) = pressure.peak, pressure.perturbed.peak
    return value, abs(perturbed - value) + ROUNDING * abs(value)


def _of_lectures(group: Group) -> dict[str, Array]:
    """Largest deviations over the peaks; of what is zero but for rounding no number."""
    shape = len(group.which), len(QUANTITIES), 1 + len(LECTURES)
    value, error = (of["lectures"].reshape(shape) for of in (group.numbers, group.errors))
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
