"""The reduced equation of motion against the bodies' own equations at 40 digits."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import Gravity
from crankmbs.mechanics.axes import gravity_vector
from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.inertia import fired_torque, reduce, rod_centre
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots, crank_train
from crankmbs.scene.read import load_scene
from crankmbs.scene.shipped import shipped_scenes
from validation.adapter import reference_variables
from validation.oracles.arithmetic import multiprecision
from validation.random_scenes import random_scene

ANGLES = np.linspace(-6.0, 7.0, 6)
DIGITS = multiprecision(40)


def torque_from_outside(scene, omega, alpha):
    """What the oracle needs from outside at a motion, shape (n,)."""
    rest = np.zeros_like(ANGLES)
    found = reference_variables(scene, ANGLES, rest + omega, rest + alpha, DIGITS)
    return found["external_torque"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_every_term_of_the_equation_of_motion(seed):
    """T = J alpha + J_1 omega^2 / 2 - torque, term by term: at rest, then with one rate alone."""
    scene = random_scene(seed)
    inertia, slope, torque = reduce(crank_train(scene), ANGLES)
    held = torque_from_outside(scene, 0, 0)
    expected = {
        "torque": (torque, -held),
        "inertia": (inertia, torque_from_outside(scene, 0, 1) - held),
        "slope": (slope, 2 * (torque_from_outside(scene, 1, 0) - held)),
    }
    for name, (ours, exact) in expected.items():
        exact = exact.astype(float)
        floor = 1e-12 * inertia.max() if name == "slope" else 0.0
        assert np.abs(ours - exact).max() <= 1e-12 * np.abs(exact).max() + floor, name


@pytest.mark.parametrize("name", shipped_scenes())
def test_many_angles_give_what_each_alone_gives(name):
    """Far away and backwards too, on both sides of every knot of the pressure and on it; in more
    than one block."""
    train = crank_train(load_scene(name))
    knots = crank_angle_knots(train)[::7]
    near = np.add.outer(knots, [-3e-9, -0.9e-9, -0.1e-9, 0.0, 1e-9])
    for turns in (-3, 0, 40):
        angles = np.append(ANGLES, near) + turns * train.period
        many = np.array(reduce(train, np.resize(angles, 5000)))
        alone = np.array([reduce(train, angle) for angle in angles[:60]]).T
        apart = np.abs(many[:, : alone.shape[1]] - alone).max(axis=1)
        assert np.all(apart <= 2e-14 * np.abs(alone).max(axis=1))
        again = many[:, len(angles) :][:, : alone.shape[1]]
        np.testing.assert_array_equal(again, many[:, : again.shape[1]])


def test_each_cylinder_has_its_share_of_the_combustion():
    train = crank_train(load_scene("misfire"))
    shares = np.linspace(0.0, 1.0, len(ANGLES) * len(train.scene.cylinders)).reshape(6, -1)
    more = reduce(train, ANGLES, shares).torque - reduce(train, ANGLES).torque
    expected = np.sum(fired_torque(train, ANGLES) * shares, axis=-1)
    assert np.abs(more - expected).max() <= 1e-13 * np.abs(expected).max()
    area, shape = train.scene.piston.gas_area, (train.scene.crank.radius, train.scene.rod.length)
    for k, cylinder in enumerate(train.scene.cylinders):
        phi = ANGLES + cylinder.phase
        loop = close_loop(phi, *shape, train.scene.piston.offset)
        alone = -area * train.combustion[k](phi) * loop.x_1
        np.testing.assert_allclose(
            fired_torque(train, ANGLES)[:, k], alone, atol=1e-13 * np.abs(alone).max()
        )


def test_the_gas_is_left_out_on_request():
    scene = replace(random_scene(0), gravity=None, torque=())
    assert np.all(reduce(CrankTrain(scene, None), ANGLES)[2] == 0.0)


def test_gravity_turns_against_the_bank():
    scene = replace(random_scene(0), gravity=Gravity(acceleration=10.0, angle=0.0))
    assert gravity_vector(scene) == (10.0, 0.0)
    assert gravity_vector(scene, 0.5 * np.pi) == pytest.approx((0.0, -10.0), abs=1e-14)
    assert gravity_vector(replace(scene, gravity=None), 1.0) == (0.0, 0.0)


def test_the_rods_ends_move_with_crank_and_piston():
    loop = close_loop(ANGLES, 0.1, 0.3, 0.01)
    throw, pin = rod_centre(loop, 0.1, 0.0), rod_centre(loop, 0.1, 1.0)
    for ours, exact in (
        (throw.x_1, -0.1 * np.sin(ANGLES)),
        (throw.y_2, -0.1 * np.sin(ANGLES)),
        (pin.x_1, loop.x_1),
        (pin.x_2, loop.x_2),
        (pin.y_1, 0.0 * ANGLES),
        (pin.y_2, 0.0 * ANGLES),
    ):
        np.testing.assert_allclose(ours, exact, atol=1e-16)
