"""The instants of a run's last cycle that a moving picture shows: equally spaced in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from crankmbs.digits import digits
from crankmbs.errors import InputError
from crankmbs.measures import last_span
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["Frames", "frames_of"]


_LASTS = 6.0  # s, about: one cycle on the screen


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
    def pace(self) -> str:
        """The slow motion in words."""
        times, what = (
            (self.slower, "slower") if self.slower >= 1.0 else (1.0 / self.slower, "faster")
        )
        return f"{digits(times, most=2)} times {what} than the machine"


def frames_of(result: Result, rate: float, length: float | None = None) -> Frames:
    """The last cycle at ``rate`` frames a second, slowed down to last about so long [s]; None: six
    seconds.

    Between samples the angle is the cubic through their angles and speeds; exact to fourth order
    in the spacing.

    Raises
    ------
    InputError : the run has no stretch of time
    """
    window = last_span(result)
    if window.duration <= 0.0:
        raise InputError(f"nothing moves that could be animated: {result.message}")
    slower = float(f"{(_LASTS if length is None else length) / window.duration:.2g}")
    count = max(2, round(window.duration * slower * rate))
    data = result.data.isel(time=slice(window.first, None))
    time, angle, speed = (data[name].values for name in ("time", "crank_angle", "crank_speed"))
    path = CubicHermiteSpline(time, angle, speed)
    at = np.arange(count, dtype=np.float64) * (window.duration / count)
    instants = window.begin + at
    mean = window.angle / window.duration
    return Frames(at, path(instants), path(instants, 1), mean, slower)
