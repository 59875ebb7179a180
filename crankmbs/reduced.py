"""The crank train reduced to one rotation, in plain floats at one crank angle.

Written out in scalars apart from the arrays of `crankmbs.inertia`: neither shares code with the
other, so they check each other. The pressure is given as the polynomials between two knots, which
can be continued beyond them.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.drives import Constant, SpeedTable, TimeTable
from crankmbs.machine import Cylinder
from crankmbs.pressure import PeriodicPressure, crank_angle_knots
from crankmbs.scene import Scene

__all__ = ["Between", "Reduced"]

Polynomial = tuple[float, float, float, float, float]  # knot [rad], then powers 3, 2, 1, 0 [Pa]

_NO_GAS: Polynomial = (0.0, 0.0, 0.0, 0.0, 0.0)
_PASSED = 1e-9  # rad: a knot this close ahead has been passed


class Between(NamedTuple):
    """Two neighbouring knots [rad], and the pressure of every cylinder between them."""

    low: float
    high: float
    pieces: tuple[Polynomial, ...]


class Reduced:
    """J, J_1 and the torque of gas and gravity at one crank angle, in plain floats.

    halved : cut every stretch between two knots in half, for a second answer with other steps;
        without gas there is a cut at every half radian then
    """

    def __init__(
        self, scene: Scene, pressure: PeriodicPressure | None, *, halved: bool = False
    ) -> None:
        crank, rod, piston = scene.crank, scene.rod, scene.piston
        self.scene, self.pressure, self.halved = scene, pressure, halved
        self.knots = crank_angle_knots(scene, pressure)
        if halved and len(self.knots):
            ends = np.append(self.knots, self.knots[0] + scene.period)
            middles = 0.5 * (ends[1:] + ends[:-1])
            self.knots = np.unique(np.concatenate([self.knots, middles % scene.period]))
        elif halved:
            self.knots = np.arange(0.0, scene.period, 0.5)
        self._r, self._l, self._a, self._e = (
            crank.radius,
            rod.length,
            rod.center_of_mass,
            piston.offset,
        )
        self._j0, self._m_rod, self._i_rod = crank.inertia, rod.mass, rod.moment_of_inertia
        self._m_piston, self._area = piston.mass, piston.gas_area or 0.0
        self._first_moment = crank.mass * crank.center_of_mass
        g = scene.gravity.acceleration if scene.gravity else 0.0
        pull = scene.gravity.angle if scene.gravity else 0.0
        self._g = (g * math.cos(pull), g * math.sin(pull))
        self._cylinders = [
            (c, g * math.cos(pull - c.bank), g * math.sin(pull - c.bank)) for c in scene.cylinders
        ]

    def around(self, theta: float, sense: float) -> Between:
        """The knots next to theta in the sense of rotation, and the polynomials between them."""
        if not len(self.knots):
            return Between(-math.inf, math.inf, (_NO_GAS,) * len(self._cylinders))
        period, knots = self.scene.period, self.knots
        ahead = theta + sense * _PASSED
        turn = math.floor(ahead / period)
        k = int(np.searchsorted(knots, ahead - turn * period, side="right"))
        low = knots[k - 1] if k > 0 else knots[-1] - period
        high = knots[k] if k < len(knots) else knots[0] + period
        middle = 0.5 * (low + high)
        pieces = tuple(self._piece(c, turn * period, middle) for c, *_ in self._cylinders)
        return Between(turn * period + low, turn * period + high, pieces)

    @cached_property
    def torque_scale(self) -> float:
        """Largest torque of gas and gravity over one period, and of constant and tabled loads
        [N m]."""
        load = sum(
            abs(t.torque) if isinstance(t, Constant) else max(map(abs, t.file.y))
            for t in self.scene.torque
            if isinstance(t, Constant | TimeTable | SpeedTable)
        )
        angles = 0.1 + np.linspace(0.0, self.scene.period, 721)  # no fold lies there
        torques = [abs(self(a, self.around(a, 1.0).pieces)[2]) for a in angles.tolist()]
        return load + max(torques)

    def _piece(self, cylinder: Cylinder, base: float, middle: float) -> Polynomial:
        """Knot (as a crank angle) and coefficients of the piece around base + middle."""
        if self.pressure is None:
            return _NO_GAS
        knots, coefficients = self.pressure.knots, self.pressure.coefficients
        within = (middle + cylinder.phase - knots[0]) % self.pressure.period
        i = int(np.searchsorted(knots - knots[0], within, side="right")) - 1
        knot = base + middle - (within - (knots[i] - knots[0]))
        a, b, c, d = (float(q) for q in coefficients[:, i])
        return float(knot), a, b, c, d

    def __call__(self, theta: float, pieces: tuple[Polynomial, ...]) -> tuple[float, float, float]:
        """J [kg m2], dJ/dtheta [kg m2/rad], torque of gas and gravity [N m]."""
        r, l, a, e = self._r, self._l, self._a, self._e
        spare, far = max(l - r - abs(e), 0.0), abs(e)
        inertia, slope = self._j0, 0.0
        gx, gy = self._g
        torque = self._first_moment * (gy * math.cos(theta) - gx * math.sin(theta))
        for (cylinder, gx, gy), (knot, c3, c2, c1, c0) in zip(self._cylinders, pieces, strict=True):
            phi = theta + cylinder.phase
            sin_p, cos_p = math.sin(phi), math.cos(phi)
            sin_b = (r * sin_p - e) / l
            wide = 1.0 + abs(sin_p)
            narrow = cos_p * cos_p / wide
            above, below = (narrow, wide) if sin_p > 0.0 else (wide, narrow)  # 1 - sin_p, 1 + sin_p
            cos_b = math.sqrt((spare + far + e + r * above) * (spare + far - e + r * below)) / l
            b1 = r * cos_p / (l * cos_b)
            towards = (below if e >= 0.0 else above) / l
            bend = sin_p * (spare / l) * (1.0 + (r + far) / l) + e * r * towards * towards
            b2 = -r * bend / (l * cos_b**3)
            x1 = -r * sin_p - l * sin_b * b1
            x2 = -r * cos_p - l * (cos_b * b1 * b1 + sin_b * b2)
            gx1, gy1 = -r * sin_p - a * sin_b * b1, r * cos_p - a * cos_b * b1
            gx2 = -r * cos_p - a * (cos_b * b1 * b1 + sin_b * b2)
            gy2 = -r * sin_p - a * (cos_b * b2 - sin_b * b1 * b1)
            inertia += (
                self._m_piston * x1 * x1
                + self._m_rod * (gx1 * gx1 + gy1 * gy1)
                + self._i_rod * b1 * b1
            )
            slope += 2.0 * (
                self._m_piston * x1 * x2
                + self._m_rod * (gx1 * gx2 + gy1 * gy2)
                + self._i_rod * b1 * b2
            )
            d = theta - knot
            gas = self._area * (((c3 * d + c2) * d + c1) * d + c0)
            torque += (self._m_piston * gx - gas) * x1 + self._m_rod * (gx * gx1 + gy * gy1)
        return inertia, slope, torque
