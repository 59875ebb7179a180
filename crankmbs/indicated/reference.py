"""What a pressure is measured from, and how a signal without a reference gets one.

A transducer of charge gives changes of pressure. Its zero comes from the inlet, where near the
bottom dead centre the cylinder has the pressure of the manifold, or from the compression, which is
nearly a polytrope: p + c = C V^-n is linear in c and C for a given n. Both are described by
A. L. Randolph, Methods of Processing Cylinder-Pressure Transducer Signals to Maximize Data Accuracy
(SAE 900170, 1990), and by M. F. J. Brunt and C. R. Pond, Evaluation of Techniques for Absolute
Cylinder Pressure Correction (SAE 970036, 1997).
"""

from __future__ import annotations

import numpy as np

from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array

__all__ = ["EXPONENTS", "at_inlet", "by_inlet", "by_polytrope", "offset_range"]

EXPONENTS = (1.28, 1.40)  # of the compression of air and mixture in engines
_COMPRESSION = (-100.0, -40.0)  # degrees from the firing dead centre
_INLET = 10.0  # degrees about the bottom dead centre


def by_polytrope(phi: Array, pressure: Array, shape: Shape, exponent: float) -> Array:
    """What is to be added to each cycle so that its compression is a polytrope.

    c of least squares in p + c = C V^-n, from 100 to 40 degrees before the firing dead centre

    Parameters
    ----------
    phi : shape (n,) [deg] from the firing dead centre; pressure : shape (cycles, n) [Pa]
    shape : with its compression ratio; exponent : n [1]

    Returns
    -------
    shape (cycles,) [Pa]; an exponent too high by 0.01 adds some percent of the pressure at the
    beginning of the compression
    """
    window = (phi >= _COMPRESSION[0]) & (phi <= _COMPRESSION[1])
    basis = shape.volume(np.radians(phi[window])) ** -exponent
    columns = np.column_stack([np.full_like(basis, -1.0), basis])
    solved, *_ = np.linalg.lstsq(columns, pressure[:, window].T, rcond=None)
    return np.asarray(solved[0])


def by_inlet(phi: Array, pressure: Array, period: float, inlet: float | Array) -> Array:
    """What is to be added to each cycle so that it has the inlet's pressure where its compression
    begins: on average within 10 degrees of the bottom dead centre.

    inlet : [Pa], or shape (cycles,)

    Returns
    -------
    shape (cycles,) [Pa]
    """
    return np.asarray(inlet - np.mean(pressure[:, at_inlet(phi, period)], axis=1))


def at_inlet(phi: Array, period: float) -> np.ndarray:
    """The rows near the bottom dead centre before the compression."""
    bottom = -180.0 if period > 400.0 else 180.0
    beside = np.abs(np.mod(phi - bottom + 180.0, 360.0) - 180.0)
    before = phi < 0.0 if period > 400.0 else np.full(phi.shape, True)
    return (beside <= _INLET) & before


def offset_range(phi: Array, mean: Array, shape: Shape) -> tuple[float, float]:
    """Least and largest offset [Pa] with which the compression is a polytrope of 1.28 to 1.40."""
    ends = [float(by_polytrope(phi, mean[None], shape, n)[0]) for n in EXPONENTS]
    return min(ends), max(ends)
