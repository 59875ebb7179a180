"""From what exudyn recorded at its steps to the variables of a result, at any time between."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from crankmbs.mechanics.geometry import top_position
from crankmbs.motion.multibody.frame import frame_of
from crankmbs.motion.multibody.gas import GasStretch
from crankmbs.motion.multibody.held import held_by
from crankmbs.motion.multibody.model import Record
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.scene.scene import Scene

__all__ = ["ROWS", "StepTable", "table_of"]

ROWS = 6  # that an interpolated value takes
_MIDDLE = 0.5 * (ROWS - 1)
_NEWTON = 6  # steps from the straight line between two rows
_LEFT = 1e-13  # of what Newton may leave


class StepTable(NamedTuple):
    """Variables at the equidistant steps of a stretch.

    begin, step [s] : time of the first row, and between rows
    after, until [s] : rows before are run-up and those beyond overrun, both no answer
    scene, gas : the machine, and its gas forces on the stretch
    names : of the variables, those of the cylinders last; n cylinders
    columns : shape (m, k), the variables side by side, less what `held_by` the gas and less the
        loads over the angle
    """

    begin: float
    step: float
    after: float
    until: float
    scene: Scene
    gas: GasStretch
    names: tuple[str, ...]
    columns: Array
    loads: tuple[Cycle, ...] = ()

    @property
    def times(self) -> Array:
        """Times of the rows [s]."""
        return self.begin + self.step * np.arange(len(self.columns), dtype=np.float64)

    def at(self, time: Array) -> dict[str, Array]:
        """All variables at times between: shape (m,), or (m, n) those of the cylinders."""
        named = self._named(self._interpolated(self.columns, time))
        theta = named["crank_angle"]
        named["external_torque"] = named["external_torque"] + self._over_angle(theta)
        held = held_by(self.scene, self.gas.along(theta), theta)
        return named | {name: named[name] + force for name, force in held.items()}

    def under(self, loads: tuple[Cycle, ...]) -> StepTable:
        """The same with loads over the angle, whose kinks then do not bend what is interpolated."""
        table, columns = self._replace(loads=loads), self.columns.copy()
        columns[:, self.names.index("external_torque")] -= table._over_angle(
            self.column("crank_angle")
        )
        return table._replace(columns=columns)

    def _over_angle(self, theta: Array) -> Array:
        """Torque of the loads over the angle [N m]."""
        return sum((load(theta) for load in self.loads), np.zeros_like(theta))

    def one_at(self, name: str, time: Array) -> Array:
        """One variable of the crank at times between."""
        return self._interpolated(self.column(name)[:, None], time)[:, 0]

    def with_rate(self, name: str, rate: str, time: Array) -> tuple[Array, Array]:
        """Two variables of the crank at times between."""
        columns = np.stack([self.column(name), self.column(rate)], axis=1)
        value, slope = self._interpolated(columns, time).T
        return value, slope

    def crossing(
        self, theta: Array, low: Array, high: Array, guess: Array
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Times at which the crank comes to angles, each between two times with no row between.

        Newton's method on the polynomials of `at`, from a guess.

        Returns
        -------
        the times, and where Newton's method has not come there
        """
        first = self._first((0.5 * (low + high) - self.begin) / self.step)
        middle = self.begin + self.step * (first + _MIDDLE)
        rows = self.column("crank_angle")[first + np.arange(ROWS)[:, None]]
        series = _LAGRANGE @ rows
        series[0] -= theta
        low, high, at = ((t - middle) / self.step for t in (low, high, guess))
        for _ in range(_NEWTON):
            off, slope = series[-1], np.zeros_like(at)
            for coefficient in series[-2::-1]:
                slope = slope * at + off
                off = off * at + coefficient
            slow = np.abs(off) > _LEFT * (1.0 + np.abs(theta))
            if not slow.any():
                break
            with np.errstate(divide="ignore", invalid="ignore"):
                at = np.clip(at - np.nan_to_num(off / slope), low, high)
        return middle + self.step * at, slow

    def column(self, name: str) -> Array:
        """One variable of the crank at the rows."""
        return self.columns[:, self.names.index(name)]

    def _interpolated(self, columns: Array, time: Array) -> Array:
        """By the polynomial of degree 5 through the six nearest rows."""
        s = (time - self.begin) / self.step
        first = self._first(s)
        rows = first[:, None] + np.arange(ROWS)
        ends = ROWS * np.arange(len(time) + 1)
        shape = len(time), len(columns)
        weights = csr_array((_weights(s - first).ravel(), rows.ravel(), ends), shape=shape)
        return np.asarray(weights @ columns)

    def _first(self, s: Array) -> NDArray[np.intp]:
        """The first of the six rows around places between rows, counted from the first row."""
        nearest = np.floor(s).astype(np.intp) - ROWS // 2 + 1
        return np.clip(nearest, 0, len(self.columns) - ROWS)

    def _named(self, values: Array) -> dict[str, Array]:
        of_crank = self.names.index("rod_angle")
        n = (values.shape[1] - of_crank) // (len(self.names) - of_crank)
        named = {name: values[:, k] for k, name in enumerate(self.names[:of_crank])}
        for k, name in enumerate(self.names[of_crank:]):
            named[name] = values[:, of_crank + k * n : of_crank + (k + 1) * n]
        return named


def table_of(
    scene: Scene, gas: GasStretch, torque: Array, record: Record, after: float, residual: float
) -> StepTable:
    """The variables at every step, from exudyn's own coordinates and multipliers.

    The energy residual is ``residual`` at time ``after``. The work of gas, friction and outside
    torque is the integral over time of their power at the steps, by the cubic through four
    neighbouring steps; that of gravity is what the centres of mass fell.

    torque : shape (m,) [N m], from outside on the crank
    """
    n = len(scene.cylinders)
    bank = np.array([c.bank for c in scene.cylinders])
    turn = np.exp(-1j * bank)
    crank, rods, pistons = _bodies(record.position, n)
    crank_v, rods_v, pistons_v = _bodies(record.velocity, n)
    crank_a, rods_a, pistons_a = _bodies(record.acceleration, n)
    theta, omega = crank[:, 2], crank_v[:, 2]
    position = (_complex(pistons) * turn).real
    velocity = (_complex(pistons_v) * turn).real
    acceleration = (_complex(pistons_a) * turn).real
    crank_pin, piston_pin = _complex(record.crank_pin) * turn, _complex(record.piston_pin) * turn
    phi = theta[:, None] + gas.gas.phases
    kinetic = _kinetic_energy(scene, crank_v, rods_v, pistons_v)
    forces = gas.along(theta)
    viscous = scene.friction.viscous if scene.friction else 0.0
    power = torque * omega - ((forces + viscous * velocity) * velocity).sum(axis=1)
    closure = kinetic - _integral(power, record.time) - _fall(scene, crank, rods, pistons)
    closure += residual - np.interp(after, record.time, closure)
    top = top_position(scene.crank.radius, scene.rod.length, scene.piston.offset)
    lever = scene.crank.radius * np.exp(-1j * phi)
    rod_torque = -(lever * crank_pin).imag
    variables = {
        "crank_angle": theta,
        "crank_speed": omega,
        "crank_acceleration": record.acceleration[:, 2],
        "external_torque": torque,
        "main_bearing_force_x": record.bearing[:, 0],
        "main_bearing_force_y": record.bearing[:, 1],
        **frame_of(scene, torque, (crank, rods, pistons), (crank_a, rods_a, pistons_a)),
        "kinetic_energy": kinetic,
        "energy_residual": closure,
        "rod_angle": bank - rods[..., 2],
        "rod_angular_speed": -rods_v[..., 2],
        "rod_angular_acceleration": -rods_a[..., 2],
        "piston_position": position,
        "piston_displacement": top - position,
        "piston_velocity": -velocity,
        "piston_acceleration": -acceleration,
        "side_force": record.side,
        "piston_pin_force_x": piston_pin.real,
        "piston_pin_force_y": piston_pin.imag,
        "crank_pin_force_x": crank_pin.real,
        "crank_pin_force_y": crank_pin.imag,
        "crank_torque": rod_torque,
        "journal_torque": np.cumsum(rod_torque, axis=1),
        "pin_torque": np.cumsum(rod_torque, axis=1) - 0.5 * rod_torque,
    }
    for name, force in held_by(scene, forces, theta).items():
        variables[name] = variables[name] - force
    columns = np.column_stack(list(variables.values()))
    step = float(record.time[1] - record.time[0])
    begin, end = float(record.time[0]), float(record.time[-1])
    return StepTable(begin, step, after, end, scene, gas, tuple(variables), columns)


def _weights(u: Array) -> Array:
    """Lagrange's polynomials of the places 0, 1, ... ROWS - 1 at ``u``, shape (len(u), ROWS)."""
    away = u - _MIDDLE
    powers = np.ones((ROWS, len(u)))
    for k in range(1, ROWS):
        powers[k] = powers[k - 1] * away
    return np.asarray(powers.T @ _LAGRANGE)


def _lagrange() -> Array:
    """Coefficients of Lagrange's polynomials in the distance from the middle of the rows.

    Shape (power, row); exact but for one rounding.
    """
    places = np.arange(ROWS) - _MIDDLE
    others = [np.delete(places, k) for k in range(ROWS)]
    columns = [np.poly(o)[::-1] / np.prod(x - o) for x, o in zip(places, others, strict=True)]
    return np.stack(columns, axis=1)


_LAGRANGE = _lagrange()


def _bodies(columns: Array, n: int) -> tuple[Array, Array, Array]:
    """Crank (m, 3), rods (m, n, 3), pistons (m, n, 2)."""
    cylinders = columns[:, 3:].reshape(-1, n, 5)
    return columns[:, :3], cylinders[..., :3], cylinders[..., 3:]


def _complex(planar: Array) -> Array:
    return planar[..., 0] + 1j * planar[..., 1]


def _kinetic_energy(scene: Scene, crank: Array, rods: Array, pistons: Array) -> Array:
    c, rod, piston = scene.crank, scene.rod, scene.piston
    own = c.moment_of_inertia - c.mass * c.center_of_mass**2
    twice = c.mass * (crank[:, :2] ** 2).sum(axis=1) + own * crank[:, 2] ** 2
    twice += rod.mass * (rods[..., :2] ** 2).sum(axis=(1, 2))
    twice += rod.moment_of_inertia * (rods[..., 2] ** 2).sum(axis=1)
    twice += piston.mass * (pistons**2).sum(axis=(1, 2))
    return np.asarray(0.5 * twice)


def _fall(scene: Scene, crank: Array, rods: Array, pistons: Array) -> Array:
    """Work of gravity [J], up to a constant."""
    if scene.gravity is None:
        return np.zeros(len(crank))
    direction = np.array([np.cos(scene.gravity.angle), np.sin(scene.gravity.angle)])
    moment = scene.crank.mass * crank[:, :2] + scene.rod.mass * rods[..., :2].sum(axis=1)
    moment += scene.piston.mass * pistons.sum(axis=1)
    return np.asarray(moment @ direction * scene.gravity.acceleration)


def _integral(power: Array, time: Array) -> Array:
    """Integral from the first row to each; the cubic through four rows, three at the ends."""
    p = power
    inner = (13.0 * (p[1:-2] + p[2:-1]) - p[:-3] - p[3:]) / 24.0
    first = (5.0 * p[0] + 8.0 * p[1] - p[2]) / 12.0
    last = (5.0 * p[-1] + 8.0 * p[-2] - p[-3]) / 12.0
    pieces = np.concatenate([[0.0, first], inner, [last]])
    return np.asarray((time[1] - time[0]) * np.cumsum(pieces))
