"""Coefficients of the method of order 8 of Dormand and Prince, SciPy's.

12 stages, the slope at the end, 3 more stages for the interpolant of order 7.
A : shape (16, 16); C : shape (16,); E3, E5 : shape (13,), errors of order 3 and 5; D : shape
(4, 16), the interpolant. Constants of what the `stepper` compiles, not arguments.
"""

import numpy as np
from scipy.integrate import DOP853

__all__ = ["E3", "E5", "A", "C", "D"]

A, C = np.zeros((16, 16)), np.ones(16)
A[:12, :12], A[12, :12], A[13:] = DOP853.A, DOP853.B, DOP853.A_EXTRA
C[:12], C[13:] = DOP853.C, DOP853.C_EXTRA
E3, E5, D = DOP853.E3.copy(), DOP853.E5.copy(), DOP853.D.copy()
