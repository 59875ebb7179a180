"""Where blocks are computed: here, in processes, or in an executor given."""

from __future__ import annotations

import math
import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
)
from contextlib import contextmanager
from typing import Protocol

from crankmbs.errors import InputError, OutputError, shown
from crankmbs.sweep.block import Block, Job, solved

__all__ = ["Workers", "check_executor", "workers_of"]

_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
_LARGEST = 512
_COUNTING = 1.0  # s between two counts of a cluster's workers
_FEW = 12  # blocks: they are done before processes have started
_GUARD = (
    "the workers could not start: each of them imports the script that sweeps, so put its call "
    'under if __name__ == "__main__":, or give executor=1'
)


class Workers(Protocol):
    """What computes blocks.

    tries : how often a case may end its worker; once where that means that it did so several times
    """

    tries: int

    @property
    def at_once(self) -> int:
        """How many blocks may be under way."""

    def submit(self, job: Job) -> Future[Block]:
        """Have a block computed."""

    def renew(self) -> None:
        """Make workers anew after one has ended."""

    def lost(self, error: BaseException) -> bool:
        """Whether an error says that a worker ended."""


class _Here:
    """In the calling process, one block after the other."""

    at_once, tries = 1, 1

    def submit(self, job: Job) -> Future[Block]:
        future: Future[Block] = Future()
        future.set_result(solved(job))
        return future

    def renew(self) -> None:
        """Nothing: there is no worker that could end."""

    def lost(self, error: BaseException) -> bool:
        return False


class _Processes:
    """Processes of this machine, started anew, each with one thread."""

    tries = 2

    def __init__(self, count: int) -> None:
        self.at_once = 2 * count  # one waits while one is computed
        self._count = count
        self._pool = self._new()

    def submit(self, job: Job) -> Future[Block]:
        with _deaf():
            return self._pool.submit(solved, job)

    def renew(self) -> None:
        self.close()
        self._pool = self._new()

    def lost(self, error: BaseException) -> bool:
        return isinstance(error, BrokenExecutor)

    def ready(self) -> Future[None]:
        """When the first of them has loaded everything."""
        with _deaf():
            return self._pool.submit(_ready)

    def close(self) -> None:
        """End them, after the blocks under way."""
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _new(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self._count, context, initializer=_begin)


class _Given:
    """An executor that is given; Dask's tries again by itself, and its workers come and go."""

    tries = 1

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._client = getattr(executor, "_client", None)
        self._counted, self._count = -math.inf, 0

    @property
    def at_once(self) -> int:
        """Of a cluster more wait than of a pool: each block comes over a network."""
        if self._client is None:
            return 2 * (getattr(self._executor, "_max_workers", None) or os.cpu_count() or 1)
        if time.monotonic() > self._counted + _COUNTING:
            self._count = sum(self._client.nthreads().values())
            self._counted = time.monotonic()
        return 4 * max(self._count, 1)

    def submit(self, job: Job) -> Future[Block]:
        return self._executor.submit(solved, job)

    def renew(self) -> None:
        """Nothing where the executor starts workers itself; a broken one is the end."""
        try:
            self._executor.submit(_ready).result()
        except Exception as error:
            raise OutputError(
                f"executor: it is broken ({type(error).__name__}); what is finished is kept, go on "
                "with a new one"
            ) from None

    def lost(self, error: BaseException) -> bool:
        return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


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


@contextmanager
def workers_of(executor: Executor | int | None, job: Job, blocks: int) -> Iterator[Workers]:
    """What computes so many blocks such as this one: an executor, or so many workers; 1 is the
    calling process alone, and None takes it for few blocks, else a process for each processor.

    Raises
    ------
    InputError : workers that cannot start, or a scene that cannot be sent to them
    """
    if isinstance(executor, Executor):
        if isinstance(executor, ProcessPoolExecutor):
            _check_sendable(job)
        try:
            ready = executor.submit(_ready)
        except RuntimeError as error:
            raise InputError(f"executor: it takes no work: {error}; give a new one") from None
        _check_ready(ready)
        yield _Given(executor)
        return
    few = executor is None and blocks < _FEW
    count = 1 if few else min(executor or os.cpu_count() or 1, blocks)
    if count <= 1:
        yield _Here()
        return
    _check_sendable(job)
    with _one_thread_each():
        pool = _Processes(count)
        try:
            _check_ready(pool.ready())
            yield pool
        finally:
            pool.close()


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
    solved(Job(scene, ("rod.length",), ((scene.rod.length,),), False))


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes that are started meanwhile compute with one thread each."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def _deaf() -> Iterator[None]:
    """Processes that are started meanwhile do not hear an interrupt while they load, when `_begin`
    has not been called yet; this one hears it when they have been told what to load."""
    here = threading.current_thread() is threading.main_thread()
    if not here or not hasattr(signal, "pthread_sigmask"):  # Windows has none
        yield
        return
    heard: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # processes inherit it
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, handler)
        if heard:
            signal.raise_signal(signal.SIGINT)


def _begin() -> None:
    """A worker leaves an interrupt to the process that writes, and ends when that has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
