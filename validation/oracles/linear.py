"""Gaussian elimination for many small systems at once, in any arithmetic."""

import numpy as np

from validation.oracles.arithmetic import Array


def solve(matrix: Array, right: Array) -> Array:
    """Solutions of matrix z = right, shapes (samples, size, size) and (samples, size, columns).

    Rows are scaled to a largest entry of 1, then Gauss-Jordan with row pivoting. Only rows with an
    entry in the pivot's column change: of bodies that touch their neighbours alone, one in five.
    """
    size, columns = matrix.shape[-1], right.shape[-1]
    scale = np.abs(matrix).max(axis=2, keepdims=True)
    work = np.concatenate([matrix, right], axis=2) / scale
    sample = np.arange(len(work))
    for k in range(size):
        pivot = k + np.abs(work[:, k:, k]).argmax(axis=1)
        chosen = work[sample, pivot, k:].copy()
        work[sample, pivot, k:] = work[:, k, k:]
        chosen = chosen / chosen[:, :1]
        factor = work[:, :, k].copy()
        factor[:, k] = 0
        rows = np.flatnonzero(factor.any(axis=0))
        work[:, rows, k:] -= factor[:, rows, None] * chosen[:, None, :]
        work[:, k, k:] = chosen
    solution: Array = work[:, :, -columns:]
    return solution
