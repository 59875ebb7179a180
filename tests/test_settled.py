"""The settled motion: the limit of the run from the start, or the sentence why there is none."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    AngleTable,
    Constant,
    Crank,
    FormulationError,
    InputError,
    Load,
    Quadratic,
    Result,
    Run,
    Scene,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.measures import measure
from crankmbs.mechanics.peaks import negligible, peak
from crankmbs.scene.read import load_scene as read_scene
from crankmbs.scene.write import scene_files

DIESEL, PROPELLER = load_scene("yi_diesel_free"), load_scene("propeller")
ROWS = DIESEL.gas.pressure
THIN = replace(DIESEL, gas=replace(DIESEL.gas, pressure=Table(ROWS.x[::20], ROWS.y[::20])))
KINKED = SpeedTable(
    file=Table((100.0, 300.0, 330.0, 340.0, 350.0, 500.0), (50.0, -60.0, -85.0, -87.0, -95.0, -120))
)
BRAKED = {
    "quadratic": (Quadratic(coefficient=7.775e-4),),
    "viscous": (Viscous(coefficient=0.26),),
    "kinked": (KINKED,),
    "mixed": (Constant(torque=-20.0), Viscous(coefficient=0.1), Quadratic(coefficient=3e-4)),
}
# what the crank gets less what the load takes is 0 at 100, 200 and 300 rad/s; at 200 it tears away
TWO_SPEEDS = SpeedTable(
    file=Table((50.0, 150.0, 250.0, 350.0), (5.0, -5.0, 5.0, -5.0)),
)


def settled(scene: Scene, **options: object) -> Result:
    return simulate(replace(scene, run=Run(until="settled", every="10 deg")), **options)


@pytest.mark.slow
@pytest.mark.parametrize("loads", BRAKED)
def test_it_is_the_last_cycle_of_a_run_that_has_settled(loads: str) -> None:
    scene = replace(DIESEL, torque=BRAKED[loads])
    found = settled(scene, formulation="crank_angle")
    assert found.status == 0, found.message
    assert found.message.startswith("settled: a disturbance decays to ")
    assert found.decay is not None
    cycles = int(np.ceil(np.log(1e-13) / np.log(found.decay.factor)))
    run = Run(until=f"{cycles} cycles", every="none", rtol=1e-11)
    long = simulate(replace(scene, run=run)).data
    at = np.arange(-1, -len(found.data.time) - 1, -1)
    peaks = {name: peak(values.values) for name, values in found.data.data_vars.items()}
    zero = negligible(peaks, {name: values.units for name, values in found.data.items()})
    for name, values in found.data.data_vars.items():
        if name not in zero | {"energy_residual"}:
            late = long[name].values[10 * (at + 1) - 1]
            assert np.abs(late - values.values[at]).max() <= 1e-10 * peaks[name], name
    time = long.time.values[10 * (at + 1) - 1]
    passed = found.data.time.values[-1] - found.data.time.values[at]
    assert np.abs(time[0] - time - passed).max() <= 1e-10 * passed[-1]
    assert found.data.time.values[0] == 0.0
    assert measure(found).window.kind == "last cycle"
    gain = measure(found).speed_gain
    assert abs(gain.value) <= gain.error


@pytest.mark.slow
@pytest.mark.parametrize("loads", ["kinked", "mixed"])
def test_both_formulations_agree_within_what_they_state(loads: str) -> None:
    scene = replace(THIN, torque=BRAKED[loads])
    one, other = (settled(scene, formulation=name) for name in ("crank_angle", "minimal"))
    for name, a in one.data.variables.items():
        if name not in ("cylinder", "energy_residual"):
            b = other.data[name]
            stated = a.attrs["error_estimate"] + b.attrs["error_estimate"]
            assert np.abs(a.values - b.values).max() <= 2.0 * stated, name
    assert measure(other).window.kind == "last cycle"
    assert one.decay is not None
    assert other.decay is not None
    apart = abs(one.decay.factor - other.decay.factor)
    assert apart <= one.decay.error + other.decay.error


def test_the_factor_is_what_a_run_loses_in_a_cycle() -> None:
    found = settled(DIESEL)
    assert found.decay is not None
    run = Run(until="3 cycles", every="720 deg", rtol=1e-12)
    speed = simulate(replace(DIESEL, run=run)).data.crank_speed.values
    left = speed**2 - float(found.data.crank_speed[0]) ** 2
    assert left[1:] / left[:-1] == pytest.approx(np.full(3, found.decay.factor), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("speed", "limit"), [(60.0, 100.0), (190.0, 100.0), (210.0, 300.0)])
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_of_several_it_is_the_one_that_the_start_comes_to(
    speed: float, limit: float, formulation: str
) -> None:
    still = replace(load_scene("coasting"), gravity=None, torque=(TWO_SPEEDS,))
    scene = replace(still, start=Start(angle=0.3, speed=speed))
    found = settled(scene, formulation=formulation)
    assert found.status == 0, found.message
    assert measure(found).mean_speed.value == pytest.approx(limit, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("start", [300.0, -20.0, 0.0])
def test_backwards_and_from_rest(start: float) -> None:
    scene = replace(
        DIESEL,
        gas=None,
        start=Start(angle=0.1, speed=start),
        torque=(Constant(torque=-60.0), Quadratic(coefficient=1e-3)),
    )
    found = settled(scene)
    assert found.status == 0, found.message
    assert found.data.crank_angle.values[0] == 0.1
    assert found.data.crank_angle.values[-1] == pytest.approx(0.1 - 4.0 * np.pi)
    assert measure(found).mean_speed.value == pytest.approx(-np.sqrt(60.0 / 1e-3), rel=1e-2)


ENDS = {
    "runs away": (replace(DIESEL, torque=()), "bound; give a load that grows with the speed"),
    "balanced": (load_scene("coasting"), "balance one another at any speed"),
    "brake": (
        replace(load_scene("coasting"), gravity=None, torque=(Viscous(coefficient=0.01),)),
        "does not settle: what the crank gets in a period is less",
    ),
    "held": (
        replace(
            load_scene("coasting"),
            gravity=None,
            torque=(
                SpeedTable(file=Table((0.0, 110.0, 110.0, 300.0), (20.0, 20.0, -30.0, -30.0))),
            ),
        ),
        "held at 1050.42 rpm at",
    ),
    "at rest": (
        replace(PROPELLER, gravity=None, torque=(), start=Start(angle=2 * np.pi, speed=0.0)),
        "at rest at 360 degrees: no torque moves the crank from here",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ENDS)
def test_what_does_not_settle_says_why(name: str) -> None:
    scene, sentence = ENDS[name]
    found = settled(scene)
    assert (found.status, found.decay) == (1, None)
    assert sentence in found.message
    assert all(np.isfinite(values).all() for values in found.data.variables.values())


def test_an_affine_map_costs_no_period_more_than_the_two_passes() -> None:
    one_cycle = replace(DIESEL, run=Run(until="1 cycle"))
    found = simulate(replace(one_cycle, run=Run(until="settled")))
    assert found.cost.evaluations <= simulate(one_cycle).cost.evaluations


def test_a_weak_brake_is_stated_with_what_it_makes_of_errors() -> None:
    weak = replace(DIESEL, torque=(Constant(torque=-86.9), Quadratic(coefficient=1e-8)))
    found, exact = (
        simulate(replace(weak, run=Run(until="settled", rtol=rtol))) for rtol in (1e-6, 1e-12)
    )
    assert found.status == exact.status
    assert found.status == 0
    apart = np.abs(found.data.crank_speed.values - exact.data.crank_speed.values).max()
    stated = sum(r.data.crank_speed.attrs["error_estimate"] for r in (found, exact))
    assert apart <= 2.0 * stated


def test_a_function_is_not_called_in_thousands_of_cycles_to_say_where_the_crank_stops() -> None:
    """2,700 revolutions later it turns back, and runs away in the other sense."""
    calls = [0]

    def pushes(_time: float, angle: float, _speed: float) -> float:
        calls[0] += 1
        return 5.0 if angle % math.tau < 1.0 else 0.0

    push = Load(pushes, kink_angles=(0.0, 1.0), period=math.tau)
    scene = load_scene("coasting").with_(
        gravity=None, crank__inertia=1.0, start__speed=200.0, torque=(push, Constant(torque=-2.0))
    )
    assert "its speed grows without bound" in settled(scene).message
    assert calls[0] < 2_000_000


def test_what_happens_once_is_refused() -> None:
    ramp = TimeTable(file=Table((0.0, 9.0), (0.0, 1.0)))
    with pytest.raises(InputError, match=r"torque\[2\], a time_table depends on time"):
        replace(DIESEL, torque=(Viscous(coefficient=0.2), ramp), run=Run(until="settled"))
    with pytest.raises(InputError, match=r'"settled" is the periodic motion that a free crank'):
        replace(load_scene("yi_diesel"), run=Run(until="settled"))
    with pytest.raises(InputError, match='did you mean "settled"'):
        Run(until="setled")
    with pytest.raises(FormulationError, match="solves for no periodic motion"):
        settled(DIESEL, formulation="multibody")


@pytest.mark.slow
def test_it_is_kept_and_written(tmp_path) -> None:
    found = settled(DIESEL)
    assert Result.load(found.save(tmp_path)).decay == found.decay
    for name, text in scene_files(found.scene, "mine").items():
        (tmp_path / name).write_text(text)
    assert read_scene(tmp_path / "mine.toml").run == found.scene.run


@pytest.mark.slow
@pytest.mark.parametrize("inertia", [3.0, 300.0])
def test_of_a_motor_too_weak_it_is_said_when_the_crank_stops(inertia: float) -> None:
    """The press takes more in a turn than the motor gives; with the heavier wheel it stops some
    cycles later. The load over the angle then drives it backwards, faster and faster, and that is
    not what happens to the press."""
    press = AngleTable(file=Table((0.0, 2.0, 2.02, 3.14, 3.16, 6.28), (0, 0, -900.0, -900.0, 0, 0)))
    scene = replace(
        load_scene("coasting"),
        gravity=None,
        crank=Crank(radius=0.05, inertia=inertia),
        start=Start(angle=0.0, speed=6.0),
        torque=(Constant(torque=100.0), press),
    )
    found = settled(scene)
    assert found.status == 1
    said = re.search(r"it stops at (\S+) s, at (\S+) degrees, where it turns back", found.message)
    assert said, found.message
    cycles = Run(until="200 cycles", every="5 deg")
    speed = simulate(replace(scene, run=cycles)).data.crank_speed
    stop = int(np.argmax(speed.values < 0.0))
    times = speed.time.values[stop - 1 : stop + 1]
    assert times[0] <= float(said[1]) <= times[1]
    assert math.degrees(speed.crank_angle.values[stop - 1]) <= float(said[2]) + 0.01


@pytest.mark.slow
def test_a_crank_without_a_flywheel_stops_in_its_first_cycle_and_that_is_the_reason() -> None:
    """The load is the same with which the shipped engine settles at 3,190 rpm."""
    scene = load_scene("propeller").with_(crank__inertia=0.0, run__until="settled")
    found = simulate(scene)
    said = re.search(
        r"before its first cycle is over it stops at (\S+) s, at (\S+) degrees, where it turns "
        r"back, as its kinetic energy of (\S+) J at the start .* larger crank\.inertia",
        found.message,
    )
    assert said, found.message
    run = simulate(scene.with_(run__until="1 cycle", run__every="1 deg"), formulation="minimal")
    assert run.data.crank_speed.values.min() < 0.0
    assert float(run.data.kinetic_energy[0]) == pytest.approx(float(said[3]), rel=1e-3)


def test_a_motor_that_starts_where_its_torque_is_flat_settles_where_it_falls():
    """No step towards the balance may be taken for a speed without bound before it is tried."""
    table = SpeedTable(file=Table((188.5, 230.4, 324.6), (55.0, -37.0, -49.0)))
    scene = load_scene("coasting").with_(
        gravity=None, torque=(table,), crank__inertia=0.1, start__speed=5.0, run__until="settled"
    )
    settled = simulate(scene)
    long = simulate(scene.with_(run__until="400 cycles", run__every="none"))
    assert settled.status == 0, settled.message
    speeds = (one.data["crank_speed"].values[-1] for one in (settled, long))
    assert next(speeds) == pytest.approx(next(speeds), rel=1e-9)


def test_a_crank_that_a_load_alone_slows_down_does_not_settle():
    """Its energy falls by a part of itself in every period, to no value above 0."""
    load = (Quadratic(coefficient=1e-3),)
    scene = load_scene("coasting").with_(gravity=None, torque=load, run__until="settled")
    result = simulate(scene)
    assert result.status == 1
    assert "it turns ever slower" in result.message
