"""The store of a sweep: a folder in Zarr's format, written block by block, with a mark at its end.

Cases lie one after the other along ``case``, a block is a chunk of every column. The mark of a
block is written behind its columns, the summary of all metadata behind the last block: a store with
it is complete.
"""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crankmbs.errors import InputError, OutputError
from crankmbs.numerics.arrays import Array
from crankmbs.sweep.block import Block
from crankmbs.sweep.columns import Column, columns_of, dims_of
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

    def write(self, number: int, block: Block) -> None:
        """Write a block, its mark last.

        Raises
        ------
        OutputError : the device is full, or the folder cannot be written
        """
        rows = self.plan.rows(number)
        where = slice(rows.start, rows.stop)
        try:
            for name, values in block.rows.items():
                _array(self.group, name)[where] = values
            _array(self.group, "status")[where] = block.status
            _array(self.group, "message")[where] = np.array(block.message, dtype=object)
            _array(self.group, "done")[number : number + 1] = 1
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
    group = _group(path, "r+")
    identity: Any = group.attrs.get("identity", {})
    other = [words for name, words in _WORDS.items() if identity.get(name) != plan.identity[name]]
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
    Dataset : of a grid over its knobs, such as ``crank.inertia``; of a sample or a list of cases
        over ``case``, with the knobs as coordinates. ``name_error`` is the error of ``name``, in
        its unit; ``status`` and ``message`` say how each case ended, where NaN stands for what it
        has not

    Raises
    ------
    OutputError : no sweep, or an unfinished one

    >>> load_sweep("no.zarr")
    Traceback (most recent call last):
    crankmbs.errors.OutputError: no.zarr: no such sweep; crankmbs sweep writes one
    """
    import xarray as xr

    folder = Path(path)
    group = _group(folder, "r")
    if not (folder / _MARK).exists():
        done, blocks = np.asarray(_array(group, "done")[:]).sum(), _array(group, "done").shape[0]
        raise OutputError(
            f"{folder}: {done} of {blocks} blocks are there; crankmbs sweep with --resume goes on"
        )
    with xr.open_zarr(folder, chunks=None, consolidated=True, decode_cf=False) as stored:
        data = stored.drop_vars("done").load()
    for one in data.variables.values():
        one.attrs.pop("_FillValue", None)
    names, shape = data.attrs.pop("knobs"), data.attrs.pop("grid")
    data = data.set_coords(names)
    return data if shape is None else _over_grid(data, names, tuple(shape))


def _over_grid(data: xr.Dataset, names: list[str], shape: tuple[int, ...]) -> xr.Dataset:
    """Cases one after the other, laid out over what was varied."""
    import xarray as xr

    def laid(one: xr.DataArray) -> Any:
        values = one.values.reshape(*shape, *one.shape[1:])
        return (*names, *one.dims[1:]), values, one.attrs

    variables = {name: laid(one) for name, one in data.data_vars.items()}
    others = {name: one for name, one in data.coords.items() if name not in names}
    for k, name in enumerate(names):
        along = tuple(slice(None) if k == j else 0 for j in range(len(shape)))
        levels = data[name].values.reshape(shape)[along]
        others[name] = xr.DataArray(levels, dims=name, attrs=data[name].attrs)
    return xr.Dataset(variables, others, data.attrs)


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
    group.attrs.update(
        {
            "title": plan.scene.title,
            "identity": {**plan.identity},
            "knobs": list(plan.cases.names),
            "grid": None if plan.cases.shape is None else list(plan.cases.shape),
        }
    )
    dims = dims_of(plan.scene, series=plan.series)
    for name, at in dims.items():
        _known(group, name, np.array(at, dtype=object if name in _TEXTS else "i4"), (name,), "")
    units = {knob.name: knob.units for knob in plan.cases.knobs}
    for name, labels in plan.cases.labels().items():
        _known(group, name, labels, ("case",), units[name])
    for name, column in columns_of(plan.scene, series=plan.series).items():
        sizes = tuple(len(dims[dim]) for dim in column.dims)
        _column(group, name, column, (count, *sizes), size)
    for name, kind, nothing in (("status", "i1", _NOT_RUN), ("message", str, "")):
        made = group.create_array(
            name, shape=(count,), chunks=(size,), dtype=kind, fill_value=nothing
        )
        made.attrs.update({_DIMS: ["case"]})
    _array(group, "status").attrs.update({"long_name": _STATUS})
    marks = group.create_array("done", shape=(plan.blocks,), chunks=(1,), dtype="i1", fill_value=0)
    marks.attrs.update({_DIMS: ["block"]})


_TEXTS = ("lecture", "quantity")


def _known(group: zarr.Group, name: str, values: Array, dims: tuple[str, ...], units: str) -> None:
    """What is known before a case is run."""
    kind: Any = str if values.dtype == object else values.dtype
    made = group.create_array(name, shape=values.shape, chunks=values.shape, dtype=kind)
    made.attrs.update({_DIMS: list(dims), **({"units": units} if units else {})})
    made[:] = values


def _column(
    group: zarr.Group, name: str, column: Column, shape: tuple[int, ...], size: int
) -> None:
    made = group.create_array(
        name, shape=shape, chunks=(size, *shape[1:]), dtype="f8", fill_value=np.nan
    )
    labels = {"units": column.units, "long_name": column.long_name}
    made.attrs.update({_DIMS: ["case", *column.dims], **labels})


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
