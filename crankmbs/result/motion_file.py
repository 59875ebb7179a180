"""The passes of a motion in a file: plain numbers, a row for every cell and for every node."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.mechanics.torque import Branch, Course, branch_of, course_of
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.mechanics.windows import Phase
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.motion import Motion, Passes
from crankmbs.motion.states import inner_samples
from crankmbs.numerics.arrays import Array, Labelled
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["DIMS", "passes_in", "with_passes"]

_MOST = 4  # passes
_OF_NODES = ("time", "angle", "speed", "energy", "acceleration", "outside")
_OF_CELLS = ("stretch", "nodes", "sense", "holds", "phases", "shares")
_WIDE = {"phases": "load", "shares": "cylinder"}


def _dims(number: int, name: str) -> tuple[str, ...]:
    if name in _OF_NODES:
        return (f"motion_{number}_node",)
    more = (f"motion_{number}_{_WIDE[name]}",) if name in _WIDE else ()
    return (f"motion_{number}_cell", *more)


DIMS = {
    f"motion_{number}_{name}": _dims(number, name)
    for number in range(_MOST)
    for name in (*_OF_NODES, *_OF_CELLS)
}
"""The dimensions of what passes add to a file, by its name there."""


def with_passes(variables: Labelled, passes: Passes) -> Labelled:
    """The variables with the cells of every pass beside them, from the first sample on."""
    data, begin = dict(variables), float(variables["time"][1][0])
    for number, motion in enumerate((passes.answer, *passes.checks)):
        rows = _rows(motion.after(begin))
        for name, row in rows.items():
            data[f"motion_{number}_{name}"] = (_dims(number, name), row, {})
    return data


def _rows(motion: Motion) -> dict[str, Array]:
    """What is written of a motion, by name."""
    functions = any(load.parts.function is not None for load in motion.train.loads)
    columns: dict[str, list[Array]] = {name: [] for name in (*_OF_NODES, *_OF_CELLS)}
    for stretch, cells in enumerate(motion.cells):
        m, n = cells.time.shape
        outside = cells.outside
        if functions and cells.acting.loads is not None:
            outside = _outside(cells, motion.train)
        unknown = np.full(m * n, np.nan)
        for name in _OF_NODES[:-1]:
            row: Array | None = getattr(cells, name)
            columns[name].append(unknown if row is None else row.ravel())
        columns["outside"].append(unknown if outside is None else outside.ravel())
        phases = [float(phase) for phase in cells.acting.phases]
        of_cells = (stretch, n, cells.acting.sense, float(cells.acting.holds))
        for name, value in zip(_OF_CELLS[:-2], of_cells, strict=True):
            columns[name].append(np.full(m, float(value)))
        columns["phases"].append(np.tile(phases, (m, 1)))
        columns["shares"].append(cells.shares)
    return {name: np.concatenate(parts) for name, parts in columns.items()}


def _outside(cells: Cells, train: CrankTrain) -> Array:
    """The torque from outside at ends and nodes [N m]; at an end, where it may jump, as it comes
    there in the cell."""
    values = inner_samples(cells, train).computed["external_torque"].reshape(cells.time.shape)
    ahead = cells.places - cells.inner()
    slopes = ends_and_nodes(cells.time.shape[1] - 2).slopes
    return np.asarray(values + ahead * (values @ slopes.T))


def passes_in(data: xr.Dataset, scene: Scene, share: float) -> tuple[Passes, xr.Dataset]:
    """The passes that `with_passes` has put beside the data of a scene, and these alone.

    Raises
    ------
    ValueError, KeyError : they are no motion of this scene
    """
    train, motions = crank_train(scene), []
    for number in range(_MOST):
        if f"motion_{number}_time" not in data:
            break
        rows = {
            name: np.asarray(data[f"motion_{number}_{name}"].values, dtype=np.float64)
            for name in (*_OF_NODES, *_OF_CELLS)
        }
        machine = train.perturbed if number == 1 else train  # the pass that betters the answer
        motions.append(Motion(machine, list(_stretches(machine, rows))))
    dims = [f"motion_{k}_{kind}" for k in range(_MOST) for kind in ("node", "cell")]
    return Passes(motions[0], tuple(motions[1:]), share), data.drop_dims(dims, errors="ignore")


def _stretches(train: CrankTrain, rows: dict[str, Array]) -> Iterator[Cells]:
    counts = rows["nodes"].astype(np.intp)
    if len(counts) == 0 or counts.min() < 3 or counts.sum() != len(rows["time"]):
        raise ValueError("no cells of a motion")
    firsts = np.cumsum(counts) - counts
    begins = [0, *(1 + np.flatnonzero(np.diff(rows["stretch"]))).tolist(), len(counts)]
    for low, high in pairwise(begins):
        n = int(counts[low])
        points = slice(int(firsts[low]), int(firsts[low]) + n * (high - low))
        nodes = {name: rows[name][points].reshape(high - low, n) for name in _OF_NODES}
        known = {name: None if np.isnan(row).any() else row for name, row in nodes.items()}
        time, angle, speed = (known[name] for name in _OF_NODES[:3])
        if time is None or angle is None or speed is None:
            raise ValueError("a motion without numbers")
        phases = tuple(Phase(int(phase)) for phase in rows["phases"][low].tolist())
        loads = None
        if known["acceleration"] is None:
            loads = _loads(train, phases, float(time[0, n // 2]), float(speed[0, n // 2]))
        acting = Acting(float(rows["sense"][low]), bool(rows["holds"][low]), phases, loads)
        shares = rows["shares"][low:high]
        energy, rate, outside = (known[name] for name in _OF_NODES[3:])
        yield Cells(time, angle, speed, acting, shares, energy, rate, outside)


def _loads(
    train: CrankTrain, phases: tuple[Phase, ...], time: float, speed: float
) -> Branch | Course:
    """What acts around a time [s] and a speed [rad/s]."""
    torques = train.loads
    branch = branch_of(torques, time, speed, rising=True, phases=phases)
    return course_of(torques, branch, time, phases)
