"""What forces on the pistons alone do in every joint; no body needs them to move."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Parts", "fired_parts", "pushed_parts"]

Parts = dict[str, list[dict[int, Array]]]
"""By variable of the result, for the crank or for each cylinder: what each cylinder, by its number
from 0, adds, shape (n,) in the variable's unit."""


def fired_parts(train: CrankTrain, theta: Array) -> Parts:
    """What a share of 1 of each cylinder's combustion adds, at crank angles of shape (n,) [rad].

    >>> sorted(fired_parts(crank_train(load_scene("v_twin")), np.zeros(1)))[:1]
    ['external_torque']
    """
    scene, area = train.scene, train.scene.piston.gas_area or 0.0
    pressures = [
        more(theta + cylinder.phase)
        for cylinder, more in zip(scene.cylinders, train.combustion or (), strict=False)
    ]
    forces = [area * pressure for pressure in pressures]
    fired = pushed_parts(scene, theta, forces)
    for name, values in (("gas_pressure", pressures), ("gas_force", forces)):
        fired[name] = [{k: each} for k, each in enumerate(values)]
    return fired


def pushed_parts(scene: Scene, theta: Array, forces: list[Array]) -> Parts:
    """What forces on the pistons towards the crank add: the rods push along themselves.

    theta : shape (n,) [rad]; forces : of each cylinder, shape (n,) [N]

    >>> scene = load_scene("coasting")
    >>> pushed_parts(scene, np.zeros(1), [np.ones(1)])["piston_pin_force_x"]
    [{0: array([1.])}]
    """
    count, crank = len(scene.cylinders), scene.crank
    shape = (crank.radius, scene.rod.length, scene.piston.offset)
    of_crank = (
        "external_torque",
        "main_bearing_force_x",
        "main_bearing_force_y",
        "frame_moment",
    )
    fired: Parts = {name: [{}] for name in of_crank}
    for k, (cylinder, along) in enumerate(zip(scene.cylinders, forces, strict=False)):
        phi = theta + cylinder.phase
        loop = close_loop(phi, *shape)
        across = -along * loop.sin_beta / loop.cos_beta
        torque = crank.radius * (loop.sin_phi * along - loop.cos_phi * across)
        cos_bank, sin_bank = np.cos(cylinder.bank), np.sin(cylinder.bank)
        fired["external_torque"][0][k] = -torque
        fired["main_bearing_force_x"][0][k] = cos_bank * along - sin_bank * across
        fired["main_bearing_force_y"][0][k] = sin_bank * along + cos_bank * across
        fired["frame_moment"][0][k] = loop.x * across - scene.piston.offset * along
        for name, share in (("journal_torque", 1.0), ("pin_torque", 0.5)):
            column = fired.setdefault(name, [{} for _ in range(count)])
            column[k][k] = share * torque
            for behind in column[k + 1 :]:
                behind[k] = torque
        own = {
            "side_force": -across,
            "piston_pin_force_x": along,
            "piston_pin_force_y": across,
            "crank_pin_force_x": along,
            "crank_pin_force_y": across,
            "crank_torque": torque,
        }
        for name, values in own.items():
            fired.setdefault(name, [{} for _ in range(count)])[k][k] = values
    return fired
