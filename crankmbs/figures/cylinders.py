"""Whose curve is which: cylinders whose curves cannot be told apart are drawn as one."""

from __future__ import annotations

import numpy as np

from crankmbs.figures.style import FLAT
from crankmbs.numerics.arrays import Array

__all__ = ["one_curve_each", "whose"]

_APART = 1e-3  # of the range of a panel's curves: less than a pixel of the panel, a fifth of a line


def one_curve_each(*panels: Array) -> list[list[int]]:
    """Cylinders, counted from 0, whose curves coincide in every panel.

    panels : each of shape (n, cylinders), any unit

    >>> one_curve_each([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
    [[0, 2], [1]]
    """
    curves = [np.asarray(panel, dtype=np.float64) for panel in panels]
    groups: list[list[int]] = []
    for k in range(curves[0].shape[1]):
        same = next((group for group in groups if _coincide(curves, group[0], k)), None)
        if same is None:
            groups.append([k])
        else:
            same.append(k)
    return groups


def whose(cylinders: list[int]) -> str:
    """Legend entry of the cylinders of one curve, counted from 0.

    >>> whose([0, 3])
    'cylinders 1, 4'
    """
    numbers = ", ".join(str(k + 1) for k in cylinders)
    return f"cylinder{'s' if len(cylinders) > 1 else ''} {numbers}"


def _coincide(curves: list[Array], first: int, second: int) -> bool:
    return all(
        bool(np.all(np.abs(panel[:, first] - panel[:, second]) <= _seen(panel))) for panel in curves
    )


def _seen(panel: Array) -> float:
    """What can be seen of a difference: nothing where the whole panel is drawn as constant."""
    return max(_APART * float(np.ptp(panel)), FLAT * float(np.max(np.abs(panel))))
