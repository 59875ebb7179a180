"""Simulation against exact and against lecture formula, the error budget of the latter, and two
runs of one scene beside each other.

The formulas themselves belong in lecture and mechanics, what a run amounts to in measures.
"""

from crankmbs.compare.against import CLOSED_FORM, Comparison, Deviation, compare
from crankmbs.compare.at import AtAngle, Reading, at_angle
from crankmbs.compare.causes import CAUSES, Budget, Cause, Split, budget
from crankmbs.compare.excerpt import Excerpt, LeftOut, check_cylinder
from crankmbs.compare.files import save_budget, save_budget_peaks, save_comparison
from crankmbs.compare.lectured import LECTURES
from crankmbs.compare.quantities import QUANTITIES, Quantity
from crankmbs.compare.size import Size, percent

__all__ = [
    "CAUSES",
    "CLOSED_FORM",
    "LECTURES",
    "QUANTITIES",
    "AtAngle",
    "Budget",
    "Cause",
    "Comparison",
    "Deviation",
    "Excerpt",
    "LeftOut",
    "Quantity",
    "Reading",
    "Size",
    "Split",
    "at_angle",
    "budget",
    "check_cylinder",
    "compare",
    "percent",
    "save_budget",
    "save_budget_peaks",
    "save_comparison",
]
