"""What the main journals carry, against beams on two supports, and what they carry together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.journals import Pin, Throw, journal_forces
from validation.random_bearings import random_bearings
from validation.random_friction import random_friction
from validation.random_scenes import random_scene

__all__ = ["beams", "of_runs"]

_NOTHING = 1e-12  # N: rounding, where a crank rests and nothing pulls
_MOTION = ("crank_angle", "crank_speed", "crank_acceleration")


def beams(case: Case) -> Outcome:
    """At random states of motion of random machines, every joint force by the oracles: the largest
    difference of a journal's force over the largest force of a joint."""
    worst, said = 0.0, ""
    for seed in _seeds(case):
        scene = random_bearings(random_scene(seed), seed)
        theta, omega, alpha = (
            np.random.default_rng([36, seed])
            .uniform([-13.0, -300.0, -2e4], [13.0, 300.0, 2e4], (5, 3))
            .T
        )
        ours = reactions(crank_train(_ours(case, scene)), theta, omega, alpha)
        exact = reference_variables(scene, theta, omega, alpha)
        worst, said = max(
            (worst, said), (_apart(scene, ours, exact, (theta, omega, alpha)), f"seed {seed}")
        )
    return Outcome(worst, said)


def of_runs(case: Case) -> Outcome:
    """Over runs with friction, by one formulation or another, from the crank pins of the run."""
    worst, said, count = 0.0, "", 0
    for seed in _seeds(case):
        scene = random_bearings(random_friction(seed), seed)
        names = case.parameters["formulations"]
        result = simulate(_ours(case, scene), formulation=names[seed % len(names)])
        variables = {str(name): one.values for name, one in result.data.variables.items()}
        theta, omega, alpha = (variables[name] for name in _MOTION)
        count += len(theta)
        worst, said = max(
            (worst, said),
            (_apart(scene, variables, variables, (theta, omega, alpha)), f"seed {seed}"),
        )
    return Outcome(worst, f"{said}; {count} samples")


def _seeds(case: Case) -> range:
    first = int(case.parameters["first"])
    return range(first, first + int(case.parameters["count"]))


def _ours(case: Case, scene: Scene) -> Scene:
    """With the journals of the case a little aside, where they have places."""
    bearings = scene.bearings
    assert bearings is not None
    places = bearings.journal_positions
    if places is None:
        return scene
    aside = (places[0] + (case.number("aside") - 1.0) * (places[1] - places[0]), *places[1:])
    return replace(scene, bearings=replace(bearings, journal_positions=aside))


def _apart(
    scene: Scene, ours: dict[str, Array], pins: dict[str, Array], motion: tuple[Array, Array, Array]
) -> float:
    """Also of the sum of all journals from the main bearing, and of shared pins from their rods."""
    banks = np.array([cylinder.bank for cylinder in scene.cylinders])
    rods = (pins["crank_pin_force_x"] + 1j * pins["crank_pin_force_y"]) * np.exp(1j * banks)
    gravity = 0.0j
    if scene.gravity is not None:
        gravity = scene.gravity.acceleration * np.exp(1j * scene.gravity.angle)
    exact = journal_forces(_throws(scene, rods), motion, gravity)
    found, bearing = (
        ours[f"{name}_force_x"] + 1j * ours[f"{name}_force_y"]
        for name in ("main_journal", "main_bearing")
    )
    largest = max(float(np.abs(each).max()) for each in (rods, exact, bearing))
    largest = largest if largest > _NOTHING else 1.0
    apart = [np.abs(found - exact).max(), np.abs(found.sum(axis=1) - bearing).max()]
    if "pin_force_x" in ours:
        shared = ours["pin_force_x"] + 1j * ours["pin_force_y"]
        for k in range(shared.shape[1]):
            own = sum(rods[:, i] for i, c in enumerate(scene.cylinders) if c.throw == k + 1)
            apart.append(np.abs(shared[:, k] - own).max())
    return float(max(apart)) / largest


def _throws(scene: Scene, rods: Array) -> tuple[Throw, ...]:
    """Each throw from the words of its scene."""
    bearings, crank = scene.bearings, scene.crank
    assert bearings is not None
    count = max(c.throw or 0 for c in scene.cylinders)
    places, given = bearings.journal_positions, bearings.throw_unbalance
    throws = []
    for k in range(count):
        own = [i for i, c in enumerate(scene.cylinders) if c.throw == k + 1]
        along = [scene.cylinders[i].position or 0.0 for i in own]
        middle = sum(along) / len(own)
        if places is None:  # both supports carry half of everything
            along, middle, places = [0.0] * len(own), 0.0, (-1.0, 1.0)
        first = scene.cylinders[own[0]]
        unbalance = crank.mass * crank.center_of_mass / count + 0.0j
        if given is not None:
            unbalance = given[k] * np.exp(1j * (first.phase + first.bank))
        pins = tuple(Pin(place, rods[:, i]) for place, i in zip(along, own, strict=True))
        throws.append(
            Throw((places[k], places[k + 1]), middle, crank.mass / count, unbalance, pins)
        )
    return tuple(throws)
