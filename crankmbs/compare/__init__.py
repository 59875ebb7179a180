"""A run against the exact closed form, the lectures' formulas, the user's and exudyn's rigid
bodies; and the error budget of formulas.

The formulas themselves belong in lecture and mechanics, the measures of a run in measures.
"""

from crankmbs.compare.against import Comparison, Deviation, compare
from crankmbs.compare.at import AtAngle, Reading, at_angle
from crankmbs.compare.causes import budget
from crankmbs.compare.chain import CAUSES, REST, checked_chain
from crankmbs.compare.excerpt import Excerpt, LeftOut, check_comparable
from crankmbs.compare.files import save_budget, save_budget_peaks, save_comparison, save_numbers
from crankmbs.compare.formula import CLOSED_FORM, Formula, formulas_of
from crankmbs.compare.largest import largest_deviations
from crankmbs.compare.lectured import LECTURES, short_name
from crankmbs.compare.numbers import NUMBERS, Number
from crankmbs.compare.quantities import OBSERVABLES, QUANTITIES, Quantity
from crankmbs.compare.size import Size, percent
from crankmbs.compare.split import Budget, Cause, Split
from crankmbs.compare.words import WORDS, Word

__all__ = [
    "CAUSES",
    "CLOSED_FORM",
    "LECTURES",
    "NUMBERS",
    "OBSERVABLES",
    "QUANTITIES",
    "REST",
    "WORDS",
    "AtAngle",
    "Budget",
    "Cause",
    "Comparison",
    "Deviation",
    "Excerpt",
    "Formula",
    "LeftOut",
    "Number",
    "Quantity",
    "Reading",
    "Size",
    "Split",
    "Word",
    "at_angle",
    "budget",
    "check_comparable",
    "checked_chain",
    "compare",
    "formulas_of",
    "largest_deviations",
    "percent",
    "save_budget",
    "save_budget_peaks",
    "save_comparison",
    "save_numbers",
    "short_name",
]
