"""Where blocks are computed: here, in processes, or in an executor given."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from typing import TypeVar

import numpy as np

from crankmbs.errors import InputError, OutputError, shown
from crankmbs.sweep.block import BROKEN, Block, Job, blank, solved

__all__ = ["Workers", "check_executor", "computed"]

T = TypeVar("T")
_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
_LARGEST = 512
_FEW = 12  # blocks: they are done before processes have started
_GUARD = (
    "the workers could not start: each of them imports the script that sweeps, so put its call "
    'under if __name__ == "__main__":, or give executor=1'
)
_ENDED = "the worker that computed this case ended, again and again"


def check_executor(executor: object) -> None:
    """Refuse what computes nothing.

    Raises
    ------
    InputError : neither an executor nor a number of processes
    """
    if executor is None or isinstance(executor, Executor):
        return
    if isinstance(executor, bool) or not isinstance(executor, int) or not 1 <= executor <= _LARGEST:
        raise InputError(
            f"executor must be a number of workers from 1 to {_LARGEST}, or an Executor of "
            f"concurrent.futures; {shown(executor)} came"
        )


def computed(
    job: Callable[[T], Job], places: list[T], executor: Executor | int | None
) -> Generator[tuple[T, Block]]:
    """The blocks at these places as they are finished: by an executor, or by so many workers; 1 is
    the calling process alone, and None takes it for few blocks, else a process for each processor.

    Raises
    ------
    InputError : workers that cannot start, or a scene that cannot be sent to them
    OutputError : an executor that was given broke
    """
    if executor is None:
        executor = 1 if len(places) < _FEW else os.cpu_count() or 1
    if isinstance(executor, int):
        executor = min(executor, len(places))
    if not places or executor == 1:
        for place in places:
            yield place, solved(job(place))
        return
    if isinstance(executor, int | ProcessPoolExecutor):
        _check_sendable(job(places[0]))
    workers = Workers(executor)
    try:
        yield from workers.computed(job, places)
    finally:
        workers.close()


class Workers:
    """Processes of this machine, or an executor that is given, and what replaces those that end."""

    def __init__(self, of: Executor | int) -> None:
        self._of = of
        self._executor = _processes(of) if isinstance(of, int) else of
        if isinstance(of, Executor):
            try:
                _check_ready(of.submit(_ready))
            except RuntimeError as error:
                raise InputError(f"executor: it takes no work: {error}; give a new one") from None

    @property
    def at_once(self) -> int:
        """How many blocks may be under way; of a cluster more wait, each comes over a network."""
        client = getattr(self._executor, "_client", None)
        if client is not None:
            return 4 * max(sum(map(int, client.nthreads().values())), 1)
        return 2 * int(getattr(self._executor, "_max_workers", None) or os.cpu_count() or 1)

    def computed(self, job: Callable[[T], Job], places: list[T]) -> Iterator[tuple[T, Block]]:
        """The blocks as they are finished. Those under way when a worker ended are computed when
        nothing else is, one by one, and where it ends again case by case."""
        ahead, lost = iter(places), list[T]()
        pending: dict[Future[Block], T] = {}
        while True:
            room = 0 if lost else max(self.at_once - len(pending), 0)
            for place in islice(ahead, room):
                pending[self._submit(job(place))] = place
            if pending:
                for future in wait(pending, return_when=FIRST_COMPLETED).done:
                    place, block = pending.pop(future), _result(future)
                    if block is None:
                        lost.append(place)
                    else:
                        yield place, block
            elif lost:
                self._renew()
                for place in lost:
                    yield place, self._alone(job(place))
                lost = []
            else:
                return

    def close(self) -> None:
        """End the processes, after the blocks under way."""
        if self._executor is not self._of:
            self._executor.shutdown(cancel_futures=True)

    def _submit(self, job: Job) -> Future[Block]:
        try:
            return self._executor.submit(solved, job)
        except BrokenExecutor as error:
            future: Future[Block] = Future()
            future.set_exception(error)
            return future

    def _alone(self, job: Job) -> Block:
        """A block computed when nothing else is; where its worker ends, case by case."""
        block = _result(self._submit(job))
        if block is not None:
            return block
        self._renew()
        if len(job.values) == 1:
            return blank(job, BROKEN, _ENDED)
        cases = [self._alone(replace(job, values=[values])) for values in job.values]
        return {name: np.concatenate([case[name] for case in cases]) for name in cases[0]}

    def _renew(self) -> None:
        """Start processes anew; a cluster does so by itself."""
        if isinstance(self._of, int):
            self.close()
            self._executor = _processes(self._of)
            return
        try:
            self._of.submit(int)
        except BrokenExecutor as error:
            raise OutputError(
                f"executor: it is broken ({type(error).__name__}); finished blocks are stored, "
                "resume with a new one"
            ) from None


def _result(future: Future[Block]) -> Block | None:
    """A block; None where its worker ended."""
    try:
        return future.result()
    except Exception as error:
        if isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker":  # Dask's
            return None
        raise


def _check_sendable(job: Job) -> None:
    """Refuse a scene that cannot be sent to another process.

    Raises
    ------
    InputError : a load in Python that is no function of a module
    """
    try:
        pickle.dumps(job)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise InputError(
            f"torque: a load cannot be sent to other processes ({error}); define its function at "
            "the top of a module, or give executor=1"
        ) from None


def _check_ready(ready: Future[None]) -> None:
    """Wait until a worker has loaded all."""
    try:
        ready.result()
    except BrokenExecutor:
        raise InputError(_GUARD) from None
    except ImportError as error:
        raise InputError(f"executor: its workers cannot load crankmbs ({error})") from None


def _ready() -> None:
    """What the first call of a worker has to load."""
    from crankmbs.scene.read import load_scene

    scene = load_scene("propeller").with_(run__until="settled")
    solved(Job(scene, ("rod.length",), [(scene.rod.length,)]))


def _processes(count: int) -> ProcessPoolExecutor:
    """Processes that have been started, each with one thread."""
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, context, initializer=_begin)
    try:
        with _starting():
            ready = [pool.submit(_ready) for _ in range(count)]
        _check_ready(ready[0])
    except BaseException:
        pool.shutdown(cancel_futures=True)
        raise
    return pool


@contextmanager
def _starting() -> Iterator[None]:
    """Processes that are started meanwhile compute with one thread each, and an interrupt does not
    reach them while they load, when `_begin` has not been called yet."""
    before = os.environ.copy()
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    mask = None
    if hasattr(signal, "pthread_sigmask"):  # Windows has none
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # processes inherit it
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _begin() -> None:
    """A worker leaves an interrupt to the process that writes, and ends when that has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
