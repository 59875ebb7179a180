"""Every case of a sweep computed and kept, block by block."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from pathlib import Path
from typing import TYPE_CHECKING

from crankmbs.scene.scene import Scene
from crankmbs.sweep.block import Block, Job, broken, joined
from crankmbs.sweep.plan import Plan, check_possible, plan_of
from crankmbs.sweep.store import Store, load_sweep, opened
from crankmbs.sweep.workers import Workers, check_executor, workers_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fill", "sweep"]

_DEADLY = "the worker that computed this case ended, again and again"


def sweep(
    scene: Scene,
    vary: object,
    *,
    out: str | Path | None = None,
    executor: Executor | int | None = None,
    keep: str = "measures",
    strict: bool = False,
) -> xr.Dataset:
    """Run a scene with some of its numbers varied; keep the measures of each case.

    With another crank radius, rod length or offset the gas is carried over the volume. Beside the
    scene's own numbers there are "rod_ratio", r / l at the same stroke, where the rod keeps mass
    and shape, and "settled_speed", to which the loads are scaled.

    Parameters
    ----------
    vary : name, as `Scene.with_` takes it with dots, -> values: "0.05..0.5 kg m^2:40",
        "0.14..0.2 m:25:log", a list as "100 mm, 120 mm" or a sequence in SI units; all are
        combined. Or a `Sample`, or a CSV file of cases with a column for each name
    out : folder for the store in Zarr's format, written block by block; an unfinished one of the
        same scene and cases is gone on with. None keeps nothing on disk
    executor : how many workers compute; 1 the calling process alone, None that for a hundred cases,
        else a process for each processor. Or an Executor of concurrent.futures
    keep : "measures", or "series": every sample too
    strict : refuse scenes that cannot be before anything runs; else such a case has status 2

    Returns
    -------
    Dataset : over what is varied, of a sample or a list over ``case``; see `load_sweep`

    Raises
    ------
    InputError : bad names, values or executor; with ``strict`` how many scenes cannot be, and why
    OutputError : ``out`` cannot be written

    >>> vary = {"crank.inertia": "0.2..0.4 kg m^2:2"}
    >>> found = sweep(load_scene("propeller").with_(run__until="settled"), vary, executor=1)
    >>> found["fluctuation"].round(4).values.tolist()
    [0.0149, 0.0075]
    """
    plan = plan_of(scene, vary, keep)
    if strict:
        check_possible(plan)
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch, "sweep.zarr") if out is None else Path(out)
        fill(plan, path, executor, lambda _: None)
        found = load_sweep(path)
        return found.load() if out is None else found


def fill(
    plan: Plan,
    path: Path,
    executor: Executor | int | None,
    report: Callable[[int], None],
) -> None:
    """Compute what a store lacks of a plan, and mark it as complete.

    report : is told of so many cases each time that some are there

    Raises
    ------
    InputError : another sweep is there, or workers that cannot start
    OutputError : it cannot be written; what is finished is kept
    """
    check_executor(executor)
    store = opened(path, plan)
    missing = [number for number in range(plan.blocks) if number not in store.done]
    report(plan.cases.count - sum(len(plan.rows(number)) for number in missing))
    if missing:
        job, count = plan.job(missing[0]), len(missing)
        with workers_of(executor, job, count) as workers:
            _Filling(store, workers, report).run(missing)
    store.finish()


class _Filling:
    """The blocks of a store under way, no more at once than workers keep busy with."""

    def __init__(self, store: Store, workers: Workers, report: Callable[[int], None]) -> None:
        self._store, self._workers, self._report = store, workers, report
        self._pending: dict[Future[Block], int] = {}

    def run(self, numbers: list[int]) -> None:
        """Have these blocks computed, and write each as it comes."""
        todo = iter(numbers)
        lost: list[int] = []
        while True:
            while len(self._pending) < self._workers.at_once and not lost:
                number = next(todo, None)
                if number is None:
                    break
                if not self._begun(number):
                    lost.append(number)
            if not self._pending:
                if not lost:
                    return
                self._alone(lost)
                lost = []
                continue
            done, _ = wait(self._pending, return_when=FIRST_COMPLETED)
            lost += [number for future in done if (number := self._written(future)) is not None]

    def _begun(self, number: int) -> bool:
        """Whether a block could be handed to the workers."""
        try:
            future = self._workers.submit(self._store.plan.job(number))
        except Exception as error:
            if not self._workers.lost(error):
                raise
            return False
        self._pending[future] = number
        return True

    def _written(self, future: Future[Block]) -> int | None:
        """Write a block that is there; the number of one whose worker has ended."""
        number = self._pending.pop(future)
        try:
            self._write(number, future.result())
        except Exception as error:
            if not self._workers.lost(error):
                raise
            return number
        return None

    def _alone(self, numbers: list[int]) -> None:
        """Compute blocks that were under way when a worker ended, one by one, and where it ends
        again case by case."""
        self._workers.renew()
        for number in numbers:
            job = self._store.plan.job(number)
            block = self._tried(job, 1) if self._workers.tries > 1 else None
            if block is None:
                cases = [job.only(k) for k in range(len(job.values))]
                block = joined(
                    [self._tried(one, self._workers.tries) or broken(one, _DEADLY) for one in cases]
                )
            self._write(number, block)

    def _tried(self, job: Job, times: int) -> Block | None:
        """A job computed alone, after so many lost workers nothing."""
        for _ in range(times):
            try:
                return self._workers.submit(job).result()
            except Exception as error:
                if not self._workers.lost(error):
                    raise
                self._workers.renew()
        return None

    def _write(self, number: int, block: Block) -> None:
        self._store.write(number, block)
        self._report(len(block.message))
