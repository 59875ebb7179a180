"""What the moving parts do to the frame, from exudyn's own coordinates and accelerations."""

from __future__ import annotations

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["frame_of"]

Bodies = tuple[Array, Array, Array]


def frame_of(scene: Scene, torque: Array, at: Bodies, acceleration: Bodies) -> dict[str, Array]:
    """Force and moments of the moving parts on the frame, by the balance of momentum.

        force = sum m (g - a)
        moment = torque + sum r x m (g - a) - sum I rate of spin

    Parameters
    ----------
    torque : shape (m,) [N m], from outside on the crank
    at, acceleration : crank (m, 3), rods (m, n, 3), pistons (m, n, 2): x, y [m], angle [rad] in the
        engine's frame, and their second derivatives

    Returns
    -------
    dict of the frame's variables, shape (m,), in N and N m
    """
    crank, rod, g = scene.crank, scene.rod, 0.0j
    if scene.gravity is not None:
        g = scene.gravity.acceleration * np.exp(1j * scene.gravity.angle)
    masses = (crank.mass, rod.mass, scene.piston.mass)
    forces = [m * (g - _complex(a)) for m, a in zip(masses, acceleration, strict=True)]
    about = [(_complex(r).conj() * f).imag for r, f in zip(at, forces, strict=True)]
    of_crank, of_rods, of_pistons = forces
    of_cylinders = of_rods + of_pistons
    force = of_crank + of_cylinders.sum(axis=1)
    own = crank.moment_of_inertia - crank.mass * crank.center_of_mass**2
    spin = own * acceleration[0][:, 2]
    spin = spin + rod.moment_of_inertia * acceleration[1][..., 2].sum(axis=1)
    moment = torque - spin + about[0] + (about[1] + about[2]).sum(axis=1)
    found = {"frame_force_x": force.real, "frame_force_y": force.imag, "frame_moment": moment}
    if scene.levers is not None:
        rocking = of_cylinders @ np.array(scene.levers)
        found |= {"rocking_moment_x": -rocking.imag, "rocking_moment_y": rocking.real}
    return found


def _complex(planar: Array) -> Array:
    return np.asarray(planar[..., 0] + 1j * planar[..., 1])
