"""Formulas of one's own: what they stand for, what they are given, and what of them is refused."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from crankmbs import Motion, Run, compare, lecture, load_scene, simulate
from crankmbs.compare import CLOSED_FORM, LECTURES, WORDS, save_numbers
from crankmbs.compare.formula import formulated
from crankmbs.figures import comparison_figure

UNTRUNCATED, _, S1 = LECTURES
ROUNDING = 1e-12  # of the peak


@pytest.fixture(scope="module")
def four():
    """Four cylinders, their speed free: 721 samples of the last cycle."""
    scene = load_scene("yi_diesel_free")
    return simulate(dataclasses.replace(scene, run=Run(until="2 cycles")))


@pytest.fixture(scope="module")
def coasting():
    """One cylinder without gas."""
    return simulate(dataclasses.replace(load_scene("coasting"), run=Run(until="1 rev")))


def piston_acceleration_harmonics(phi, mean_omega, crank_radius, rod_length, offset):
    return lecture.piston_acceleration_series(
        phi, crank_radius=crank_radius, rod_length=rod_length, offset=offset, omega=mean_omega
    )


def side_thrust(phi, gas_force, mean_omega, reciprocating_mass, crank_radius, rod_length, offset):
    gear = {"crank_radius": crank_radius, "rod_length": rod_length, "offset": offset}
    net = gas_force - reciprocating_mass * lecture.piston_acceleration(
        phi, omega=mean_omega, alpha=0.0, **gear
    )
    return net * lecture.tan_beta(phi, **gear)


def kinetic_energy(reduced_inertia, omega):
    return reduced_inertia * omega**2 / 2


def piston_acceleration_exact(phi, omega, alpha, crank_radius, rod_length, offset):
    return lecture.piston_acceleration(
        phi,
        omega=omega,
        alpha=alpha,
        crank_radius=crank_radius,
        rod_length=rod_length,
        offset=offset,
    )


@pytest.mark.parametrize("cylinder", [1, 3])
@pytest.mark.parametrize(
    ("function", "quantity", "reference"),
    [
        (piston_acceleration_harmonics, "piston acceleration", S1),
        (side_thrust, "side thrust", UNTRUNCATED),
        (piston_acceleration_exact, "piston acceleration", CLOSED_FORM),
    ],
)
def test_what_the_lectures_say_comes_out_alike(four, cylinder, function, quantity, reference):
    found = compare(four, {"mine": function}, cylinder=cylinder)
    mine, theirs = found.row(quantity, "mine"), found.row(quantity, reference)
    assert mine.values == pytest.approx(theirs.values, abs=ROUNDING * theirs.peak)
    assert mine.error == pytest.approx(mine.values - found.simulated[quantity], abs=0.0)
    assert mine.size.largest >= np.max(np.abs(mine.error))
    if reference != CLOSED_FORM:
        assert mine.size == pytest.approx(theirs.size, rel=1e-9)  # between the samples, too
    assert found.references == (CLOSED_FORM, *LECTURES, "mine")
    if reference != CLOSED_FORM:
        assert mine.size.largest > 1e-3 * mine.peak


def test_a_variable_of_the_result_is_compared_with_the_closed_form_too(four):
    found = compare(four, {"J omega^2 / 2": kinetic_energy})
    for reference in ("J omega^2 / 2", CLOSED_FORM):
        row = found.row("kinetic energy", reference)
        assert row.size.largest < ROUNDING * row.peak
    lighter = lambda reduced_inertia, omega: 0.999 * reduced_inertia * omega**2 / 2  # noqa: E731
    assert compare(four, {"kinetic energy": lighter}).row(
        "kinetic energy", "kinetic energy"
    ).size.largest == pytest.approx(1e-3 * row.peak, rel=1e-6)


def test_the_equation_of_motion_gives_the_run_s_own_acceleration(coasting):
    def crank_acceleration(generalized_force, reduced_slope, reduced_inertia, omega):
        return (generalized_force - reduced_slope * omega**2 / 2) / reduced_inertia

    row = compare(coasting, {"mine": crank_acceleration}).row("crank acceleration", "mine")
    assert row.size.largest < ROUNDING * row.peak


def test_a_formula_of_the_whole_engine_sees_every_cylinder(four):
    shapes: dict[str, tuple[tuple[int, ...], ...]] = {}

    def torque_from_gas(phi, gas_force, theta, gravity_x):
        shapes.setdefault("one", (phi.shape, gas_force.shape, theta.shape))
        return 0.0 * phi

    def frame_force_x(phi, gas_force, friction_force, theta, cylinders):
        every = phi.shape, gas_force.shape, friction_force.shape, theta.shape
        shapes.setdefault("all", every)  # at the samples, then between them
        assert np.allclose(phi[:, 2] - theta, four.scene.cylinders[2].phase, atol=1e-9)
        assert not friction_force.any()
        return 0.0 * theta + cylinders

    found = compare(four, {"one": torque_from_gas, "all": frame_force_x}, cylinder=3)
    n = len(found.excerpt.theta)
    assert shapes == {"one": ((n,), (n,), (n,)), "all": ((n, 4), (n, 4), (n, 4), (n,))}
    assert np.array_equal(found.row("frame force x", "all").values, np.full(n, 4.0))


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("crank_radius", 0.046),
        ("rod_ratio", 0.3),
        ("crank_inertia", 0.15),
        ("start_omega", 3200.0 * math.pi / 30.0),
        ("reciprocating_mass", 1.542292),
        ("rod_crank_pin_mass", 1.202135),
        ("piston_area", 57.079e-4),
        ("rod_inertia", 5.8422202e-3),
        ("cylinders", 4.0),
        ("gravity_x", 0.0),
    ],
)
def test_a_word_is_the_scene_s_number(four, word, value):
    scope: dict[str, Any] = {}
    exec(f"def torque({word}): return {word}", scope)
    values = compare(four, {"mine": scope["torque"]}).row("torque", "mine").values
    assert values == pytest.approx(np.full(len(values), value), rel=1e-6, abs=1e-12)


def test_every_word_has_a_value(four):
    scope: dict[str, Any] = {}
    exec(f"def frame_force_x({', '.join(WORDS)}): return theta", scope)
    assert formulated("mine", scope["frame_force_x"]).words == tuple(WORDS)
    assert compare(four, {"mine": scope["frame_force_x"]}).row("frame force x", "mine")


def test_gravity_is_that_along_the_cylinder_and_of_the_engine():
    scene = dataclasses.replace(
        load_scene("v_twin"),
        gravity=load_scene("coasting").gravity,
        motion=Motion(speed=100.0),
        start=None,
        torque=(),
        run=Run(until="1 cycle"),
    )
    result = simulate(scene)
    found = compare(
        result,
        {
            "torque": lambda gravity_x: gravity_x,
            "side thrust": lambda gravity_y: gravity_y,
            "frame force x": lambda gravity_x: gravity_x,
        },
        cylinder=2,
    )
    bank = scene.cylinders[1].bank
    along = found.row("torque", "torque").values
    across = found.row("side thrust", "side thrust").values
    assert along == pytest.approx(-9.81 * math.cos(bank))
    assert across == pytest.approx(9.81 * math.sin(bank))
    assert found.row("frame force x", "frame force x").values == pytest.approx(-9.81)


def formula_named(name, function):
    function.__name__ = name
    return function


@pytest.mark.parametrize(
    ("name", "label", "quantity"),
    [
        ("acceleration", "mine", "piston acceleration"),
        ("piston_acceleration", "torque", "piston acceleration"),
        ("crank_acceleration_2", "mine", "crank acceleration"),
        ("gas_torque_mine", "mine", "gas torque"),
        ("torque", "mine", "torque"),
        ("<lambda>", "Torque, second order", "torque"),
        ("f", "piston pin force y by hand", "piston pin force y"),
        ("rod_angle", "mine", "rod angle"),
        ("fluctuation_mine", "mine", "fluctuation"),
        ("mean_speed", "mine", "mean speed"),
    ],
)
def test_a_formula_stands_for_what_its_name_or_its_label_begins_with(name, label, quantity):
    assert formulated(label, formula_named(name, lambda phi: phi)).quantity == quantity


def test_parameters_that_are_no_words_keep_their_defaults(four):
    def torque(theta, *ignored, order=3, **more):
        assert (ignored, more) == ((), {})
        return order + 0.0 * theta

    assert set(compare(four, {"mine": torque}).row("torque", "mine").values) == {3.0}


def test_a_formula_cannot_spoil_the_run(four):
    def torque(theta, omega):
        theta *= 0.0
        omega += 1.0
        return theta

    before = compare(four).row("torque", S1).values
    assert np.array_equal(compare(four, {"mine": torque}).row("torque", S1).values, before)


def test_a_number_of_the_run_has_its_formula_beside_it(four, coasting, tmp_path):
    formulas = {
        "fluctuation, W/(J omega^2)": lambda crank_inertia: 0.01,
        "mean speed": lambda start_omega: start_omega,
        "imep": lambda gas_pressure: np.mean(gas_pressure),
        "indicated power": lambda gas_force: float(gas_force.shape[1]),
    }
    found = compare(four, formulas, cylinder=2)
    measures = four.measures()
    by_name = {row.quantity: row for row in found.numbers}
    assert by_name["fluctuation"].simulated == measures.fluctuation
    assert by_name["fluctuation"].error == 0.01 - measures.fluctuation.value
    assert by_name["mean speed"].percent == pytest.approx(
        100.0 * (3200.0 * math.pi / 30.0 / measures.mean_speed.value - 1.0)
    )
    assert by_name["imep"].simulated == measures.imep[1]
    assert by_name["indicated power"].value == 4.0
    lines = save_numbers(found, tmp_path).read_text().splitlines()
    assert len(lines) == 1 + len(formulas)
    assert lines[1].startswith('"fluctuation, W/(J omega^2)",fluctuation,1,0.01,0.02')
    without = compare(coasting, {"imep": lambda gas_force: 0.0})
    assert not without.numbers
    assert without.left_out[-1] == ("imep", "imep", "there is no whole cycle with gas")


def test_what_the_run_does_not_have_is_left_out(coasting):
    formulas = {"gas torque": lambda phi: phi, "friction force": lambda phi: phi}
    reasons = {entry[:2]: entry.reason for entry in compare(coasting, formulas).left_out}
    assert reasons["gas torque", "gas torque"] == "the scene has no gas"
    assert reasons["friction force", "friction force"] == "the run has none"


def test_the_figure_draws_a_formula_beside_the_others(four):
    speed = {"crank speed": lambda theta, mean_omega: mean_omega}
    found = compare(four, {"my thrust": side_thrust} | speed)
    figure = comparison_figure(found, ("crank speed", "side thrust"))
    speeds, thrusts, *below = figure.axes
    drawn = [
        [line.get_label() for line in ax.lines if line.get_label()[0] != "_"]
        for ax in (speeds, thrusts, *below)
    ]
    assert drawn == [["run"], ["run"], ["crank speed"], ["Grega", "Yi et al.", "my thrust"]]
    assert speeds.get_ylim()[0] > 300.0  # no line at zero, or the swing could not be seen
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"my thrust", "crank speed"} <= set(legend)
    assert speeds.get_ylabel() == "[rad/s]"


def test_the_legend_names_the_authors_of_the_formulas_drawn_and_no_others(four):
    found = compare(four, {"crank speed": lambda theta, mean_omega: mean_omega})
    figures = [
        comparison_figure(found, (name,))
        for name in ("crank speed", "side thrust", "piston displacement")
    ]
    legends = [[text.get_text() for text in figure.legends[0].get_texts()] for figure in figures]
    assert legends == [
        ["run", "crank speed"],
        ["run", "Grega", "Yi et al."],
        ["run", "Grega and Yi et al."],
    ]
    for figure in figures:
        caption = figure.get_supxlabel()
        assert "error: formula minus run" in caption
        assert "over the last cycle; numerical error at most" in caption
