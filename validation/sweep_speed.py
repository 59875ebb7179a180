"""`python -m validation.sweep_speed`: what a sweep costs beside the solving of its cases.

Our part of a case: plan, store, summary and figure with a solver that gives numbers at once, and
the peak of the memory, for ten thousand to a million cases. Then, as ratios within one run: one
sweep by two workers, threads and processes, over two sweeps of half the cases side by side; and,
with blocks that take ten milliseconds, two workers of a Dask cluster over the pool.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from crankmbs import Sample, load_scene, load_sweep, sweep
from crankmbs.figures import png, sweep_figure
from crankmbs.sweep.block import BROKEN, Block, Job, blank
from crankmbs.sweep.plan import plan_of
from crankmbs.sweep.run import fill
from crankmbs.sweep.summary import summary

__all__ = ["main"]

_SCENE = load_scene("propeller").with_(run__until="settled")
_RANGES = {"crank.inertia": "0.05..0.5 kg m^2", "rod.length": "0.14..0.2 m"}
_COUNTS = (10_000, 100_000, 1_000_000)
_ROUNDS = 5
_CASES, _BLOCKS = 4000, 128  # some seconds of one processor: store and start-up are little of it
_BLOCK = 0.01  # s


class _At(Executor):
    """Has other work done than it is asked for, there where another executor does it."""

    def __init__(self, work: Callable[[Job], Block], there: Executor | None = None) -> None:
        self._work, self._there = work, there
        self._max_workers, self._client = 2, getattr(there, "_client", None)

    def submit(self, _: Any, /, *given: Any, **__: Any) -> Future[Any]:
        """The work on a job; of a call without one, which makes workers ready, nothing."""
        if not given:
            given, work = (0,), abs
        else:
            work = self._work  # type: ignore[assignment]
        if self._there is not None:
            return self._there.submit(work, *given)
        future: Future[Any] = Future()
        future.set_result(work(*given))
        return future


def main(arguments: list[str] | None = None) -> int:
    """Print all of it, or one line of the first part."""
    parser = argparse.ArgumentParser(prog="python -m validation.sweep_speed", description=__doc__)
    parser.add_argument("--cases", type=int, help="only our part, of so many cases")
    count = parser.parse_args(arguments).cases
    if count:
        print(_ours(count), flush=True)
        return 0
    for count in _COUNTS:  # each in a process of its own, for the peak of its memory
        words = [sys.executable, "-m", "validation.sweep_speed", "--cases", str(count)]
        os.spawnv(os.P_WAIT, sys.executable, words)
    print(f"beside {os.getloadavg()[0]:.1f} processes that want {os.cpu_count()} processors:")
    print(_side_by_side())
    print(_dask())
    return 0


def _ours(count: int) -> str:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "sweep.zarr")
        begin = [time.perf_counter()]
        fill(plan_of(_SCENE, Sample(_RANGES, count), "measures"), path, _At(_Numbers()), _unsaid)
        begin.append(time.perf_counter())
        summary(path)
        begin.append(time.perf_counter())
        filled = _peak()
        assert png(sweep_figure(load_sweep(path), "fluctuation"))
        begin.append(time.perf_counter())
    store, summed, drawn = np.diff(begin) / count * 1e6
    return (
        f"{count:8} cases: stored in {store:.1f} us a case, summed up in {summed:.1f}, drawn in "
        f"{drawn:.1f}; peak {filled:.0f} MB, with the figure {_peak():.0f} MB"
    )


class _Numbers:
    """A block at once, of numbers that have been drawn before."""

    def __init__(self) -> None:
        self._drawn: Block = {}

    def __call__(self, job: Job) -> Block:
        count = len(job.values)
        if not self._drawn:
            rng, self._drawn = np.random.default_rng(1), blank(job, 0, "reached its end")
            for values in self._drawn.values():
                if values.dtype == np.float64:
                    values[:] = rng.random(values.shape)
        return {name: values[:count] for name, values in self._drawn.items()}


def _peak() -> float:
    """The most memory that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def _unsaid(_: int) -> None:
    pass


def _side_by_side() -> str:
    """One sweep by two workers over two of half its cases, each in a process of its own."""
    ratios: dict[str, list[float]] = {"threads": [], "processes": []}
    taken = []
    with _pool() as pool, ThreadPoolExecutor(2) as threads:
        for k in range(_ROUNDS + 1):
            halves = [pool.submit(_alone, half) for half in range(2)]
            apart = max(half.result() for half in halves)
            for name, executor in (("threads", threads), ("processes", pool)):
                begin = time.perf_counter()
                sweep(_SCENE, {"crank.inertia": f"0.1..0.5 kg m^2:{_CASES}"}, executor=executor)
                together = time.perf_counter() - begin
                ratios[name] += [apart / together] if k else []  # the first loads everything
            taken += [apart] if k else []
    about = f"over two copies side by side, {statistics.median(taken):.1f} s"
    return "\n".join(_said(f"two {name} {about}", each) for name, each in ratios.items())


def _alone(half: int) -> float:
    """How long half of the cases take here [s]."""
    begin, (low, high) = time.perf_counter(), ((0.1, 0.3), (0.3, 0.5))[half]
    vary = {"crank.inertia": f"{low}..{high} kg m^2:{_CASES // 2}"}
    sweep(_SCENE, vary, executor=1)
    return time.perf_counter() - begin


def _dask() -> str:
    """Two workers of a cluster on this machine over the pool, with short blocks."""
    from distributed import Client, LocalCluster

    vary, ratios = Sample(_RANGES, 4 * _BLOCKS), []
    with (
        _pool() as pool,
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        there = client.get_executor(pure=False)
        for k in range(_ROUNDS + 1):
            taken = []
            for executor in (pool, there):
                begin = time.perf_counter()
                sweep(_SCENE, vary, executor=_At(_busy, executor))
                taken.append(time.perf_counter() - begin)
            ratios += [taken[0] / taken[1]] if k else []
    return _said(f"Dask over the pool, {_BLOCK * 1e3:.0f} ms a block", ratios)


def _busy(job: Job) -> Block:
    """Nothing, for as long as a short block."""
    end = time.perf_counter() + _BLOCK
    while time.perf_counter() < end:
        pass
    return blank(job, BROKEN, "busy")


def _pool() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(2, multiprocessing.get_context("spawn"))


def _said(what: str, ratios: list[float]) -> str:
    middle = statistics.median(ratios)
    return f"{what}: {100.0 * middle:.0f} % of the speed ({min(ratios):.2f} to {max(ratios):.2f})"


if __name__ == "__main__":
    sys.exit(main())
