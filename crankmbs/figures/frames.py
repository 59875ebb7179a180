"""The instants of a run's last cycle that a moving picture shows: equally spaced in time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crankmbs.digits import digits
from crankmbs.errors import InputError
from crankmbs.measures import last_span
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["Frames", "frames_of", "round_below"]


_LASTS = 6.0  # s, about: one cycle on the screen
_LEAD = math.radians(30.0)  # the lead as it is shown, at most
_EVEN = 1e-9  # rad: a lead that is none


@dataclass(frozen=True)
class Frames:
    """Instants of the last cycle, equally spaced in time; the last leads on to the first.

    time [s] since the cycle began, angle [rad] unwrapped, speed [rad/s] : shape (n,)
    mean [rad/s] : over the cycle; slower : times that the film is slower than the machine
    """

    time: Array
    angle: Array
    speed: Array
    mean: float
    slower: float

    @property
    def leads(self) -> Array:
        """By how much the crank is ahead of one that turns evenly [rad], negative where it is
        behind; on average over the cycle not at all."""
        ahead = self.angle - self.angle[0] - self.mean * self.time
        leads: Array = ahead - ahead.mean()
        return leads

    @property
    def magnified(self) -> float:
        """How many times the lead is shown, a round number from 1; 0 where the crank turns
        evenly."""
        most = float(np.max(np.abs(self.leads)))
        return max(round_below(_LEAD / most), 1.0) if most > _EVEN else 0.0

    @property
    def ring(self) -> str:
        """What a ring at mean speed shows, in words."""
        if self.magnified == 0.0:
            return "ring: the crank turns evenly"
        times = f"magnified {self.magnified:g} times" if self.magnified > 1.0 else "as it is"
        return f"ring: the mean speed, the crank's lead {times}"

    def lead_in_words(self, frame: int) -> str:
        """By how much the crank is ahead of the mean speed or behind, in the sense of rotation."""
        lead = math.degrees(self.leads[frame]) * math.copysign(1.0, self.mean)
        decimals = min(max(2 + math.floor(math.log10(self.magnified)), 1), 6)
        return f"{abs(lead):.{decimals}f} deg {'ahead' if lead >= 0.0 else 'behind'}"

    @property
    def pace(self) -> str:
        """The slow motion in words."""
        times, manner = (
            (self.slower, "slower") if self.slower >= 1.0 else (1.0 / self.slower, "faster")
        )
        return f"{digits(times, most=2)} times {manner} than the machine"


def round_below(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above a positive value.

    >>> round_below(34.0)
    20.0
    """
    power = 10.0 ** math.floor(math.log10(value))
    return max(each * power for each in (1.0, 2.0, 5.0) if each * power <= value * (1.0 + 1e-9))


def frames_of(result: Result, rate: float, length: float | None = None) -> Frames:
    """The last cycle at ``rate`` frames a second, slowed down to last about so long [s]; None: six
    seconds.

    Raises
    ------
    InputError : the run has no stretch of time
    """
    window = last_span(result)
    if window.duration <= 0.0:
        raise InputError(f"nothing moves that could be animated: {result.message}")
    slower = float(f"{(_LASTS if length is None else length) / window.duration:.2g}")
    count = max(2, round(window.duration * slower * rate))
    at = np.arange(count, dtype=np.float64) * (window.duration / count)
    samples = result.passes.answer.at(window.begin + at, in_time=True)
    mean = window.angle / window.duration
    return Frames(at, samples.theta, samples.omega, mean, slower)
