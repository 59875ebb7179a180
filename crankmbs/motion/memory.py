"""How many samples this machine has memory for."""

from __future__ import annotations

from functools import cached_property

import psutil

from crankmbs.errors import InputError

__all__ = ["Room"]

_TIMES = 10  # what a run takes at its peak, saved at its end, over what it stores: 3 to 9 measured


_LITTLE = 16e6  # bytes: less than what was loaded to come here, and not worth to ask the system


class Room:
    """The memory that is free, for samples of so many numbers each; looked at where there are more
    than a few."""

    def __init__(self, numbers: int) -> None:
        self._numbers = numbers

    @cached_property
    def _free(self) -> int:
        """Bytes, without swapping."""
        return int(psutil.virtual_memory().available)

    def check(self, samples: float) -> None:
        """Refuse more samples than memory holds.

        Raises
        ------
        InputError : how many, what they take, what is free, and the way out
        """
        taken = samples * 8 * self._numbers * _TIMES
        if taken > _LITTLE and taken > self._free:
            raise InputError(
                f"run.every: {samples:.3g} samples of {self._numbers} numbers each came, which "
                f"take up to {taken / 1e9:.3g} GB, and {self._free / 1e9:.3g} GB are free; give a "
                'wider spacing, or every = "none" to keep the last cycle alone'
            )
