"""S1's Table 3: masses of pistons and rods per piston area."""

from __future__ import annotations

from crankmbs import lecture
from validation import reference
from validation.case import Case
from validation.judge import Outcome

__all__ = ["table_3"]

_BOUNDS = ("min", "max")


def table_3(case: Case) -> Outcome:
    """Every printed mass against the table of the lectures, [g/cm^2], and the range of bores."""
    unit = case.number("kg_per_m2")
    apart: dict[str, float] = {}
    for row in reference.rows("s1_table3"):
        name, _, bore = row["engine_type"].partition(" ")
        ours = lecture.SPECIFIC_MASSES[name]
        for part in ("piston", "rod"):
            for bound, mass in zip(_BOUNDS, getattr(ours, part), strict=True):
                printed = float(row[f"{part}_mass_{bound}_g_per_cm2"])
                apart[f"{part} of the {name} engine"] = abs(mass / unit - printed)
        low, high = bore.removeprefix("D=").removesuffix(" mm").split("-")
        for bound, metres in zip((low, high), ours.bore, strict=True):
            apart[f"bore {bound} mm, {name}"] = abs(1e3 * metres - float(bound))
    worst = max(apart, key=lambda name: apart[name])
    return Outcome(apart[worst], f"{len(apart)} ranges and bores; the worst is {worst}")
