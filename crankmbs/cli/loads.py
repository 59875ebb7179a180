"""Bearing loads before and after a change of the machine, as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crankmbs.cli.text import cells, table

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
        row = [f"{joint} [N]"]
        for measures in (before, after):
            if measures is None:
                row += ["-", "-"]
                continue
            peaks = (j.peak for j in measures.joints if j.joint == joint)
            largest = max(peaks, key=lambda peak: peak.value)
            row += cells(largest)
        if largest.value > 0.0:
            rows.append(row)
    over = f"largest load over the {after.window.kind}"
    heading = [over, "before", "num. error", words, "num. error"]
    return table(heading, rows) if rows else ""
