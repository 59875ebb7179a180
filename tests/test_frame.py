"""What the engine does to its frame, and the torques in its crank."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Crank,
    Cylinder,
    InputError,
    Layout,
    Motion,
    Piston,
    Rod,
    Run,
    Scene,
    accumulated_torque,
    load_scene,
    simulate,
)
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import SUMS, variables_of
from crankmbs.motion.assemble import Assembled
from crankmbs.motion.base import Samples, Solution
from crankmbs.result import Result
from crankmbs.scene.read import load_scene as read
from crankmbs.scene.write import scene_files
from validation.adapter import reference_variables
from validation.case import CASES
from validation.checks.honest import true_errors
from validation.oracles.arithmetic import multiprecision
from validation.random_scenes import random_scene

BANKED = load_scene(CASES.parent / "scenes" / "banked_crank.toml")


def state(seed, samples=7):
    rng = np.random.default_rng(seed)
    low, high = [-13.0, -300.0, -2e4], [13.0, 300.0, 2e4]
    return rng.uniform(low, high, (samples, 3)).T


def placed(scene, seed):
    """A scene with a random place along the crank for each cylinder."""
    rng = np.random.default_rng([21, seed])
    cylinders = tuple(replace(c, position=rng.uniform(-0.5, 0.5)) for c in scene.cylinders)
    return replace(scene, layout=Layout(cylinders=cylinders))


def in_line(order, **layout):
    """Cylinders in line without offset, at constant speed."""
    return Scene(
        crank=Crank(radius=0.05, inertia=0.01),
        rod=Rod(length=0.17, mass=0.7, center_of_mass=0.05, inertia=4e-3),
        piston=Piston(mass=0.5),
        layout=Layout(firing_order=order, **layout),
        motion=Motion(speed=300.0),
        run=Run(until="1 cycle", every="5 deg"),
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_rocking_moments_of_random_machines(seed):
    scene, motion = placed(random_scene(seed), seed), state(seed)
    ours = reactions(crank_train(scene), *motion)
    exact = reference_variables(scene, *motion, multiprecision(40))
    forces = ("frame_force_x", "frame_force_y")
    scale = max(np.abs(exact[name].astype(float)).max() for name in forces)  # times a metre
    for name in ("rocking_moment_x", "rocking_moment_y"):
        assert np.abs(ours[name] - exact[name].astype(float)).max() < 1e-12 * scale


@pytest.mark.parametrize("seed", range(5))
def test_the_frame_feels_bearing_walls_and_heads(seed):
    """The rates of momentum are what bearing, walls and gas on the heads add up to."""
    scene = random_scene(seed)
    found = reactions(crank_train(scene), *state(seed))
    bank = np.array([c.bank for c in scene.cylinders])
    on_frame = (found["gas_force"] - 1j * found["side_force"]) * np.exp(1j * bank)
    bearing = found["main_bearing_force_x"] + 1j * found["main_bearing_force_y"]
    force = found["frame_force_x"] + 1j * found["frame_force_y"]
    scale = max(np.abs(found["gas_force"]).max(), np.abs(bearing).max())
    np.testing.assert_allclose(force, on_frame.sum(axis=1) - bearing, rtol=0, atol=1e-12 * scale)


def test_torques_in_the_crank_are_accumulated_ones():
    found = reactions(crank_train(BANKED), *state(1))
    expected = accumulated_torque(found["crank_torque"])
    np.testing.assert_allclose(found["journal_torque"], expected.journals[:, 1:], rtol=1e-14)
    np.testing.assert_allclose(found["pin_torque"], expected.pins, rtol=1e-12)


def test_the_mean_moment_on_the_frame_is_the_mean_torque_from_outside():
    """At constant speed and without weight angular momentum comes back after a cycle."""
    scene = replace(BANKED, gravity=None, start=None, torque=(), motion=Motion(speed=250.0))
    scene = replace(scene, run=Run(until="1 cycle", every="0.25 deg"))
    data = simulate(scene).data.isel(time=slice(1, None))
    moment, torque = (data[n].values for n in ("frame_moment", "external_torque"))
    assert moment.mean() == pytest.approx(torque.mean(), rel=1e-9)
    assert np.ptp(moment) > 5.0 * abs(moment.mean())


def test_an_in_line_four_shakes_along_its_cylinders_at_second_order():
    data = simulate(in_line((1, 3, 4, 2), spacing=0.1)).data
    along = data["frame_force_x"].values
    size = np.abs(along).max()
    assert np.abs(data["frame_force_y"].values).max() < 1e-12 * size
    for name in ("rocking_moment_x", "rocking_moment_y"):  # throws mirrored about the middle
        assert np.abs(data[name].values).max() < 1e-12 * size
    np.testing.assert_allclose(along[:37], along[36:73], atol=1e-9 * size)  # 180 degrees later


def test_an_in_line_three_rocks_and_does_not_shake():
    """Its forces of first and second order cancel; their moments do not."""
    data = simulate(in_line((1, 3, 2), spacing=0.1)).data
    reciprocating = 300.0**2 * 0.05 * (0.5 + 0.7 * 0.05 / 0.17)
    assert np.abs(data["frame_force_x"].values).max() < 0.01 * reciprocating
    rocking = np.abs(data["rocking_moment_y"].values).max()
    assert rocking > 0.1 * reciprocating
    doubled = simulate(in_line((1, 3, 2), spacing=0.2)).data["rocking_moment_y"]
    assert np.abs(doubled.values).max() == pytest.approx(2.0 * rocking, rel=1e-12)


@pytest.mark.parametrize("until", ["1 rev", "9 rev"])
@pytest.mark.parametrize("formulation", ["kinetostatic", "multibody"])
def test_pistons_on_massless_rods_rock_as_their_acceleration_says(formulation, until):
    """r x F of what pistons alone do to the frame, F = -m a along a cylinder's axis at (0, 0, z):
    M_x = -sum z F_y and M_y = sum z F_x, with their signs; the places are not symmetric. Over many
    turns a run meets the same angles again."""
    radius, length, speed, mass = 0.05, 0.17, 300.0, 0.5
    phase, bank = np.radians([0.0, 110.0, 250.0]), np.radians([-20.0, 40.0, 25.0])
    lever = np.array([-0.15, 0.05, 0.15])  # beyond the middle of the first and the last
    scene = Scene(
        crank=Crank(radius=radius, inertia=0.01),
        rod=Rod(length=length),
        piston=Piston(mass=mass),
        layout=Layout(
            cylinders=tuple(
                Cylinder(phase=p, bank=b, position=z + 1.0)
                for p, b, z in zip(phase, bank, lever, strict=True)
            )
        ),
        motion=Motion(speed=speed),
        run=Run(until=until, every="5 deg"),
    )
    data = simulate(scene, formulation=formulation).data
    phi = data["crank_angle"].values[:, None] + phase
    root = np.sqrt(length**2 - (radius * np.sin(phi)) ** 2)
    slope = radius**2 * np.cos(2.0 * phi) / root
    slope += (radius**2 * np.sin(2.0 * phi) / 2.0) ** 2 / root**3
    force = mass * speed**2 * (radius * np.cos(phi) + slope)  # -m d2x/dt2
    size = np.abs(force).max() * np.abs(lever).max()
    for name, expected in (
        ("rocking_moment_x", -force * lever * np.sin(bank)),
        ("rocking_moment_y", force * lever * np.cos(bank)),
    ):
        ours, stated = data[name].values, data[name].attrs["error_estimate"]
        assert stated < 1e-6 * size
        allowed = 2.0 * stated + 1e-12 * size
        np.testing.assert_allclose(ours, expected.sum(axis=1), rtol=0.0, atol=allowed)
        assert np.abs(ours).max() > 0.1 * size


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("every", ["1 deg", "0.21 ms"])
def test_stated_errors_hold(formulation, every):
    scene = replace(BANKED, run=Run(until="0.6 rev", every=every, rtol=1e-5))
    result = simulate(scene, formulation=formulation)
    true, _ = true_errors(result, scene)
    for name in SUMS | {"rod_angular_speed", "rod_angular_acceleration"}:
        stated = result.data[name].attrs["error_estimate"]
        assert true[name] <= 2.0 * stated, name
        assert stated < 1e-4 * np.abs(result.data[name].values).max(), name


def test_an_engine_whose_forces_cancel_is_not_refined_for_them():
    """What is left of several cylinders may be rounding of each: its share of error counts not."""
    errors = {"crank_angle": 1e-3, "side_force": 1e-2, "frame_force_y": 1.0}
    peaks = {"crank_angle": 1.0, "side_force": 1.0, "frame_force_y": 0.1}
    turning = Samples(*np.array([[0.0, 1.0]] * 5))
    solution = Solution(turning, 0, "", 0, 0)
    assert Assembled(solution, None, peaks, errors).relative_error == 1e-2


@pytest.mark.slow
def test_saved_and_read_with_its_places(tmp_path):
    for scene in (BANKED, in_line((1, 3, 2), spacing=0.1), in_line((1, 3, 2))):
        assert variables_of(scene).keys() == set(simulate(scene).data.variables) - {"cylinder"}
    short = replace(BANKED, run=Run(until="20 deg", every="5 deg"))
    result = simulate(short)
    again = Result.load(result.save(tmp_path / "saved"))
    assert again.data.identical(result.data)
    for scene in (short, in_line((1, 3, 2), spacing=0.1)):
        for file, text in scene_files(scene, "mine").items():
            (tmp_path / file).write_text(text)
        found = read(tmp_path / "mine.toml")
        assert found.levers == scene.levers
        assert found.cylinders == scene.cylinders


def test_levers_are_counted_from_the_middle():
    assert in_line((1, 3, 2), spacing=0.1).levers == pytest.approx((-0.1, 0.0, 0.1))
    assert BANKED.levers == pytest.approx((-0.105, 0.005, 0.105))
    assert in_line((1, 3, 2)).levers is None


@pytest.mark.parametrize(
    ("layout", "said"),
    [
        ({"cylinders": (Cylinder(position=0.1), Cylinder())}, "1 of 2 came with one"),
        ({"cylinders": (Cylinder(position=0.1),), "spacing": 0.1}, "not both; both came"),
        ({"cylinders": (Cylinder(), Cylinder(bank=1.0)), "spacing": 0.1}, "may share a throw"),
        ({"firing_order": (1, 2), "spacing": 0.0}, "spacing: must be above 0"),
        ({"firing_order": (1, 2), "spacing": math.inf}, "spacing"),
    ],
)
def test_places_that_cannot_be(layout, said):
    with pytest.raises(InputError, match=said):
        Layout(**layout)


def test_a_driven_crank_without_inertia_runs():
    heavy, *light = (
        simulate(replace(in_line((1, 3, 4, 2)), crank=Crank(radius=0.05, inertia=inertia)))
        for inertia in (0.01, None, 0.0)
    )
    for result in light:
        assert np.array_equal(result.data["external_torque"], heavy.data["external_torque"])
