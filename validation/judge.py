"""Judging a claim: run its check, and call everything but a met tolerance red."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from validation.case import Case
from validation.reference import MissingReference

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["SEEN", "Outcome", "Skipped", "Verdict", "judge", "seen"]

SEEN = "seen"


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
    """What became of a claim.

    word : "holds", "fails", "skipped", "no reference" or "broken"
    mutant : what `seen` says of its shifted parameter; "" where that was not tried
    """

    case: Case
    word: str
    outcome: Outcome
    mutant: str = ""

    @property
    def green(self) -> bool:
        """Whether the claim holds, and would not with its shifted parameter."""
        return self.word == "holds" and self.mutant in ("", SEEN)


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


def seen(case: Case) -> str:
    """Whether the shifted parameter of a claim turns it red, and a shorter run alone does not:
    `SEEN`, or what came instead."""
    shifted = judge(replace(case, mutated=True, shortened=True))
    if shifted.word != "fails":
        return f"{shifted.word} under {case.mutant.parameter} shifted: {shifted.outcome.detail}"
    if case.mutant.until is not None:
        shorter = judge(replace(case, shortened=True))
        if shorter.word != "holds":
            return f"{shorter.word} shortened alone: {shorter.outcome.detail}"
    return SEEN


def _check_of(case: Case) -> Callable[[Case], Outcome]:
    module, _, function = case.check.partition(".")
    found: Callable[[Case], Outcome] = getattr(
        importlib.import_module(f"validation.checks.{module}"), function
    )
    return found
