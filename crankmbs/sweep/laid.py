"""The columns of a store as xarray reads them: over what was varied, and not before they are asked
for."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
import xarray as xr
import zarr
from xarray.backends import BackendArray, BackendEntrypoint
from xarray.core import indexing

from crankmbs.numerics.arrays import Array

__all__ = ["SweepStore"]


class SweepStore(BackendEntrypoint):
    """The engine with which xarray opens the folder of a sweep."""

    open_dataset_parameters = ("filename_or_obj", "drop_variables")

    def open_dataset(self, filename_or_obj: Any, *, drop_variables: Any = None) -> xr.Dataset:
        """Its measures over the knobs of a grid, or over the cases of a sample or a list."""
        group = zarr.open_group(
            str(filename_or_obj), mode="r", zarr_format=2, use_consolidated=True
        )
        about = dict(group.attrs)
        names: Any = about.pop("knobs")
        shape: Any = about.pop("grid")
        over = (names, tuple(shape)) if shape else (["case"], None)
        found = {name: _variable(one, *over) for name, one in sorted(group.arrays())}
        for name in {"done", *(drop_variables or ())}:
            found.pop(name, None)
        data = xr.Dataset(found, attrs=about).set_coords(names)
        return _by_levels(data, names) if shape else data


def _variable(column: Any, dims: list[str], grid: tuple[int, ...] | None) -> xr.Variable:
    about = dict(column.attrs)
    own: Any = about.pop("_ARRAY_DIMENSIONS")
    if own[0] != "case":
        return xr.Variable(own, _objects(column[:]), about)
    laid = _Laid(column, grid or (column.shape[0],))
    return xr.Variable([*dims, *own[1:]], indexing.LazilyIndexedArray(laid), about)


def _by_levels(data: xr.Dataset, names: list[str]) -> xr.Dataset:
    """Each knob of a grid over itself alone: it is the same in all other cases."""
    levels = {
        name: (name, data[name][{other: 0 for other in names if other != name}].values)
        for name in names
    }
    about = {name: data[name].attrs for name in names}
    data = data.drop_vars(names).assign_coords(levels)
    for name in names:
        data[name].attrs.update(about[name])
    return data


class _Laid(BackendArray):
    """A column whose cases, one after the other in the store, lie over a grid.

    column : of zarr, shape (cases, ...); grid : a shape with as many cases
    """

    def __init__(self, column: Any, grid: tuple[int, ...]) -> None:
        self._column, self._grid = column, grid
        self.shape = (*grid, *column.shape[1:])
        self.dtype = np.dtype(object) if column.dtype.kind == "T" else column.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.BASIC, self._read
        )

    def _read(self, key: tuple[int | slice, ...]) -> Array:
        count = len(self._grid)
        places = [np.arange(n)[k] for n, k in zip(self._grid, key[:count], strict=True)]
        shape = tuple(n for place in places for n in place.shape)
        if prod(shape) == prod(self._grid):
            values = self._column[:]
        else:
            rows = np.ravel_multi_index(np.ix_(*map(np.atleast_1d, places)), self._grid).ravel()
            values = self._column.oindex[rows] if rows.size else self._column[:0]
        laid = _objects(values).reshape(*shape, *self._column.shape[1:])
        rest = (slice(None),) * len(shape)
        return np.asarray(laid[(*rest, *key[count:])])


def _objects(values: Array) -> Array:
    """Texts as xarray has them, which knows none of NumPy's own type for them."""
    return values.astype(object) if values.dtype.kind == "T" else values
