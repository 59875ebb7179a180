"""Numbers as text, with no more digits than their error leaves."""

from __future__ import annotations

import math

__all__ = ["digits", "error_digits"]


def digits(value: float, error: float = 0.0, most: int = 6) -> str:
    """A number to the second digit of its error, and to ``most`` digits at most.

    >>> digits(1234.5678, 0.3)
    '1234.57'
    >>> digits(1234.5678, 20.0)
    '1235'
    """
    if not math.isfinite(value):
        return "-"
    if value == 0.0:
        return "0"
    size = int(f"{value:.{most - 1}e}".split("e")[1])  # the exponent after rounding
    last = size - most + 1
    if 0.0 < error < math.inf:
        last = max(last, math.floor(math.log10(error)) - 1)
    rounded = round(value, -last)
    if rounded == 0.0:
        return "0"
    if -4 <= size < 7:
        return f"{rounded:.{max(-last, 0)}f}"
    return f"{rounded:.{max(size - last, 0)}e}"


def error_digits(error: float) -> str:
    """An error to two digits, rounded up.

    >>> error_digits(0.0123)
    '0.013'
    """
    if not 0.0 < error < math.inf:
        return digits(error)
    unit = 10.0 ** (math.floor(math.log10(error)) - 1)
    return digits(math.ceil(error / unit * (1.0 - 1e-12)) * unit, most=2)
