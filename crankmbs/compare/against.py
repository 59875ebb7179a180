"""A run against the exact closed form and against the lectures' formulas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crankmbs.compare.excerpt import Answer, Excerpt, LeftOut, excerpt_of, vanishing
from crankmbs.compare.lectured import LECTURES
from crankmbs.compare.size import Size
from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["CLOSED_FORM", "Comparison", "Deviation", "compare"]


CLOSED_FORM = "closed form"


@dataclass(frozen=True)
class Deviation:
    """One quantity of a run against one reference, over the stretch compared.

    values : shape (n,) [unit], of the reference; error : shape (n,) [unit], reference minus run
    size : maximum and RMS of the error [unit], and the angle of the maximum: the cylinder's cycle
        angle, for the main bearing the crank angle
    peak [unit] : largest magnitude in the run
    """

    quantity: str
    reference: str
    values: Array
    error: Array
    size: Size
    peak: float


@dataclass(frozen=True)
class Comparison:
    """A run against every reference.

    simulated : quantity -> shape (n,), the run's own values in SI units
    rows : reference by reference; left_out : what could not be compared, and why
    """

    excerpt: Excerpt
    simulated: Answer
    rows: tuple[Deviation, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def references(self) -> tuple[str, ...]:
        """The references that could be had, in their order."""
        return tuple(dict.fromkeys(row.reference for row in self.rows))

    def row(self, quantity: str, reference: str = CLOSED_FORM) -> Deviation:
        """The deviation of one quantity from one reference.

        Raises
        ------
        InputError : there is none
        """
        for row in self.rows:
            if (row.quantity, row.reference) == (quantity, reference):
                return row
        raise InputError(
            f"no {quantity!r} against {reference!r} here; quantities: "
            f"{', '.join(self.simulated)}; references: {', '.join(self.references)}"
        )


def compare(result: Result, cylinder: int = 1) -> Comparison:
    """Compare a run with the closed form and with the lectures, over its last whole cycle.

    Every reference is evaluated at the run's own crank angles. "closed form" is Newton-Euler at
    the run's own theta, omega and alpha, with the rigid rod and gravity: exact, so that the error
    is the run's. The lectures take the time mean of the speed, the two-mass rod and no gravity,
    and count displacement from l + r: the error is theirs (`budget` says what it is made of). S0
    and S1, the sources of `crankmbs.lecture`, truncate the motion after the second harmonic; S1
    truncates the way of the force through the rod too.
    Only "multibody" has joint forces of its own; other formulations take them from the closed form
    and agree with it to rounding.

    Parameters
    ----------
    result : any formulation; cylinder : number of the one compared, the main bearing carries all

    Returns
    -------
    Comparison : in SI units; what cannot be compared is listed with its reason

    Raises
    ------
    InputError : no such cylinder

    >>> comparison = compare(simulate(load_scene("yi_diesel")))
    >>> comparison.row("side thrust", "untruncated lecture").size.largest > 290.0
    True
    """
    excerpt = excerpt_of(result, cylinder)
    simulated = excerpt.simulated()
    references = {CLOSED_FORM: excerpt.newton_euler(result.scene)}
    left_out = [LeftOut(name, "", reason) for name, reason in excerpt.left_out().items()]
    for reference, formulas in LECTURES.items():
        try:
            references[reference] = excerpt.lecture(formulas, constant_speed=True)
        except InputError as error:
            left_out += [LeftOut(name, reference, str(error)) for name in simulated]
    nothing = vanishing([simulated, *references.values()])
    left_out += [LeftOut(name, "", reason) for name, reason in nothing.items()]
    kept = {name: curve for name, curve in simulated.items() if name not in nothing}
    rows = tuple(
        _deviation(excerpt, reference, name, curve, answer[name])
        for reference, answer in references.items()
        for name, curve in kept.items()
    )
    return Comparison(excerpt, kept, rows, tuple(left_out))


def _deviation(
    excerpt: Excerpt, reference: str, quantity: str, simulated: Array, values: Array
) -> Deviation:
    error = values - simulated
    return Deviation(
        quantity=quantity,
        reference=reference,
        values=values,
        error=error,
        size=excerpt.size(quantity, error),
        peak=float(np.max(np.abs(simulated))),
    )
