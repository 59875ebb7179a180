"""Two runs of one scene, sample by sample: their difference beside both stated errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from crankmbs.errors import InputError
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.drives import Start
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene

__all__ = ["Difference", "differences", "followed"]


_SAME = 1e-6  # of the sample spacing: so near each other two samples are one
_MOTION = {
    "crank speed": ("crank_speed",),
    "crank acceleration": ("crank_acceleration",),
    "piston displacement": ("piston_displacement",),
    "piston velocity": ("piston_velocity",),
    "piston acceleration": ("piston_acceleration",),
}
_FORCES = {
    "main bearing": ("main_bearing_force_x", "main_bearing_force_y"),
    "crank pin": ("crank_pin_force_x", "crank_pin_force_y"),
    "piston pin": ("piston_pin_force_x", "piston_pin_force_y"),
    "side force": ("side_force",),
    "external torque": ("external_torque",),
}


@dataclass(frozen=True)
class Difference:
    """One quantity of two runs.

    size : shape (n, 1) or (n, cylinders) [units], length of the difference at the samples
    crank_angle : shape (n,) [rad]
    peak [units] : largest value of the quantity
    errors [units] : what each of the two runs states; formulations : their names
    """

    quantity: str
    units: str
    crank_angle: Array
    size: Array
    peak: float
    errors: tuple[float, float]
    formulations: tuple[str, str]

    @property
    def largest(self) -> tuple[float, int, int]:
        """Largest difference [units], its sample and its column."""
        sample, column = np.unravel_index(int(np.argmax(self.size)), self.size.shape)
        return float(self.size[sample, column]), int(sample), int(column)

    @property
    def share(self) -> float:
        """Largest difference over the sum of the stated errors; at most 1 where both hold."""
        allowed, largest = sum(self.errors), self.largest[0]
        if allowed == 0.0:
            return 0.0 if largest == 0.0 else math.inf
        return largest / allowed


def followed(result: Result) -> Scene:
    """The scene of a run that shows the same motion: a settled one as the run of one period from
    its first sample, which formulations follow that solve for none.

    >>> followed(simulate(load_scene("coasting"))).run.until.unit
    's'
    """
    scene = result.scene
    if not scene.settles or result.status != 0:
        return scene
    angle, speed = (float(result.data[name].values[0]) for name in ("crank_angle", "crank_speed"))
    run = replace(scene.run, until=Extent(value=scene.settled_period, unit="rad"))
    return replace(scene, start=Start(angle=angle, speed=speed), run=run)


def differences(result: Result, check: Result) -> tuple[Difference, ...]:
    """Compare two runs of one scene at equal samples, over the stretch that both cover.

    A run that ends before the other has a sample at its end that the other has not, and where only
    one of them comes to another angle before it reverses their samples part: they are compared up
    to there. Forces are compared as vectors. With samples on crank angles the motion differs in the
    time at which they are passed, with samples in time in the crank angle.

    Raises
    ------
    InputError : the runs are not of one scene (their formulations and rtol may differ)

    >>> scene = load_scene("coasting")
    >>> differences(simulate(scene), simulate(scene, rtol=1e-6))[0].quantity
    'time'
    """
    plan = plan_of(result.scene)
    if plan != plan_of(check.scene) or _cylinders(result) != _cylinders(check):
        raise InputError("only runs of one scene, sampled alike, can be compared")
    base = {"crank angle": ("crank_angle",)} if plan.in_time else {"time": ("time",)}
    rows = {**base, **_MOTION, **_FORCES}
    n = min(result.data.sizes["time"], check.data.sizes["time"])
    # where only the end is kept the samples agree from the end, else from the start
    kept = slice(-n, None)
    if result.scene.run.every is not None:
        kept = slice(_shared(result, check, plan))
    return tuple(_difference(result, check, kept, *row) for row in rows.items())


def _shared(result: Result, check: Result, plan: Plan) -> int:
    """How many samples both runs have, counted from the start."""
    runs = (result, check)
    a, b = (run.data["time" if plan.in_time else "crank_angle"].values for run in runs)
    n = min(len(a), len(b))
    apart = np.abs(a[:n] - b[:n]) > _SAME * plan.every
    if len(a) == len(b) and result.status == check.status:
        apart[-1] = False  # the end, which each may reach elsewhere
    return max(int(np.argmax(apart)) if apart.any() else n, 1)


def _difference(
    result: Result, check: Result, kept: slice, title: str, names: tuple[str, ...]
) -> Difference:
    ours = [result.data[name].values for name in names]
    theirs = [check.data[name].values for name in names]
    size = np.sqrt(sum((a[kept] - b[kept]) ** 2 for a, b in zip(ours, theirs, strict=True)))
    length = np.sqrt(sum(a**2 for a in ours))
    return Difference(
        quantity=title,
        units=str(result.data[names[0]].attrs["units"]),
        crank_angle=result.data["crank_angle"].values[kept],
        size=size.reshape(len(size), -1),
        peak=float(np.max(length)),
        errors=(_stated(result, names), _stated(check, names)),
        formulations=(result.formulation, check.formulation),
    )


def _stated(result: Result, names: tuple[str, ...]) -> float:
    return math.hypot(*(result.data[name].attrs["error_estimate"] for name in names))


def _cylinders(result: Result) -> int:
    return int(result.data.sizes["cylinder"])
