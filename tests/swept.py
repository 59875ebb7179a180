"""Blocks of a sweep without a run."""

import numpy as np

from crankmbs.sweep.block import Block
from crankmbs.sweep.columns import columns_of, dims_of


def block_of(job, **given):
    """A block of cases that reached their end, with these columns; all others are NaN."""
    count = len(job.values)
    sizes = {dim: len(at) for dim, at in dims_of(job.scene, series=False).items()}
    rows = {
        name: np.full((count, *(sizes[dim] for dim in column.dims)), np.nan)
        for name, column in columns_of(job.scene, series=False).items()
    }
    return Block(rows | given, np.zeros(count, np.int8), ("reached its end",) * count)
