"""A chain of causes in the order that one sets: it adds up, whatever the order and the formula."""

import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crankmbs import InputError, Motion, Run, Spring, budget, lecture, load_scene, simulate
from crankmbs.compare import CAUSES, LECTURES, REST, compare, save_budget, save_budget_peaks
from crankmbs.figures import budget_figure
from crankmbs.scene.parts import Friction

UNTRUNCATED, _, S1 = LECTURES


def piston_velocity(phi, mean_omega, crank_radius, rod_ratio):
    return crank_radius * mean_omega * (np.sin(phi) + rod_ratio / 2 * np.sin(2 * phi))


def side_thrust(phi, gas_force, omega, alpha, reciprocating_mass, crank_radius, rod_length, offset):
    gear = {"crank_radius": crank_radius, "rod_length": rod_length, "offset": offset}
    moved = lecture.piston_acceleration(phi, omega=omega, alpha=alpha, **gear)
    return (gas_force - reciprocating_mass * moved) * lecture.tan_beta(phi, **gear)


def rod_angle_small(phi, rod_ratio):
    return rod_ratio * np.sin(phi)


OWN = {"v": piston_velocity, "N": side_thrust, "beta": rod_angle_small}


@pytest.fixture(scope="module")
def swinging():
    """One cylinder in which every cause is worth something but the solver's, of which a made-up
    error of the run's stands."""
    base = load_scene("yi_diesel")
    motion = Motion(speed={"mean": 300.0, "amplitude": 9.0, "order": 2.0})
    scene = dataclasses.replace(
        base,
        motion=motion,
        gravity=load_scene("coasting").gravity,
        friction=Friction(ring_force=40.0, ring_pressure=0.02, viscous=30.0),
        force=(Spring(stiffness=4e3),),
    )
    result = simulate(scene)
    off = result.data.copy()
    off["side_force"] = off["side_force"] + 7.0
    return dataclasses.replace(result, data=off)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(order=st.permutations(list(CAUSES)), count=st.integers(1, len(CAUSES)))
def test_every_order_adds_up_to_formula_minus_run(swinging, order, count):
    chain = order[:count]
    found = budget(swinging, OWN, chain=chain)
    named = [*chain, *([] if count == len(CAUSES) else [REST])]
    assert list(found.chain) == named
    assert {split.reference for split in found.splits} == {S1, *OWN}
    for split in found.splits:
        assert [cause.name for cause in split.causes] == named
        total = sum(cause.curve for cause in split.causes)
        largest = max(split.peak, *(cause.size.largest for cause in split.causes))
        error = split.values - split.simulated
        assert np.array_equal(split.total.curve, error)
        assert np.max(np.abs(total - error)) <= 1e-15 * len(named) * largest


def test_the_totals_are_those_of_the_comparison(swinging):
    found, rows = budget(swinging, OWN, chain=["gravity", "series"]), compare(swinging, OWN)
    for split in found.splits:
        row = rows.row(split.quantity, split.reference)
        assert np.array_equal(split.total.curve, row.error)
        assert split.total.size.rms == row.size.rms
        # the points between the samples follow from the curves, and the causes are more of them
        assert split.total.size.largest == pytest.approx(row.size.largest, rel=2e-5)


def test_what_a_cause_is_worth_depends_on_what_still_stands(swinging):
    """The series at the run's own speed is another than at its mean; a weight is the same."""
    usual = budget(swinging).split("side thrust")
    order = ["gravity", "constant speed", "series", "two-mass rod"]
    turned = budget(swinging, chain=order).split("side thrust")
    worth = {
        name: turned.cause(name).curve - usual.cause(name).curve
        for name in ("gravity", "series", "constant speed", "two-mass rod")
    }
    assert np.max(np.abs(worth["series"])) > 1e-3 * usual.peak
    assert worth["series"] == pytest.approx(-worth["constant speed"], abs=1e-12 * usual.peak)
    for name in ("gravity", "two-mass rod"):
        assert np.max(np.abs(worth[name])) < 1e-12 * usual.peak


def test_the_series_at_the_run_s_own_speed_is_the_lecture_less_the_closed_form(swinging):
    scene = dataclasses.replace(
        swinging.scene,
        gravity=None,
        friction=None,
        rod=dataclasses.replace(swinging.scene.rod, inertia="two-mass"),
    )
    split = budget(swinging, chain=["constant speed", "series"]).split("piston velocity")
    at_own = lecture.piston_velocity_series(
        split_angle(swinging),
        crank_radius=scene.crank.radius,
        rod_length=scene.rod.length,
        offset=scene.piston.offset,
        omega=swinging.data["crank_speed"].values,
    )
    exact = swinging.data["piston_velocity"].values[:, 0]
    assert split.cause("series").curve == pytest.approx(at_own - exact, abs=1e-12 * split.peak)


def split_angle(result):
    return result.data["crank_angle"].values


def test_the_rest_is_what_is_not_named(swinging):
    whole, part = budget(swinging), budget(swinging, chain=["series", "datum", "constant speed"])
    for split in part.splits:
        full = whole.split(split.quantity)
        unnamed = sum(cause.curve for cause in full.causes[3:])
        assert split.cause(REST).curve == pytest.approx(unnamed, abs=1e-13 * split.peak)
        for name in list(CAUSES)[:3]:
            assert np.array_equal(split.cause(name).curve, full.cause(name).curve)
    assert ": the rest costs up to " in part.split("side thrust").sentence()


def test_the_solver_s_part_is_the_run_s_error_wherever_it_is_lifted(swinging):
    for chain in (None, ["solver", "series"]):
        found = budget(swinging, OWN, chain=chain)
        for reference in (None, "N"):
            solver = found.split("side thrust", reference).cause("solver").curve
            assert solver == pytest.approx(np.full(len(solver), -7.0), abs=1e-8)
        assert found.split("torque").share(found.split("torque").cause("solver")) == 0.0


def test_a_formula_idealizes_what_it_does_not_ask_for(swinging):
    found = budget(swinging, OWN)
    thrust, velocity = found.split("side thrust", "N"), found.split("piston velocity", "v")
    named = {cause.name for cause in thrust.causes if thrust.share(cause) > 0.0}
    assert named == {"two-mass rod", "friction", "forces", "gravity", "solver"}
    for name in ("two-mass rod", "friction"):
        theirs = found.split("side thrust").cause(name).curve
        assert thrust.cause(name).curve == pytest.approx(theirs, abs=1e-12 * thrust.peak)
    named = {cause.name for cause in velocity.causes if velocity.share(cause) > 0.0}
    assert named == {"series", "constant speed"}
    angle = found.split("rod angle", "beta")
    assert angle.share(angle.cause("series")) == angle.share(angle.total) > 1.0


def test_the_datum_is_a_formula_s_own_where_the_chain_names_it():
    result = simulate(load_scene("yi_diesel"))
    scene = result.scene
    gear = {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}

    def displacement(phi, offset):
        return lecture.piston_displacement(phi, offset=offset, **gear)

    shift = lecture.datum_shift(offset=scene.piston.offset, **gear)
    for chain, cause in ((None, "series"), (["series", "datum"], "datum")):
        split = budget(result, {"s": displacement}, chain=chain).split("piston displacement", "s")
        curve = split.cause(cause).curve
        assert curve == pytest.approx(np.full(len(curve), shift), rel=1e-6)
        assert split.total.size.largest == pytest.approx(shift, rel=1e-6)


def test_an_exact_formula_is_wrong_by_nothing(swinging):
    def acceleration(phi, omega, alpha, crank_radius, rod_length, offset):
        return lecture.piston_acceleration(
            phi,
            omega=omega,
            alpha=alpha,
            crank_radius=crank_radius,
            rod_length=rod_length,
            offset=offset,
        )

    split = budget(swinging, {"a": acceleration}).split("piston acceleration", "a")
    assert not any(split.share(cause) for cause in (*split.causes, split.total))
    assert split.sentence().startswith("piston acceleration by a: right but for rounding")


def test_what_has_no_causes_is_left_out_with_its_reason(swinging):
    formulas = {
        "crank speed": lambda theta, mean_omega: mean_omega,
        "fluctuation": lambda mean_omega: 0.06,
        "rocking moment x": lambda theta: theta,
    }
    found = budget(swinging, formulas)
    assert {split.reference for split in found.splits} == {S1}
    reasons = {entry.quantity: entry.reason for entry in found.left_out}
    assert "at the run's own speed" in reasons["crank speed"]
    assert reasons["rocking moment x"] == "the run has none"


def test_a_rod_ratio_of_one_has_no_series_but_one_s_own(swinging):
    base = swinging.scene
    scene = dataclasses.replace(
        base,
        rod=dataclasses.replace(base.rod, length=base.crank.radius, center_of_mass=0.01),
        piston=dataclasses.replace(base.piston, offset=0.0),
        run=Run(until="60 deg"),
    )
    found = budget(simulate(scene), OWN, chain=["series", "constant speed"])
    assert [cause.name for cause in found.split("torque").causes] == ["constant speed", REST]
    assert found.split("torque").reference == UNTRUNCATED
    own = found.split("piston velocity", "v")
    assert [cause.name for cause in own.causes] == ["series", "constant speed", REST]


@pytest.mark.parametrize(
    ("chain", "message"),
    [
        (["two masses"], 'a cause is series, .*; "two masses" came; did you mean "two-mass rod"'),
        (["series", "series"], 'each cause once; "series" came twice; leave one out'),
        ([], 'chain must be a list of causes, such as .*; "?\\[\\]"? came'),
        ("series", 'chain must be a list of causes, .*; "series" came'),
        ([3], "a cause is series, datum, .*; 3 came"),
    ],
)
def test_what_is_no_chain_is_refused(swinging, chain, message):
    with pytest.raises(InputError, match=message):
        budget(swinging, chain=chain)


def test_a_split_that_is_not_there_is_named(swinging):
    with pytest.raises(InputError, match=r'no "torque" by "N" here; there are "Yi et al."'):
        budget(swinging, OWN).split("torque", "N")


def test_the_files_have_every_formula(swinging, tmp_path):
    found = budget(swinging, OWN, chain=["constant speed", "series"])
    heading, *lines = save_budget_peaks(found, tmp_path).read_text().splitlines()
    assert heading.startswith("reference,quantity,unit,cylinder,cause,peak,max")
    parts = ("constant speed", "series", REST, "total")
    assert [line.split(",")[:5] for line in lines[-12:]] == [
        [label, quantity, unit, "1", part]
        for (label, quantity, unit), part in itertools.product(
            (
                ("v", "piston velocity", "m/s"),
                ("N", "side thrust", "N"),
                ("beta", "rod angle", "rad"),
            ),
            parts,
        )
    ]
    heading = save_budget(found, tmp_path).read_text().partition("\n")[0]
    assert heading.endswith("angle_deg,run,formula,total,constant speed,series,rest")


def test_a_figure_of_a_formula_has_its_causes(swinging):
    figure = budget_figure(budget(swinging, OWN), ("side thrust",), "N")
    top, bottom = figure.axes
    drawn = [
        [line.get_label() for line in ax.lines if line.get_label()[0] != "_"]
        for ax in (top, bottom)
    ]
    assert drawn == [
        ["run", "N"],
        ["sum of the causes", "two-mass rod", "gravity", "friction", "forces", "solver"],
    ]
    assert "error: formula minus run, and its causes (too small" in figure.get_supxlabel()
