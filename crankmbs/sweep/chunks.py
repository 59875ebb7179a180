"""A block of a column written as a chunk of Zarr's format 2, byte by byte what Zarr would write.

Zarr's own way to a chunk takes a millisecond, as long as a case takes that is computed in a batch.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import zarr

    from crankmbs.numerics.arrays import Array

__all__ = ["Chunks"]


class Chunks:
    """The chunks of one array whose blocks are its chunks, whole along every other dimension."""

    def __init__(self, folder: Path, array: zarr.Array[Any]) -> None:
        of_text = array.dtype.kind == "T"
        self._folder, self._dtype = folder, np.dtype(object) if of_text else array.dtype
        self._nothing = np.full(array.chunks, array.fill_value, dtype=self._dtype)
        self._codecs: list[Any] = [*array.filters, *array.compressors]
        self._tail = ".0" * (array.ndim - 1)

    def write(self, number: int, values: Array) -> None:
        """Write a block; as with Zarr one of fill values alone is no file.

        Raises
        ------
        OSError : the device is full, or the folder cannot be written
        """
        chunk: Any = self._nothing.copy()
        chunk[: len(values)] = values
        if np.array_equal(chunk, self._nothing, equal_nan=self._dtype.kind == "f"):
            return
        for codec in self._codecs:
            chunk = codec.encode(chunk)
        (self._folder / f"{number}{self._tail}").write_bytes(chunk)
