"""The lectures behind the formulas, by their titles."""

from __future__ import annotations

import re

__all__ = ["TITLES", "sources_in"]

TITLES = {
    "S0": (
        "Grega",
        "R. Grega: Automobile Design, part 5L, Kinematics and dynamics of crank mechanism. "
        "Lecture, Technical University of Košice.",
    ),
    "S1": (
        "Yi, Win, Htay",
        "M. M. Yi, S. Y. Win, T. T. Htay: Kinematic Analysis of Crank Shaft for Diesel Engine. "
        "Technological University Thanlyin.",
    ),
    "S2": (
        "Kholbekov, Amonov, Omanov",
        "T. K. Kholbekov, C. E. Amonov, E. N. Omanov: Kinematics of KShM of Internal Combustion "
        "Engines. Termez.",
    ),
}
"""By their key in the validation's bibliography: short, and in full."""

_KEY = re.compile(r"\b(S[012])\b(?: (Eq\. \d+(?:(?:,| to| =) \d+)*))?")


def sources_in(text: str) -> str:
    """The sources that a docstring names by their keys, in words; equations that have numbers.

    >>> sources_in("Source: S0-F28, S1 Eq. 25 before its truncation.")
    'Grega; Yi, Win, Htay, Eq. 25'
    """
    equations_of: dict[str, list[str]] = {}
    for key, equations in _KEY.findall(text):
        equations_of.setdefault(key, [])
        if equations:
            equations_of[key].append(equations)
    return "; ".join(", ".join([TITLES[key][0], *where]) for key, where in equations_of.items())
