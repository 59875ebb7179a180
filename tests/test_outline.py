"""The drawing of the mechanism: lengths, places and frames are those of the run."""

import dataclasses
import math

import numpy as np
import pytest

from crankmbs import load_scene, shipped_scenes, simulate
from crankmbs.figures.outline import in_engine_frame, mechanism

ANGLES = np.linspace(0.0, 4.0 * math.pi, 61)


@pytest.mark.parametrize("name", shipped_scenes())
def test_crank_and_rod_keep_their_lengths(name):
    scene = load_scene(name)
    drawn = mechanism(scene, ANGLES)
    crank = np.linalg.norm(drawn.crank_pin, axis=-1)
    rod = np.linalg.norm(drawn.piston_pin - drawn.crank_pin, axis=-1)
    assert crank == pytest.approx(scene.crank.radius, rel=1e-12)
    assert rod == pytest.approx(scene.rod.length, rel=1e-12)


def test_piston_pins_are_where_the_run_has_them():
    result = simulate(load_scene("v_twin"))
    drawn = mechanism(result.scene, result.data["crank_angle"].values)
    position = result.data["piston_position"].values
    offset = np.full_like(position, result.scene.piston.offset)
    assert drawn.piston_pin == pytest.approx(in_engine_frame(result.scene, position, offset))


def test_rods_on_one_pin_are_drawn_on_one_pin():
    drawn = mechanism(load_scene("v_twin"), ANGLES)
    assert drawn.crank_pin[:, 0] == pytest.approx(drawn.crank_pin[:, 1], abs=1e-15)
    left, right = drawn.piston_pin[0]
    assert left[1] < 0.0 < right[1]  # banks of -30 and +30 degrees


def test_the_piston_stays_in_its_liner_and_below_the_head():
    scene = load_scene("v_twin")
    one = dataclasses.replace(scene.layout, cylinders=scene.layout.cylinders[:1])
    upright = dataclasses.replace(one.cylinders[0], bank=0.0)
    scene = dataclasses.replace(scene, layout=dataclasses.replace(one, cylinders=(upright,)))
    drawn = mechanism(scene, np.linspace(0.0, 2.0 * math.pi, 7201))
    assert drawn.piston[..., 1].max() - drawn.piston[..., 1].min() == pytest.approx(0.094)
    assert drawn.piston[..., 0].min() == pytest.approx(drawn.liner[..., 0].min())
    height = np.ptp(drawn.gas[..., 0], axis=-1)
    assert height.max() / height.min() == pytest.approx(10.0)  # the compression ratio
    assert drawn.piston[..., 1].min() == pytest.approx(-0.047)  # about the axis


def test_an_offset_lies_in_y():
    scene = load_scene("yi_diesel")
    drawn = mechanism(scene, [0.0, math.pi / 2.0])
    assert drawn.piston_pin[:, 0, 1] == pytest.approx(1.2972e-3)
    assert drawn.crank_pin[1, 0] == pytest.approx([0.0, 0.046], abs=1e-15)
    assert drawn.liner[0, :, 1].mean() == pytest.approx(1.2972e-3)
