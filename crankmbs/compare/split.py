"""An error budget: for every quantity the formula, the run and the causes of their difference."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crankmbs.compare.chain import CAUSES, REST
from crankmbs.compare.excerpt import Excerpt, LeftOut
from crankmbs.compare.lectured import LECTURES, row_of
from crankmbs.compare.size import Size, percent
from crankmbs.digits import digits
from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array
from crankmbs.scene.sentences import there_are

__all__ = ["Budget", "Cause", "Split"]

_NOTHING = 1e-12  # of the larger of formula and run: rounding, not a cause
_ABSENT = 1e-9  # of the formula's peak: a run's peak below it is rounding, no base for percents


@dataclass(frozen=True)
class Cause:
    """curve : shape (n,) [unit], what the cause adds to the formula's answer; size : of it;
    at_largest [unit] : where the formula's error is largest."""

    name: str
    curve: Array
    size: Size
    at_largest: float

    def __repr__(self) -> str:
        return f"<Cause {self.name!r}: {digits(self.size.largest)} at most, {_where(self)}>"


@dataclass(frozen=True)
class Split:
    """The error of one quantity, cause by cause.

    reference : the formula, as in `crankmbs.compare.Deviation`
    values, simulated : shape (n,) [unit], of formula and run; their difference is `total`, the sum
        of the causes
    peak [unit] : largest magnitude in the run; maxima are those of the curves between the samples,
        too, but for a formula of the user whose value at an angle depends on others
    """

    quantity: str
    reference: str
    values: Array
    simulated: Array
    causes: tuple[Cause, ...]
    total: Cause
    peak: float

    def __repr__(self) -> str:
        return f"<Split of the {self.sentence()}>"

    def cause(self, name: str) -> Cause:
        """One of the causes, as tables or files call it.

        Raises
        ------
        InputError : there is none of this name
        """
        for cause in self.causes:
            if name in (cause.name, self.heading(cause.name)):
                return cause
        known = there_are(name, [self.heading(cause.name) for cause in self.causes])
        raise InputError(f"no cause {shown(name)} here{known}")

    def share(self, cause: Cause) -> float:
        """The peak of a cause in percent of the run's; 0 where it is rounding, NaN where the
        run's is, beside the formula's."""
        formula_peak = float(np.max(np.abs(self.values)))
        if cause.size.largest <= _NOTHING * max(formula_peak, self.peak):
            return 0.0
        return percent(cause.size.largest, self.peak if self.peak > _ABSENT * formula_peak else 0.0)

    def sentence(self) -> str:
        """The largest error of the formula and of each of its causes, the largest first.

        The causes peak at different angles, so their peaks do not add up to that of the error.
        """
        total = self.share(self.total)
        subject = self.quantity if self.is_lecture else f"{self.quantity} by {self.reference}"
        if math.isnan(total):
            source = "lecture" if self.is_lecture else "formula"
            return f"{subject}: the run has none, the {source} has"
        if not total:
            return f"{subject}: right but for rounding"
        parts: list[str] = []
        for cause in sorted(self.causes, key=self.share, reverse=True):
            if self.share(cause) > 0.0:
                size = f"{_readable(self.share(cause))} %, {_where(cause)}"
                parts.append(f"{self.named(cause)} {'' if parts else 'costs up to '}{size}")
        if len(parts) < len(self.causes):
            parts.append("no other cause contributes")
        largest = f"off by up to {_readable(total)} % of the peak, {_where(self.total)}"
        return f"{subject}: {largest}: {'; '.join(parts)}"

    def at_largest(self) -> dict[str, float]:
        """What each cause adds where the error is largest, in percent of the run's peak, signed:
        together the error there.

        >>> split = budget(simulate(load_scene("yi_diesel"))).split("side thrust")
        >>> f"{split.at_largest()['two-mass rod']:.2f} of {sum(split.at_largest().values()):.2f} %"
        '-14.95 of -16.30 %'
        """
        return {cause.name: percent(cause.at_largest, self.peak) for cause in self.causes}

    def without(self, cause: Cause) -> float:
        """The largest error that is left without one cause, in percent of the run's peak."""
        return percent(float(np.max(np.abs(self.total.curve - cause.curve))), self.peak)

    @property
    def is_lecture(self) -> bool:
        """Whether the formula is the lectures'."""
        return self.reference in LECTURES

    def heading(self, name: str) -> str:
        """What a cause is called over a column: what a user's formula cuts off is its own."""
        return "formula" if name == "series" and not self.is_lecture else name

    def named(self, cause: Cause) -> str:
        """A cause in words, as they stand in a sentence."""
        if cause.name == "series" and not self.is_lecture:
            return "the formula itself"
        return "the rest" if cause.name == REST else CAUSES[cause.name]


@dataclass(frozen=True)
class Budget:
    """The errors of the lectures' formulas and of the user's, cause by cause; chain : the causes in
    their order; left_out : quantity, missing cause (or all) and reason."""

    excerpt: Excerpt
    chain: tuple[str, ...]
    splits: tuple[Split, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def ranked(self) -> tuple[Split, ...]:
        """The splits, the largest error in percent of its quantity's peak first."""
        return tuple(sorted(self.splits, key=lambda split: -(split.share(split.total) or 0.0)))

    def __repr__(self) -> str:
        largest = self.ranked[0].sentence() if self.splits else "nothing to split"
        return f"<Budget of {len(self.splits)} quantities; {largest}>"

    def _repr_html_(self) -> str:
        from crankmbs.report.html import budget_html

        return budget_html(self)

    def split(self, quantity: str, reference: str | None = None) -> Split:
        """The split of one quantity by the lectures' formulas, or by that of a label, which may be
        called as tables and figures do.

        Raises
        ------
        InputError : there is none
        """
        return row_of(self.splits, quantity, reference)


def _where(cause: Cause) -> str:
    return f"at {round(math.degrees(cause.size.angle), 1):g} degrees"


def _readable(share: float) -> str:
    return digits(share, most=3) if share >= 1e-3 else f"{share:.0e}"
