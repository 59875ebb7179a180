"""The columns of a sweep, each with its error: measures, the errors of the lectures' formulas, and
where they are wanted the samples."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.compare import LECTURES, QUANTITIES, largest_deviations
from crankmbs.errors import InputError
from crankmbs.measures import Estimate, JointForce, Measures, measure
from crankmbs.measures.joints import joints_of
from crankmbs.mechanics.variables import variables_of
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["Column", "Row", "columns_of", "dims_of", "row_of", "samples_of"]

Row = dict[str, Array]
_ERROR = "_error"
_CYLINDER = ("cylinder",)
_FORMULAS = ("lecture", "quantity")


class Column(NamedTuple):
    """units, long_name; dims : beyond the case."""

    units: str
    long_name: str
    dims: tuple[str, ...] = ()


_MEASURES = {
    "mean_speed": Column("rad/s", "mean speed"),
    "fluctuation": Column("1", "coefficient of fluctuation, (max - min) / mean speed"),
    "speed_gain": Column("rad/s", "drift of the speed over the window"),
    "crank_torque": Column("N m", "mean gas and inertia torque"),
    "external_torque": Column("N m", "mean load torque (drive, where positive)"),
    "indicated_power": Column("W", "indicated power"),
    "imep": Column("Pa", "indicated mean effective pressure", _CYLINDER),
    "imep_crank_end": Column("Pa", "indicated mean effective pressure, crank end", _CYLINDER),
    "indicated_power_head_end": Column("W", "indicated power of the head ends"),
    "indicated_power_crank_end": Column("W", "indicated power of the crank ends"),
    "friction_power": Column("W", "friction power"),
    "mechanical_efficiency": Column("1", "mechanical efficiency"),
    "force_power": Column("W", "power of the forces on the pistons"),
}
_LECTURE = Column("1", "largest deviation of the lecture, over the peak", _FORMULAS)


def columns_of(scene: Scene, *, series: bool) -> dict[str, Column]:
    """The columns of a sweep of a scene by name; the error of ``name`` is ``name_error``.

    >>> "fluctuation_error" in columns_of(load_scene("propeller"), series=False)
    True
    """
    without = set() if scene.gas is not None else {"indicated_power", "imep"}
    without |= set() if scene.double_acting else {n for n in _MEASURES if n.endswith("_end")}
    without |= set() if scene.friction is not None else {"friction_power", "mechanical_efficiency"}
    without |= set() if scene.force else {"force_power"}
    columns = {name: column for name, column in _MEASURES.items() if name not in without}
    joints = _joints(scene)
    for joint, dims in joints.items():
        words = joint.replace("_", " ")
        force = "side force" if joint == "side_force" else f"{words} force"
        columns[f"{joint}_peak"] = Column("N", f"largest {force}", dims)
        columns[f"{joint}_mean"] = Column("N", f"mean {force} over time", dims)
    if scene.fuel is None:  # the lectures know one pressure for all firings
        columns["lecture_deviation"] = _LECTURE
    if series:
        columns |= _series(scene)
    errors = {
        f"{name}{_ERROR}": Column(
            column.units,
            f"error of {column.long_name}",
            tuple(
                dim for dim in column.dims if not (dim == "sample" or name.startswith("series_"))
            ),
        )
        for name, column in columns.items()
    }
    for joint, dims in joints.items():
        angle = "cycle angle" if dims == _CYLINDER else "crank angle"
        words = joint.replace("_", " ")
        errors[f"{joint}_peak_angle"] = Column("rad", f"{angle} of the largest {words}", dims)
    errors["energy_closure"] = Column("1", "largest energy residual over peak kinetic energy")
    errors["relative_error"] = Column("1", "relative global error, estimated")
    return columns | errors


def _joints(scene: Scene) -> dict[str, tuple[str, ...]]:
    """The joints of a scene by name, and over which dimension each is one of many."""
    return {
        joint.joint.replace(" ", "_"): (joint.of,) if joint.of else () for joint in joints_of(scene)
    }


def dims_of(scene: Scene, *, series: bool) -> dict[str, tuple[str, ...] | tuple[int, ...]]:
    """The coordinates of the dimensions beyond the case."""
    coordinates: dict[str, tuple[str, ...] | tuple[int, ...]] = {
        "cylinder": tuple(range(1, len(scene.cylinders) + 1))
    }
    if scene.throws is not None:
        coordinates["journal"] = tuple(range(1, len(scene.throws.rods) + 1))
        if scene.throws.shared:
            coordinates["pin"] = coordinates["journal"][:-1]
    if scene.fuel is None:
        coordinates |= {"lecture": tuple(LECTURES), "quantity": tuple(QUANTITIES)}
    if series:
        coordinates["sample"] = tuple(range(samples_of(scene)))
    return coordinates


def row_of(result: Result, samples: int | None) -> Row:
    """The columns of one run that it has, with series so many samples of them; what it has not is
    NaN.

    Raises
    ------
    InputError : more samples
    """
    row = _measured(measure(result), result.scene)
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
        return math.ceil(math.degrees(scene.period)) + 3
    every, every_in_time = scene.run.every.resolve(scene.period)
    if every_in_time != in_time:
        raise InputError(
            "run.every: series of all cases are kept where run.every and run.until are both angles "
            "or both times, or the number of samples is not known beforehand; change one of them"
        )
    return math.floor(end / every) + 2


def _measured(measures: Measures, scene: Scene) -> Row:
    row: Row = {"energy_closure": np.array(measures.energy_closure)}
    for name in _MEASURES:
        _put(row, name, getattr(measures, name))
    for joint, dims in _joints(scene).items():
        of_one = [force for force in measures.joints if force.joint.replace(" ", "_") == joint]
        single = not dims
        for statistic in ("peak", "mean"):
            estimates = tuple(getattr(force, statistic) for force in of_one)
            _put(row, f"{joint}_{statistic}", estimates[0] if single else estimates)
        angles = np.array([_angle(force, scene.period) for force in of_one])
        row[f"{joint}_peak_angle"] = angles[0] if single else angles
    return row


def _put(row: Row, name: str, estimates: Estimate | tuple[Estimate, ...] | None) -> None:
    if estimates is not None:
        value, error = np.array(estimates, dtype=np.float64).T
        row[name], row[f"{name}{_ERROR}"] = value, error


def _angle(joint: JointForce, period: float) -> float:
    return joint.crank_angle % period if joint.cycle_angle is None else joint.cycle_angle


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


def _series(scene: Scene) -> dict[str, Column]:
    sampled = {"time": Column("s", "time", ("sample",))}
    sampled["crank_angle"] = Column("rad", "crank angle", ("sample",))
    for name, about in variables_of(scene).items():
        dims = ("sample", about.of) if about.of else ("sample",)
        sampled[name] = Column(about.units, about.long_name, dims)
    return {f"series_{name}": column for name, column in sampled.items()}


def _sampled(result: Result, most: int) -> Row:
    count, row = result.data.sizes["time"], {}
    if count > most:
        raise InputError(
            f"run: series of all cases are kept in {most} samples, those of the scene that is "
            f"varied; {count} came; give that scene the longest run"
        )
    for name in _series(result.scene):
        variable = result.data[name.removeprefix("series_")]
        rest = np.full((most - count, *variable.shape[1:]), np.nan)
        row[name] = np.concatenate([variable.values, rest])
        row[f"{name}{_ERROR}"] = np.array(variable.attrs["error_estimate"])
    return row
