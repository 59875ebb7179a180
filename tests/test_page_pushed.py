"""Unlike cylinders, double-acting ones and forces from outside on the pistons in the page's engine,
as in Python: scenes of each kind of force, and random ones, seeds fixed beforehand."""

from dataclasses import replace

import pytest
from page_engine import differences, sizes, unlike
from page_guards import DRAGS, MACHINE, PUSHES, stepping, uneven
from page_scenes import sampled, settled, shortened

from crankmbs import Force, load_scene, simulate
from crankmbs.measures import measure
from crankmbs.page import refusals
from crankmbs.page.knobs import choices_of, first_of, knobs_of
from crankmbs.scene.forces import ConstantForce, ForceTimeTable
from crankmbs.scene.run import Extent
from crankmbs.scene.tables import Table
from validation.random_double import random_double
from validation.random_unlike import random_unlike

STAGES = load_scene("two_stage_compressor")
EACH = {f"{n} {one.kind}": (one,) for n, one in enumerate(DRAGS)}
MADE = {
    "two stages": STAGES,
    **{name: replace(STAGES, force=force) for name, force in EACH.items()},
    "every force": replace(uneven(settled("v_twin")), force=DRAGS),
    "a jump at a sample": stepping(replace(settled("v_twin"), **MACHINE, force=PUSHES)),
    "a run": replace(shortened(uneven(load_scene("propeller")), 1.5), force=DRAGS),
    "driven": replace(uneven(load_scene("yi_diesel")), force=DRAGS),
    "both ends": replace(load_scene("steam_engine"), force=(ConstantForce(force=50.0),)),
}
LEFT = {"function", "governor", "random firing", "rest"}  # to Python


def steady(scene):
    """The scene with those of its forces that are the same in every cycle, all the time."""
    whole = {"after": None, "until": None, "from_speed": None, "until_speed": None}
    kept = [one for one in scene.force if one.law.over_time is None and one.law.python is None]
    return replace(scene, force=tuple(replace(one, **whole) for one in kept))


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_motion_every_reaction_and_measure_are_those_of_python(engine, name):
    scene = sampled(MADE[name], 0.5)
    assert refusals(scene) == ()
    result = simulate(scene, rtol=1e-12)
    found = engine.answer(scene, result.data["crank_angle"].values)
    assert found["ending"] == "complete", result.message
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])
    measures = measure(result)
    assert unlike(measures, found["measures"], sizes(result, measures)) == {}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("draw", "seeds", "least"),
    [
        (lambda seed: steady(random_unlike(seed)), range(5000, 5120), 50),
        (random_double, range(60), 15),
    ],
    ids=["unlike", "double-acting"],
)
def test_random_ones_are_those_of_python(engine, draw, seeds, least):
    same, slow = [], []
    for seed in seeds:
        scene = draw(seed)
        reasons = {said.partition(":")[0] for said in refusals(scene)}
        assert reasons <= LEFT
        if reasons:
            continue
        every = Extent(value=0.2, unit="rad")
        scene = replace(scene, run=replace(scene.run, every=every))
        result = simulate(scene, rtol=1e-12)
        found = engine.answer(scene, result.data["crank_angle"].values)
        if found["ending"] == "slow":  # comes to rest, turns back, or nearly so
            over_time = any("near standstill" in reason for reason in result.reasons)
            assert result.status == 1 or over_time, seed
            slow.append(seed)
            continue
        assert found["ending"] == "complete", (seed, result.message)
        worst = differences(result, found["variables"])
        assert max(worst.values()) < 1e-9, (seed, max(worst.items(), key=lambda one: one[1]))
        same.append(seed)
    assert len(same) > least
    assert len(slow) < 20


def test_what_changes_with_time_is_left_to_python():
    rows = ForceTimeTable(file=Table((0.0, 10.0), (0.0, 5.0)))
    for force in (rows, ConstantForce(force=5.0, after=0.1)):
        (said,) = refusals(replace(STAGES, run=shortened(STAGES).run, force=(force,)))
        assert said == "force: a force on the pistons changes with time or has a window"
    given = replace(STAGES, run=shortened(STAGES).run, force=(Force(lambda *_: 0.0),))
    assert refusals(given)[0].startswith("function: a force on a piston is a function of Python")


def test_unlike_cylinders_have_no_knobs_of_one_geometry():
    names = [knob.name for knob in knobs_of(STAGES)]
    assert names == ["speed", "load", "pressure", "flywheel", "counterweight"]
    assert [choice.name for choice in choices_of(STAGES)] == ["speed_is"]
    driven = replace(uneven(load_scene("compressor")), force=())
    assert first_of(driven).knobs == ("speed", "pressure", "counterweight")
    one = replace(load_scene("propeller"), force=(ConstantForce(force=5.0, cylinder=1),))
    assert "cylinders" not in {choice.name for choice in choices_of(one)}
    each = replace(one, force=(ConstantForce(force=5.0),))
    assert "cylinders" in {choice.name for choice in choices_of(each)}
