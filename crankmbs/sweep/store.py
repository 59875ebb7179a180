"""The store of a sweep: a folder in Zarr's format, written by xarray block by block.

The measures that have the same dimensions are one array, over what is varied and the measure; a
block is a chunk of every array. The status of its cases is written last, and the summary of all
metadata behind the last block: a store that has it is complete.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
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

__all__ = ["Store", "load_sweep", "opened", "read_store", "unfinished"]

_COMPLETE = ".zmetadata"
_LABELS = ("units", "long_name")
_NOT_RUN = -128
_FORMAT: Any = {"zarr_format": 2, "consolidated": False}
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

    def __init__(self, path: Path, plan: Plan) -> None:
        self._path, self._dims, self._of = path, plan.cases.dims, _measures(plan)
        there = read_store(path)
        self.done = int(np.count_nonzero(there["status"] != _NOT_RUN))
        blocks = zip(plan.boxes, _finished(there).flat, strict=True)
        self.missing = [box for box, finished in blocks if not finished]

    def write(self, box: Box, block: Block) -> None:
        """Write a block, its status last.

        Raises
        ------
        OutputError : the device is full, or the folder cannot be written
        """
        import xarray as xr

        sizes = [part.stop - part.start for part in box]

        def at(of_cases: NDArray[Any], over: Iterable[str] = ()) -> xr.Variable:
            return xr.Variable((*self._dims, *over), of_cases.reshape(*sizes, *of_cases.shape[1:]))

        values = {
            name: at(np.stack([block[column] for column in columns], axis=1), _over(name, columns))
            for name, columns in self._of.items()
        }
        region = dict(zip(self._dims, box, strict=True))
        with _writing(self._path):
            for part in (
                values | {"message": at(block["message"])},
                {"status": at(block["status"])},
            ):
                xr.Dataset(part).to_zarr(self._path, region=region, **_FORMAT)


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

    new = not any(path.glob("[!.]*"))  # a killed start may have left a group without words
    if not new:
        _check_resumable(path, plan)
    try:
        with _writing(path):
            if new or not _finished(read_store(path)).any():
                _lay_out(path, plan)
            for half in path.rglob("*.partial"):  # of a write that was killed
                half.unlink()
        yield Store(path, plan)
        with _writing(path):
            zarr.consolidate_metadata(str(path), zarr_format=2)
    except BaseException:
        if not any(path.glob("status/[0-9]*")):
            shutil.rmtree(path, ignore_errors=True)
        raise


def unfinished(path: Path) -> bool:
    """Whether there is the beginning of a sweep, which can be resumed."""
    return (path / ".zattrs").exists() and not (path / _COMPLETE).exists()


def read_store(path: Path) -> xr.Dataset:
    """The arrays of a store, each read from the folder when it is used.

    Raises
    ------
    OutputError : no sweep
    """
    import xarray as xr

    if not path.exists():
        raise OutputError(f"{path}: no such sweep; crankmbs sweep writes one")
    try:
        data = xr.open_dataset(
            path, engine="zarr", consolidated=False, mask_and_scale=False, decode_times=False
        )
        data.attrs["identity"]
    except (OSError, LookupError, TypeError, ValueError):
        raise OutputError(f"{path}: no sweep of crankmbs; give the folder of one") from None
    return data


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
    data = read_store(folder)
    if not (folder / _COMPLETE).exists():
        done = _finished(data)
        raise OutputError(
            f"{folder}: {done.sum()} of {done.size} blocks are finished; crankmbs sweep --resume "
            "computes the others"
        )
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
    theirs: Any = read_store(path).attrs["identity"]
    unlike = [words for name, words in _OTHER.items() if theirs.get(name) != (ours[name] or None)]
    if unlike:
        raise InputError(f"{path}: holds a sweep {' and '.join(unlike)}; give another folder")
    if (path / _COMPLETE).exists():
        raise InputError(f"{path}: this sweep is complete; give another folder to compute it anew")


def _finished(store: xr.Dataset) -> NDArray[np.bool_]:
    """Whether each block is there, by the status of its first case."""
    if "status" not in store:  # which is laid out last
        return np.zeros(0, dtype=bool)
    status = store["status"]
    first = tuple(slice(None, None, length) for length in status.encoding["chunks"])
    return np.asarray(status.values[first] != _NOT_RUN)


def _measures(plan: Plan) -> dict[str, dict[str, Column]]:
    """The arrays of measures by name, and the columns in each."""
    arrays: dict[str, dict[str, Column]] = {}
    for name, column in columns_of(plan.scene, series=plan.series).items():
        arrays.setdefault("_".join((*column.dims, "measures")), {})[name] = column
    return arrays


def _over(name: str, columns: dict[str, Column]) -> dict[str, Sequence[object]]:
    """The dimensions of an array of measures beyond the case, with their labels."""
    one, *_ = columns.values()
    return {name.removesuffix("s"): list(columns), **one.dims}


def _lay_out(path: Path, plan: Plan) -> None:
    """Say what the store is of, and write all that is known before a case is run; the arrays hold
    one value that stands everywhere, which takes no memory and no file."""
    import xarray as xr

    cases = plan.cases
    data = xr.Dataset(attrs={"title": plan.scene.title, "identity": plan.identity})
    for knob in cases.knobs:
        dims = [knob.name] if cases.grid else cases.dims
        data.coords[knob.name] = (dims, knob.labels, {"units": knob.units})

    def add(name: str, over: Mapping[str, Sequence[object]], nothing: Any, about: object) -> None:
        sizes = tuple(map(len, over.values()))
        empty = np.broadcast_to(nothing, (*cases.shape, *sizes))
        encoding = {"chunks": (*plan.chunks, *sizes), "_FillValue": nothing}
        data.coords.update(over)
        data[name] = xr.Variable((*cases.dims, *over), empty, about, encoding)

    for name, columns in _measures(plan).items():
        about = {label: [getattr(each, label) for each in columns.values()] for label in _LABELS}
        add(name, _over(name, columns), np.nan, about)
    add("message", {}, np.array("", dtype=object), {})
    add("status", {}, np.int8(_NOT_RUN), {"long_name": _STATUS})
    data.to_zarr(path, mode="w", write_empty_chunks=False, **_FORMAT)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written ({error.strerror or error}); choose another folder"
        ) from None
