"""Inverting monotone functions, also where Newton alone would fail."""

import numpy as np
import pytest

from crankmbs.numerics.roots import first_above, invert_monotone


def cube(x):
    return x**3, 3.0 * x**2


def step_like(x):
    return np.arctan(1e6 * (x - 0.3)), 1e6 / (1.0 + (1e6 * (x - 0.3)) ** 2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("function", [cube, step_like])
def test_many_targets_at_once(function, sign):
    exact = np.array([-1.0, -0.7, 0.0, 0.3, 0.3 + 1e-7, 0.9, 1.0])
    target = sign * function(exact)[0]

    def signed(x):
        value, slope = function(x)
        return sign * value, sign * slope

    found = invert_monotone(signed, target, np.full(7, -1.0), np.full(7, 1.0))
    value, slope = signed(found)
    assert np.all(np.abs(value - target) <= 4e-16 * (np.abs(slope) + np.abs(target)) + 1e-40)


def test_targets_at_the_ends_and_beyond_stay_in_the_bracket():
    low, high = np.zeros(3), np.ones(3)
    found = invert_monotone(cube, np.array([-1.0, 1.0, 2.0]), low, high)
    np.testing.assert_allclose(found, [0.0, 1.0, 1.0], atol=1e-12)


@pytest.mark.parametrize("steep", [1e-9, 1e-3, 1.0, 1e3])
def test_rounding_does_not_send_it_to_and_fro(steep):
    """The value knows its place to 1e-16 / steep only; Newton's method is there in a few steps."""
    targets, asked = 1.0 + steep * np.linspace(0.0, 1.0, 201), []

    def function(x):
        asked.append(x)
        return 1.0 + steep * np.sin(x), steep * np.cos(x)

    found = invert_monotone(function, targets[:100], np.zeros(100), np.full(100, 1.5))
    assert len(asked) < 40
    np.testing.assert_allclose(function(found)[0], targets[:100], rtol=1e-15)


def test_a_step_to_an_end_is_not_taken_for_the_answer():
    """From the middle Newton's method goes to the end exactly, and the root is not there."""
    found = invert_monotone(cube, np.array([0.5]), np.zeros(1), np.ones(1))
    assert found[0] == pytest.approx(0.5 ** (1 / 3), rel=1e-15)


def test_nothing_to_find():
    assert len(invert_monotone(cube, np.empty(0), np.empty(0), np.empty(0))) == 0


def turning(top, height, times=1.0):
    return lambda x: (times * (height - (x - top) ** 2), -2.0 * times * (x - top))


@pytest.mark.parametrize("times", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("top", [0.05, 0.3, 0.7, 0.99])
def test_a_function_that_is_above_zero_for_a_moment(top, times):
    assert first_above(turning(top, 1e-6, times), 0.0, 1.0) == pytest.approx(top - 1e-3, abs=1e-9)
    assert first_above(turning(top, -1e-6, times), 0.0, 1.0) is None


def test_a_function_that_begins_at_zero():
    assert first_above(lambda x: (x * (x - 1e-3), 2.0 * x - 1e-3), 0.0, 1.0) == pytest.approx(1e-3)
    assert first_above(lambda x: (x, np.ones(1)), 0.0, 1.0) == 0.0
