"""Decisions on the fuel by the letter of the rule: at the start, and wherever the throw of a
cylinder is half a turn past its axis for the first time, forwards or backwards."""

from __future__ import annotations

import math

from validation.oracles.changes import Changes

__all__ = ["Decider"]

_SAME = 1e-9  # rad: decisions so near one another are one


class Decider:
    """The shares as they stand, and the angles of the next decisions [rad], both ways."""

    def __init__(self, changes: Changes, theta: float, omega: float) -> None:
        assert changes.firings is not None
        self.firings, self.cycle = changes.firings, changes.cycle
        self.phases = [float(phase) for phase, _ in changes.machine.cylinders]
        self.start, self.before = (theta, omega), (0.0, theta)
        self.low = self.high = theta
        governor = self.firings.governor
        self.integral = governor.initial if governor else 0.0
        self.set_in: float | None = None
        self.over = False
        self.shares = [0.0] * len(self.phases)
        self._decide(0.0, theta, omega, dict.fromkeys(range(len(self.phases)), 1))

    @property
    def bounds(self) -> tuple[float, float]:
        """The next angles backwards and forwards at which a cylinder decides."""
        return self._next(self.low, -1), self._next(self.high, 1)

    def decide(self, time: float, theta: float, omega: float) -> None:
        """At one of these angles."""
        forwards = theta > self.high
        cycles = {}
        for k, phase in enumerate(self.phases):
            off = math.remainder(theta + phase - math.pi, self.cycle)
            if abs(off) < _SAME:
                cycles[k] = self._number(phase, theta, forwards=forwards)
        self.low, self.high = min(theta, self.low), max(theta, self.high)
        self._decide(time, theta, omega, cycles)

    def _next(self, beyond: float, way: int) -> float:
        found = []
        for phase in self.phases:
            turns = (beyond + way * 2.0 * _SAME + phase - math.pi) / self.cycle
            turns = math.ceil(turns) if way > 0 else math.floor(turns)
            found.append(math.pi - phase + turns * self.cycle)
        return min(found) if way > 0 else max(found)

    def _number(self, phase: float, theta: float, *, forwards: bool) -> int:
        """How many firing dead centres of the cylinder lie between the start and the one that this
        share is for, itself included; at least 1."""
        if forwards:
            firing = theta + math.pi
            last = (firing + phase - 2.0 * math.pi) / self.cycle
            passed = (self.start[0] + phase - 2.0 * math.pi) / self.cycle
            return round(last) - math.floor(passed + _SAME)
        firing = theta - (self.cycle - math.pi)
        last = (firing + phase - 2.0 * math.pi) / self.cycle
        passed = (self.start[0] + phase - 2.0 * math.pi) / self.cycle
        return math.ceil(passed - _SAME) - round(last)

    def _decide(self, time: float, theta: float, omega: float, cycles: dict[int, int]) -> None:
        share = 1.0
        governor = self.firings.governor
        if governor is not None:
            spent = time - self.before[0]
            mean = (theta - self.before[1]) / spent if spent > 0.0 else omega
            error = governor.speed - mean
            more = self.integral + governor.ki * error * spent
            free = governor.kp * error + more
            share = min(max(free, governor.least), governor.most)
            if (free - share) * error <= 0.0:
                self.integral = more
        if not self._burns(time, omega):
            share = 0.0
        for k, cycle in cycles.items():
            self.shares[k] = share * self.firings.part(k + 1, cycle)
        self.before = (time, theta)

    def _burns(self, time: float, omega: float) -> bool:
        """Whether a decision lies within the window of the fuel; speeds are met between two."""
        of = self.firings
        self.over |= time >= of.until
        if self.set_in is None:
            met = of.from_speed is None or _met(of.from_speed, self.start[1], omega)
            if met and time >= of.after:
                self.set_in = omega
        elif of.until_speed is not None:
            self.over |= _met(of.until_speed, self.set_in, omega)
        return self.set_in is not None and not self.over


def _met(speed: float, before: float, now: float) -> bool:
    return min(before, now) <= speed <= max(before, now)
