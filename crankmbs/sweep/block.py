"""A block of cases, computed wherever a worker takes it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import ceil
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.rows import Rows, rows_of
from crankmbs.errors import CrankmbsError
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.once import forget
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.sweep.columns import Row, columns_of, dims_of, row_of, samples_of
from crankmbs.sweep.scenes import scene_of

__all__ = ["BROKEN", "IMPOSSIBLE", "Block", "Job", "block_size", "broken", "joined", "solved"]

Ended = tuple[Row, int, str]  # of one case: its columns, status and sentence

T = TypeVar("T")
IMPOSSIBLE, BROKEN = 2, -2  # status of a case whose scene is refused; that ended its worker
_FAILED = -1
_FEWEST, _BLOCKS = 4, 128
_SOME, _WIDE, _TOGETHER = 32, 512, 16  # the same of cases that are solved together
_MOST, _MOST_SERIES = 2048, 256  # a block is a file of each column: few files, some 40 MB of series


@dataclass(frozen=True)
class Job:
    """What a worker has to know: the scene, the names that are varied, their values by case."""

    scene: Scene
    names: tuple[str, ...]
    values: tuple[tuple[object, ...], ...]
    series: bool

    def only(self, number: int) -> Job:
        """One of its cases alone."""
        return Job(self.scene, self.names, self.values[number : number + 1], self.series)


@dataclass(frozen=True)
class Block:
    """What came of a job's cases.

    rows : by column, shape (cases, ...), NaN where a case has none
    status : shape (cases,): of the run, or IMPOSSIBLE or BROKEN; message : the sentences
    """

    rows: dict[str, Array]
    status: NDArray[np.int8]
    message: tuple[str, ...]


def block_size(count: int, *, series: bool, together: bool = False) -> int:
    """How many of so many cases make a block, whoever computes them.

    together : whether most are solved together, so fast that files would take longer

    >>> block_size(1000, series=False), block_size(10**6, series=False)
    (8, 2048)
    >>> block_size(10_000, series=False, together=True), block_size(96, series=False, together=True)
    (512, 32)
    """
    fewest = min(max(ceil(count / _TOGETHER), _SOME), _WIDE) if together else _FEWEST
    return min(max(ceil(count / _BLOCKS), fewest), _MOST_SERIES if series else _MOST)


def solved(job: Job) -> Block:
    """Compute the cases of a job: together those that `crankmbs.batch` can, the others one after
    the other; a case that fails is a row with its status and sentence.

    >>> job = Job(load_scene("yi_diesel"), ("rod.length",), ((0.16,), (0.01,)), False)
    >>> print(solved(job).status)
    [0 2]
    """
    cases = [_attempt(partial(scene_of, job.scene, job.names, values)) for values in job.values]
    scenes = [case if isinstance(case, Scene) else None for case in cases]
    together = [] if job.series else rows_of(scenes)
    solved_together = {int(k) for rows in together for k in rows.which}
    samples = samples_of(job.scene) if job.series else None
    ended: dict[int, Ended] = {}
    for k, case in enumerate(cases):
        if k not in solved_together:
            ended[k] = _one(case, samples)
            forget(case)
    return _block(job, ended, together)


def broken(job: Job, message: str) -> Block:
    """What is left of cases that end their worker."""
    return _block(job, {k: ({}, BROKEN, message) for k in range(len(job.values))}, [])


def joined(parts: list[Block]) -> Block:
    """The blocks of single cases as one."""
    rows = {name: np.concatenate([part.rows[name] for part in parts]) for name in parts[0].rows}
    status = np.concatenate([part.status for part in parts])
    return Block(rows, status, tuple(text for part in parts for text in part.message))


def _attempt(make: Callable[[], T]) -> T | Ended:
    """What is made, or how the case ended that did not get so far."""
    try:
        return make()
    except CrankmbsError as error:
        return {}, IMPOSSIBLE, str(error)
    except Exception as error:  # of a limit nobody knew: the other cases are computed
        return {}, _FAILED, f"broke off: {type(error).__name__}: {error}"


def _one(case: Scene | Ended, samples: int | None) -> Ended:
    if not isinstance(case, Scene):
        return case
    result = _attempt(partial(simulate, case))
    if not isinstance(result, Result):
        return result
    row = _attempt(partial(row_of, result, samples))
    if isinstance(row, dict):
        return row, result.status, result.message
    failed = row[1] == _FAILED and result.status  # as where a load failed before a sample
    return ({}, result.status, result.message) if failed else row


def _block(job: Job, ended: dict[int, Ended], together: list[Rows]) -> Block:
    sizes = {dim: len(at) for dim, at in dims_of(job.scene, series=job.series).items()}
    rows, count = {}, len(job.values)
    for name, column in columns_of(job.scene, series=job.series).items():
        rows[name] = np.full((count, *(sizes[dim] for dim in column.dims)), np.nan)
        for some in together:
            rows[name][some.which] = some.columns[name]
        for k, (row, _, _) in ended.items():
            if name in row:
                rows[name][k] = row[name]
    status, message = np.zeros(count, dtype=np.int8), [""] * count
    for some in together:
        for k, text in zip(some.which, some.messages, strict=True):
            message[k] = text
    for k, (_, code, text) in ended.items():
        status[k], message[k] = code, text
    return Block(rows, status, tuple(message))
