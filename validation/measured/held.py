"""A record held against the free run: half orders, orders one by one, and the even part."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from validation.measured.free_run import Engine, Unknown, free_run
from validation.measured.identify import Identified, slopes_of
from validation.measured.logged import Array, Logged, half_orders, orders_of

__all__ = ["Held", "held", "wheel_errors"]

_RPM = 30.0 / np.pi
_SHOWN = 5.5  # order


class Held(NamedTuple):
    """Some cycles of a record and what the free run makes of them.

    name; first, cycles : which, and how many; mean : speed [rpm]; load [N m]
    imep [Pa] : the mean gas work over the swept volume
    measured, predicted : half orders of ln omega, shape (cycles, edges); band : half width of the
        interval of the prediction's mean, shape (edges,); the parameters' alone
    whole_measured, whole_predicted : ln of the intervals' speeds less their mean, over the mean
        cycle, shape (2, edges), the measured one with the wheel's errors taken off
    """

    name: str
    first: int
    cycles: int
    mean: float
    load: float
    imep: float
    measured: Array
    predicted: Array
    band: Array
    whole_measured: Array
    whole_predicted: Array

    def numbers(self, pitch: float) -> dict[str, Any]:
        """What the page and the tests take, speeds in rpm."""
        left = self.measured - self.predicted
        mean, mean_left = self.measured.mean(axis=0), left.mean(axis=0)
        ours, theirs = (orders_of(each, pitch, _SHOWN) for each in (self.predicted, self.measured))
        scatter = theirs.std(axis=0, ddof=1) / np.sqrt(self.cycles)
        ratio = theirs.mean(axis=0) / ours.mean(axis=0)
        even = [each.mean(axis=0) for each in (self.whole_measured, self.whole_predicted)]
        low = orders_of(mean_left, pitch, 2.5)
        return {
            "cycles": [self.first + 1, self.first + self.cycles],
            "mean_rpm": self.mean,
            "load_Nm": self.load,
            "imep_bar": self.imep / 1e5,
            "half_rms_rpm": self.mean * _rms(mean),
            "left_rms_rpm": self.mean * _rms(mean_left),
            "left_to_order_2.5_rms_rpm": self.mean * float(np.sqrt(0.5 * np.sum(np.abs(low) ** 2))),
            "left_single_cycle_rms_rpm": self.mean * _rms(left),
            "band_largest_rpm": self.mean * float(np.max(self.band)),
            "correlation": float(np.corrcoef(mean, self.predicted.mean(axis=0))[0, 1]),
            "orders": [
                {
                    "order": 0.5 + k,
                    "measured_rpm": self.mean * float(np.abs(theirs.mean(axis=0)[k])),
                    "scatter_rpm": self.mean * float(scatter[k]),
                    "ratio": float(np.abs(ratio[k])),
                    "lag_deg": float(-np.degrees(np.angle(ratio[k]))),
                }
                for k in range(len(ratio))
            ],
            "even_rms_rpm": self.mean * _rms(even[0]),
            "even_left_rms_rpm": self.mean * _rms(even[0] - even[1]),
        }


def held(
    logged: Logged,
    engine: Engine,
    found: Identified,
    errors: Array,
    first: int,
    count: int,
) -> Held:
    """Cycles ``first`` to ``first + count - 1``; errors : of the wheel, by `wheel_errors`."""
    run = free_run(logged, engine, found.unknown, first, count)
    times = logged.edge_times(first, count)
    edges = logged.edges
    slopes = slopes_of(logged, engine, found.unknown, first, count, range(len(found.covariance)))
    band = found.factor * np.sqrt(np.einsum("ij,jk,ik->i", slopes, found.covariance, slopes))
    steps = [np.log(np.diff(each)).reshape(count, 2, edges) for each in (times, run.times)]
    whole = [-each.mean(axis=0) for each in (steps[0] - errors, steps[1])]
    widths = np.log(np.diff(logged.edge_angles(0, 1))).reshape(2, edges)
    whole = [each + widths - np.mean(each + widths) for each in whole]
    return Held(
        logged.name,
        first,
        count,
        float(4.0 * np.pi * count / (times[-1] - times[0]) * _RPM),
        run.load,
        run.work / count / engine.swept,
        half_orders(times, edges),
        half_orders(run.times, edges),
        band,
        whole[0],
        whole[1],
    )


def wheel_errors(logged: Logged, engine: Engine, unknown: Unknown, first: int, count: int) -> Array:
    """ln of each interval's width over that of `Logged.edge_angles`, shape (edges,).

    What the mean of both revolutions has beside the free run: the wheel's errors, and what the
    model errs by in whole orders.
    """
    run = free_run(logged, engine, unknown, first, count)
    apart = np.log(np.diff(logged.edge_times(first, count)) / np.diff(run.times))
    return np.asarray(apart.reshape(-1, logged.edges).mean(axis=0))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
