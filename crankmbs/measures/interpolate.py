"""The variables of a run at any time or crank angle, each with its error."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError, shown
from crankmbs.motion.motion import Motion, Passes
from crankmbs.motion.states import variables_at
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["interp", "read_at", "read_with_errors"]

_HAIR = 1e-12  # of the run: an end may be so far off by rounding


def interp(
    result: Result, time: ArrayLike | None = None, crank_angle: ArrayLike | None = None
) -> xr.Dataset:
    """Every variable but the energy residual, at times or at crank angles, by the polynomials that
    the motion was solved with; forces follow from it. Nothing is run again.

    Parameters
    ----------
    time : shape (n,) or one number [s], within the run; or
    crank_angle : shape (n,) or one number [rad], unwrapped, as in ``result.data``

    Returns
    -------
    Dataset as ``result.data``, in the order asked for; ``error_estimate`` adds to that of the
    samples what the motions that check the run differ by at these points

    Raises
    ------
    InputError : neither or both, no finite numbers, outside what is kept of the run; an angle that
        a crank which turns back passes twice

    >>> data = interp(simulate(load_scene("propeller")), time=[0.1, 0.20001])
    >>> data.sizes["time"]
    2
    """
    if (time is None) == (crank_angle is None):
        came = "neither" if time is None else "both"
        raise InputError(f"give time or crank_angle, exactly one of the two; {came} came")
    in_time = crank_angle is None
    name, unit = ("time", "s") if in_time else ("crank_angle", "rad")
    places = _inside(result, name, unit, time if in_time else crank_angle)
    if not in_time and not result.passes.answer.turns_one_way:
        raise InputError("the crank rests or turns back, and an angle has no one time; give time")
    return read_at(result, result.passes, places, in_time=in_time)


def read_at(result: Result, passes: Passes, places: Array, *, in_time: bool) -> xr.Dataset:
    """Every variable of passes over a result, or a part of them, at times [s], or else at crank
    angles [rad], shape (n,), as `interp` gives it."""
    import xarray as xr

    values, errors = read_with_errors(result, passes, places, in_time=in_time)
    rows = {}
    for variable, value in values.items():
        sampled = result.data[variable]
        attributes = {**sampled.attrs, "error_estimate": errors[variable]}
        rows[variable] = (sampled.dims, value, attributes)
    coordinates = {name: rows.pop(name) for name in ("time", "crank_angle")}
    numbers = {str(of): result.data[of] for of in result.data.dims if of != "time"}
    return xr.Dataset(rows, {**coordinates, **numbers})


def read_with_errors(
    result: Result, passes: Passes, places: Array, *, in_time: bool
) -> tuple[dict[str, Array], dict[str, float]]:
    """The same as arrays, (n,) or (n, cylinders), and the error of each."""

    def read(motion: Motion) -> dict[str, Array]:
        return variables_at(motion.train, motion.at(places, in_time=in_time))

    values, checks = read(passes.answer), [read(motion) for motion in passes.checks]
    sampled, errors = result.variables, {}
    for variable, value in values.items():
        apart = [float(np.max(np.abs(check[variable] - value))) for check in checks]
        stated = float(sampled[variable][2]["error_estimate"])
        errors[variable] = stated + passes.share * max(apart, default=0.0)
    return values, errors


def _inside(result: Result, name: str, unit: str, at: ArrayLike | None) -> Array:
    """What is asked for, shape (n,), none of it outside the samples."""
    try:
        places = np.atleast_1d(np.asarray(at, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError(f"{name} must be numbers [{unit}]; {shown(at)} came") from None
    if places.ndim != 1 or places.size == 0 or not np.all(np.isfinite(places)):
        raise InputError(f"{name} must be finite numbers [{unit}] in a row; {shown(at)} came")
    values = result.data[name].values
    low, high = float(values.min()), float(values.max())
    first = result.passes.answer.cells[0]  # of a long run with few samples the end is kept
    begin = float((first.time if unit == "s" else first.angle)[0, 0])
    low, high = (max(low, begin), high) if values[-1] >= values[0] else (low, min(high, begin))
    hair = _HAIR * max(abs(low), abs(high))
    outside = places[(places < low - hair) | (places > high + hair)]
    if outside.size:
        raise InputError(
            f"{name} must be within what is kept of the run, {low:.9g} to {high:.9g} {unit}; "
            f"{outside[0]:.9g} {unit} came"
        )
    return np.clip(places, low, high)
