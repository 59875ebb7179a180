"""Free runs as a whole: hand-over at rest, every physical end with its sentence, honest limits."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Quadratic,
    Run,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.free import handover, passes

COASTING, PROPELLER = load_scene("coasting"), load_scene("propeller")
BOTH = pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
COULOMB = SpeedTable(file=Table((-100.0, 0.0, 0.0, 100.0), (5.0, 5.0, -5.0, -5.0)))
GOVERNOR = SpeedTable(file=Table((0.0, 110.0, 110.0, 300.0), (20.0, 20.0, -30.0, -30.0)))


def scene(base=COASTING, until="3 rev", every="10 deg", **changes):
    return replace(base, **changes, run=Run(until=until, every=every, rtol=1e-7))


def at_rest(angle):
    return Start(angle=angle, speed=0.0)


FOLDING = replace(COASTING.rod, length=0.046, center_of_mass=0.02)
ENDS = {
    "dead centre": (
        scene(PROPELLER, gravity=None, torque=(), start=at_rest(2 * np.pi)),
        "at rest at 360 degrees: no torque moves the crank from here",
    ),
    "swing": (
        scene(start=at_rest(1.0), every="5 ms"),
        "swings without reaching the end: 21 reversals, the last",
    ),
    "friction": (scene(gravity=None, torque=(COULOMB,), until="9 rev"), "held at 0 rpm at"),
    "governor": (scene(gravity=None, torque=(GOVERNOR,)), "held at 1050.42 rpm at"),
    "brake": (scene(gravity=None, torque=(Viscous(coefficient=1e6),)), "came to rest at 17.18"),
    "fold": (scene(rod=FOLDING), "the rod folds onto the crank at 89.9999 degrees"),
}


@BOTH
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if name == "swing" else ()) for name in ENDS],
)
def test_physical_ends(name, formulation):
    ending, sentence = ENDS[name]
    result = simulate(ending, formulation=formulation)
    assert result.status == 1
    assert result.message.startswith(sentence)
    assert np.all(np.diff(result.data["time"].values) > 0.0)
    assert all(np.isfinite(values).all() for values in result.data.variables.values())


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("every", ["10 deg", "1 deg", "none"])
def test_a_swing_that_turns_on_its_samples(formulation, every):
    """It returns to the angle where it starts, which a pass may reach or miss by rounding."""
    swinging = scene(start=at_rest(1.0), until="3 rev", every=every)
    result = simulate(swinging, formulation=formulation)
    assert (result.status, result.message[:6]) == (1, "swings")
    assert 0.0 < result.error.estimated <= 1e-7


CROSSINGS = {
    "from rest": scene(load_scene("torque_driven"), start=at_rest(0.0)),
    "swinging back": scene(PROPELLER, start=Start(angle=0.0, speed=6.3), until="2 s"),
    "pushed back": scene(
        gravity=None, start=Start(angle=0.0, speed=30.0), torque=(Constant(torque=-20.0),)
    ),
    "started later": scene(
        gravity=None,
        start=at_rest(0.4),
        torque=(TimeTable(file=Table((0.0, 0.1, 0.1, 2.0), (0.0, 0.0, 9.0, 9.0))),),
    ),
}


@pytest.mark.parametrize("name", CROSSINGS)
def test_minimal_carries_across_rest_and_both_agree(name):
    """Seamless: the two formulations differ by less than they state together."""
    one, other = (simulate(CROSSINGS[name], formulation=f) for f in ("crank_angle", "minimal"))
    assert one.status == other.status == 0
    assert any("near standstill, from" in reason for reason in one.reasons)
    assert one.data.sizes == other.data.sizes
    for variable in ("time", "crank_angle", "crank_speed", "side_force"):
        a, b = one.data[variable], other.data[variable]
        stated = a.attrs["error_estimate"] + b.attrs["error_estimate"]
        assert np.abs(a.values - b.values).max() <= 2.0 * stated


@pytest.mark.slow
@BOTH
def test_a_tolerance_out_of_reach_is_said(formulation):
    beside = scene(PROPELLER, gravity=None, torque=(), start=at_rest(2 * np.pi + 1e-9))
    result = simulate(replace(beside, run=Run(until="0.2 s")), formulation=formulation, rtol=1e-12)
    assert result.status == 0
    assert result.error.estimated > 1e-12
    assert "asked for 1e-12, reached" in result.message


@BOTH
@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-11])
def test_the_tolerance_is_kept(formulation, rtol):
    loaded = scene(torque=(Constant(torque=3.0), Viscous(coefficient=0.05)))
    result = simulate(loaded, formulation=formulation, rtol=rtol)
    assert result.error.asked == rtol
    assert 0.0 < result.error.estimated <= rtol


def test_cells_are_split_on_the_way_and_nothing_is_begun_anew(monkeypatch):
    integrate, passed = passes.integrate, []

    def counted(grid, *arguments, **options):
        passed.append(made := integrate(grid, *arguments, **options))
        return made

    monkeypatch.setattr(passes, "integrate", counted)
    result = simulate(load_scene("torque_driven"), formulation="crank_angle")
    assert result.error.estimated <= result.error.asked
    answer, better = passed
    assert len(answer.hand.grid.edges) > len(
        passes.first_grid(crank_train(load_scene("torque_driven")), result.error.asked).edges
    )
    assert np.array_equal(better.grid.edges, answer.hand.grid.edges)


def halved(grid):
    return grid.split(np.full(len(grid.edges) - 1, 2)) if len(grid.edges) < 1000 else grid


def test_cells_that_are_split_in_every_segment_give_an_answer(monkeypatch):
    monkeypatch.setattr(handover, "_ROUNDS", 3)
    monkeypatch.setattr(Grid, "refined", lambda grid, *_: halved(grid))
    result = simulate(COASTING, formulation="crank_angle")
    assert result.status == 0
    assert 0.0 < result.error.estimated < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("rtol", [1e-9, 1e-12])
@pytest.mark.parametrize("name", ["torque_driven", "coasting"])
def test_time_as_the_variable_reaches_a_tight_tolerance(name, rtol):
    assert simulate(load_scene(name), formulation="minimal", rtol=rtol).error.estimated <= rtol


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_samples_on_dead_centres_alone_have_no_velocity_of_the_piston_to_err(formulation):
    scene = load_scene("propeller").with_(run__until="2 rev", run__every="1 rev")
    result = simulate(scene, formulation=formulation, rtol=1e-6)
    assert np.abs(result.data["piston_velocity"].values).max() < 1e-12
    assert 0.0 < result.error.estimated <= 1e-6


@pytest.mark.parametrize("load", [Quadratic(coefficient=1e-4), Viscous(coefficient=1e-3)])
def test_tighter_costs_more(load):
    loaded = scene(PROPELLER, torque=(load,))
    costs = [simulate(loaded, rtol=rtol).cost.evaluations for rtol in (1e-4, 1e-8, 1e-12)]
    assert costs == sorted(costs)


@pytest.mark.slow
def test_a_swing_is_left_to_time(monkeypatch):
    """Eight hand-overs that did not last a period are enough: from then on it must turn one."""
    segments, advance = [], handover.crank_angle.advance

    def counted(*args):
        segments.append(args)
        return advance(*args)

    monkeypatch.setattr(handover.crank_angle, "advance", counted)
    swing = replace(COASTING, start=at_rest(1.0), run=Run(until="20 s", every="0.1 s", rtol=1e-7))
    result = simulate(swing, formulation="crank_angle")
    assert result.status == 0
    assert np.count_nonzero(np.diff(np.sign(result.data["crank_speed"].values))) > 20
    assert 8 <= len(segments) <= 40, "both passes together"
