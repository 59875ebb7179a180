"""MATLAB's ode45: the pair of Dormand and Prince under the step control of the ODE suite.

Sources: J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26 (coefficients);
L. F. Shampine, M. W. Reichelt, SIAM J. Sci. Comput. 18 (1997) 1-22 (the suite).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Slope = Callable[[float, Vector], Vector]

_NODES = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
_STAGES = tuple(
    np.array(row)
    for row in (
        (),
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    )
)
_ERROR = np.array((71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40))
_SAFETY, _POWER = 0.8, 1 / 5


def ode45(
    slope: Slope, start: Vector, end: float, rtol: float, atol: float
) -> tuple[Vector, list[Vector]]:
    """Integrate y' = slope(t, y) from 0 to `end`; the times of the steps and the states there.

    The error of a step is measured in every component by the larger of |y| and atol / rtol.
    """
    threshold, longest = atol / rtol, 0.1 * end
    time, state, first = 0.0, start, slope(0.0, start)
    times, states = [time], [state]
    rate = np.max(np.abs(first) / np.maximum(np.abs(state), threshold)) / (_SAFETY * rtol**_POWER)
    step = min(longest, 1.0 / rate)
    while time < end:
        failed = False
        while True:
            step = min(longest, step)
            last = 1.1 * step >= end - time
            step = end - time if last else step
            reached, slopes = _try(slope, time, state, first, step)
            size = np.maximum(np.maximum(np.abs(state), np.abs(reached)), threshold)
            error = step * float(np.max(np.abs(_ERROR @ slopes) / size))
            if error <= rtol:
                break
            shrink = 0.5 if failed else max(0.1, _SAFETY * (rtol / error) ** _POWER)
            step, failed = shrink * step, True
        time = end if last else time + step
        state, first = reached, slopes[-1]
        times.append(time)
        states.append(state)
        if not failed:
            step *= min(5.0, _SAFETY * (rtol / error) ** _POWER) if error > 0.0 else 5.0
    return np.array(times), states


def _try(
    slope: Slope, time: float, state: Vector, first: Vector, step: float
) -> tuple[Vector, Vector]:
    """The state after a step, and the slopes of all stages, shape (7, n); the last is there."""
    slopes, reached = [first], state
    for node, weights in zip(_NODES[1:], _STAGES[1:], strict=True):
        reached = state + step * (weights @ np.array(slopes))
        slopes.append(slope(time + node * step, reached))
    return reached, np.array(slopes)
