"""A block of cases, computed wherever a worker takes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import ceil
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.rows import rows_of
from crankmbs.errors import CrankmbsError
from crankmbs.numerics.once import forget
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.sweep.columns import columns_of, row_of, samples_of
from crankmbs.sweep.scenes import scene_of

__all__ = ["BROKEN", "IMPOSSIBLE", "Block", "Job", "blank", "block_size", "solved"]

Block = dict[str, NDArray[Any]]
"""What came of a job's cases, by column, shape (cases, ...), NaN where a case has none; as "status"
that of the run, or IMPOSSIBLE or BROKEN, and as "message" its sentence."""

Case = dict[str, Any]  # of one: what it has of a block

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
    values: Sequence[tuple[object, ...]]
    series: bool = False


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


def blank(job: Job, status: int, message: str) -> Block:
    """Cases that have nothing but this status and message."""
    count, columns = len(job.values), columns_of(job.scene, series=job.series)
    block: Block = {
        name: np.full((count, *column.shape), np.nan) for name, column in columns.items()
    }
    block["status"] = np.full(count, status, dtype=np.int8)
    block["message"] = np.full(count, message, dtype=object)
    return block


def solved(job: Job) -> Block:
    """Compute the cases of a job: together those that `crankmbs.batch` can, the others one after
    the other; a case that fails is a row with its status and sentence.

    >>> job = Job(load_scene("yi_diesel"), ("rod.length",), [(0.16,), (0.01,)])
    >>> print(solved(job)["status"])
    [0 2]
    """
    cases = [_attempt(partial(scene_of, job.scene, job.names, values)) for values in job.values]
    scenes = [case if isinstance(case, Scene) else None for case in cases]
    samples = samples_of(job.scene) if job.series else None
    block, alone = blank(job, 0, ""), set(range(len(cases)))
    for rows in [] if job.series else rows_of(scenes):
        alone -= set(rows.which.tolist())
        _put(block, rows.which, rows.columns | {"message": rows.messages})
    for k in alone:
        case = cases[k]
        ended = _attempt(partial(_alone, case, samples)) if isinstance(case, Scene) else case
        _put(block, k, ended)
        forget(case)
    return block


def _attempt(make: Callable[[], T]) -> T | Case:
    """What is made, or how the case ended that did not get so far."""
    try:
        return make()
    except CrankmbsError as error:
        return {"status": IMPOSSIBLE, "message": str(error)}
    except Exception as error:  # of a limit nobody knew: the other cases are computed
        return {"status": _FAILED, "message": f"broke off: {type(error).__name__}: {error}"}


def _alone(scene: Scene, samples: int | None) -> Case:
    result = simulate(scene)
    ended: Case = {"status": result.status, "message": result.message}
    try:
        return row_of(result, samples) | ended
    except CrankmbsError:
        raise
    except Exception:
        if result.status == 0:
            raise
        return ended  # as where a load failed before a sample


def _put(block: Block, at: Any, columns: Case) -> None:
    for name in block.keys() & columns.keys():
        block[name][at] = columns[name]
