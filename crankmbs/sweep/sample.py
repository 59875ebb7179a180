"""A sample: points spread evenly over a unit cube, drawn block by block where the method can."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array

if TYPE_CHECKING:
    from scipy.stats import qmc

__all__ = ["Sample"]

_METHODS = ("sobol", "latin")
_MOST = 10_000_000


@dataclass(frozen=True)
class Sample:
    """Cases spread over ranges: n points of a scrambled Sobol sequence, or of a Latin hypercube.

    vary : name -> range, such as {"crank.inertia": "0.05..0.5 kg m^2:log"}
    n : how many; a power of two is best with "sobol"
    method : "sobol" or "latin"
    seed : from which the points are drawn
    """

    vary: Mapping[str, str]
    n: int
    method: str = "sobol"
    seed: int = 1

    def __post_init__(self) -> None:
        for name, least in (("n", 1), ("seed", 0)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= _MOST:
                raise InputError(
                    f"{name} must be a whole number from {least} to {_MOST}; {shown(value)} came"
                )
        if self.method not in _METHODS:
            raise InputError(f'method must be "sobol" or "latin"; {shown(self.method)} came')

    def points(self, rows: range) -> Array:
        """Some successive points of the n in the unit cube, shape (len(rows), knobs).

        >>> Sample({"rod.length": "0.14..0.2 m"}, 4, "latin").points(range(1, 4)).shape
        (3, 1)
        """
        if self.method == "latin":
            return self._hypercube[rows.start : rows.stop]
        sequence = self._sequence
        if sequence.num_generated > rows.start:
            sequence.reset()
        if sequence.num_generated < rows.start:
            sequence.fast_forward(rows.start - sequence.num_generated)
        if sequence.num_generated == 0:  # SciPy warns of a first draw of no power of two
            first = sequence.random(1)
            rest = [sequence.random(len(rows) - 1)] if len(rows) > 1 else []
            return np.concatenate([first, *rest])
        return np.asarray(sequence.random(len(rows)))

    @cached_property
    def _sequence(self) -> qmc.Sobol:
        from scipy.stats import qmc  # a fifth of a second, for samples alone

        return qmc.Sobol(len(self.vary), rng=self.seed)

    @cached_property
    def _hypercube(self) -> Array:
        """All points: the strata of each knob are one permutation."""
        from scipy.stats import qmc

        return np.asarray(qmc.LatinHypercube(len(self.vary), rng=self.seed).random(self.n))
