"""Orders of the torque and of the force on the frame, beside closed forms at constant speed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from crankmbs.measures.estimate import Estimate
from crankmbs.measures.orders import Harmonics, Orders
from crankmbs.measures.span import Span
from crankmbs.measures.summary import mean_speed
from crankmbs.mechanics.harmonics import Waves, closed_orders
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["EngineOrder", "EngineOrders", "engine_orders"]

_ON_PISTONS = ("gas_force", "friction_force", "applied_force")  # towards the crank


@dataclass(frozen=True)
class EngineOrder:
    """One quantity's orders in a run, and in closed form.

    closed : shape (n,) amplitude exp(i phase) [units] at constant speed, zero at half orders; None
        where there is none
    """

    quantity: str
    units: str
    orders: Orders
    closed: Waves | None


@dataclass(frozen=True)
class EngineOrders:
    """The orders of an engine over a stretch of its run.

    speed [rad/s] : the mean, which the closed forms are taken at
    """

    window: Span
    speed: Estimate
    rows: tuple[EngineOrder, ...]


def engine_orders(result: Result, highest: float = 12.0) -> EngineOrders:
    """Orders of torque and frame force over the last whole cycle of a run, or the last period.

    "torque" is that of all rods on the crank; "inertia torque" what of it comes neither from the
    gas, the friction and the forces from outside on the pistons nor from the weights of rods and
    pistons. Closed forms are `crankmbs.mechanics.harmonics` at the
    mean speed: what a run differs by is the part of its changing speed.

    Raises
    ------
    InputError : as `crankmbs.measures.orders.orders`

    >>> [row.quantity for row in engine_orders(simulate(load_scene("propeller"))).rows]
    ['torque', 'inertia torque', 'frame force x', 'frame force y']
    """
    harmonics = Harmonics(result, highest)
    speed = mean_speed(result, harmonics.window)
    closed = closed_orders(result.scene, int(highest)) if highest >= 1.0 else None

    def at_mean(name: str) -> Waves | None:
        if closed is None:
            return None
        waves = np.zeros(len(harmonics.order), dtype=np.complex128)
        waves[harmonics.order % 1.0 == 0.0] = getattr(closed, name) * speed.value**2
        return waves

    torque = harmonics.split(lambda v: v["crank_torque"].sum(axis=1))
    inertia = harmonics.split(_inertia_torque(result))
    rows = [
        EngineOrder("torque", "N m", torque, None),
        EngineOrder("inertia torque", "N m", inertia, at_mean("torque")),
    ]
    for axis in "xy":
        name = f"frame_force_{axis}"
        rows.append(EngineOrder(f"frame force {axis}", "N", harmonics.of(name), at_mean(name)))
    return EngineOrders(harmonics.window, speed, tuple(rows))


def _inertia_torque(result: Result) -> Callable[[Mapping[str, Array]], Array]:
    scene = result.scene
    weightless = replace(scene, crank=replace(scene.crank, mass=0.0))
    parts = CrankTrain(weightless, None)  # its torque is that of the weights of rods and pistons

    def torque(variables: Mapping[str, Array]) -> Array:
        per_speed = variables["piston_velocity"] / variables["crank_speed"][:, None]
        forces = sum(variables[name] for name in _ON_PISTONS if name in variables)
        weights = reduce(parts, variables["crank_angle"]).torque
        torque = variables["crank_torque"] - forces * per_speed
        return np.asarray(torque.sum(axis=1) - weights)

    return torque
