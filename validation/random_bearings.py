"""Bearings for a random machine: throws along its crank, rods that share pins, journals between
them, and unbalances that add up to the crank's."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs import Bearings, Layout, Scene
from crankmbs.scene.parts import Cylinder

__all__ = ["random_bearings"]

_TURN = 2.0 * math.pi


def random_bearings(scene: Scene, seed: int) -> Scene:
    """A scene with bearings drawn from a seed; its motion, and every other force, as they were, but
    where rods come to share a pin."""
    rng = np.random.default_rng([35, seed])
    cylinders = list(scene.cylinders)
    count = int(rng.integers(1, len(cylinders) + 1))
    numbers = rng.permutation([*range(count), *rng.integers(0, count, len(cylinders) - count)])
    sense = float(rng.choice([-1.0, 1.0]))
    edges = sense * np.cumsum(rng.uniform(0.05, 0.2, 2 * count + 1)) + rng.uniform(-1.0, 1.0)
    journals, middles = edges[0::2], edges[1::2]
    turns: dict[int, float] = {}
    for k, throw in enumerate(numbers.tolist()):
        one = cylinders[k]
        turn = turns.setdefault(throw, one.phase + one.bank)
        spread = 0.04 * rng.uniform(-1.0, 1.0) if list(numbers).count(throw) > 1 else 0.0
        cylinders[k] = Cylinder(
            phase=one.phase,
            bank=math.remainder(turn - one.phase, _TURN),
            position=float(middles[throw]) + spread,
            throw=throw + 1,
        )
    bearings = Bearings(
        journal_positions=tuple(journals.tolist()) if count > 1 or rng.random() < 0.7 else None,
        throw_unbalance=_unbalances(rng, scene, [turns[k] for k in range(count)]),
    )
    layout = Layout(cylinders=tuple(cylinders))
    return replace(scene, layout=layout, bearings=bearings)


def _unbalances(
    rng: np.random.Generator, scene: Scene, turns: list[float]
) -> tuple[float, ...] | None:
    """Of each throw: all but two at random, those two so that they close."""
    whole = scene.crank.mass * scene.crank.center_of_mass
    if len(turns) < 2 or rng.random() < 0.3:
        return None
    size = abs(whole) or 0.01
    given = size * rng.uniform(-2.0, 2.0, len(turns) - 2)
    along = np.exp(1j * np.array(turns))
    left = whole - complex(given @ along[:-2])
    last = np.array([along[-2:].real, along[-2:].imag])
    if abs(np.linalg.det(last)) < 0.1:
        return None
    return (*given.tolist(), *np.linalg.solve(last, [left.real, left.imag]).tolist())
