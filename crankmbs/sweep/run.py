"""Every case of a sweep computed and stored, block by block."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from crankmbs.scene.scene import Scene
from crankmbs.sweep.plan import Plan, check_possible, plan_of
from crankmbs.sweep.store import load_sweep, opened
from crankmbs.sweep.workers import check_executor, computed

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fill", "run_in_memory", "sweep"]


def sweep(
    scene: Scene,
    vary: object,
    *,
    out: str | Path | None = None,
    executor: Executor | int | None = None,
    keep: str = "measures",
    strict: bool = False,
) -> xr.Dataset:
    """Run a scene with some of its numbers varied, and store the measures of each case.

    With another crank radius, rod length or offset the gas is carried over the volume. Beside the
    numbers of the scene there are "rod_ratio", r / l at the same stroke, where the rod keeps mass
    and shape, and "settled_speed", to which the loads are scaled.

    Parameters
    ----------
    vary : name, as `Scene.with_` takes it with dots, -> values: "0.05..0.5 kg m^2:40",
        "0.14..0.2 m:25:log", a list as "100 mm, 120 mm" or a sequence in SI units; all are
        combined. Or a `Sample`, or a CSV file of cases with a column for each name
    out : folder for the store in Zarr's format, written block by block; an unfinished one of the
        same scene and cases is resumed. None stores nothing on disk
    executor : how many workers compute; 1 the calling process alone, None that for a hundred cases,
        else a process for each processor. Or an Executor of concurrent.futures
    keep : "measures", or "series": every sample too
    strict : refuse scenes that cannot be built before anything runs; else such a case has status 2

    Returns
    -------
    Dataset : over what is varied, of a sample or a list over ``case``; see `load_sweep`

    Raises
    ------
    InputError : bad names, values or executor; with ``strict`` how many scenes cannot be
        built, and why
    OutputError : ``out`` cannot be written

    >>> vary = {"crank.inertia": "0.2..0.4 kg m^2:2"}
    >>> data = sweep(load_scene("propeller").with_(run__until="settled"), vary, executor=1)
    >>> data["fluctuation"].round(4).values.tolist()
    [0.0149, 0.0075]
    """
    plan = plan_of(scene, vary, keep)
    if strict:
        check_possible(plan)
    if out is None:
        return run_in_memory(plan, executor)
    fill(plan, Path(out), executor, lambda _: None)
    return load_sweep(out)


def run_in_memory(plan: Plan, executor: Executor | int | None) -> xr.Dataset:
    """Compute every case of a plan, and store it nowhere but in memory."""
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch, "sweep.zarr")
        fill(plan, path, executor, lambda _: None)
        return load_sweep(path).load()


def fill(
    plan: Plan,
    path: Path,
    executor: Executor | int | None,
    report: Callable[[int], None],
) -> None:
    """Compute what a store lacks of a plan, and mark it as complete.

    report : is called with a number of cases each time that so many are finished

    Raises
    ------
    InputError : another sweep is there, or workers that cannot start
    OutputError : it cannot be written; finished blocks stay
    """
    check_executor(executor)
    with opened(path, plan) as store:
        report(store.done)
        with closing(computed(plan.job, store.missing, executor)) as blocks:
            for box, block in blocks:
                store.write(box, block)
                report(len(block["status"]))
