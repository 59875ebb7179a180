"""Valid scenes of a free crank that settles, drawn from a seed: the machines of `random_scene`
under loads that take what gas and weight give at one speed, more above it and less below."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs import Scene
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.train import crank_train
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import Constant, Quadratic, SpeedTable, Viscous
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from validation.random_scenes import random_scene

__all__ = ["random_settled"]

_SPARE = 1.1  # times the shortest rod
_KINDS = ("quadratic", "viscous", "table", "all")


def random_settled(seed: int) -> Scene:
    """The scene of a seed."""
    rng, base = np.random.default_rng([14, seed]), random_scene(seed)
    # a rod that just escapes its fold is left to the ordinary runs: the oracle has even panels
    least = _SPARE * (base.crank.radius + abs(base.piston.offset))
    base = replace(base, rod=replace(base.rod, length=max(base.rod.length, least)))
    train, angles = crank_train(base), np.linspace(0.0, base.period, 2001)[:-1]
    inertia, _, torque = reduce(train, angles)
    sense = 1.0 if rng.random() < 0.7 else -1.0
    # so fast that gas and weight change the speed by a part of it at most, or hardly
    swing = float(np.ptp(np.cumsum(torque - torque.mean()))) * (angles[1] - angles[0])
    stiff = math.exp(rng.uniform(math.log(3.0), math.log(300.0)))
    slow = math.sqrt(2.0 * stiff * max(swing, 1e-3) / float(inertia.min()))
    speed = max(slow, 3.0)
    # what the load takes in a radian, of the energy: from far slower to about as fast as a cycle
    taken = 0.5 * float(inertia.mean()) * speed**2 * math.exp(rng.uniform(-8.0, -2.5))
    drive = Constant(torque=sense * taken - float(torque.mean()))
    loads = _loads(rng, _KINDS[int(rng.integers(len(_KINDS)))], taken, speed)
    run = Run(
        until="settled",
        every=Extent(value=base.period / int(rng.integers(7, 20)), unit="rad"),
        rtol=math.exp(rng.uniform(math.log(1e-12), math.log(1e-4))),
    )
    start = Start(
        angle=float(rng.uniform(-7.0, 7.0)),
        speed=sense * speed * float(rng.uniform(0.8, 1.6)),
    )
    return replace(base, start=start, torque=(drive, *loads), run=run)


def _loads(rng: np.random.Generator, kind: str, taken: float, speed: float) -> tuple[Torque, ...]:
    """Loads that take a torque [N m] at a speed [rad/s], and at its negative."""
    if kind == "quadratic":
        return (Quadratic(coefficient=taken / speed**2),)
    if kind == "viscous":
        return (Viscous(coefficient=taken / speed),)
    if kind == "table":
        return (_table(rng, taken, speed),)
    third = taken / 3.0
    both = Quadratic(coefficient=third / speed**2), Viscous(coefficient=third / speed)
    return (*both, _table(rng, third, speed))


def _table(rng: np.random.Generator, taken: float, speed: float) -> SpeedTable:
    """An odd table that falls from row to row."""
    rows = np.sort(rng.uniform(0.3, 2.0, int(rng.integers(2, 6)))) * speed
    values = np.cumsum(rng.uniform(0.2, 2.0, len(rows)))
    values *= taken / float(np.interp(speed, rows, values))
    x, y = (*(-rows[::-1]), *rows), (*values[::-1], *(-values))
    return SpeedTable(file=Table(tuple(map(float, x)), tuple(map(float, y))))
