"""The store of a sweep: a folder in Zarr's format, written block by block, with a mark at its end.

Cases lie one after the other along ``case``, a block is a chunk of every column. The mark of a
block is written behind its columns, the summary of all metadata behind the last block: a store with
it is complete.
"""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crankmbs.errors import InputError, OutputError
from crankmbs.sweep.block import Block
from crankmbs.sweep.chunks import Chunks
from crankmbs.sweep.columns import columns_of, dims_of
from crankmbs.sweep.plan import Plan

if TYPE_CHECKING:
    import xarray as xr
    import zarr

__all__ = ["Store", "columns_in", "load_sweep", "opened", "unfinished"]

_MARK = ".zmetadata"
_DIMS = "_ARRAY_DIMENSIONS"  # by which xarray knows them
_NOT_RUN = -128
_STATUS = (
    "0 reached its end, 1 ended before it, -1 broke off, 2 a scene that cannot be, -2 ended its "
    "worker"
)
_WORDS = {
    "version": "by another version of crankmbs",
    "scene": "of another scene",
    "functions": "with functions in Python that are others, or cannot be told from others",
    "cases": "of other cases",
    "keep": "that keeps other things",
}


@dataclass(frozen=True)
class Store:
    """The store of a plan, open for writing.

    done : numbers of the blocks that are there
    """

    path: Path
    plan: Plan
    group: zarr.Group
    done: frozenset[int]

    @cached_property
    def _columns(self) -> dict[str, Chunks]:
        return {name: Chunks(self.path / name, one) for name, one in self.group.arrays()}

    def write(self, number: int, block: Block) -> None:
        """Write a block, its mark last.

        Raises
        ------
        OutputError : the device is full, or the folder cannot be written
        """
        known = {knob.name: knob.labels for knob in self.plan.cases.at(self.plan.rows(number))}
        ended = {"status": block.status, "message": np.array(block.message, dtype=object)}
        try:
            for name, values in (known | block.rows | ended).items():
                self._columns[name].write(number, values)
            self._columns["done"].write(number, np.ones(1))
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def finish(self) -> None:
        """Mark the store as complete.

        Raises
        ------
        OutputError : it cannot be written
        """
        import zarr

        try:
            zarr.consolidate_metadata(str(self.path), zarr_format=2)
        except OSError as error:
            raise _unwritable(self.path, error) from None


def opened(path: Path, plan: Plan) -> Store:
    """The store of a plan, made where there is none; one that is there is gone on with.

    Raises
    ------
    InputError : a store of another scene, of other cases or by another version; a complete one
    OutputError : it cannot be written, or is no such store
    """
    if not path.exists():
        _make(path, plan)
        return Store(path, plan, _group(path, "r+"), frozenset())
    group, ours = _group(path, "r+"), plan.identity
    identity: Any = group.attrs.get("identity", {})
    other = [said for name, said in _WORDS.items() if identity.get(name) != (ours[name] or None)]
    if other:
        raise InputError(f"{path}: holds a sweep {' and '.join(other)}; give another folder")
    if (path / _MARK).exists():
        raise InputError(f"{path}: this sweep is complete; give another folder to compute it anew")
    for left in path.rglob("*.partial"):  # of a write that was killed
        left.unlink()
    done = np.flatnonzero(np.asarray(_array(group, "done")[:])).tolist()
    return Store(path, plan, group, frozenset(done))


def unfinished(path: Path) -> bool:
    """Whether there is the beginning of a sweep, which can be gone on with."""
    return path.is_dir() and not (path / _MARK).exists()


def columns_in(path: Path) -> dict[str, zarr.Array[Any]]:
    """The columns of a store by name, none of them in memory; sorted.

    Raises
    ------
    OutputError : no sweep
    """
    return dict(sorted(_group(path, "r").arrays()))


def load_sweep(path: str | Path) -> xr.Dataset:
    """Read a sweep that is complete, labelled by what was varied.

    Returns
    -------
    Dataset : read from the folder as it is asked for; of a grid over its knobs, such as
        ``crank.inertia``; of a sample or a list of cases over ``case``, with the knobs as
        coordinates. ``name_error`` is the error of ``name``, in its unit; ``status`` and
        ``message`` say how each case ended, where NaN stands for what it has not

    Raises
    ------
    OutputError : no sweep, or an unfinished one

    >>> load_sweep("no.zarr")
    Traceback (most recent call last):
    crankmbs.errors.OutputError: no.zarr: no such sweep; crankmbs sweep writes one
    """
    import xarray as xr

    from crankmbs.sweep.laid import SweepStore

    folder = Path(path)
    group = _group(folder, "r")
    if not (folder / _MARK).exists():
        done, blocks = np.asarray(_array(group, "done")[:]).sum(), _array(group, "done").shape[0]
        raise OutputError(
            f"{folder}: {done} of {blocks} blocks are there; crankmbs sweep with --resume goes on"
        )
    return xr.open_dataset(folder, engine=SweepStore, decode_cf=False)


def _make(path: Path, plan: Plan) -> None:
    """Make the store, with all that is known before a case is run, in one move."""
    import zarr

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}-"))
    except OSError as error:
        raise _unwritable(path, error) from None
    try:
        _fill(zarr.open_group(str(part), mode="w", zarr_format=2), plan)
        part.chmod(0o755)
        part.rename(path)
    except OSError as error:
        raise _unwritable(path, error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _fill(group: zarr.Group, plan: Plan) -> None:
    count, size = plan.cases.count, plan.size
    group.attrs.put(
        {
            "title": plan.scene.title,
            "identity": {**plan.identity},
            "knobs": list(plan.cases.names),
            "grid": None if plan.cases.shape is None else list(plan.cases.shape),
        }
    )
    dims = dims_of(plan.scene, series=plan.series)
    for name, at in dims.items():
        kind: Any = str if isinstance(at[0], str) else "i4"
        about: Any = {_DIMS: [name]}
        made = group.create_array(
            name, shape=(len(at),), chunks=(len(at),), dtype=kind, attributes=about
        )
        made[:] = np.array(at, dtype=object if kind is str else kind)
    for name, (kind, nothing, own, labels) in _columns_of(plan).items():
        sizes = tuple(len(dims[dim]) for dim in own)
        about = {_DIMS: ["case", *own], **labels}
        shape, chunks = (count, *sizes), (size, *sizes)
        group.create_array(
            name, shape=shape, chunks=chunks, dtype=kind, fill_value=nothing, attributes=about
        )
    about = {_DIMS: ["block"]}
    group.create_array(
        "done", shape=(plan.blocks,), chunks=(1,), dtype="i1", fill_value=0, attributes=about
    )


class _Kind(NamedTuple):
    """What a column holds, and where nothing is; its dimensions beyond the case, and its labels."""

    dtype: Any
    nothing: object
    dims: tuple[str, ...]
    about: dict[str, str]


def _columns_of(plan: Plan) -> dict[str, _Kind]:
    """All that is written of a case."""
    found = {
        "status": _Kind("i1", _NOT_RUN, (), {"long_name": _STATUS}),
        "message": _Kind(str, "", (), {}),
    }
    for knob in plan.cases.at(range(1)):
        about = {"units": knob.units} if knob.units else {}
        kind, nothing = ("f8", np.nan) if knob.numbers else (str, "")
        found[knob.name] = _Kind(kind, nothing, (), about)
    for name, column in columns_of(plan.scene, series=plan.series).items():
        about = {"units": column.units, "long_name": column.long_name}
        found[name] = _Kind("f8", np.nan, column.dims, about)
    return found


def _group(path: Path, mode: Any) -> zarr.Group:
    import zarr

    if not path.exists():
        raise OutputError(f"{path}: no such sweep; crankmbs sweep writes one")
    try:
        group = zarr.open_group(str(path), mode=mode, zarr_format=2)
        _array(group, "done")
    except (OSError, LookupError, TypeError, ValueError):
        raise OutputError(f"{path}: no sweep of crankmbs; give the folder of one") from None
    return group


def _array(group: zarr.Group, name: str) -> Any:
    return group[name]


def _unwritable(path: Path, error: OSError) -> OutputError:
    return OutputError(
        f"{path}: cannot be written ({error.strerror or error}); choose another folder"
    )
