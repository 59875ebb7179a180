"""Many scenes that differ in some of their numbers: what is varied, where it is computed, the store
that holds what comes out.

What one scene amounts to belongs in measures and compare.
"""

from crankmbs.sweep.indices import SobolIndices, sobol_indices
from crankmbs.sweep.minimize import Minimum, minimize
from crankmbs.sweep.run import sweep
from crankmbs.sweep.sample import Sample
from crankmbs.sweep.sensitivity import Sensitivity, sensitivity
from crankmbs.sweep.solve import Solved, solve
from crankmbs.sweep.store import load_sweep

__all__ = [
    "Minimum",
    "Sample",
    "Sensitivity",
    "SobolIndices",
    "Solved",
    "load_sweep",
    "minimize",
    "sensitivity",
    "sobol_indices",
    "solve",
    "sweep",
]
