"""A logger's record of an engine whose inertia, dead centre, delay and wheel are known.

The energy of the crank is the integral of the torque over the angle, summed here: nothing of
crankmbs' runs. The pressure scatters from cycle to cycle.
"""

from dataclasses import dataclass

import numpy as np
from records import Record

from validation.oracles.measured import Engine, pressure_of

SMALL = Engine(
    radius=27.5, rod_length=84.0, ratio=8.5, inlet=0.8, heat=15.0, burns=-8.0, lasts=60.0
)


@dataclass
class EngineLog(Record):
    """inertia [kg m^2] of crank and rotor; reciprocating [kg]; load [N m]; scatter of the cycles'
    pressures above their inlet's; jitter of an edge [s]."""

    engine: object = SMALL
    cycles: int = 8
    inertia: float = 0.018
    reciprocating: float = 0.2
    bore: float = 67.0
    load: float = 9.0
    scatter: float = 0.05
    jitter: float = 1e-6
    step: float = 1e-5

    def __post_init__(self):
        super().__post_init__()
        begin = self.dead_centre - 360.0
        turn = np.floor((self._angle - begin) / 720.0).astype(int)
        shares = 1.0 + self.scatter * self._rng.standard_normal(turn.max() - turn.min() + 1)
        inlet = self.engine.inlet
        clean = pressure_of(self.engine, self._angle - self.dead_centre)
        self._bar = inlet + shares[turn - turn.min()] * (clean - inlet)
        r, l = 1e-3 * self.engine.radius, 1e-3 * self.engine.rod_length
        phi = np.radians(self._angle - self.dead_centre)
        lever = r * np.sin(phi) + r**2 * np.sin(2.0 * phi) / (
            2.0 * np.sqrt(l**2 - (r * np.sin(phi)) ** 2)
        )  # -dx / dphi, x the piston's place
        torque = 1e5 * (self._bar - 1.0) * np.pi / 4.0 * (1e-3 * self.bore) ** 2 * lever - self.load
        step = np.radians(self._angle[1] - self._angle[0])
        work = np.concatenate([[0.0], np.cumsum(0.5 * (torque[1:] + torque[:-1])) * step])
        inertia = self.inertia + self.reciprocating * lever**2
        speed = np.sqrt(2.0 * (0.5 * self.inertia * 314.0**2 + work) / inertia)
        slow = 1.0 / speed
        self._time = np.concatenate([[0.0], np.cumsum(0.5 * (slow[1:] + slow[:-1])) * step])

    @property
    def edges(self):
        passed = super().edges
        return passed + self.jitter * np.random.default_rng(self.seed).standard_normal(len(passed))

    @property
    def columns(self):
        time = np.arange(0.0, self._time[-1], self.step)
        bar = np.interp(self.angle_at(time - self.delay), self._angle, self._bar)
        bar = bar + self.noise * self._rng.standard_normal(len(bar))
        return time, 5.0 * (0.115 + 0.00385 * bar), self._wheel(time)
