"""The settled motion of an engine with fuel: misfires that come again, and governors."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from test_fuel import FOUR, GOVERNOR, THIN_GAS, fuelled

from crankmbs import (
    Constant,
    Extent,
    Fuel,
    InputError,
    Layout,
    Misfire,
    Result,
    Run,
    Viscous,
    engine_orders,
    orders,
    simulate,
)
from crankmbs.cli.orders import orders_report
from crankmbs.figures import save_figures
from crankmbs.measures import measure

MISFIRE = Misfire(cylinder=1, cycles="every 2")
THIRD = Misfire(cylinder=2, cycles="every 3")
LOW = replace(GOVERNOR, max=0.5)
TWO = Layout(firing_order=(1, 2))
FUELS = {
    "all fire": Fuel(),
    "every 2": Fuel(misfire=[MISFIRE]),
    "every 2 and 3": Fuel(misfire=[MISFIRE, THIRD]),
    "governor": Fuel(governor=GOVERNOR),
    "clipped governor": Fuel(governor=LOW),
    "governor and misfire": Fuel(governor=GOVERNOR, misfire=[THIRD]),
}
PERIODS = {"all fire": 1, "every 2": 2, "every 2 and 3": 6, "governor and misfire": 3}


def settled(fuel, **changes):
    return replace(fuelled(fuel, **changes), run=Run(until="settled", every="10 deg"))


@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.0, 1.0])
@pytest.mark.parametrize("name", FUELS)
def test_it_is_the_end_of_a_run_that_has_settled(name, angle):
    """Of as many periods as leave 1e-13 of a disturbance."""
    scene = settled(FUELS[name], start=replace(FOUR.start, angle=angle))
    found = simulate(scene)
    assert found.status == 0, found.message
    assert found.decay is not None
    period = scene.settled_period
    assert period == pytest.approx(PERIODS.get(name, 1) * scene.period)
    count = int(np.ceil(np.log(1e-13) / np.log(found.decay.factor)))
    cycles = Extent(value=float(count * round(period / scene.period)), unit="cycle")
    run = Run(until=cycles, every="none", rtol=1e-11)
    late = simulate(replace(scene, run=run)).data
    back = np.arange(round(scene.period / np.radians(10.0)))
    back = back[back % 18 > 0]  # not where a cylinder decides: of the sides of a jump either counts
    steps, own = len(late.time) - 1 - 10 * back, len(found.data.time) - 1 - back
    for key in ("crank_speed", "crank_torque", "main_bearing_force_x", "fuel", "gas_force"):
        apart = np.abs(late[key].values[steps] - found.data[key].values[own]).max()
        assert apart <= 2e-10 * np.abs(found.data[key].values).max(), key


@pytest.mark.slow
@pytest.mark.parametrize("name", ["governor", "governor and misfire"])
@pytest.mark.parametrize("loads", [FOUR.torque, (Viscous(coefficient=0.2),)])
def test_unclipped_the_mean_is_exactly_the_governors_speed(name, loads):
    result = simulate(settled(FUELS[name], torque=loads))
    mean = measure(result).mean_speed
    assert abs(mean.value / GOVERNOR.speed - 1.0) < 1e-12
    assert 0.0 < result.data["fuel"].values.max() < GOVERNOR.max


@pytest.mark.slow
def test_both_formulations_agree_within_what_they_state():
    one, other = (
        simulate(settled(FUELS["governor"], gas=THIN_GAS, layout=TWO), formulation=name)
        for name in ("crank_angle", "minimal")
    )
    for key in ("time", "crank_speed", "fuel", "side_force"):
        a, b = one.data[key], other.data[key]
        stated = a.attrs["error_estimate"] + b.attrs["error_estimate"]
        assert np.abs(a.values - b.values).max() <= 2.0 * stated, key
    apart = abs(one.decay.factor - other.decay.factor)
    assert apart <= one.decay.error + other.decay.error


@pytest.mark.slow
def test_the_factor_is_what_a_run_loses_in_a_cycle():
    found = simulate(settled(FUELS["governor"]))
    run = Run(until="50 cycles", every="720 deg", rtol=1e-12)
    speed = simulate(replace(found.scene, run=run)).data.crank_speed.values
    left = (speed - float(found.data.crank_speed[0]))[20:]
    before, now = (
        np.column_stack([left[1:-1], left[:-2]]),
        left[2:],
    )  # two factors lead, others err it by 2e-4
    one, other = np.linalg.lstsq(before, now, rcond=None)[0]
    assert np.abs(np.roots([1.0, -one, -other])).max() == pytest.approx(
        found.decay.factor, rel=1e-3
    )


def test_measures_are_over_the_whole_period():
    found = measure(simulate(settled(FUELS["every 2"])))
    assert found.window.kind == "last period"
    assert abs(found.window.angle) == pytest.approx(2.0 * FOUR.period)
    assert abs(found.speed_gain.value) <= found.speed_gain.error
    fires, burns = (found.imep[k].value for k in (0, 1))
    motored = measure(simulate(settled(Fuel(misfire=[Misfire(cylinder=1, cycles="every 1")]))))
    expected = 0.5 * (burns + motored.imep[0].value)
    assert fires == pytest.approx(expected, rel=1e-6)


HARD = replace(GOVERNOR, kp=0.002, ki=3.0, max=5.0)
LOST = {
    "hunts": (Fuel(governor=HARD), FOUR.torque, "the governor hunts, as what is off its steady"),
    "swings": (
        Fuel(governor=replace(GOVERNOR, kp=1.0, max=5.0)),
        FOUR.torque,
        "the governor hunts, from its least share to its greatest and back",
    ),
    "runs away": (Fuel(misfire=[MISFIRE]), (), "its speed grows without bound"),
    "stalls": (
        Fuel(misfire=[MISFIRE]),
        (Viscous(coefficient=2.0), Constant(torque=-100.0)),
        "more than the 25000 evaluations that the cost cap allows",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LOST)
def test_what_does_not_settle_says_why(name):
    fuel, loads, sentence = LOST[name]
    found = simulate(settled(fuel, torque=loads, gas=THIN_GAS), cost_cap=0.5)
    assert (found.status, found.decay) == (-1 if "cost cap" in sentence else 1, None)
    assert sentence in found.message
    assert all(np.isfinite(values).all() for values in found.data.variables.values())


@pytest.mark.parametrize(
    ("fuel", "why"),
    [
        (Fuel(scatter=0.1), "scatter makes every share another"),
        (Fuel(misfire=[Misfire(cylinder=1, cycles="3")]), "a listed misfire happens once"),
        (Fuel(governor=GOVERNOR, after=0.1), "a window acts once"),
    ],
)
def test_what_happens_once_or_at_random_is_refused(fuel, why):
    with pytest.raises(InputError, match=why):
        settled(fuel)


@pytest.mark.slow
def test_it_is_kept(tmp_path):
    found = simulate(settled(FUELS["governor"]))
    again = Result.load(found.save(tmp_path))
    assert again.decay == found.decay
    assert again.decay.factor < inf


def test_orders_are_over_the_whole_period():
    """Quarters of an order, against the sum over evenly spaced samples of the period."""
    scene = settled(FUELS["every 2"])
    found = simulate(replace(scene, run=replace(scene.run, every="1 deg")))
    speed, angle = (found.data[name].values[:-1] for name in ("crank_speed", "crank_angle"))
    assert angle[-1] - angle[0] == pytest.approx(np.radians(1439.0))
    split = orders(found, "crank_speed", 4.0)
    np.testing.assert_array_equal(split.order, np.arange(1, 17) / 4.0)
    waves = np.exp(-1j * np.outer(split.order, angle)) @ speed * 2.0 / len(speed)
    apart = np.abs(split.amplitude * np.exp(1j * split.phase) - waves)
    assert apart.max() <= 1e-6 * np.abs(waves).max()
    assert split.mean == pytest.approx(speed.mean(), rel=1e-8)  # rows at each degree: an alias
    assert np.abs(waves[0]) > 0.1 * np.abs(waves).max()  # the misfire's own order, of two cycles
    engine = engine_orders(found, 4.0)
    assert engine.window.kind == "last period"
    assert "orders over the last period" in orders_report(engine)


@pytest.mark.slow
def test_the_cycles_of_a_settled_period_are_drawn(tmp_path):
    save_figures(simulate(settled(FUELS["every 2"])), tmp_path)
    assert (tmp_path / "cycles.png").exists()
