"""SciPy's DOP853 for single steps, each of which begins anew."""

from __future__ import annotations

import numpy as np
from scipy.integrate import DOP853

from crankmbs.numerics.arrays import Array

__all__ = ["StepByStep"]


class StepByStep(DOP853):
    """Its tolerances hold for all steps, and its equation may be another one in each.

    >>> solver = StepByStep(lambda t, y: np.ones(1), 0.0, [0.0], 0.5, first_step=0.5)
    >>> solver.step()
    >>> solver.again(0.25, np.ones(1))
    >>> solver.step()
    >>> float(solver.t), round(float(solver.y[0]), 12)
    (0.25, 0.25)
    """

    def again(self, width: float, slopes: Array) -> None:
        """Set back to time 0, with nothing gained: as it was made, for a step of ``width`` [s].

        slopes : of the equation there, shape (n,)
        """
        self.t, self.y, self.f = 0.0, np.zeros(self.n), slopes
        self.t_bound = self.max_step = self.h_abs = width
        self.status, self.nfev = "running", 1
