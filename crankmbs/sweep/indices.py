"""How much of a measure's spread over some ranges comes from which knob: Sobol's indices."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crankmbs.errors import InputError, shown
from crankmbs.measures import Estimate
from crankmbs.numerics.arrays import Array, Index
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.cases import Cases
from crankmbs.sweep.knobs import Interval, Knob, interval_of
from crankmbs.sweep.plan import Plan
from crankmbs.sweep.reading import Reading, free_reading_of
from crankmbs.sweep.run import run_in_memory
from crankmbs.sweep.sample import Sample

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SobolIndices", "sobol_indices"]

_RESAMPLES = 400
_CONFIDENCE = 1.96  # standard errors: 95 % of a normal distribution
_OWN = 8.0  # of the measure's error over its standard deviation: more it does to no index


@dataclass(frozen=True)
class SobolIndices:
    """What share of a measure's variance is due to which knob.

    knobs : their names, in the order of the indices
    measure : what varies
    first : of each knob alone; total : with all that it does together with others, each with its
        error; NaN where there are none
    runs : how many there were
    status, message : 0 and how many runs; 1 and why there are none
    """

    knobs: tuple[str, ...]
    measure: Reading
    first: tuple[Estimate, ...]
    total: tuple[Estimate, ...]
    runs: int
    status: int
    message: str


def sobol_indices(
    scene: Scene,
    vary: Mapping[str, str],
    measures: str | Sequence[str],
    *,
    n: int = 256,
    seed: int = 1,
    executor: Executor | int | None = None,
) -> tuple[SobolIndices, ...]:
    """First-order and total indices of Sobol for some measures over ranges of knobs.

    With Y over ranges in which the knobs X_i are uniform, or with ":log" their logarithms,

        S_i = Var(E(Y | X_i)) / Var(Y),   S_Ti = 1 - Var(E(Y | all but X_i)) / Var(Y),

    estimated by `scipy.stats.sobol_indices` (Saltelli 2010) on its design of n (knobs + 2)
    runs, which all measures share. The error is 1.96 standard errors of 400 resamplings of that
    design, 95 % where they are normal, with n below 64 rather less; and 8 times the largest error
    of the measure over its standard deviation, which bounds what that error does to either index.

    Parameters
    ----------
    vary : two ranges or more, {"crank.inertia": "0.05..0.5 kg m^2:log", "rod.length": ...}
    measures : one or several, "fluctuation", "peak crank pin force", "side thrust by Grega"
    n : a power of two
    seed : from which design and resamplings are drawn
    executor : as of `sweep`

    Returns
    -------
    tuple : one for each measure, in their order; of status 1 where a run has it not, as the
        design needs each of them, or where it is the same in all runs

    Raises
    ------
    InputError : no scene, no two ranges, no such measure, n no power of two

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> vary = {"crank.inertia": "0.2..0.4 kg m^2", "piston.mass": "0.5..0.6 kg"}
    >>> (indices,) = sobol_indices(scene, vary, "fluctuation", n=8)
    >>> print(indices.total[0].value > 0.5 > 0.01 > indices.total[1].value)
    True
    """
    check_scene(scene)
    if not isinstance(vary, Mapping) or len(vary) < 2:
        raise InputError(
            "vary must be two names or more and their ranges, as one alone has all of the "
            f'variance: {{"crank.inertia": "0.05..0.5 kg m^2", ...}}; {shown(vary)} came'
        )
    Sample(vary, n, seed=seed)  # refuses no numbers
    if n < 2 or n & (n - 1):
        raise InputError(
            f"n must be a power of two from 2 on, or Sobol's points are not balanced; {n} came, "
            f"{2 ** n.bit_length()} is the next"
        )
    knobs = tuple(interval_of(scene, *item) for item in vary.items())
    words, names = [measures] if isinstance(measures, str) else measures, [k.name for k in knobs]
    readings = [free_reading_of(scene, text, names) for text in words]
    plan = Plan(scene, Cases(_design(knobs, n, seed), grid=False), series=False)
    data = run_in_memory(plan, executor)
    return tuple(_indices_of(plan, data, reading, n, seed) for reading in readings)


def _design(knobs: tuple[Interval, ...], n: int, seed: int) -> tuple[Knob, ...]:
    """The knobs at the points for which SciPy asks: n of its A, n of B, then of those mixed."""
    from scipy import stats

    designs: list[Array] = []
    uniform: Any = stats.uniform()

    def recorded(points: Array) -> Array:
        designs.append(points)
        return np.asarray(points.sum(axis=0))

    stats.sobol_indices(func=recorded, n=n, dists=[uniform] * len(knobs), rng=seed)
    columns = np.concatenate(designs, axis=1)
    return tuple(knob.taken(column) for knob, column in zip(knobs, columns, strict=True))


def _indices_of(plan: Plan, data: xr.Dataset, reading: Reading, n: int, seed: int) -> SobolIndices:
    names, count = plan.cases.names, plan.cases.count
    read, errors = reading.of(data)
    values = np.where(data["status"] == 0, read, np.nan)
    why = _why_not(plan, data, reading, values)
    if why:
        nothing = (Estimate(math.nan, math.nan),) * len(names)
        return SobolIndices(names, reading, nothing, nothing, count, 1, why)
    deviation = float(np.std(values[: 2 * n]))
    estimates, rng = _indices(values, n, np.arange(n)), np.random.default_rng(seed)
    resampled = [_indices(values, n, rng.integers(n, size=n)) for _ in range(_RESAMPLES)]
    error = _CONFIDENCE * np.std(resampled, axis=0, ddof=1) + _OWN * float(errors.max()) / deviation
    first, total = (
        tuple(Estimate(*pair) for pair in zip(*order, strict=True))
        for order in zip(estimates.tolist(), error.tolist(), strict=True)
    )
    return SobolIndices(names, reading, first, total, count, 0, f"from {count} runs")


def _indices(values: Array, n: int, rows: Index) -> Array:
    """First-order and total indices from some rows of the design, shape (2, knobs)."""
    from scipy import stats

    mixed = values[2 * n :].reshape(n, -1).T[:, None]
    parts: Any = {
        "f_A": values[None, rows],
        "f_B": values[None, n + rows],
        "f_AB": mixed[..., rows],
    }
    indices = stats.sobol_indices(func=parts, n=n)
    return np.array([indices.first_order, indices.total_order])


def _why_not(plan: Plan, data: xr.Dataset, reading: Reading, values: Array) -> str:
    """Why there are no indices; empty where there are."""
    missing = np.flatnonzero(np.isnan(values))
    if missing.size == 0:
        same = np.ptp(values) <= 1e-12 * np.max(np.abs(values))
        return f"{reading.words} is the same in all {len(values)} runs" if same else ""
    first = int(missing[0])
    place = ", ".join(
        f"{knob.name} = {knob.values[first]:.6g} {knob.units}".rstrip() for knob in plan.cases.knobs
    )
    return (
        f"{missing.size} of {len(values)} runs have no {reading.words}, and indices need all; the "
        f"first at {place}: {data['message'].values[first]}; narrow the ranges"
    )
