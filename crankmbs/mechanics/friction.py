"""Friction of the pistons on their walls.

    friction_force = -sign(v) (ring_force + ring_pressure |gas_force|) - viscous v

with the piston's velocity v = -x_1 omega, positive towards the crank. A piston changes the sense in
which it slides at its dead centres, which are known angles: there the value after counts. By
virtual work the crank feels

    Q = sum of friction_force dv/domega
      = -sign(omega) sum (ring_force |x_1| + ring_pressure |Q_gas|) - viscous omega sum x_1^2

with the torque Q_gas of each cylinder's gas. So at one sense of rotation all but the last term is a
function of the angle, smooth between the dead centres and the angles at which a gas force changes
its sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.axes import axes_of, closed_loops, gears_of
from crankmbs.mechanics.axes import slides as sliding
from crankmbs.mechanics.inertia import fired_torque, gas_at
from crankmbs.mechanics.pressure import pressures_at
from crankmbs.mechanics.torque import pushing
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phases
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import period_of
from crankmbs.scene.parts import Friction

__all__ = [
    "Rubbing",
    "friction_forces",
    "friction_torque",
    "held_share",
    "rubbing",
]

_NONE = Friction()


class Rubbing(NamedTuple):
    """What rubs at crank angles of shape (...), as torques on the crank, with what of the forces
    from outside on the pistons does as friction does.

    rings : shape (...) [N m], of the ring force, against either sense of rotation
    gas : shape (..., cylinders) [N m], torque of the gas without combustion, of which the rings
        feel the share ``pressed``
    drag : shape (...) [N m s/rad], of the viscous friction per speed
    """

    rings: Array
    gas: Array
    drag: Array
    pressed: float

    def coulomb(self, more: Array | float = 0.0) -> Array:
        """Torque against either sense of rotation [N m]; ``more``: what combustion adds to that of
        the gas."""
        return np.asarray(self.rings + self.pressed * np.abs(self.gas + more).sum(axis=-1))


def rubbing(train: CrankTrain, theta: ArrayLike, phases: Phases = ()) -> Rubbing:
    """Friction reduced to the crank, at crank angles of shape (...) [rad], in these phases of the
    loads; exact.

    >>> float(rubbing(crank_train(load_scene("coasting")), 1.0).coulomb())
    0.0
    """
    scene, friction = train.scene, train.scene.friction or _NONE
    theta = np.asarray(theta, dtype=np.float64)
    angles = theta.ravel()
    loop = closed_loops(scene, angles)
    x_1 = loop.x_1
    rings = friction.ring_force * np.abs(x_1).sum(axis=0)
    drag = friction.viscous * (x_1**2).sum(axis=0)
    for push in pushing(train, phases):
        more = push.resisting(angles, loop)
        rings, drag = rings + more[0], drag + more[1]
    pressure = gas_at(train, angles)
    gas = np.zeros_like(x_1) if pressure is None else pressure
    torque = -gears_of(scene).area * gas * x_1
    return Rubbing(
        rings.reshape(theta.shape),
        torque.T.reshape(*theta.shape, len(torque)),
        drag.reshape(theta.shape),
        friction.ring_pressure,
    )


def friction_torque(
    train: CrankTrain,
    theta: ArrayLike,
    omega: ArrayLike,
    sense: ArrayLike,
    shares: ArrayLike | None = None,
    phases: Phases = (),
) -> Array:
    """Torque of the friction on the crank [N m], at crank angles, speeds and senses of rotation of
    one shape (...) [rad, rad/s, a sign]; 0 where nothing rubs.

    shares : shape (cylinders,) or (..., cylinders), of the combustion; None leaves it out

    >>> float(friction_torque(crank_train(load_scene("coasting")), 1.0, 2.0, 1.0))
    0.0
    """
    if not train.rubs:
        return np.zeros(np.shape(theta))
    rubbed, more = rubbing(train, theta, phases), 0.0
    if shares is not None and train.combustion is not None:
        more = fired_torque(train, theta) * np.asarray(shares)
    against = np.asarray(sense) * rubbed.coulomb(more)
    return np.asarray(-against - rubbed.drag * np.asarray(omega))


def friction_forces(
    train: CrankTrain,
    theta: Array,
    omega: Array,
    fuel: Array | None = None,
    slides: Array | None = None,
) -> Array:
    """Friction on every piston [N], positive towards the crank; exact.

    Parameters
    ----------
    theta, omega : shape (n,) [rad, rad/s]
    fuel : shape (n, cylinders), shares of the combustion; None leaves it out
    slides : shape (n,), the sense of rotation that sets the sense of sliding, by default the sign
        of the speed; between -1 and 1 it is, at rest, the share of the friction that holds

    Returns
    -------
    shape (n, cylinders); 0 at rest, where ``slides`` is not given

    >>> friction_forces(crank_train(load_scene("coasting")), np.ones(1), np.ones(1)).shape
    (1, 1)
    """
    scene, friction = train.scene, train.scene.friction or _NONE
    theta, omega = np.asarray(theta, dtype=np.float64), np.asarray(omega, dtype=np.float64)
    slides = np.sign(omega) if slides is None else slides
    area, period = gears_of(scene).area, period_of(theta, train.period)
    phi = np.add.outer(axes_of(scene).phases, period.angles)
    gas = np.zeros((len(phi), len(theta)))
    if train.pressure is not None:
        gas += (area * pressures_at(train.pressure, phi))[:, period.which]
    if train.combustion is not None and fuel is not None:
        gas += fuel.T * (area * pressures_at(train.combustion, phi))[:, period.which]
    ways = (sliding(scene, period.angles, sense)[:, period.which] for sense in (1.0, -1.0))
    towards = np.where(slides >= 0.0, *ways)
    limit = friction.ring_force + friction.ring_pressure * np.abs(gas)
    velocity = -closed_loops(scene, period.angles).x_1[:, period.which] * omega
    forces = -np.abs(slides) * towards * limit - friction.viscous * velocity
    return np.asarray(forces.T)


def held_share(
    train: CrankTrain,
    theta: float,
    torque: ArrayLike,
    shares: Sequence[float] = (),
    phases: Phases = (),
) -> Array:
    """The share of the friction of a crank at rest that it takes to hold a torque [N m] on it, with
    its sign; above 1 or below -1 it does not hold, infinite where nothing rubs.

    >>> float(held_share(crank_train(load_scene("coasting")), 1.0, -3.0))
    -inf
    """
    torque = np.asarray(torque, dtype=np.float64)
    most = -friction_torque(train, theta, 0.0, 1.0, shares or None, phases)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(torque == 0.0, 0.0, torque / np.abs(most))
