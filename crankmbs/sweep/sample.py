"""A sample: points spread evenly over a unit cube."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array

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

    def points(self) -> Array:
        """The n points in the unit cube, shape (n, knobs).

        >>> Sample({"rod.length": "0.14..0.2 m"}, 4, "latin").points().shape
        (4, 1)
        """
        from scipy.stats import qmc  # a third of a second: only where cases are drawn

        if self.method == "latin":
            return np.asarray(qmc.LatinHypercube(len(self.vary), rng=self.seed).random(self.n))
        sequence = qmc.Sobol(len(self.vary), rng=self.seed)
        whole = (self.n - 1).bit_length()  # SciPy warns of a number that is no power of two
        return np.asarray(sequence.random_base2(whole)[: self.n])
