"""A crank that turns on and on: its energy over the crank angle, period by period, by quadrature.

With the loads c0 - c omega^2 the kinetic energy E = J omega^2 / 2 obeys
dE/dtheta = T + c0 - 2 c E / J, linear in E, so E = exp(-A) (E_0 + int exp(A) (T + c0) dtheta) with
A = int 2 c / J dtheta is one affine map per period, and 100,000 periods cost as little as those
until E repeats itself.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from validation.oracles.arithmetic import LONG, Array, Number
from validation.oracles.energy import kinetic_energy
from validation.oracles.free_motion import Motion
from validation.oracles.machine import Machine
from validation.oracles.newton_euler import newton_euler
from validation.oracles.pressure import pressure_pieces

NODES = 12
WIDEST = np.pi / 24  # of a panel [rad]: Gauss with 12 nodes errs far below rounding
CHUNK = 1000  # periods at once


class _Stretch(NamedTuple):
    """From one angle over panels: J and weight at the nodes, and the maps of E to the nodes.

    E at node = growth_inside (E_0 + rise_inside), shape (panels, NODES); at the ends of the
    panels likewise with growth and rise, shape (panels,).
    """

    inertia: Array
    weight: Array
    growth_inside: Array
    rise_inside: Array
    growth: Array
    rise: Array

    def times(self, start: Array) -> Array:
        """Time [s] spent in every panel from the energies `start`, shape (n,) to (n, panels)."""
        energy = self.growth_inside * (start[:, None, None] + self.rise_inside)
        spent: Array = (self.weight * np.sqrt(self.inertia / (2 * energy))).sum(axis=2)
        return spent


@dataclass(frozen=True)
class Turning:
    """What of a machine depends on the crank angle."""

    machine: Machine

    def stretch(self, edges: Array) -> _Stretch:
        """Panels between increasing angles [rad], none of them across a knot."""
        nodes, weights = (LONG.array(x) for x in legendre.leggauss(NODES))
        inside = LONG.array(antiderivatives().ravel()).reshape(NODES, NODES)
        half = np.diff(edges)[:, None] / 2
        theta = edges[:-1, None] + half * (1 + nodes)
        inertia = self.inertia(theta.ravel()).reshape(theta.shape)
        push = self.push(theta.ravel(), 0 * theta.ravel()).reshape(theta.shape)
        rate = 2 * LONG.number(self.machine.loads.quadratic) / inertia
        loss, losses = _running(half * rate, inside, weights)
        rise, rises = _running(half * np.exp(loss) * push, inside, weights)
        return _Stretch(
            inertia, half * weights, np.exp(-loss), rise, np.exp(-losses[1:]), rises[1:]
        )

    def inertia(self, theta: Array) -> Array:
        """J(theta): twice the kinetic energy at unit speed."""
        return 2 * kinetic_energy(self.machine, theta, theta * 0 + 1)

    def push(self, theta: Array, omega: Array) -> Array:
        """The torque that acts on a crank at these speeds, the quadratic load left out."""
        needed = newton_euler(self.machine, theta, omega, theta * 0).external_torque
        push: Array = LONG.number(self.machine.loads.constant) - needed
        return push

    def edges(self, start: Number, offsets: Array, period: Number) -> Array:
        """Angles from `start` over one period: knots, wanted offsets, and no panel too wide."""
        panels = int(np.ceil(period / WIDEST))
        inner = [LONG.array(offsets), period * (np.arange(1, panels + 1) / panels)]
        for pressure, (phase, _) in zip(
            self.machine.pressures, self.machine.cylinders, strict=False
        ):
            pieces = pressure_pieces(pressure)
            for k in range(round(float(period / pieces.period))):
                knots = pieces.knots + k * pieces.period
                inner.append((knots - LONG.number(phase) - start) % period)
        merged = np.unique(np.concatenate([period * np.zeros(1), *inner]))
        edges: Array = start + merged[merged <= period]
        return edges


def many_turns(machine: Machine, theta0: Number, omega0: Number, angles: Array) -> Motion:
    """The motion from (theta0, omega0 > 0) at t = 0, at increasing angles [rad] that it passes.

    The loads are constant and quadratic, and the crank never comes near rest. Exact but for
    rounding (64 bits; the quadrature's weights have 53).

    Raises
    ------
    ValueError : another load, or a crank that does not turn forwards
    """
    loads = machine.loads
    tables = (*loads.time_tables, *loads.speed_tables, *loads.angle_tables)
    if loads.viscous or tables or not omega0 > 0:
        raise ValueError("the loads must be constant or quadratic, and the speed above 0")
    turning = Turning(machine)
    start, wanted = LONG.number(theta0), LONG.array(angles)
    period = LONG.whole_turns(machine.period)
    first = LONG.array([theta0])
    energy = (turning.inertia(first) * LONG.number(omega0) ** 2 / 2)[0]
    whole = turning.stretch(turning.edges(start, wanted[:0], period))
    turns = np.floor((wanted - start) / period).astype(np.int64)
    time, energies = wanted * 0, wanted * 0
    reached, passed = 0, LONG.number(0)
    for turn in np.unique(turns):
        energy, spent = _skip(whole, energy, int(turn) - reached)
        reached, passed = int(turn), passed + spent
        here = turns == turn
        offsets = wanted[here] - start - turn * period
        edges = turning.edges(start, offsets, period)
        part = turning.stretch(edges)
        at = np.searchsorted(edges - start, offsets)
        at_edges = np.append(energy, part.growth * (energy + part.rise))
        since = np.append(0 * passed, np.cumsum(part.times(np.array([energy]))[0]))
        time[here], energies[here] = passed + since[at], at_edges[at]
    inertia = turning.inertia(wanted)
    omega = np.sqrt(2 * energies / inertia)
    drag = LONG.number(loads.quadratic) * omega * omega
    alpha = (turning.push(wanted, omega) - drag) / inertia
    return Motion(time, wanted, omega, alpha, len(whole.growth))


def _skip(whole: _Stretch, energy: Number, periods: int) -> tuple[Number, Number]:
    """Energy after so many whole periods, and the time they take."""
    passed = 0 * energy
    while periods > 0:
        starts = [energy]
        while len(starts) < min(CHUNK, periods) + 1:
            starts.append(whole.growth[-1] * (starts[-1] + whole.rise[-1]))
        spent = whole.times(np.array(starts[:-1])).sum(axis=1)
        passed, periods, energy = passed + spent.sum(), periods - len(spent), starts[-1]
        if abs(starts[-1] - starts[-2]) <= 4 * LONG.epsilon * energy:
            return energy, passed + periods * spent[-1]
    return energy, passed


def _running(panels: Array, inside: Array, weights: Array) -> tuple[Array, Array]:
    """Integral from the beginning up to every node, and up to every edge."""
    ends = np.append(0 * weights[:1], np.cumsum(panels @ weights))
    return ends[:-1, None] + panels @ inside.T, ends


def antiderivatives() -> Array:
    """Row i times the values at the nodes is the integral from -1 to node i."""
    nodes, _ = legendre.leggauss(NODES)
    values = legendre.legvander(nodes, NODES)
    k = np.arange(1, NODES)
    integrals = np.empty((NODES, NODES))
    integrals[:, 0] = nodes + 1
    integrals[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * k + 1)
    matrix: Array = integrals @ np.linalg.inv(values[:, :-1])
    return matrix
