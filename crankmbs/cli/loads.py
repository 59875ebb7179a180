"""Bearing loads before and after a change of the machine, as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crankmbs.cli.text import table
from crankmbs.digits import digits, error_digits

if TYPE_CHECKING:
    from crankmbs.measures import Measures

__all__ = ["loads_table"]


def loads_table(before: Measures | None, after: Measures, words: str) -> str:
    """The largest peak of every kind of joint that bears a load; dashes where there is no motion
    before; empty where there is no load.

    words : what is changed, as a heading
    """
    rows = []
    for joint in dict.fromkeys(force.joint for force in after.joints):
        cells: list[str] = []
        for measures in (before, after):
            if measures is None:
                cells += ["-", "-"]
                continue
            largest = max(
                (j for j in measures.joints if j.joint == joint), key=lambda j: j.peak.value
            )
            cells += [digits(*largest.peak), error_digits(largest.peak.error)]
        if any(j.peak.value > 0.0 for j in after.joints if j.joint == joint):
            rows.append([f"{joint} [N]", *cells])
    over = f"largest load over the {after.window.kind}"
    heading = [over, "before", "num. error", words, "num. error"]
    return table(heading, rows) if rows else ""
