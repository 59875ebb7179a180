"""Pressures carried over to another geometry in the engine, as in Python, and what it shows while a
knob moves."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_engine import differences
from page_scenes import MISFIRE, POLYTROPE, SETTLING, altered, fuelled, settled

from crankmbs import load_scene, simulate
from crankmbs.mechanics.carried import carried_over
from crankmbs.mechanics.train import crank_train
from crankmbs.page import exported
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.tables import Table


@pytest.mark.parametrize(
    "change", [{"length": 0.75}, {"offset": 0.011}, {"offset": -0.007, "radius": 0.9}], ids=str
)
@pytest.mark.parametrize("interpolation", ["step", "linear", "pchip", "cubic"])
def test_pressures_are_carried_over_as_in_python(engine, interpolation, change):
    for name in ("propeller", "yi_diesel"):
        scene = load_scene(name)
        scene = replace(scene, gas=replace(scene.gas, interpolation=interpolation))
        assert_carried(engine, scene, altered(scene, **change))


@pytest.mark.parametrize("change", [{"length": 0.75}, {"offset": 0.011}], ids=str)
def test_diagrams_and_combustion_are_carried_over_too(engine, change):
    diagram = load_scene("v_twin")
    late = replace(diagram.gas.indicator, pre_expansion=1.3)
    fired = replace(
        diagram, gas=replace(diagram.gas, indicator=late), fuel=Fuel(misfire=(MISFIRE,))
    )
    for scene in (diagram, fired, fuelled("yi_diesel_free", motored=POLYTROPE)):
        assert_carried(engine, scene, altered(scene, **change))


@pytest.mark.parametrize("change", [{"length": 0.75}, {"offset": 0.011}], ids=str)
def test_both_ends_are_carried_over_too(engine, change):
    steam, turn = load_scene("steam_engine"), 2.0 * math.pi
    rows = tuple(turn * k / 5.0 for k in range(15))
    thrice = Table(
        rows, (0.0, 1e5, 4e5, 2e5, 5e4, 0.0, 2e5, 3e5, 1e5, 0.0, 0.0, 3e5, 3e5, 2e5, 1e4)
    )
    gas = replace(steam.gas, crank_end=thrice, cycles="sequence")
    twice = Table(tuple(turn * k / 4.0 for k in range(8)), (5e5, 1e5, 0.0, 2e5) * 2)
    fired = replace(gas, pressure=twice, motored=steam.gas.pressure)
    for scene in (
        steam,
        replace(steam, gas=replace(gas, pressure=twice)),
        replace(steam, gas=fired, fuel=Fuel(misfire=(MISFIRE,))),
        replace(steam, gas=replace(steam.gas, crank_end=2e5)),
    ):
        assert_carried(engine, scene, altered(scene, **change))


def assert_carried(engine, before, scene):
    train = crank_train(carried_over(scene, before))
    shape = {
        "radius": scene.crank.radius,
        "length": scene.rod.length,
        "offset": scene.piston.offset,
    }
    found = engine.ask("carried", scene=exported(before), shape=shape)
    size = np.abs(train.pressure[0].coefficients[3]).max()
    expected = {
        "pressure": train.pressure,
        "firing": tuple(
            replace(one, coefficients=one.coefficients + more.coefficients)
            for one, more in zip(train.pressure, train.combustion or (), strict=False)
        ),
        "crank_end": train.crank_end or (),
    }
    for name, cycles in expected.items():
        assert len(found[name]) == len(cycles)
        for (knots, coefficients), one in zip(found[name], cycles, strict=True):
            if train.combustion is None:
                np.testing.assert_allclose(knots, one.knots, rtol=0.0, atol=1e-11)
            moved = type(one)(np.array(knots), np.reshape(coefficients, (4, -1)))
            for part in (0.2, 0.5, 0.8):
                phi = one.knots[:-1] + part * np.diff(one.knots)
                np.testing.assert_allclose(moved(phi), one(phi), rtol=0.0, atol=1e-11 * size)


@pytest.mark.parametrize("change", [{}, {"length": 1.08, "offset": 0.004}], ids=["", "geometry"])
@pytest.mark.parametrize("name", SETTLING)
def test_what_is_shown_while_a_knob_moves_is_right_to_less_than_a_pixel(engine, name, change):
    before = settled(name)
    scene = altered(before, **change)
    result = simulate(carried_over(scene, before), rtol=1e-10)
    moved = {**exported(scene), "gas": exported(before)["gas"]}
    found = engine.ask("dragged", scene=moved, angles=result.data["crank_angle"].values)
    worst = differences(result, found)
    assert max(worst.values()) < 1e-3, max(worst.items(), key=lambda one: one[1])
