"""When loads set in and end, against closed forms: a bare flywheel of 0.5 kg m2."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Crank,
    Extent,
    InputError,
    Piston,
    Quadratic,
    Rod,
    Run,
    Scene,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    load_scene,
    simulate,
)
from crankmbs.mechanics.windows import Phase, first_phases, later_phases
from crankmbs.scene.read import parse_scene
from crankmbs.scene.write import scene_files

FREE = ["crank_angle", "minimal"]


def wheel(*torque, speed=0.0, until=4.0, every=0.125, angle=0.3):
    return Scene(
        crank=Crank(radius=0.04, inertia=0.5),
        rod=Rod(length=0.14),
        piston=Piston(mass=0.0),
        start=Start(angle=angle, speed=speed),
        torque=torque,
        run=Run(
            until=Extent(value=until, unit="s"), every=Extent(value=every, unit="s"), rtol=1e-10
        ),
    )


def speeds(scene, formulation):
    result = simulate(scene, formulation=formulation)
    assert result.status == 0, result.message
    data = result.data
    return data["time"].values, data["crank_speed"].values, result


def close(values, exact):
    np.testing.assert_allclose(values, exact, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("formulation", FREE)
def test_after_and_until(formulation):
    t, omega, _ = speeds(wheel(Constant(torque=5.0, after=0.55, until=2.3), speed=7.0), formulation)
    close(omega, 7.0 + 10.0 * np.clip(t - 0.55, 0.0, 2.3 - 0.55))


@pytest.mark.parametrize("formulation", FREE)
def test_a_starter_is_off_for_good(formulation):
    """It is off at 20 rad/s; a brake brings the crank back through that speed."""
    starter = Constant(torque=10.0, until_speed=20.0)
    brake = Constant(torque=-5.0, after=1.5, until=3.0)
    t, omega, _ = speeds(wheel(starter, brake), formulation)
    close(omega, np.minimum(20.0 * t, 20.0) - 10.0 * np.clip(t - 1.5, 0.0, 1.5))


@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("begin", [10.0, 30.0])
def test_a_speed_is_met_from_either_side(formulation, begin):
    push = Constant(torque=5.0 if begin < 20.0 else -5.0)
    late = Constant(torque=-3.0 * push.torque, from_speed=20.0, until_speed=12.0)
    t, omega, _ = speeds(wheel(push, late, speed=begin, until=2.5), formulation)
    sign = math.copysign(1.0, push.torque)
    there = 20.0 - sign * 20.0 * (t - 1.0)  # after a second it pulls thrice as hard
    exact = np.where(t < 1.0, begin + sign * 10.0 * t, there)
    if begin < 20.0:  # and at 12 rad/s, 0.4 s later, it is over
        exact = np.where(t < 1.4, exact, 12.0 + 10.0 * (t - 1.4))
    close(omega, exact)


@pytest.mark.parametrize("formulation", FREE)
def test_both_a_time_and_a_speed_must_have_been_met(formulation):
    """The speed is met at 1 s and left again; the load sets in at 3 s."""
    down = Constant(torque=-5.0)
    late = Constant(torque=5.0, from_speed=10.0, after=3.0)
    t, omega, _ = speeds(wheel(down, late, speed=20.0), formulation)
    close(omega, 20.0 - 10.0 * np.minimum(t, 3.0))


@pytest.mark.parametrize("formulation", FREE)
def test_backwards_a_speed_has_its_sign(formulation):
    down = Constant(torque=-5.0)
    never, then = (
        Constant(torque=50.0, from_speed=15.0),
        Constant(torque=5.0, from_speed=-15.0),
    )
    t, omega, _ = speeds(wheel(down, never, then, speed=-5.0), formulation)
    close(omega, -5.0 - 10.0 * np.minimum(t, 1.0))


@pytest.mark.parametrize("formulation", FREE)
def test_a_crank_at_rest_waits(formulation):
    t, omega, result = speeds(wheel(Constant(torque=5.0, after=1.3)), formulation)
    close(omega, 10.0 * np.maximum(t - 1.3, 0.0))
    assert "rest" not in result.message


@pytest.mark.parametrize("formulation", FREE)
def test_a_crank_that_is_held_waits_too(formulation):
    clutch = SpeedTable(file=Table((-9.0, 0.0, 0.0, 9.0), (4.0, 4.0, -4.0, -4.0)))
    t, omega, result = speeds(wheel(clutch, Constant(torque=9.0, after=1.3)), formulation)
    close(omega[t < 1.3], 0.0)
    t1 = t[(t > 1.3) & (omega < 9.0)]
    close(omega[(t > 1.3) & (omega < 9.0)], 10.0 * (t1 - 1.3))
    close(result.data["external_torque"].values[t < 1.3], 0.0)


@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("starts", [{"from_speed": 5.0}, {"after": 1.0, "from_speed": 5.0}])
def test_at_rest_with_no_load_that_may_set_in_is_status_1(formulation, starts):
    result = simulate(wheel(Constant(torque=5.0, **starts)), formulation=formulation)
    assert result.status == 1
    assert "at rest" in result.message


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
def test_whole_periods_are_skipped_only_between_changes(formulation):
    scene = wheel(Constant(torque=5.0, after=30.2), Constant(torque=-2.5), speed=200.0, until=60.0)
    kept = replace(scene, run=replace(scene.run, every=None))
    result = simulate(kept, formulation=formulation)
    assert float(result.data["crank_speed"][-1]) == pytest.approx(200.0 - 151.0 + 149.0, rel=1e-9)


def test_multibody_lands_on_times_and_speeds():
    starter = Constant(torque=10.0, until_speed=20.0)
    brake = Constant(torque=-5.0, after=1.55, until=2.64)
    scene = wheel(starter, brake, speed=2.0, until=3.0)
    scene = replace(scene, piston=Piston(mass=2.0), rod=Rod(length=0.14, mass=1.0))
    answer, check = (simulate(scene, formulation=name) for name in ("crank_angle", "multibody"))
    for name in ("crank_speed", "crank_angle", "external_torque"):
        a, b = answer.data[name], check.data[name]
        apart = np.max(np.abs(a.values - b.values))
        assert apart <= a.error_estimate + b.error_estimate
    assert check.error.estimated < 1e-4


def test_a_time_table_need_cover_only_its_window():
    table = Table((1.0, 2.0), (4.0, 4.0))
    t, omega, _ = speeds(wheel(TimeTable(file=table, after=1.0, until=2.0), speed=5.0), "auto")
    close(omega, 5.0 + 8.0 * np.clip(t - 1.0, 0.0, 1.0))
    with pytest.raises(InputError, match=r"must cover its window, 0.5 to 2 s; it goes from 1 to 2"):
        wheel(TimeTable(file=table, after=0.5, until=2.0))
    with pytest.raises(InputError, match=r"must cover the run, 0 to 4 s; it goes from 1 to 2"):
        wheel(TimeTable(file=table))
    late = TimeTable(file=table, after=1.0, until_speed=99.0)
    with pytest.raises(InputError, match=r"torque\[1\].file: table: the time table ends at 2 s"):
        simulate(wheel(late, speed=5.0))


def test_a_window_that_never_opens_is_refused():
    with pytest.raises(InputError, match="until must be later than after, 2 s"):
        Constant(torque=1.0, after=2.0, until=1.0)
    with pytest.raises(InputError, match="until must be later than the start, 0 s"):
        Constant(torque=1.0, until=0.0)


def test_phases_go_one_way():
    loads = (Quadratic(coefficient=1.0, after=1.0, from_speed=5.0, until_speed=5.0),)
    phases = first_phases(loads, 0.0)
    walked = [phases[0]]
    for t, omega in ((2.0, 5.0), (3.0, 6.0), (4.0, 5.0), (5.0, 5.0)):
        phases = later_phases(loads, phases, t, omega)
        walked.append(phases[0])
    over = Phase.OVER
    assert walked == [Phase.WAITING, Phase.ACTING, Phase.ACTING, over, over]
    assert first_phases((Constant(torque=1.0),), 0.0) == ()


def test_windows_are_written(tmp_path):
    load = Constant(torque=1.0, after=0.5, until=2.0, from_speed=10 * math.pi, until_speed=-1.25)
    text = scene_files(wheel(load), "again")["again.toml"]
    assert 'from_speed = "300 rpm"' in text
    assert parse_scene(text, tmp_path / "again.toml").torque == (load,)


def test_existing_scenes_have_no_mode():
    assert first_phases(load_scene("propeller").torque, 300.0) == ()


def test_a_reader_is_told():
    load = Constant(torque=1.0, after=0.5, until_speed=10 * math.pi)
    assert load.window_words == ", after 0.5 s, until 300 rpm"
    assert Constant(torque=1.0).window_words == ""


JUMPS = TimeTable(file=Table([0.0, 0.2, 0.2, 1.0], [0.0, 0.0, 4.0, 4.0]))


@pytest.mark.slow
@pytest.mark.parametrize("formulation", [*FREE, "multibody"])
def test_a_sample_at_a_jump_in_time_has_the_value_after_it(formulation):
    """Also where rounding puts the sample beside it: 3 * 0.1 lies above 0.3."""
    off = Constant(torque=-2.0, after=0.3, until=0.7 + 1e-12)
    loads = (off, Constant(torque=1.0, until=0.5), JUMPS)
    every, until = Extent(value=0.1, unit="s"), Extent(value=0.8, unit="s")
    scene = replace(load_scene("coasting"), torque=loads, run=Run(until=until, every=every))
    data = simulate(scene, formulation=formulation, cost_cap=600.0).data
    torque = [1.0, 1.0, 5.0, 3.0, 3.0, 2.0, 2.0, 4.0, 4.0]
    np.testing.assert_allclose(data["external_torque"], torque, rtol=0.0, atol=1e-4)
    apart = data["external_torque"].attrs["error_estimate"]
    assert apart <= (1e-3 if formulation == "multibody" else 1e-9)
