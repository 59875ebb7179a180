"""Loads of the main journals and of shared pins, and what contradicts itself about them."""

import dataclasses

import numpy as np
import pytest

from crankmbs import (
    Bearings,
    Cylinder,
    Gravity,
    InputError,
    Layout,
    Shell,
    at_angle,
    balance,
    confirm,
    load_scene,
    simulate,
    sweep,
)
from crankmbs.cli.orders import reading_report
from crankmbs.cli.report import report
from crankmbs.measures import measure
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.result import Result
from crankmbs.scene.bearings import throws_of
from validation.checks.journals import _apart
from validation.random_bearings import random_bearings
from validation.random_scenes import random_scene

FOUR = load_scene("yi_diesel_free").with_(run__until="1 cycle", layout__spacing="100 mm")
DIESEL = FOUR.with_(
    bearings=Bearings(
        crank_pin=Shell(diameter="56 mm", width="31 mm"),
        main_journal=Shell(diameter="65 mm", width="32 mm"),
    )
)
TWIN = load_scene("v_twin").with_(run__until="1 cycle")
VEE = dataclasses.replace(
    TWIN,
    layout=Layout(
        cylinders=tuple(
            Cylinder(phase=c.phase, bank=c.bank, position=place, throw=1)
            for c, place in zip(TWIN.cylinders, ("0 mm", "30 mm"), strict=True)
        )
    ),
    gravity=Gravity(acceleration=300.0, angle=1.0),
    bearings=Bearings(journal_positions=("-50 mm", "80 mm")),
)
AXES = ("x", "y")


def test_journals_lie_between_throws_and_the_outer_two_as_far_outside():
    throws = throws_of(DIESEL)
    assert throws.numbers == (0, 1, 2, 3)
    assert np.array(throws.rods) == pytest.approx(
        0.5 * np.array([[1, 0, 0, 0], [1, 1, 0, 0], [0, 1, 1, 0], [0, 0, 1, 1], [0, 0, 0, 1]])
    )


def test_a_throw_off_the_middle_of_its_journals_loads_the_nearer_one_more():
    (first, second), (left, right) = throws_of(VEE).rods
    assert (first, left) == pytest.approx((80 / 130, 50 / 130))
    assert (second, right) == pytest.approx((50 / 130, 80 / 130))


def test_all_journals_together_carry_the_main_bearing_and_a_pin_its_rods():
    for scene in (DIESEL, VEE):
        data = simulate(scene).data
        for axis in AXES:
            total = data[f"main_journal_force_{axis}"].sum("journal")
            bearing = data[f"main_bearing_force_{axis}"]
            assert float(abs(total - bearing).max()) < 1e-12 * float(abs(bearing).max())
    pin = data.pin_force_x.values + 1j * data.pin_force_y.values
    rods = data.crank_pin_force_x.values + 1j * data.crank_pin_force_y.values
    banks = np.array([c.bank for c in VEE.cylinders])
    assert pin[:, 0] == pytest.approx((rods * np.exp(1j * banks)).sum(axis=1), rel=1e-12)


@pytest.mark.parametrize("name", ["friction", "misfire"])
def test_friction_and_each_firing_reach_the_journals(name):
    scene = load_scene(name).with_(run__until="1 cycle")
    if len(scene.cylinders) > 1:
        scene = scene.with_(layout__spacing="90 mm")
    data = simulate(scene.with_(bearings=Bearings())).data
    for axis in AXES:
        bearing = data[f"main_bearing_force_{axis}"]
        apart = data[f"main_journal_force_{axis}"].sum("journal") - bearing
        assert float(abs(apart).max()) < 1e-12 * float(abs(bearing).max())


@pytest.mark.parametrize(
    "formulation", [pytest.param("minimal", marks=pytest.mark.slow), "multibody"]
)
def test_every_formulation_agrees_within_what_it_states(formulation):
    one, other = simulate(VEE), simulate(VEE, formulation=formulation)
    for name in ("main_journal_force_x", "main_journal_force_y", "pin_force_x", "pin_force_y"):
        apart = np.abs(one.data[name].values - other.data[name].values).max()
        stated = [each.data[name].attrs["error_estimate"] for each in (one, other)]
        assert 0.0 < apart <= sum(stated)
        assert sum(stated) < 1e-5 * np.abs(one.data[name].values).max()


@pytest.mark.parametrize("seed", [0, 7, 11, 184])
def test_a_counterweight_pulls_at_its_own_throw(seed):
    scene = random_bearings(random_scene(seed), seed)
    motion = np.random.default_rng(seed).uniform(-5.0, 5.0, (3, 4))
    found = reactions(crank_train(scene), *motion)
    assert _apart(scene, found, found, tuple(motion)) < 1e-12


def test_counterweights_change_the_journals_and_nothing_else():
    counter = DIESEL.with_(bearings__throw_unbalance=(-0.02, -0.02, -0.02, -0.02))
    plain, weighed = simulate(DIESEL).data, simulate(counter).data
    assert float(abs(plain.main_bearing_force_x - weighed.main_bearing_force_x).max()) == 0.0
    middle = plain.main_journal_force_x.sel(journal=3) - weighed.main_journal_force_x.sel(journal=3)
    speed, angle = plain.crank_speed.values, plain.crank_angle.values
    turning = 0.02 * speed**2 * np.cos(angle + np.pi)  # of throws 2 and 3, half of each
    slow = 0.02 * plain.crank_acceleration.values * np.sin(angle + np.pi)
    assert middle.values == pytest.approx(-turning - slow, abs=1e-9 * np.abs(turning).max())


def test_measures_and_report_name_every_journal_with_its_specific_load(tmp_path):
    result = simulate(DIESEL)
    found = measure(result)
    journals = [each for each in found.joints if each.joint == "main journal"]
    assert [each.number for each in journals] == [1, 2, 3, 4, 5]
    x, y = (result.data[f"main_journal_force_{axis}"].values for axis in AXES)
    largest = np.hypot(x, y).max(axis=0)
    for each, size in zip(journals, largest, strict=True):
        assert each.cylinder is None
        assert size * (1.0 - 1e-12) <= each.peak.value <= size * 1.01
        assert each.specific_peak.value == pytest.approx(each.peak.value / (0.065 * 0.032))
        assert each.mean.value < each.peak.value
    pins = [each for each in found.joints if each.joint == "crank pin"]
    assert pins[0].specific_mean.value == pytest.approx(pins[0].mean.value / (0.056 * 0.031))
    text = report("diesel", result, found)
    assert "main journal 5" in text
    assert "specific load over the last cycle [N/mm^2]" in text
    assert "statically determinate" in text
    result.save(tmp_path)
    again = Result.load(tmp_path / "result.nc")
    assert again.data.main_journal_force_x.equals(result.data.main_journal_force_x)
    assert "main_journal_force_x 5 [N]" in (tmp_path / "motion.csv").read_text().splitlines()[0]
    assert again.interp(time=[0.01]).main_journal_force_y.sizes == {"time": 1, "journal": 5}


def test_one_throw_rests_on_its_two_journals_by_halves():
    scene = load_scene("propeller").with_(bearings=Bearings(), run__until="1 cycle")
    data = simulate(scene).data
    half = 0.5 * data.main_bearing_force_x.values
    for journal in (1, 2):
        assert data.main_journal_force_x.sel(journal=journal).values == pytest.approx(half)


def test_a_sweep_has_the_journals_of_every_case():
    scene = DIESEL.with_(run__until="settled")
    found = sweep(scene, {"crank.inertia": ["0.15 kg m^2", "0.3 kg m^2"]})
    alone = measure(simulate(scene.with_(crank__inertia="0.3 kg m^2")))
    (third,) = [j for j in alone.joints if (j.joint, j.number) == ("main journal", 3)]
    assert found.main_journal_peak.sizes["journal"] == 5
    assert float(found.main_journal_peak[1, 2]) == pytest.approx(third.peak.value, rel=1e-9)


@pytest.mark.parametrize(
    ("scene", "changes", "sentence"),
    [
        (
            load_scene("yi_diesel_free"),
            {"bearings": Bearings(main_journal=Shell(diameter=0.06, width=0.03))},
            "give layout.spacing or each cylinder's position",
        ),
        (
            DIESEL,
            {"bearings__journal_positions": ("0 mm", "100 mm")},
            "bearings__journal_positions: one more than throws is needed, 5; 2 came; rods that "
            "share a pin have the same throw; split pins with no journal between them cannot be",
        ),
        (
            DIESEL,
            {"bearings__journal_positions": ("-50 mm", "110 mm", "150 mm", "250 mm", "350 mm")},
            "throw 2 at 0.1 m must lie between journals 2 and 3; they are at 0.11 and 0.15 m",
        ),
        (
            DIESEL,
            {"bearings__throw_unbalance": (0.01, 0.01)},
            "one for each throw is needed, 4; 2 came",
        ),
        (
            DIESEL,
            {"bearings__throw_unbalance": (0.01, 0.01, 0.01, 0.02)},
            "together, each along its throw, they are the crank's mass * center_of_mass",
        ),
        (
            VEE,
            {"layout__cylinders__2__phase": "290 deg"},
            "cylinders 1 and 2 of throw 1 have 330 and 320 degrees; split pins with no journal",
        ),
        (
            VEE,
            {"layout__cylinders__2__throw": 3},
            "throws are numbered from 1 without a gap; [1, 3] came",
        ),
        (VEE, {"layout__cylinders__2__throw": None}, "give the throw of every cylinder or of none"),
        (
            VEE,
            {"layout__cylinders__2__position": "90 mm"},
            "layout__cylinders__2__position: the rod must lie between the journals beside its "
            "throw, -0.05 and 0.08 m; 0.09 m came",
        ),
        (
            VEE,
            {"bearings__journal_positions": ("20 mm", "80 mm")},
            "throw 1 at 0.015 m must lie between journals 1 and 2",
        ),
    ],
)
def test_what_contradicts_itself_is_refused_by_name(scene, changes, sentence):
    with pytest.raises(InputError) as refused:
        scene.with_(**changes)
    assert sentence in str(refused.value)


@pytest.mark.parametrize("seed", range(8))
def test_the_frame_rocks_as_journals_walls_and_heads_push_it(seed):
    """The moment of all that touches the frame, each at its place along the crank."""
    scene = random_bearings(random_scene(seed), seed)
    if scene.bearings.journal_positions is None:
        scene = dataclasses.replace(
            scene, bearings=Bearings(journal_positions=(-9.0, 9.0), throw_unbalance=None)
        )
    motion = np.random.default_rng([37, seed]).uniform(
        [-13.0, -300.0, -2e4], [13.0, 300.0, 2e4], (5, 3)
    )
    found = reactions(crank_train(scene), *motion.T)
    places = np.array([c.position for c in scene.cylinders])
    middle = 0.5 * (places.min() + places.max())
    banks = np.array([c.bank for c in scene.cylinders])
    pushed = (found["gas_force"] - 1j * found["side_force"]) * np.exp(1j * banks)
    journals = found["main_journal_force_x"] + 1j * found["main_journal_force_y"]
    at = np.array(scene.bearings.journal_positions) - middle
    moment = pushed @ (places - middle) - journals @ at
    size = 1e-12 * max(np.abs(pushed).max(), np.abs(journals).max()) * np.abs(at).max()
    np.testing.assert_allclose(found["rocking_moment_x"], -moment.imag, rtol=0, atol=size)
    np.testing.assert_allclose(found["rocking_moment_y"], moment.real, rtol=0, atol=size)


COUNTERWEIGHT = 0.02  # kg m


@pytest.mark.parametrize("formulation", ["kinetostatic", "multibody"])
def test_counterweights_of_throws_are_a_couple_on_the_frame(formulation):
    """sqrt(3) d U omega^2 in all directions alike: throws 120 degrees and d apart."""
    plain = load_scene("grega_lecture").with_(
        layout=Layout(firing_order=(1, 3, 2), spacing=0.1),
        bearings=Bearings(),
        motion__speed=200.0,
        run__until="2 rev",
    )
    added = plain.with_(bearings__throw_unbalance=(-COUNTERWEIGHT,) * 3)
    runs = [simulate(scene, formulation=formulation).data for scene in (plain, added)]
    moments = [each.rocking_moment_x.values + 1j * each.rocking_moment_y.values for each in runs]
    couple = np.sqrt(3.0) * 0.1 * COUNTERWEIGHT * 200.0**2
    assert np.abs(moments[1] - moments[0]) == pytest.approx(couple, rel=1e-7)
    at_zero = runs[1].crank_angle.values == 0.0
    assert (moments[1] - moments[0])[at_zero].imag > 0.0  # throw 1, ahead of the middle, pulls down


def test_balance_counts_what_the_throws_have():
    """Before less by the couple of what is there; after the same whatever was there."""
    plain = DIESEL.with_(layout=Layout(firing_order=(1, 3, 2), spacing=0.1))
    found = [
        balance(plain.with_(bearings__throw_unbalance=size and (-size,) * 3))
        for size in (None, COUNTERWEIGHT)
    ]
    before, after = (
        [
            next(
                getattr(row, side).value
                for row in each.remaining
                if (row.quantity, row.direction, row.order) == ("rocking moment", "largest", 1.0)
            )
            for each in found
        ]
        for side in ("before", "after")
    )
    speed = found[0].result.data.crank_speed.values.mean()
    couple = np.sqrt(3.0) * 0.1 * COUNTERWEIGHT * speed**2
    assert before[0] - before[1] == pytest.approx(couple, rel=0.01)  # the speed is not even
    assert after[1] == pytest.approx(after[0], rel=1e-6)


def test_two_throws_at_one_place_are_asked_for_their_pin():
    cylinders = tuple(dataclasses.replace(c, throw=None, position=0.0) for c in VEE.cylinders)
    with pytest.raises(InputError, match="cylinders on one pin have the same throw"):
        dataclasses.replace(VEE, layout=Layout(cylinders=cylinders), bearings=Bearings())


def test_without_main_journals_and_places_the_pins_alone_have_shells():
    scene = load_scene("yi_diesel_free").with_(
        bearings=Bearings(crank_pin=Shell(diameter="56 mm", width="31 mm"))
    )
    assert scene.throws is None
    (first, *_) = [j for j in measure(simulate(scene)).joints if j.joint == "crank pin"]
    assert first.specific_peak.value == pytest.approx(first.peak.value / (0.056 * 0.031))


def test_loads_are_drawn_in_the_frame_of_the_body_that_carries_them():
    result = simulate(VEE)
    figure = result.plot("bearings")
    shell, journal, big_end, pin = figure.axes
    scale = 1e3  # kN
    force = result.data.main_journal_force_x.values + 1j * result.data.main_journal_force_y.values
    drawn = [
        np.array(axes.lines[0].get_ydata()) + 1j * np.array(axes.lines[0].get_xdata())
        for axes in figure.axes
    ]
    angle = result.data.crank_angle.values
    assert drawn[0] * scale == pytest.approx(-force[:, 0])
    assert drawn[1] * scale == pytest.approx(force[:, 0] * np.exp(-1j * angle))
    rod = result.data.crank_pin_force_x.values + 1j * result.data.crank_pin_force_y.values
    beta, phases = result.data.rod_angle.values, np.array([c.phase for c in VEE.cylinders])
    assert drawn[2] * scale == pytest.approx(rod[:, 0] * np.exp(1j * beta[:, 0]))
    load = -(rod * np.exp(-1j * (angle[:, None] + phases))).sum(axis=1)
    assert drawn[3] * scale == pytest.approx(load)
    titles = [axes.get_title() for axes in (shell, journal, big_end, pin)]
    assert [title.split(",")[0] for title in titles] == [
        "load on main bearing shells",
        "load on main journals",
        "load on big-end shells",
        "load on crank pins",
    ]
    with pytest.raises(InputError, match="bearings = Bearings"):
        simulate(TWIN).plot("bearings")


@pytest.mark.slow
def test_a_reading_at_an_angle_and_exudyn_have_every_journal():
    result = simulate(VEE)
    readings = {r.quantity: r for r in at_angle(result, "60 deg").readings}
    for number in (1, 2):
        found = readings[f"main_journal_force_x {number}"]
        assert found.cylinder is None
        sample = result.data.main_journal_force_x.values[60, number - 1]
        assert found.value == pytest.approx(sample, abs=1e-6)
    text = reading_report(at_angle(result, "60 deg"))
    assert "main journal force x 2" in text
    bodies = confirm(result)
    (journals,) = [row for row in bodies.period if row.quantity == "main journal"]
    assert journals.share <= 1.0
    assert journals.largest[0] < 1e-5 * journals.peak
