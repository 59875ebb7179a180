"""Records over time as a data logger writes them, of a motion and a pressure that are known."""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from exports import FIRED

from validation.oracles.measured import pressure_of

SENSOR = "(V/5 - 0.115)/0.00385 bar"
ORDERS = (
    (0.5, 0.012, 0.3),
    (1.0, 0.02, -0.8),
    (1.5, 0.02, 0.5),
    (2.0, 0.006, 1.0),
    (3.5, 0.004, 2.0),
)


@dataclass
class Record:
    """Teeth stand behind their places by normal errors [deg], the first and the last one before the
    gap by more; dead_centre [deg]: behind the place of the first tooth, of the first revolution."""

    engine: object
    cycles: int = 5
    teeth: int = 60
    missing: int = 2
    uneven: float = 0.05
    gap: tuple[float, float] = (0.9, -0.5)
    dead_centre: float = 385.0
    delay: float = 0.0
    noise: float = 0.0
    step: float = 2e-5
    seed: int = 1
    errors: np.ndarray = field(init=False)

    def __post_init__(self):
        rng = np.random.default_rng(self.seed)
        self.errors = self.uneven * rng.standard_normal(self.teeth - self.missing)
        if self.missing:
            self.errors[[0, -1]] += self.gap
        self._rng = rng
        self._angle = np.arange(-250.0, 720.0 * self.cycles + 200.0, 0.02)
        slow = 1.0 / self.speed(self._angle)
        steps = 0.5 * (slow[1:] + slow[:-1]) * np.diff(self._angle)
        self._time = np.concatenate([[0.0], np.cumsum(steps)])

    @staticmethod
    def speed(angle):
        """Degrees per second, over the angle from the place of the first tooth."""
        swing = sum(a * np.cos(n * np.radians(angle) + phase) for n, a, phase in ORDERS)
        return 18000.0 * (1.0 + swing)

    def angle_at(self, time):
        return np.interp(time, self._time, self._angle)

    @property
    def edges(self):
        """Times at which the teeth pass."""
        turns = np.arange(-1, 2 * self.cycles + 1)[:, None] * 360.0
        places = 360.0 / self.teeth * np.arange(self.teeth - self.missing)
        passed = (places + self.errors + turns).ravel()
        inside = (passed > self._angle[0]) & (passed < self._angle[-1])
        return np.interp(passed[inside], self._angle, self._time)

    @property
    def columns(self):
        """Time [s], sensor [V], wheel [V]."""
        time = np.arange(0.0, self._time[-1], self.step)
        shown = self.angle_at(time - self.delay)
        bar = pressure_of(self.engine, shown - self.dead_centre)
        bar = bar + self.noise * self._rng.standard_normal(len(bar))
        return time, 5.0 * (0.115 + 0.00385 * bar), self._wheel(time)

    def _wheel(self, time):
        """High for half a pitch behind each edge, with flanks of 0.6 degrees."""
        angle, edges = self.angle_at(time), self.angle_at(self.edges)
        behind = angle - edges[np.clip(np.searchsorted(edges, angle + 0.3) - 1, 0, None)]
        rise = np.clip((behind + 0.3) / 0.6, 0.0, 1.0)
        fall = np.clip((behind - 180.0 / self.teeth + 0.3) / 0.6, 0.0, 1.0)
        return -0.7 + 4.7 * (rise - fall)

    def text(self, names=None):
        lines = [] if names is None else [";".join(names)]
        lines += [f"{t:.6e};{p:.6e};{w:.6e}" for t, p, w in zip(*self.columns, strict=True)]
        return "\n".join(lines) + "\n"


@cache
def text_of(**options):
    """The text of a record of the fired engine."""
    return Record(**{"engine": FIRED, **options}).text()


def written(folder, text):
    """A file with this text."""
    path = folder / "record.txt"
    path.write_text(text)
    return path
