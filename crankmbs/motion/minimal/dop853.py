"""Coefficients of two methods of Dormand and Prince, SciPy's, in one table of stages.

Order 8: 12 stages, the slope at the end, and 3 more for the interpolant of order 7. Order 5, for
short steps: the first stage, then five of its own and the slope at the end, rows 16 to 21.
A : shape (22, 22); C : shape (22,); E3, E5 : shape (13,), errors of order 3 and 5; D : shape
(4, 16), the interpolant; E4, D4 : shape (22,), error of the short step and the last coefficient of
its interpolant of order 4. Constants of what the `stepper` compiles, not arguments.
"""

import numpy as np
from scipy.integrate import DOP853, RK45

__all__ = ["D4", "E3", "E4", "E5", "A", "C", "D"]

_OWN = [0, *range(16, 22)]  # stages of order 5

A, C, E4, D4 = np.zeros((22, 22)), np.ones(22), np.zeros(22), np.zeros(22)
A[:12, :12], A[12, :12], A[13:16, :16] = DOP853.A, DOP853.B, DOP853.A_EXTRA
C[:12], C[13:16] = DOP853.C, DOP853.C_EXTRA
E3, E5, D = DOP853.E3.copy(), DOP853.E5.copy(), DOP853.D.copy()
A[np.ix_(_OWN[1:6], _OWN[:5])], A[21, _OWN[:6]] = RK45.A[1:], RK45.B
C[16:21], E4[_OWN], D4[_OWN] = RK45.C[1:], RK45.E, RK45.P[:, 3]
