"""What is compared: the lectures' quantities, how they follow from a run's variables, and these
variables themselves.

The lectures' net force, rod force, tangential and radial force belong to a rod without mass. A
rod of any inertia has them too: they are what is left of the crank pin force when the inertia
force of the mass m_or, which the two-mass rod puts on the crank pin, is taken out of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from crankmbs.compare.bodies import Bodies
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = [
    "OBSERVABLES",
    "QUANTITIES",
    "Quantity",
    "cycle_angles",
    "observed",
    "variable_of",
]


class Quantity(NamedTuple):
    """units; the lectures' symbol in TeX, if they have one; ``per_cylinder`` or of the engine."""

    units: str
    symbol: str = ""
    per_cylinder: bool = True


QUANTITIES = {
    "piston displacement": Quantity("m", "s"),
    "piston velocity": Quantity("m/s", "v"),
    "piston acceleration": Quantity("m/s^2", "a"),
    "net force": Quantity("N", "F_v"),
    "side thrust": Quantity("N", "N"),
    "rod force": Quantity("N", "F_{oj}"),
    "tangential force": Quantity("N", "F_T"),
    "radial force": Quantity("N", "F_R"),
    "torque": Quantity("N m", "M_k"),
    "gas torque": Quantity("N m"),
    "piston pin force x": Quantity("N"),
    "piston pin force y": Quantity("N"),
    "crank pin force x": Quantity("N"),
    "crank pin force y": Quantity("N"),
    "main bearing force x": Quantity("N", per_cylinder=False),
    "main bearing force y": Quantity("N", per_cylinder=False),
}

OBSERVABLES = {
    name.replace("_", " "): Quantity(variable.units, per_cylinder=variable.per_cylinder)
    for name, variable in EVERY.items()
    if name not in ("time", "crank_angle", "fuel") and variable.of in ("", "cylinder")
} | QUANTITIES
"""What a formula may stand for: the lectures' quantities, and the variables of a result."""


_CALLED = {"side thrust": "side_force", "torque": "crank_torque"}


def variable_of(quantity: str) -> str:
    """The variable of a result that a quantity is, if it is one."""
    return _CALLED.get(quantity, quantity.replace(" ", "_"))


def cycle_angles(scene: Scene, theta: Array) -> Array:
    """Cycle angle of every cylinder at the crank angles, shape (n, cylinders) [rad]."""
    phases = np.array([cylinder.phase for cylinder in scene.cylinders], dtype=np.float64)
    return np.asarray(np.add.outer(phases, theta).T)


def observed(
    bodies: Bodies, variables: Mapping[str, Array], phi: Array, omega: Array, alpha: Array
) -> dict[str, Array]:
    """The compared quantities of a run, or of `crankmbs.mechanics.reactions.reactions`.

    With S the crank pin force and C the crank pin, the load through the rod is S - m_or C'':

        F_v = X part,  F_oj = part along the rod,  F_T = R sin(phi) - part across the throw, ...

    Exact for any rigid rod.

    Parameters
    ----------
    variables : by name, as in `crankmbs.result.VARIABLES`, SI units, shape (..., n, cylinders)
    phi : cycle angles, shape (n, cylinders) [rad]; omega, alpha : shape (..., n) or (..., 1)
        [rad/s, rad/s2], the motion they belong to

    Returns
    -------
    dict over QUANTITIES: shape (..., n, cylinders), those of the whole engine (..., n); "gas
    torque" is the gas force times ds/dphi = r (sin(phi) + cos(phi) tan(beta)), also at rest
    """
    omega, alpha = omega[..., None], alpha[..., None]
    sin_phi, cos_phi = np.sin(phi), np.cos(phi)
    square = omega**2
    turning = bodies.masses.crank_pin * bodies.crank_radius
    through_x = variables["crank_pin_force_x"] + turning * (cos_phi * square + sin_phi * alpha)
    through_y = variables["crank_pin_force_y"] + turning * (sin_phi * square - cos_phi * alpha)
    beta = variables["rod_angle"]
    lever = bodies.crank_radius * (sin_phi + cos_phi * np.tan(beta))
    through = {
        "net force": through_x,
        "rod force": through_x * np.cos(beta) - through_y * np.sin(beta),
        "tangential force": through_x * sin_phi - through_y * cos_phi,
        "radial force": through_x * cos_phi + through_y * sin_phi,
        "gas torque": variables["gas_force"] * lever,
    }
    return {
        name: through[name] if name in through else variables[variable_of(name)]
        for name in QUANTITIES
    }
