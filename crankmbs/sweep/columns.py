"""The columns of a sweep, each with its error: measures, the errors of the lectures' formulas, and
where they are wanted the samples."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from crankmbs.compare import LECTURES, QUANTITIES, largest_deviations
from crankmbs.errors import InputError
from crankmbs.measures import Measures, measure
from crankmbs.measures.joints import kinds_of
from crankmbs.measures.names import angles_of, names_of, values_of
from crankmbs.mechanics.variables import variables_of
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["Column", "Row", "columns_of", "row_of", "samples_of"]

Row = dict[str, Array]
_ERROR = "_error"


class Column(NamedTuple):
    """units, long_name; dims : beyond the case, with their labels."""

    units: str
    long_name: str
    dims: Mapping[str, Sequence[object]] = MappingProxyType({})

    @property
    def shape(self) -> tuple[int, ...]:
        """Of what one case has."""
        return tuple(len(labels) for labels in self.dims.values())


def columns_of(scene: Scene, *, series: bool = False) -> dict[str, Column]:
    """The columns of a sweep of a scene by name; the error of ``name`` is ``name_error``.

    Raises
    ------
    InputError : with series, a number of samples that shows only on the way

    >>> "fluctuation_error" in columns_of(load_scene("propeller"))
    True
    """
    labels = _labels(scene)

    def over(*dims: str) -> dict[str, Sequence[object]]:
        return {dim: labels[dim] for dim in dims if dim}

    columns = {
        name: Column(about.units, about.words, over(about.of))
        for name, about in names_of(scene).items()
    }
    if scene.fuel is None:  # the lectures know one pressure for all firings
        words = "largest deviation of the lecture, over the peak"
        columns["lecture_deviation"] = Column("1", words, over("lecture", "quantity"))
    errors = {name: column.dims for name, column in columns.items()}
    if series:
        labels["sample"] = range(samples_of(scene))
        columns |= {
            f"series_{name}": Column(about.units, about.long_name, over("sample", about.of))
            for name, about in variables_of(scene).items()
        }
    columns |= {
        f"{name}{_ERROR}": Column(
            column.units, f"error of {column.long_name}", errors.get(name, {})
        )
        for name, column in columns.items()
    }
    for kind in kinds_of(scene):
        angle = "cycle angle" if kind.of == "cylinder" else "crank angle"
        words = f"{angle} of the largest {kind.joint}"
        columns[f"{kind.key}_peak_angle"] = Column("rad", words, over(kind.of))
    columns["energy_closure"] = Column("1", "largest energy residual over peak kinetic energy")
    columns["relative_error"] = Column("1", "relative global error, estimated")
    return columns


def _labels(scene: Scene) -> dict[str, Sequence[object]]:
    """The labels of the dimensions beyond the case."""
    labels: dict[str, Sequence[object]] = {"cylinder": range(1, len(scene.cylinders) + 1)}
    if scene.throws is not None:
        labels["journal"] = range(1, len(scene.throws.rods) + 1)
        labels["pin"] = labels["journal"][:-1]
    return labels | {"lecture": list(LECTURES), "quantity": list(QUANTITIES)}


def row_of(result: Result, samples: int | None = None) -> Row:
    """The columns of one run that it has, with series so many samples of them; what it has not is
    NaN.

    Raises
    ------
    InputError : more samples
    """
    row = _measured(measure(result))
    row["relative_error"] = np.array(result.error.estimated)
    if result.scene.fuel is None:
        row |= _lectured(result)
    if samples is not None:
        row |= _sampled(result, samples)
    return row


def samples_of(scene: Scene) -> int:
    """How many samples a run of a scene has at most.

    Raises
    ------
    InputError : that shows only on the way

    >>> samples_of(load_scene("yi_diesel"))
    722
    """
    end, in_time = scene.end
    if scene.run.every is None:
        return math.ceil(math.degrees(scene.settled_period)) + 3
    every, every_in_time = scene.run.every.resolve(scene.period)
    if every_in_time != in_time:
        raise InputError(
            "run.every: series of all cases are kept where run.every and run.until are both angles "
            "or both times, or the number of samples is not known beforehand; change one of them"
        )
    return math.floor(end / every) + 2


def _measured(measures: Measures) -> Row:
    row: Row = {"energy_closure": np.array(measures.energy_closure)}
    scene, angles = measures.scene, angles_of(measures)
    names = names_of(scene)
    for name, estimates in values_of(measures).items():
        pairs = np.array(estimates, dtype=np.float64).T
        row[name], row[f"{name}{_ERROR}"] = pairs if names[name].of else pairs[:, 0]
    for kind in kinds_of(scene):
        peaks = angles[f"{kind.key}_peak"]
        places = [crank % scene.period if cycle is None else cycle for crank, cycle in peaks]
        row[f"{kind.key}_peak_angle"] = np.array(places if kind.of else places[0])
    return row


def _lectured(result: Result) -> Row:
    """Errors of the lectures, as far as they have one."""
    value, error = np.full((2, len(LECTURES), len(QUANTITIES)), np.nan)
    try:
        deviations = largest_deviations(result)
    except InputError:  # folded all the time
        return {}
    for (lecture, quantity), deviation in deviations.items():
        at = list(LECTURES).index(lecture), list(QUANTITIES).index(quantity)
        value[at], error[at] = deviation
    return {"lecture_deviation": value, f"lecture_deviation{_ERROR}": error}


def _sampled(result: Result, most: int) -> Row:
    count, row = result.data.sizes["time"], {}
    if count > most:
        raise InputError(
            f"run: series of all cases are kept in {most} samples, those of the scene that is "
            f"varied; {count} came; give that scene the longest run"
        )
    for name in variables_of(result.scene):
        variable = result.data[name]
        rest = np.full((most - count, *variable.shape[1:]), np.nan)
        row[f"series_{name}"] = np.concatenate([variable.values, rest])
        row[f"series_{name}{_ERROR}"] = np.array(variable.attrs["error_estimate"])
    return row
