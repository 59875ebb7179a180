"""The store of a sweep: a folder in Zarr's format, written block by block.

The measures that have the same dimensions are one array, over what is varied and the measure; a
block is a chunk of every array. The status of its cases is written last, and the summary of all
metadata behind the last block: a store that has it is complete.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crankmbs.errors import InputError, OutputError
from crankmbs.sweep.block import Block
from crankmbs.sweep.columns import Column, columns_of
from crankmbs.sweep.plan import Box, Plan

if TYPE_CHECKING:
    import xarray as xr
    import zarr

__all__ = ["Store", "load_sweep", "opened", "read_group", "unfinished"]

_COMPLETE = ".zmetadata"
_LABELS = ("units", "long_name")
_NOT_RUN = -128
_STATUS = (
    "0 reached its end, 1 ended before it, -1 broke off, 2 a scene that cannot be built, -2 ended "
    "its worker"
)
_OTHER = {
    "version": "by another version of crankmbs",
    "scene": "of another scene",
    "functions": "with functions in Python that are others, or cannot be told from others",
    "cases": "of other cases",
    "keep": "that stores other things",
}


class Store:
    """A store open for writing.

    done : how many cases are there; missing : the boxes of the blocks that are not
    """

    def __init__(self, path: Path, plan: Plan, group: zarr.Group) -> None:
        self._path, self._of = path, _measures(plan)
        self._arrays: dict[str, Any] = dict(group.arrays())
        self.done = int(np.count_nonzero(self._arrays["status"][:] != _NOT_RUN))
        blocks = zip(plan.boxes, _finished(group).flat, strict=True)
        self.missing = [box for box, finished in blocks if not finished]

    def write(self, box: Box, block: Block) -> None:
        """Write a block, its status last.

        Raises
        ------
        OutputError : the device is full, or the folder cannot be written
        """
        values = {
            name: np.stack([block[column] for column in columns], axis=1)
            for name, columns in self._of.items()
        }
        values |= {name: block[name] for name in ("message", "status")}
        sizes = tuple(part.stop - part.start for part in box)
        with _writing(self._path):
            for name, of_cases in values.items():
                self._arrays[name][box] = of_cases.reshape(*sizes, *of_cases.shape[1:])


@contextmanager
def opened(path: Path, plan: Plan) -> Iterator[Store]:
    """The store of a plan for writing: a new one, or an unfinished one that is resumed. It is
    marked as complete behind what is done with it; where that raises, a store that has no finished
    block is removed.

    Raises
    ------
    InputError : a store of another scene, of other cases or by another version; a complete one
    OutputError : it cannot be written, or is no such store
    """
    import zarr

    new = not any(path.glob("[!.]*")) and not (path / ".zattrs").exists()
    if not new:
        _check_resumable(path, plan)
    try:
        with _writing(path):
            group = zarr.open_group(str(path), mode="a", zarr_format=2)
            if not _finished(group).any():
                _lay_out(group, plan)
            for half in path.rglob("*.partial"):  # of a write that was killed
                half.unlink()
        yield Store(path, plan, group)
        with _writing(path):
            zarr.consolidate_metadata(str(path), zarr_format=2)
    except BaseException:
        if not any(path.glob("status/[0-9]*")):
            shutil.rmtree(path, ignore_errors=True)
        raise


def unfinished(path: Path) -> bool:
    """Whether there is the beginning of a sweep, which can be resumed."""
    return (path / ".zattrs").exists() and not (path / _COMPLETE).exists()


def read_group(path: Path) -> zarr.Group:
    """The group of a store, to read.

    Raises
    ------
    OutputError : no sweep
    """
    import zarr

    if not path.exists():
        raise OutputError(f"{path}: no such sweep; crankmbs sweep writes one")
    try:
        group = zarr.open_group(str(path), mode="r", zarr_format=2)
        group.attrs["identity"]
    except (OSError, LookupError, TypeError, ValueError):
        raise OutputError(f"{path}: no sweep of crankmbs; give the folder of one") from None
    return group


def load_sweep(path: str | Path) -> xr.Dataset:
    """Read a sweep that is complete, labelled by what was varied.

    Returns
    -------
    Dataset : each column is read from the folder when it is used; of a grid over its knobs, such as
        ``crank.inertia``; of a sample or a list of cases over ``case``, with the knobs as
        coordinates. ``name_error`` is the error of ``name``, in its unit; ``status`` and
        ``message`` say how each case ended, and NaN stands for what a case has not

    Raises
    ------
    OutputError : no sweep, or an unfinished one

    >>> load_sweep("no.zarr")
    Traceback (most recent call last):
    crankmbs.errors.OutputError: no.zarr: no such sweep; crankmbs sweep writes one
    """
    import xarray as xr

    folder = Path(path)
    done = _finished(read_group(folder))
    if not (folder / _COMPLETE).exists():
        raise OutputError(
            f"{folder}: {done.sum()} of {done.size} blocks are finished; crankmbs sweep --resume "
            "computes the others"
        )
    data = xr.open_dataset(folder, engine="zarr", mask_and_scale=False, decode_times=False)
    for each in data.variables.values():
        each.attrs.pop("_FillValue", None)
    variables = {name: data[name] for name in ("message", "status")}
    for name in map(str, set(data).difference(variables)):
        array, over = data[name], name.removesuffix("s")
        for k, column in enumerate(data[over].values):
            variables[column] = array.isel({over: k}, drop=True)
            variables[column].attrs = {label: array.attrs[label][k] for label in _LABELS}
    return xr.Dataset(dict(sorted(variables.items())), attrs=data.attrs)


def _check_resumable(path: Path, plan: Plan) -> None:
    ours = plan.identity
    theirs: Any = read_group(path).attrs["identity"]
    unlike = [words for name, words in _OTHER.items() if theirs.get(name) != (ours[name] or None)]
    if unlike:
        raise InputError(f"{path}: holds a sweep {' and '.join(unlike)}; give another folder")
    if (path / _COMPLETE).exists():
        raise InputError(f"{path}: this sweep is complete; give another folder to compute it anew")


def _finished(group: zarr.Group) -> NDArray[np.bool_]:
    """Whether each block is there, by the status of its first case."""
    if "status" not in group:  # which is laid out last
        return np.zeros(0, dtype=bool)
    status: Any = group["status"]
    return np.asarray(status[:][tuple(slice(None, None, n) for n in status.chunks)] != _NOT_RUN)


def _measures(plan: Plan) -> dict[str, dict[str, Column]]:
    """The arrays of measures by name, and the columns in each."""
    arrays: dict[str, dict[str, Column]] = {}
    for name, column in columns_of(plan.scene, series=plan.series).items():
        arrays.setdefault("_".join((*column.dims, "measures")), {})[name] = column
    return arrays


def _lay_out(group: zarr.Group, plan: Plan) -> None:
    """Say what the store is of, then make all arrays, the status last; coordinates are known before
    a case is run."""
    about: Any = {"title": plan.scene.title, "identity": plan.identity}
    group.attrs.put(about | {"coordinates": " ".join(plan.cases.names)})
    cases, arrays, labels = plan.cases, _measures(plan), dict[str, Sequence[object]]()

    def add(name: str, over: Sequence[str], about: dict[str, Any], **array: Any) -> None:
        about = {"_ARRAY_DIMENSIONS": list(over), **about}  # by which xarray knows them
        group.create_array(name, attributes=about, overwrite=True, **array)

    def add_empty(
        name: str, dtype: Any, nothing: object, over: Sequence[str], about: dict[str, Any]
    ) -> None:
        sizes = tuple(len(labels[dim]) for dim in over)
        shape, chunks = (*cases.shape, *sizes), (*plan.chunks, *sizes)
        over = (*cases.dims, *over)
        add(name, over, about, shape=shape, chunks=chunks, dtype=dtype, fill_value=nothing)

    for knob in cases.knobs:
        over = [knob.name] if cases.grid else cases.dims
        add(knob.name, over, {"units": knob.units}, data=knob.labels, fill_value=None)
    for name, columns in arrays.items():
        one, *_ = columns.values()
        labels |= {name.removesuffix("s"): list(columns), **one.dims}
        about = {label: [getattr(each, label) for each in columns.values()] for label in _LABELS}
        add_empty(name, "f8", np.nan, (name.removesuffix("s"), *one.dims), about)
    for name, at in labels.items():
        dtype = np.dtypes.StringDType() if isinstance(at[0], str) else None
        add(name, [name], {}, data=np.array(at, dtype), fill_value=None)
    add_empty("message", str, "", (), {})
    add_empty("status", "i1", _NOT_RUN, (), {"long_name": _STATUS})


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written ({error.strerror or error}); choose another folder"
        ) from None
