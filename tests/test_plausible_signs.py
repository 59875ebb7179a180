"""A sense of rotation that passes the cycle of the gas backwards is said, and no other."""

import re

import pytest

from crankmbs import Quadratic, SpeedFile, Table, load_scene, simulate
from crankmbs.measures.plausible import warnings


def backwards(scene):
    return [said for said in warnings(scene) if "passes the cycle of the gas backwards" in said]


@pytest.mark.parametrize("name", ["propeller", "two_stage_compressor", "grega_lecture"])
def test_a_cycle_passed_backwards_is_said_with_its_work(name):
    """The work is that of the mean effective pressures of a run, in either sense."""
    scene = load_scene(name)
    key = "start" if scene.start is not None else "motion"
    speed = (scene.start or scene.motion).speed
    turned = scene.with_(**{f"{key}__speed": -speed})
    assert backwards(scene) == []
    (said,) = backwards(turned)
    assert said.startswith(f"{key}.speed: at a negative speed")
    swept = [gear.stroke * gear.piston.gas_area for gear in scene.running_gear]
    cycles = simulate(scene).cycles.imep.values[-1] @ swept
    below, above = (float(x) for x in re.findall(r"(-?[\d.]+) J", said))
    assert below == -above
    assert above == pytest.approx(cycles, rel=2e-3)


@pytest.mark.parametrize("name", ["coasting", "yi_diesel"])
def test_without_gas_or_forwards_nothing_is_said(name):
    assert backwards(load_scene(name)) == []


def test_a_brake_on_an_engine_that_turns_backwards_is_none_that_drives():
    """The gas takes work there, so that its sense says nothing of the load's."""
    scene = load_scene("yi_diesel_free").with_(
        start__speed=-335.0, torque=(Quadratic(coefficient=1e-4),)
    )
    assert list(warnings(scene)) == backwards(scene)


def test_a_cycle_that_does_no_work_has_no_sense():
    """Compressed and expanded along one polytrope, taken in and put out at one pressure."""
    indicator = load_scene("v_twin").gas.indicator
    exponent, intake = indicator.n_compression, indicator.intake_pressure
    scene = load_scene("v_twin").with_(
        start__speed=-100.0,
        gas__indicator__n_expansion=exponent,
        gas__indicator__exhaust_pressure=intake,
        gas__indicator__peak_pressure=intake * indicator.compression_ratio**exponent * (1 + 1e-9),
    )
    assert backwards(scene) == []


def test_a_speed_over_time_is_not_judged():
    """It may turn either way."""
    rows = SpeedFile(file=Table([0.0, 1.0], [-100.0, 100.0]))
    assert backwards(load_scene("grega_lecture").with_(motion__speed=rows)) == []
