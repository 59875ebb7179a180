"""Datasets to netCDF and back; no file is handed to HDF5 to write, and none is believed."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from crankmbs.numerics.arrays import Labelled

if TYPE_CHECKING:
    import h5py
    import xarray as xr

__all__ = ["read_netcdf", "write_netcdf"]

_NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable"


def write_netcdf(variables: Labelled, file: Path, **attrs: str) -> None:
    """Write variables as netCDF-4.

    It is built in memory: where a disk is full, HDF5 fails once more when the process ends, and
    ends it with a segmentation fault.

    Raises
    ------
    OSError : the file cannot be written
    """
    import h5netcdf

    built = io.BytesIO()
    with h5netcdf.File(built, "w") as opened:
        for dims, values, _ in variables.values():
            for name, size in zip(dims, values.shape, strict=True):
                if name not in opened.dimensions:
                    opened.dimensions[name] = size
        for name, (dims, values, about) in variables.items():
            opened.create_variable(name, dims, data=values).attrs.update(about)
        opened.attrs.update(attrs)
    with file.open("wb") as stream:
        stream.write(built.getbuffer())


def read_netcdf(file: Path, dims: Mapping[str, tuple[str, ...]]) -> xr.Dataset:
    """Read a dataset that `write_netcdf` wrote, all of it; nothing else is opened.

    dims : variable -> dimensions, of those that may be there

    Raises
    ------
    ValueError : it holds links, or less than it promises, or one of these as no floats
    OSError, LookupError, RuntimeError, TypeError : HDF5 cannot make sense of it
    """
    import h5py
    import xarray as xr

    with h5py.File(file) as raw:
        _check_plain(raw, file.stat().st_size)
    with xr.open_dataset(
        file, engine="h5netcdf", decode_times=False, phony_dims="access"
    ) as opened:
        data = opened.load()
    for name, names in dims.items():
        if name in data.variables and (data[name].dims != names or data[name].dtype.kind != "f"):
            raise ValueError(f"{name} is no variable over {names}")
    return data


def _check_plain(raw: h5py.File, size: int) -> None:
    """Numbers alone, in this file and as many as it promises: a header of a few bytes can ask for
    any memory."""
    import h5py

    promised = 0
    for name in raw:
        plain = isinstance(raw.get(name, getlink=True), h5py.HardLink)
        dataset = raw[name] if plain else None
        if not isinstance(dataset, h5py.Dataset) or dataset.external or dataset.is_virtual:
            raise ValueError(f"{name} lies elsewhere")
        if dataset.dtype.kind not in "fi":
            raise ValueError(f"{name} has no numbers")
        if bytes(dataset.attrs.get("NAME", b"")).startswith(_NO_VARIABLE):
            continue  # the length of a dimension, which is never read
        promised += math.prod(dataset.shape or ()) * dataset.dtype.itemsize
    if promised > size:
        raise ValueError(f"{promised} bytes promised, {size} there")
