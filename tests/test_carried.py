"""A pressure carried over to another geometry: the same function of the swept fraction."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from crankmbs import load_scene
from crankmbs.mechanics.carried import carried_angle, carried_over
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.train import crank_train
from crankmbs.scene.gas import Gas
from crankmbs.scene.loads import Quadratic
from crankmbs.scene.parts import Cylinder, Layout
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import DEGREE

SHAPES = [
    ((0.046, 0.153, 0.0), (0.046, 0.12, 0.0)),
    ((0.046, 0.153, 0.0), (0.046, 0.153, 0.022)),
    ((0.05, 0.11, -0.03), (0.02, 0.3, 0.01)),
    ((1.0, 1.31, 0.3), (1.0, 1.5, -0.45)),
]


def fraction(phi, shape):
    """Swept fraction of the stroke, to 50 digits, by the textbook formula."""
    r, l, e = (mpmath.mpf(q) for q in shape)
    phi = mpmath.mpf(phi)
    x = r * mpmath.cos(phi) + mpmath.sqrt(l**2 - (r * mpmath.sin(phi) - e) ** 2)
    top, bottom = (mpmath.sqrt((l + s * r) ** 2 - e**2) for s in (1, -1))
    return (top - x) / (top - bottom)


@pytest.mark.parametrize(("before", "after"), SHAPES)
def test_the_swept_fraction_and_the_stroke_stay(before, after):
    top, bottom = dead_centres(*before)
    new_top, new_bottom = dead_centres(*after)
    phi = np.linspace(-7.0, 14.0, 85) + 1e-3  # at a dead centre rounding tells the stroke
    moved = carried_angle(phi, before, after)
    assert (np.diff(moved) > 0.0).all()
    with mpmath.workdps(50):
        for old, new in zip(phi.tolist(), moved.tolist(), strict=True):
            assert abs(fraction(old, before) - fraction(new, after)) < 4e-15
            down, still = (
                (a - t) % math.tau <= b - t
                for a, t, b in ((old, top, bottom), (new, new_top, new_bottom))
            )
            assert down == still


@pytest.mark.parametrize(("before", "after"), SHAPES)
def test_dead_centres_become_dead_centres_and_small_ways_from_them_keep_their_digits(before, after):
    with mpmath.workdps(50):
        for old, new in zip(dead_centres(*before), dead_centres(*after), strict=True):
            assert carried_angle(old, before, after) == pytest.approx(new, abs=1e-15)
            for way in (1e-3, 1e-6, -1e-5):
                moved = float(carried_angle(old + way, before, after))
                # next to a dead centre x falls as the square of the way from it
                near = mpmath.sqrt(
                    fraction(old + way, before) if old < 2 else 1 - fraction(old + way, before)
                )
                there = mpmath.sqrt(
                    fraction(moved, after) if old < 2 else 1 - fraction(moved, after)
                )
                assert abs(near - there) < 1e-15


@pytest.mark.parametrize(("before", "after"), SHAPES)
def test_back_again_it_is_where_it_was(before, after):
    phi = np.linspace(-7.0, 14.0, 200)
    back = carried_angle(carried_angle(phi, before, after), after, before)
    np.testing.assert_allclose(back, phi, rtol=0.0, atol=3e-15 * 14)
    np.testing.assert_allclose(carried_angle(phi, before, before), phi, rtol=0.0, atol=2e-14)


def altered(scene, *, length=None, offset=None):
    rod = replace(scene.rod, length=length or scene.rod.length)
    shift = scene.piston.offset if offset is None else offset
    return replace(scene, rod=rod, piston=replace(scene.piston, offset=shift))


def work_ratio(scene):
    """Work of the gas in a cycle over that which its highest pressure would do in a stroke."""
    theta = np.linspace(0.0, scene.period, 20_001)
    gas = replace(crank_train(replace(scene, gravity=None)))
    torque = reduce(gas, theta).torque
    work = np.trapezoid(torque, theta)
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    top, bottom = close_loop(dead_centres(r, l, e), r, l, e).x
    return work / (scene.piston.gas_area * (top - bottom) * gas.pressure[0].peak[1])


@pytest.mark.parametrize("change", [{"offset": 0.022}, {"length": 0.1}, {"offset": -0.03}])
def test_the_mean_effective_pressure_stays(change):
    before = load_scene("yi_diesel")
    scene = altered(before, **change)
    expected = work_ratio(before)
    assert work_ratio(carried_over(scene, before)) == pytest.approx(expected, rel=2e-4)
    assert abs(work_ratio(scene) / expected - 1.0) > 0.02  # left in place it does not


def test_an_offset_no_longer_turns_the_propeller_backwards():
    before = load_scene("propeller")
    scene = altered(before, offset=0.022)
    assert work_ratio(scene) < 0.0 < work_ratio(carried_over(scene, before))


def test_a_table_and_its_interpolation_are_the_same_pressure_elsewhere():
    before = load_scene("yi_diesel")
    scene = carried_over(altered(before, offset=0.02), before)
    table, moved = before.gas.pressure, scene.gas.pressure
    assert moved.y == table.y
    shapes = ((0.046, before.rod.length, e) for e in (before.piston.offset, 0.02))
    expected = carried_angle(table.x, *shapes)
    np.testing.assert_allclose(moved.x, expected, atol=1e-15)
    (pressure,) = pressures_of(scene)
    (given,) = pressures_of(before)
    np.testing.assert_allclose(pressure(expected[:-1]), given(table.x[:-1]), rtol=1e-9, atol=1e-3)


def test_columns_of_one_instant_move_each_over_its_own_cycle():
    angle = np.arange(0.0, 720.0, 10.0) * DEGREE
    own = 1e5 * (2.0 + np.cos(angle))
    late = 1e5 * (2.0 + np.cos(angle + 3.0))
    table = CylinderTable(tuple(angle.tolist()), (tuple(own.tolist()), tuple(late.tolist())))
    base = load_scene("propeller")
    layout = Layout(cylinders=(Cylinder(), Cylinder(phase=3.0)))
    gas = Gas(pressure=table, absolute=False, interpolation="cubic")
    before = replace(base, gas=gas, layout=layout, torque=(Quadratic(coefficient=1e-4),))
    scene = carried_over(altered(before, offset=0.02), before)
    first, second = pressures_of(scene)
    phi = np.linspace(0.0, 12.0, 50)
    np.testing.assert_allclose(first(phi), second(phi), rtol=2e-3)


def test_the_zero_of_a_table_stays_where_it_was():
    before = load_scene("yi_diesel")
    rows = before.gas.pressure
    turned = Table(tuple(x - math.tau for x in rows.x), rows.y, rows.source)
    shifted = replace(before, gas=replace(before.gas, pressure=turned, zero="firing_tdc"))
    one, other = (
        pressures_of(carried_over(altered(scene, offset=0.02), scene))[0]
        for scene in (before, shifted)
    )
    phi = np.linspace(0.0, 12.0, 100)
    np.testing.assert_allclose(one(phi), other(phi), rtol=1e-9, atol=1e-3)


def test_a_diagram_is_one_of_the_volume_already():
    before = load_scene("v_twin")
    scene = altered(before, offset=0.01)
    assert carried_over(scene, before) is scene
    without = load_scene("coasting")
    assert carried_over(altered(without, offset=0.01), without).gas is None
