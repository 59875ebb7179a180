"""Motion and joint forces at samples: what contenders give, and how far two of them differ."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["END", "MOTION", "Trace", "differences", "stated", "trace_of"]


END, MOTION = "end", "motion"

_FORCES = {
    "main bearing": ("main_bearing_force_x", "main_bearing_force_y"),
    "crank pin": ("crank_pin_force_x", "crank_pin_force_y"),
    "piston pin": ("piston_pin_force_x", "piston_pin_force_y"),
    "side force": ("side_force",),
}
_DRIVE = {"drive torque": ("external_torque",)}


@dataclass(frozen=True)
class Trace:
    """Samples of a run, the last one at its end.

    time, theta, omega : shape (n,) [s, rad, rad/s]
    forces : by name, shape (n, components) or (n, cylinders, components) [N, N m]
    """

    time: Array
    theta: Array
    omega: Array
    forces: Mapping[str, Array] = field(default_factory=dict)

    def end(self) -> Trace:
        """The last sample alone, without its forces."""
        last = slice(-1, None)
        return Trace(self.time[last], self.theta[last], self.omega[last])


def trace_of(result: Result) -> Trace:
    """The trace of a result; where the speed is prescribed, the drive's torque is a reaction."""
    data = result.data
    return Trace(
        data["time"].values,
        data["crank_angle"].values,
        data["crank_speed"].values,
        {
            name: np.stack([data[part].values for part in parts], axis=-1)
            for name, parts in _names(result).items()
        },
    )


def stated(result: Result, trace: Trace, start: float) -> dict[str, float]:
    """The error that a result states, by the names and scales of `differences`."""
    error = {name: float(values.attrs["error_estimate"]) for name, values in result.data.items()}
    angle = float(result.data["crank_angle"].attrs["error_estimate"]) / _turned(trace, start)
    motion = max(angle, error["crank_speed"] / _peak(trace.omega[:, None]))
    forces = {
        name: math.hypot(*(error[part] for part in parts)) / _peak(trace.forces[name])
        for name, parts in _names(result).items()
    }
    return {END: motion, MOTION: motion, **forces}


def differences(trace: Trace, reference: Trace, start: float) -> dict[str, float]:
    """Largest relative differences, by name.

    "end" and "motion": the worse of the crank angle at equal times, per radian turned since
    ``start`` [rad], and of the speed relative to its peak; at the last sample and over all. Then
    each force, as a vector, relative to its peak. What the trace does not have is left out.
    """
    turned = _turned(reference, start)
    rows, others = _matched(trace, reference)
    late = trace.time[rows] - reference.time[others]
    ahead = trace.theta[rows] - reference.theta[others] - reference.omega[others] * late
    faster = trace.omega[rows] - reference.omega[others]
    motion = np.maximum(np.abs(ahead) / turned, np.abs(faster) / _peak(reference.omega[:, None]))
    errors = {END: float(motion[-1])}
    if len(trace.time) > 1:
        errors[MOTION] = float(np.max(motion))
    for name, force in trace.forces.items():
        right = reference.forces[name]
        size = np.linalg.norm(force[rows] - right[others].reshape(force[rows].shape), axis=-1)
        errors[name] = float(np.max(size)) / _peak(right)
    return errors


def _matched(trace: Trace, reference: Trace) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows of both that are one sample: the ends, and before them what lies on the same grid.

    Runs that end at one time may differ in the grid angle they pass last, and, where only the
    last cycle is kept, in the one they keep first.
    """
    n, m = len(trace.time) - 1, len(reference.time) - 1
    ahead = float(trace.theta[0] - reference.theta[0]) if n > 0 else 0.0
    skip = round(ahead / float(reference.theta[1] - reference.theta[0])) if ahead else 0
    mine, other = max(-skip, 0), max(skip, 0)
    common = max(min(n - mine, m - other), 0)
    return (
        np.append(np.arange(mine, mine + common), n),
        np.append(np.arange(other, other + common), m),
    )


def _names(result: Result) -> dict[str, tuple[str, ...]]:
    return _FORCES | (_DRIVE if result.scene.motion is not None else {})


def _turned(trace: Trace, start: float) -> float:
    return float(np.max(np.abs(trace.theta - start))) or 1.0


def _peak(values: Array) -> float:
    return float(np.max(np.linalg.norm(values, axis=-1))) or 1.0
