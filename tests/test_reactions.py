"""Newton-Euler body by body against all bodies' equations at once, at 40 digits."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import load_scene
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.newton_euler import UNITS, Powers, balanced, powers_of, rows_of
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.reactions import Table, balances, reactions
from crankmbs.mechanics.train import CrankTrain, crank_train
from validation.adapter import reference_variables
from validation.oracles.arithmetic import multiprecision
from validation.random_scenes import random_scene

DIGITS = multiprecision(40)


def motion(seed, samples=7):
    """Angles, speeds and accelerations of both signs."""
    rng = np.random.default_rng(seed)
    theta = rng.uniform(-13.0, 13.0, samples)
    return theta, rng.uniform(-300.0, 300.0, samples), rng.uniform(-2e4, 2e4, samples)


def misfit(scene, state, exact):
    """Largest error of each variable relative to its peak; of a force, to that of the vector."""
    ours = reactions(crank_train(scene), *state)
    assert ours.keys() == exact.keys()
    peaks = {name: np.abs(values.astype(float)).max() for name, values in exact.items()}
    worst = {}
    for name, values in exact.items():
        vector = {name, name.replace("_force_x", "_force_y"), name.replace("_force_y", "_force_x")}
        error = np.abs(ours[name] - values.astype(float)).max()
        worst[name] = error / (max(peaks[part] for part in vector) or 1.0)
    return worst


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_every_variable_of_random_machines(seed):
    scene, state = random_scene(seed), motion(seed)
    worst = misfit(scene, state, reference_variables(scene, *state, DIGITS))
    assert max(worst.values()) < 1e-12, worst


@pytest.mark.slow
@pytest.mark.parametrize("name", ["yi_diesel", "compressor", "v_twin", "coasting", "torque_driven"])
def test_every_variable_of_shipped_machines(name):
    scene, state = load_scene(name), motion(1)
    worst = misfit(scene, state, reference_variables(scene, *state, DIGITS))
    assert max(worst.values()) < 1e-12, worst


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_every_balance_per_power(seed):
    """Per omega^2, alpha and 1, of which it has what is said, and put together."""
    scene, (theta, omega, alpha) = random_scene(seed), motion(seed)
    train, exact = crank_train(scene), reference_variables(scene, *motion(seed), DIGITS)
    powers = Powers(*np.atleast_2d(omega**2, alpha, np.ones(7)))
    units, whole = (balanced(train, theta, of) for of in (UNITS, powers))
    assert list(units) == list(rows_of(scene))
    for name, count in rows_of(scene).items():
        vector = {name, name.replace("_force_x", "_force_y"), name.replace("_force_y", "_force_x")}
        peak = max(np.abs(exact[part].astype(float)).max() for part in vector) or 1.0
        wanted = np.atleast_2d(exact[name].astype(float).T)
        per_speed = omega if name in ("rod_angular_speed", "piston_velocity") else 1.0
        of_one = units[name].shape[1] == 1
        parts = [units[name][:, 0 if of_one else k] * powers[k] for k in powers_of(name)]
        for found in (sum(parts), whole[name][:, 0]):
            assert found.shape == (count, 7)
            assert np.abs(found * per_speed - wanted).max() < 1e-12 * peak, name
        others = set(range(units[name].shape[1])) - set(powers_of(name))
        assert of_one or not units[name][:, list(others)].any(), name


def test_arrays_of_any_kind_are_taken_and_left():
    """With gaps, read-only, broadcast."""
    train = crank_train(load_scene("coasting"))
    theta, _, alpha = motion(1)
    expected = reactions(train, theta, 0.0 * theta + 3.0, alpha)
    gaps = np.repeat(theta, 2)[::2]
    still = np.broadcast_to(3.0, 7)
    alpha.flags.writeable = False
    found = reactions(train, gaps, still, alpha)
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values)
    np.testing.assert_array_equal(reduce(train, gaps).inertia, reduce(train, theta).inertia)
    assert reduce(train, still.reshape(1, 7)).torque.shape == (1, 7)


@pytest.mark.slow
def test_angles_that_come_back():
    """Every force from its parts of omega^2, alpha and 1 at one angle of the period."""
    scene = load_scene("v_twin")
    _, omega, alpha = motion(3, 24)
    theta = 0.3 + scene.period / 6 * np.arange(24)
    state = theta, omega, alpha
    worst = misfit(scene, state, reference_variables(scene, *state, DIGITS))
    assert max(worst.values()) < 1e-12, worst


@pytest.mark.parametrize("part", ["rod.length", "piston.mass", "gravity.angle", "rod.inertia"])
def test_a_shifted_parameter_is_seen(part):
    """One part in 1e11 more of one parameter is more than the tolerance lets pass."""
    scene, state = load_scene("compressor"), motion(2)
    owner, field = part.split(".")
    old = getattr(scene, owner)
    changed = replace(scene, **{owner: replace(old, **{field: getattr(old, field) * (1 + 1e-10)})})
    worst = misfit(changed, state, reference_variables(scene, *state, DIGITS))
    assert max(worst.values()) > 1e-12


def test_a_state_of_any_length():
    scene = load_scene("v_twin")
    found = reactions(crank_train(scene), [0.1], [1.0], [0.0])
    assert found["main_bearing_force_x"].shape == (1,)
    assert found["side_force"].shape == (1, 2)


def test_cycles_after_one_another_are_as_each_alone():
    """Where the angles repeat they are looked at once: the same, to their last digit."""
    scene = load_scene("v_twin")
    theta = np.radians(np.arange(0.25, 2000.0, 1.0))
    omega, alpha = 300.0 + 10.0 * np.sin(theta / 3), 500.0 * np.cos(theta / 5)
    together = reactions(crank_train(scene), theta, omega, alpha)
    for samples in (slice(0, 700), slice(700, 1400), slice(1400, None)):
        state = theta[samples], omega[samples], alpha[samples]
        alone = reactions(crank_train(scene), *state)
        for name, values in alone.items():
            scale = np.abs(together[name]).max()
            np.testing.assert_allclose(together[name][samples], values, rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("samples", [5, 24])
def test_deviations_are_those_between_two_motions(samples):
    """Of angles that come back as of others, and without the variables of the second motion."""
    scene = load_scene("v_twin")
    pressure, theta = pressures_of(scene), 0.3 + scene.period / 6 * np.arange(samples)
    one, other = ((theta + 1e-3 * k, *motion(k, samples)[1:]) for k in (1, 2))
    first, second = (balances(CrankTrain(scene, pressure), *state) for state in (one, other))
    values, others = np.empty((2, sum(first.rows.values()), samples))
    first.fill(values)
    second.fill(others)
    apart = np.abs(values - others).max(axis=1)
    assert second.apart(values) == pytest.approx(apart, rel=1e-12)
    table = Table(first.rows, values)
    assert list(table.variables) == list(reactions(CrankTrain(scene, pressure), *one))
    table.variables["side_force"][samples // 2, 1] = np.nan
    found = second.apart(values)
    assert np.flatnonzero(np.isnan(found)) == table.places["side_force"].start + 1
    by_name = dict(zip(first.rows, table.largest(found), strict=True))
    assert [name for name, most in by_name.items() if np.isnan(most)] == ["side_force"]
