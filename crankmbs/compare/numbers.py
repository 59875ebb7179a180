"""Single numbers of a run that a formula may stand for, and what the formula gives for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from crankmbs.compare.size import percent
from crankmbs.measures import Estimate, Measures

__all__ = ["NUMBERS", "Number", "NumberOf"]


class NumberOf(NamedTuple):
    """units; estimate : read from measures, None where they lack it; lacking : why they may."""

    units: str
    estimate: Callable[[Measures, int], Estimate | None]
    lacking: str = ""
    per_cylinder: bool = False


def _imep(measures: Measures, cylinder: int) -> Estimate | None:
    return None if measures.imep is None else measures.imep[cylinder - 1]


NUMBERS = {
    "fluctuation": NumberOf("1", lambda m, _: m.fluctuation),
    "mean speed": NumberOf("rad/s", lambda m, _: m.mean_speed),
    "indicated power": NumberOf("W", lambda m, _: m.indicated_power, "the scene has no gas"),
    "imep": NumberOf("Pa", _imep, "there is no whole cycle with gas", per_cylinder=True),
}
"""As `crankmbs.Measures` has them."""


@dataclass(frozen=True)
class Number:
    """One number by a formula and by the run.

    value [units] : by the formula; simulated [units] : of the run, with its error
    """

    quantity: str
    reference: str
    value: float
    simulated: Estimate

    @property
    def units(self) -> str:
        """Of both."""
        return NUMBERS[self.quantity].units

    @property
    def error(self) -> float:
        """Formula minus run [units]."""
        return self.value - self.simulated.value

    @property
    def percent(self) -> float:
        """The error in percent of the run's value; NaN where that is 0."""
        return percent(self.error, abs(self.simulated.value))
