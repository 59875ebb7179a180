"""Work of the gas by quadrature, for tests of what a scene says about its load and power."""

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.pressure import pressures_of


def gas_work(scene):
    """Work of one cylinder's gas over a cycle [J], by Gauss quadrature on each piece."""
    pressure = pressures_of(scene)[0]
    node, weight = np.polynomial.legendre.leggauss(6)
    width = np.diff(pressure.knots)[:, None]
    distance = 0.5 * width * (node + 1.0)
    value = pressure.piece(np.arange(len(width))[:, None], distance)
    loop = close_loop(
        pressure.knots[:-1, None] + distance,
        scene.crank.radius,
        scene.rod.length,
        scene.piston.offset,
    )
    return float(np.sum(-value * loop.x_1 * weight * 0.5 * width)) * scene.piston.gas_area
