"""Shares of the combustion: misfires, scatter, a governor, windows.

Long, as every rule of the one law is held beside the same scenes.
"""

import math
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scene_texts import FREE, INDICATED, edited, refusal

from crankmbs import (
    Constant,
    Extent,
    Fuel,
    Governor,
    InputError,
    Misfire,
    Motion,
    Polytrope,
    Quadratic,
    Result,
    Table,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.measures import measure
from crankmbs.mechanics.firing import governed
from crankmbs.mechanics.pressure import motored_of, pressures_of
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle import firings as crank_angle_firings
from crankmbs.motion.crank_angle.firings import solve_fired
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.motion.crank_angle.solvers import Begin
from crankmbs.motion.mode import begun
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.write import scene_files
from validation.adapter import machine_of
from validation.oracles import firings

RPM = pi / 30.0
FOUR = load_scene("yi_diesel_free")
ROWS = FOUR.gas.pressure
DEGREES = np.degrees(ROWS.x)
BACK = np.interp(np.radians(360.0 - np.abs(DEGREES - 360.0)), ROWS.x, ROWS.y)
EXPANDS = (DEGREES >= 360.0) & (DEGREES <= 540.0)
MOTORED = Table(ROWS.x, np.where(EXPANDS, np.minimum(ROWS.y, BACK), ROWS.y).tolist())
GAS = replace(FOUR.gas, motored=MOTORED, interpolation="pchip")
THIN = [Table(table.x[::30], table.y[::30]) for table in (ROWS, MOTORED)]
THIN_GAS = replace(GAS, pressure=THIN[0], motored=THIN[1])
GOVERNOR = Governor(speed=3000 * RPM, kp=0.01, ki=0.1, max=1.2, initial=0.5)
FUELS = {
    "misfire": Fuel(
        misfire=[Misfire(cylinder=3, cycles="2-3"), Misfire(cylinder=1, cycles="every 2")]
    ),
    "scatter": Fuel(scatter=0.2, seed=7),
    "governor": Fuel(governor=GOVERNOR),
    "clipping governor": Fuel(governor=replace(GOVERNOR, kp=0.2, max=1.0, min=0.1)),
    "all at once": Fuel(governor=GOVERNOR, scatter=0.1, misfire=[Misfire(cylinder=2, cycles="3")]),
}


def fuelled(fuel, cycles=4.0, **changes):
    run = replace(FOUR.run, until=Extent(value=cycles, unit="cycle"))
    return replace(FOUR, **{"gas": GAS, "fuel": fuel, "run": run, **changes})


def part(fuel):
    """What misfires and scatter leave of a share, by the letter of the rule."""

    def left(cylinder, cycle):
        lists = {"2-3": (2, 3), "3": (3,), "every 2": range(2, 100, 2)}
        for misfire in fuel.misfire or ():
            if misfire.cylinder == cylinder and cycle in lists[misfire.cycles]:
                return 0.0
        z = np.random.default_rng((fuel.seed, cylinder, cycle)).standard_normal()
        return max(0.0, 1.0 + fuel.scatter * z)

    return left


def exact(scene, angles):
    """The oracle's motion and shares."""
    fuel, given = scene.fuel, scene.fuel.governor
    law = given and firings.Governor(
        given.speed, given.kp, given.ki, given.min, given.max, given.initial
    )
    machine = machine_of(scene)
    motored = machine_of(replace(scene, gas=replace(THIN_GAS, pressure=THIN[1]))).pressure
    start = scene.start.angle, scene.start.speed
    return firings.governed_motion(machine, motored, start, angles, law, part(fuel))


def assert_as_the_oracle_has_it(data, motion, shares):
    """Samples but the first: what is fired, and the motion within twice the stated errors."""
    assert np.abs(data["fuel"].values[1:] - shares).max() < 1e-10
    for key, values in (("crank_speed", motion.omega), ("crank_acceleration", motion.alpha)):
        true = np.abs(data[key].values[1:] - values).max()
        floor = 1e-12 * np.abs(data[key].values).max()
        assert true <= 2.0 * data[key].attrs["error_estimate"] + floor
    assert np.ptp(shares) > 0.01


@pytest.mark.slow
def test_the_oracle_has_the_same_shares_and_motion():
    """Of all at once `test_cycles` has it."""
    begin = replace(FOUR.start, angle=-9.0)
    scene = fuelled(FUELS["governor"], cycles=0.8, start=begin, gas=THIN_GAS)
    run = replace(scene.run, every=Extent(value=0.5, unit="rad"))
    data = simulate(replace(scene, run=run)).data
    assert_as_the_oracle_has_it(data, *exact(scene, data["crank_angle"].values[1:]))


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["minimal", "multibody"])
@pytest.mark.parametrize("name", ["governor", "all at once"])
def test_the_formulations_agree(name, formulation):
    scene = fuelled(FUELS[name], cycles=1.5)
    both = ("crank_angle", formulation)
    ours, theirs = (simulate(scene, formulation=one, cost_cap=600.0).data for one in both)
    for key in ("fuel", "crank_speed", "gas_force", "main_bearing_force_x", "crank_torque"):
        apart = np.abs(ours[key].values - theirs[key].values).max()
        stated = ours[key].attrs["error_estimate"] + theirs[key].attrs["error_estimate"]
        assert apart <= 2.0 * stated
        assert stated < 1e-4 * np.abs(ours[key].values).max()


def test_a_share_of_one_is_the_fired_pressure():
    with_fuel, without = (
        simulate(fuelled(fuel, cycles=2.0)).data for fuel in (Fuel(misfire=None), None)
    )
    for key in without.drop_vars(["energy_residual", "frame_force_y"]):  # those are rounding
        np.testing.assert_allclose(
            with_fuel[key], without[key], rtol=1e-9, atol=1e-9 * np.abs(without[key]).max()
        )


@pytest.mark.slow
def test_settled_and_unclipped_the_mean_speed_is_the_governors():
    scene = fuelled(FUELS["governor"], cycles=150.0)
    result = simulate(replace(scene, run=replace(scene.run, every=None)))
    mean = measure(result).mean_speed
    assert abs(mean.value / GOVERNOR.speed - 1.0) < 1e-9


def test_a_prescribed_speed_fires_by_the_same_rule():
    fuel = FUELS["misfire"]
    motion = Motion(speed=FOUR.start.speed, angle=FOUR.start.angle)
    driven = simulate(fuelled(fuel, start=None, torque=(), motion=motion)).data
    free = simulate(fuelled(fuel)).data
    np.testing.assert_array_equal(driven["fuel"].values, free["fuel"].values)
    residual = np.abs(driven["energy_residual"].values).max()
    assert residual < 1e-9 * driven["kinetic_energy"].values.max()


@pytest.mark.slow
def test_backwards_it_fires_too():
    scene = fuelled(FUELS["scatter"], cycles=3.0)
    scene = replace(scene, start=replace(FOUR.start, speed=-300.0), torque=())
    ours, theirs = (simulate(scene, formulation=one).data for one in ("crank_angle", "minimal"))
    np.testing.assert_allclose(ours["fuel"], theirs["fuel"], rtol=1e-12)
    first = ours["fuel"].values[0]
    left = [part(scene.fuel)(k, 1) for k in range(1, 5)]
    np.testing.assert_allclose(first, left, rtol=1e-12)


def test_fuel_only_within_its_window():
    scene = fuelled(Fuel(after=0.03, until=0.08), cycles=4.0)
    data = simulate(scene).data
    fuel, time = data["fuel"].values[:, 0], data["time"].values
    assert set(np.unique(fuel)) == {0.0, 1.0}
    begun = time[np.flatnonzero(fuel)[0]]
    assert 0.03 <= begun <= 0.03 + 0.04
    assert fuel[-1] == 0.0


def test_fuel_sets_in_at_a_speed_and_ends_at_another():
    fuel = Fuel(from_speed=50.0, until_speed=90.0)
    start = replace(FOUR.start, speed=0.0)
    scene = fuelled(fuel, cycles=6.0, start=start, torque=(Constant(torque=120.0),))
    data = simulate(scene).data
    shares, speed = data["fuel"].values.max(axis=1), data["crank_speed"].values
    on = np.flatnonzero(shares)
    assert len(on) > 0
    assert speed[on[0]] >= 50.0 - 1e-9
    assert shares[-1] == 0.0


def test_the_governor_holds_its_integral_where_it_clips():
    governor = Governor(speed=100.0, kp=0.1, ki=1.0, min=0.0, max=1.0, initial=0.5)
    assert governed(governor, 0.5, 50.0, 0.1) == (1.0, 0.5)
    assert governed(governor, 0.5, -50.0, 0.1) == (0.0, 0.5)
    assert governed(governor, 5.0, -1.0, 0.1) == (1.0, 4.9)


@pytest.mark.parametrize("scene", ["grega_lecture", "v_twin"])
def test_the_diagram_without_combustion_is_its_compression_both_ways(scene):
    scene = load_scene(scene)
    period, ratio = scene.period, scene.gas.indicator.compression_ratio
    fired, motored = pressures_of(scene)[0], motored_of(scene)[0]
    ambient = scene.gas.ambient
    before = np.linspace(pi + 0.2, 2.0 * pi - 0.2, 50)
    np.testing.assert_allclose(motored(before), fired(before), rtol=1e-8, atol=1e-3)
    most = motored(np.linspace(0.0, period, 20_001)).max() + ambient
    indicator = scene.gas.indicator
    assert most == pytest.approx(
        indicator.intake_pressure * ratio**indicator.n_compression, rel=1e-6
    )
    one = crank_train(replace(scene, fuel=Fuel()))
    angle = np.linspace(0.1, period, 500)
    both = one.pressure[0](angle) + one.combustion[0](angle)
    np.testing.assert_allclose(both, fired(angle), rtol=1e-9, atol=1e-3)


@pytest.mark.parametrize("e", [0.0012972, 0.012, -0.012])
def test_a_polytrope_continues_the_file(e):
    """From 20 degrees before the true top dead centre to the true bottom dead centre."""
    polytrope = Polytrope(polytrope=1.32, closes=-20 * pi / 180, compression_ratio=18.0)
    scene = FOUR.with_(piston__offset=e)
    scene = replace(scene, gas=replace(FOUR.gas, motored=polytrope))
    fired, motored = pressures_of(scene)[0], motored_of(scene)[0]
    ambient, r, l = FOUR.gas.ambient, 0.046, FOUR.rod.length
    begin = 2.0 * pi + np.arcsin(e / (l + r)) - 20 * pi / 180
    end = 3.0 * pi + np.arcsin(e / (l - r))
    parts = [np.linspace(0.0, begin - 0.01, 200), np.linspace(end + 0.01, 12.5, 100)]
    outside = np.concatenate(parts)
    np.testing.assert_allclose(motored(outside), fired(outside), rtol=1e-9, atol=1e-3)
    inside = np.linspace(begin, end - 1e-6, 100)
    stroke = np.sqrt((l + r) ** 2 - e**2) - np.sqrt((l - r) ** 2 - e**2)
    x = r * np.cos(inside) + np.sqrt(l**2 - (r * np.sin(inside) - e) ** 2)
    size = 1.0 + 17.0 * (np.sqrt((l + r) ** 2 - e**2) - x) / stroke
    expected = (fired(inside[0]) + ambient) * (size[0] / size) ** 1.32
    np.testing.assert_allclose(motored(inside) + ambient, expected, rtol=1e-8)
    apart = motored.knots[:, None] - fired.knots[:-1]
    off = np.abs(apart - fired.period * np.round(apart / fired.period)).min(axis=0)
    assert off.max() < 1e-12  # the rows are knots of both, halved where the polytrope needs it
    assert len(motored.knots) < 1.3 * len(fired.knots)


def test_a_polytrope_needs_a_pressure_to_begin_with():
    rows = Table([0.0, 5.2, 5.6, 6.2, 9.0], [1e5, 1.2e5, 3e5, 60e5, 2e5])  # the spline dips
    polytrope = Polytrope(polytrope=1.3, closes=-0.9, compression_ratio=10.0)
    scene = replace(FOUR, gas=replace(FOUR.gas, pressure=rows, motored=polytrope))
    with pytest.raises(InputError, match=r"above 0 absolute; at 308.* bar came between the rows"):
        motored_of(scene)


@pytest.mark.slow
def test_written_read_and_saved_it_is_the_same(tmp_path):
    scene = fuelled(replace(FUELS["all at once"], after=0.01, from_speed=300.0), cycles=1.0)
    for file, text in scene_files(scene, "mine").items():
        (tmp_path / file).write_text(text)
    back = load_scene(tmp_path / "mine.toml")
    assert back.fuel == scene.fuel
    result = simulate(back)
    result.save(tmp_path / "saved")
    again = Result.load(tmp_path / "saved")
    assert again.scene == back
    np.testing.assert_array_equal(again.data["fuel"].values, result.data["fuel"].values)


FUEL = '[gas]\npressure = "gas.csv"\nmotored = "gas.csv"'


@pytest.mark.parametrize(
    ("fuel", "message"),
    [
        (
            'misfire = [{ cylinder = 2, cycles = "3" }]',
            "fuel.misfire[1].cylinder: must be from 1 to 1; 2 came",
        ),
        (
            'misfire = [{ cylinder = 1, cycles = "8-5" }]',
            'fuel.misfire[1].cycles: must be a cycle such as "5", cycles such as "5-8", or "every '
            '4"; "8-5" came',
        ),
        (
            'governor = { speed = "1500 rpm", kp = "1 mm", ki = "0.02 1/rad" }',
            'fuel.governor.kp: "1 mm" is no proportional gain here: use s/rad, s/deg or 1/rpm',
        ),
        (
            'governor = { speed = "1500 rpm", kp = 1, ki = 1, min = 0.5, max = 0.2 }',
            "fuel.governor: min must be at most max; 0.5 and 0.2 came",
        ),
        ('after = "2 s"\nuntil = "1 s"', "fuel: until must come later than after, 2 s; 1 s came"),
        ("scater = 1", 'fuel.scater: unknown key; did you mean "scatter"?'),
    ],
)
def test_bad_fuel_gets_one_sentence(read, fuel, message):
    text = edited(FREE, '[gas]\npressure = "gas.csv"', FUEL)
    assert refusal(read, edited(text, "[start]", f"[fuel]\n{fuel}\n\n[start]")) == message


def test_fuel_needs_the_pressure_without_combustion(read):
    text = edited(FREE, "[start]", "[fuel]\nscatter = 0.1\n\n[start]")
    assert refusal(read, text) == (
        "gas.motored: with [fuel] the pressure without combustion is needed, of which a firing "
        'takes its share; give motored = "motored.csv", or an indicator'
    )


def test_a_diagram_has_its_own(read):
    text = edited(INDICATED, "[start]", "[fuel]\nscatter = 0.1\n\n[start]")
    assert read(text).fuel.scatter == 0.1


@pytest.mark.parametrize("speed", [300.0, -300.0])
@pytest.mark.parametrize("loads", [(Quadratic(coefficient=7e-4),), (Viscous(coefficient=0.2),)])
@pytest.mark.parametrize("name", [*FUELS, "segment"])
def test_cells_solved_at_once_are_those_from_decision_to_decision(name, loads, speed, monkeypatch):
    segment = replace(FUELS["all at once"], from_speed=0.98 * speed, until=0.2)
    fuel = segment if name == "segment" else FUELS[name]
    start = replace(FOUR.start, angle=0.1, speed=speed)
    grid = grid_of(crank_train(fuelled(fuel, start=start, torque=loads)), gauss(5))
    sense = math.copysign(1.0, speed)
    begin = State(0.0, 0.1, speed, 0.0, begun(grid.train))
    terms = grid.terms(0.1, sense, 5000, sense * math.inf)
    branch = branch_of(loads, 0.0, speed, rising=speed > 0.0)
    at = Begin(sense, 8000.0, 0.0, math.inf, 0.1)
    once = solve_fired(grid, terms, branch, at, begin)
    monkeypatch.setattr(crank_angle_firings, "_foreseen", lambda *_: False)
    each = solve_fired(grid, terms, branch, at, begin)
    assert [cell for cell, _ in once.modes] == [cell for cell, _ in each.modes]
    assert len(once.modes) > 10
    for (_, mine), (_, other) in zip(once.modes[:-3], each.modes[:-3], strict=True):
        assert mine.firing.shares == pytest.approx(other.firing.shares, rel=1e-13)
        assert mine.firing.time == pytest.approx(other.firing.time, rel=1e-13)
    m = int(np.argmax(np.append(once.cells.edges, 0.0) < 1000.0)) - 1  # near rest rounding grows
    assert m > 1000
    for row, beside in zip(once.cells.first(m), each.cells.first(m), strict=True):
        np.testing.assert_allclose(row, beside, rtol=1e-12, atol=1e-10)
    torques = once.terms.torque[:m], each.terms.torque[:m]
    np.testing.assert_allclose(*torques, rtol=1e-12, atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_a_sample_at_a_decision_is_before_it(formulation):
    """Backwards from 180 degrees its crank angle and the edge of a cell round differently."""
    scene = fuelled(Fuel(scatter=0.2, seed=3), cycles=6.0)
    start = replace(FOUR.start, angle=pi, speed=-200.0)
    result = simulate(replace(scene, start=start), formulation=formulation)
    events = result.events
    decided = events["kind"].values == "fuel"
    angles, cylinders = events["crank_angle"].values[decided], events["cylinder"].values[decided]
    fuel, at = result.data["fuel"].values, result.data["crank_angle"].values
    before, after = [], []
    for angle, cylinder in zip(angles[4:-4], cylinders[4:-4] - 1, strict=True):
        k = int(np.argmin(np.abs(at - angle)))
        assert at[k] == pytest.approx(angle, abs=1e-9)
        assert fuel[k, cylinder] == fuel[k - 1, cylinder]
        before.append(fuel[k, cylinder])
        after.append(fuel[k + 1, cylinder])
    assert np.count_nonzero(np.array(before) != after) > 12
