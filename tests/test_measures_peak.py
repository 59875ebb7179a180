"""The largest value of a quantity that can be evaluated anywhere."""

import numpy as np
import pytest

from crankmbs.measures.peak import highest

TIME = np.linspace(0.0, 1.0, 11)


def found(quantity):
    """When it is largest, and how large it is there."""
    (when,), (top,) = highest(TIME, quantity(TIME)[None], lambda t: quantity(t)[None])
    return when, top


@pytest.mark.parametrize("beside", [1e-3, 1e-5, 1e-8, -1e-7])
def test_a_bend_beside_a_sample_is_found(beside):
    bend = 0.3 + 0.1 * beside
    when, top = found(lambda t: np.where(t < bend, 2.0 * (t - bend), 3.0 * (bend - t)))
    assert abs(when - bend) < 1e-14
    assert abs(top) < 1e-14


@pytest.mark.parametrize("inside", [0.3, 0.01, 1e-4])
def test_a_maximum_just_after_the_beginning_is_found(inside):
    top_at = 0.1 * inside
    when, top = found(lambda t: 1e-3 - (t - top_at) ** 2)
    assert abs(when - top_at) < 1e-8
    assert top == pytest.approx(1e-3, rel=1e-15, abs=0.0)


def test_of_two_maxima_in_one_interval_that_of_another_quantity_does_not_count():
    """Quantities with the same largest sample go their own ways from there."""
    tops = np.array([0.32, 0.27])
    when, top = highest(TIME, -np.abs(TIME - tops[:, None]), lambda t: -np.abs(t - tops[:, None]))
    np.testing.assert_allclose(when, tops, rtol=1e-14)
    np.testing.assert_allclose(top, 0.0, atol=1e-14)


def test_a_bend_that_is_lower_where_it_was_first_looked_at_is_not_given_up():
    """Until it is looked at more closely a lower bend, on a sample, is ahead."""
    bend = 0.7 + 0.1 * 8.5 / 16.0
    when, top = found(
        lambda t: np.maximum(1.0 - 10.0 * np.abs(t - TIME[3]), 1.01 - 10.0 * np.abs(t - bend))
    )
    assert abs(when - bend) < 1e-13
    assert top == pytest.approx(1.01, rel=1e-13)
