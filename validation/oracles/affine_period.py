"""The periodic speed of a crank under a quadratic load, whatever its flywheel: tables of the angle
once, then the energy in closed form.

dE/dtheta = Q(theta) - 2 c E / J(theta) has the integrating factor exp(I), I = integral of 2 c / J,
so that E = exp(-I) (E_0 + R), R = integral of exp(I) Q, and the period fixes E_0.
"""

import numpy as np
from numpy.polynomial import Polynomial, legendre

from validation.oracles.arithmetic import Array
from validation.oracles.machine import Machine
from validation.oracles.many_turns import Turning

__all__ = ["Periodic"]

NODES = 5  # of Gauss on each piece between two edges, in which no knot may lie


class Periodic:
    """A machine without its flywheel, tabulated over one period [rad], a whole number of turns.

    edges : shape (n + 1,) [rad], increasing; every knot of the pressure is one of them
    """

    def __init__(self, machine: Machine, edges: Array) -> None:
        turning, (nodes, weights) = Turning(machine), legendre.leggauss(NODES)
        self.edges, self.half, self.weights = edges, np.diff(edges)[:, None] / 2, weights
        self.inside = np.transpose([_integral(nodes, k) for k in range(NODES)])
        self.angles = edges[:-1, None] + self.half * (1 + nodes)
        flat = self.angles.ravel()
        own = machine.crank_inertia
        self.rods = self._tabulated(turning.inertia(flat)) - own
        self.rods_at_edges = np.asarray(turning.inertia(edges), dtype=np.float64) - own
        self.push = self._tabulated(turning.push(flat, 0 * flat))
        self.turning = turning

    def speed(self, flywheel: float) -> Array:
        """The periodic speed at the edges [rad/s], with a crank of this inertia [kg m2]."""
        inertia = self.rods + flywheel
        decay, factor = self._summed(2 * self.turning.machine.loads.quadratic / inertia)
        gained, _ = self._summed(np.exp(factor) * self.push)
        energy = np.exp(-decay) * (gained[-1] / np.expm1(decay[-1]) + gained)
        return np.asarray(np.sqrt(2 * energy / (self.rods_at_edges + flywheel)))

    def work(self, speed: float) -> Array:
        """Work of gas, weights and rods at a constant speed beyond its mean, at the edges [J]."""
        flat = self.angles.ravel()
        torque = self._tabulated(self.turning.push(flat, 0 * flat + speed))
        done, _ = self._summed(torque)
        turned = (self.edges - self.edges[0]) / (self.edges[-1] - self.edges[0])
        return np.asarray(done - done[-1] * turned)

    def _tabulated(self, values: Array) -> Array:
        return np.asarray(values, dtype=np.float64).reshape(self.angles.shape)

    def _summed(self, values: Array) -> tuple[Array, Array]:
        """Integral of values at the nodes, from the first edge to every edge and to every node."""
        ends = np.append(0.0, np.cumsum(self.half[:, 0] * (values @ self.weights)))
        return ends, ends[:-1, None] + self.half * (values @ self.inside.T)


def _integral(nodes: Array, k: int) -> Array:
    """From -1 to every node, of the polynomial that is 1 at node k and 0 at the others."""
    others = np.delete(nodes, k)
    one = Polynomial.fromroots(others)
    return np.asarray((one / one(nodes[k])).integ(lbnd=-1)(nodes))
