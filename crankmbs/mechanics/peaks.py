"""How large variables are, and which are nothing beside the others."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.numerics.arrays import Array

__all__ = ["negligible", "peak", "relative_error", "relative_errors"]

_UNITS = {name: about.units for name, about in EVERY.items()}
_FAR_OUT = "velocity of a point of the crank"
_NOTHING = 1e-10  # of the largest of the same unit; multibody's Newton iterations leave more rarely


def peak(values: Array) -> float:
    """Largest absolute value, 0 of none.

    >>> peak(np.array([1.0, -2.0]))
    2.0
    """
    return float(np.abs(values).max(initial=0.0))


def negligible(peaks: Mapping[str, float], units: Mapping[str, str]) -> set[str]:
    """What is zero but for rounding: at most 1e-10 of the largest peak of its unit.

    >>> negligible({"x": 1.0, "y": 1e-12, "z": 1e-12}, {"x": "N", "y": "N", "z": "m"})
    {'y'}
    """
    largest: dict[str, float] = {}
    for name, size in peaks.items():
        largest[units[name]] = max(largest.get(units[name], 0.0), size)
    return {name for name, size in peaks.items() if size <= _NOTHING * largest[units[name]]}


def relative_error(peaks: Mapping[str, float], errors: Mapping[str, float], turned: float) -> float:
    """The worst of the `relative_errors`.

    >>> relative_error({"crank_speed": 100.0}, {"crank_speed": 1e-4, "crank_angle": 2e-6}, 1.0)
    2e-06
    """
    return max(relative_errors(peaks, errors, turned).values(), default=0.0)


def relative_errors(
    peaks: Mapping[str, float], errors: Mapping[str, float], turned: float
) -> dict[str, float]:
    """Relative errors: of the crank angle per radian turned, of each other variable of a result
    relative to its peak.

    The energy residual is a check and does not count, nor do sums in which the cylinders may
    cancel; nor does what is `negligible`, a velocity of pistons beside that of a point of the crank
    as far out as they are, as in samples on dead centres alone.
    """
    sizes = {**peaks, "crank_angle": turned}
    far_out = peaks.get("crank_speed", 0.0) * peaks.get("piston_position", 0.0)
    ignored = negligible(sizes | {_FAR_OUT: far_out}, _UNITS | {_FAR_OUT: "m/s"}) - {_FAR_OUT}
    ignored |= SUMS | {"energy_residual"}
    return {name: errors[name] / size for name, size in sizes.items() if name not in ignored}
