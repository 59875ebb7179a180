"""Two runs of one scene with equal samples, quantity by quantity."""

import math

import numpy as np

from crankmbs.compare.confirm import Difference
from crankmbs.motion.plan import plan_of

_JOINTS = ("main_bearing", "crank_pin", "piston_pin")
ROWS = {
    "crank speed": ("crank_speed",),
    "crank acceleration": ("crank_acceleration",),
    "piston displacement": ("piston_displacement",),
    "piston velocity": ("piston_velocity",),
    "piston acceleration": ("piston_acceleration",),
    **{j.replace("_", " "): (f"{j}_force_x", f"{j}_force_y") for j in _JOINTS},
    "side force": ("side_force",),
    "external torque": ("external_torque",),
}


def differences(result, check):
    """What two runs differ by at their samples, beside the errors that both state."""
    base, rows = "crank_angle" if plan_of(result.scene).in_time else "time", []
    for title, names in {base.replace("_", " "): (base,), **ROWS}.items():
        ours, theirs = (np.array([run.data[name] for name in names]) for run in (result, check))
        size = np.sqrt(((ours - theirs) ** 2).sum(axis=0))
        stated = [
            math.hypot(*(run.data[name].attrs["error_estimate"] for name in names))
            for run in (result, check)
        ]
        rows.append(
            Difference(
                quantity=title,
                units=result.data[names[0]].attrs["units"],
                crank_angle=result.data["crank_angle"].values,
                size=size.reshape(len(size), -1),
                peak=float(np.max(np.sqrt((ours**2).sum(axis=0)))),
                errors=tuple(stated),
                formulations=(result.formulation, check.formulation),
            )
        )
    return tuple(rows)
