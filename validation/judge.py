"""Judging a claim: run its check, and call everything but a met tolerance red."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from validation.case import Case
from validation.reference import MissingReference

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Outcome", "Skipped", "Verdict", "judge"]


class Skipped(Exception):
    """The check cannot be made here; the message says why."""


@dataclass(frozen=True)
class Outcome:
    """What a check found.

    error : in the case's norm, to be at most its tolerance
    detail : one line with the numbers behind it
    table : lines of a Markdown table for the report; figures : by file name without suffix
    """

    error: float
    detail: str
    table: tuple[str, ...] = ()
    figures: Mapping[str, Figure] = field(default_factory=dict)


@dataclass(frozen=True)
class Verdict:
    """word : "holds", "fails", "skipped", "no reference" or "broken"; only the first is green."""

    case: Case
    word: str
    outcome: Outcome

    @property
    def green(self) -> bool:
        """Whether the claim holds."""
        return self.word == "holds"


def judge(case: Case) -> Verdict:
    """Run the check of a claim; an error in it makes the claim red, not the run."""
    try:
        outcome = _check_of(case)(case)
    except Skipped as reason:
        return Verdict(case, "skipped", Outcome(math.nan, str(reason)))
    except MissingReference as reason:
        return Verdict(case, "no reference", Outcome(math.nan, str(reason)))
    except Exception as error:
        return Verdict(case, "broken", Outcome(math.nan, f"{type(error).__name__}: {error}"))
    return Verdict(case, "holds" if outcome.error <= case.tolerance else "fails", outcome)


def _check_of(case: Case) -> Callable[[Case], Outcome]:
    module, _, function = case.check.partition(".")
    found: Callable[[Case], Outcome] = getattr(
        importlib.import_module(f"validation.checks.{module}"), function
    )
    return found
