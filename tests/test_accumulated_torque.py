"""Torque accumulated along the crank."""

import numpy as np
import pytest

from crankmbs import load_scene, simulate
from crankmbs.errors import InputError
from crankmbs.lecture.accumulated_torque import accumulated_torque


def test_the_last_journal_carries_what_the_drive_takes():
    """Constant speed, no gravity, a crank balanced on its axis: nothing is lost on the way."""
    data = simulate(load_scene("grega_lecture")).data
    journals, pins = accumulated_torque(data["crank_torque"].values)
    assert journals.shape == (721, 5)
    assert pins.shape == (721, 4)
    np.testing.assert_allclose(journals[:, -1], -data["external_torque"].values, atol=1e-10)
    np.testing.assert_array_equal(journals[:, 0], 0.0)


def test_a_pin_stands_between_its_journals():
    torque = np.random.default_rng(7).normal(size=(5, 3))
    journals, pins = accumulated_torque(torque)
    np.testing.assert_allclose(pins, 0.5 * (journals[:, 1:] + journals[:, :-1]), atol=1e-15)


@pytest.mark.parametrize("nothing", [1.0, np.zeros((4, 0))])
def test_no_cylinder(nothing):
    with pytest.raises(InputError, match="one or more cylinders; none came"):
        accumulated_torque(nothing)
