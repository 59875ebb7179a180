"""What the combustion alone does in every joint, for a share of 1; no body needs it to move."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array

__all__ = ["fired_parts"]


def fired_parts(train: CrankTrain, theta: Array) -> dict[str, list[dict[int, Array]]]:
    """What a share of 1 of each cylinder's combustion adds: the rod pushes along itself.

    theta : shape (n,) [rad]

    Returns
    -------
    by variable of the result, for the crank or for each cylinder: what each cylinder, by its number
    from 0, adds, shape (n,) in the variable's unit

    >>> sorted(fired_parts(crank_train(load_scene("v_twin")), np.zeros(1)))[:1]
    ['external_torque']
    """
    scene, count = train.scene, len(train.scene.cylinders)
    crank, area = scene.crank, scene.piston.gas_area or 0.0
    shape = (crank.radius, scene.rod.length, scene.piston.offset)
    of_crank = (
        "external_torque",
        "main_bearing_force_x",
        "main_bearing_force_y",
        "frame_moment",
    )
    fired: dict[str, list[dict[int, Array]]] = {name: [{}] for name in of_crank}
    for k, (cylinder, more) in enumerate(
        zip(scene.cylinders, train.combustion or (), strict=False)
    ):
        phi = theta + cylinder.phase
        loop, pressure = close_loop(phi, *shape), more(phi)
        along = area * pressure
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
            "gas_pressure": pressure,
            "gas_force": along,
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
