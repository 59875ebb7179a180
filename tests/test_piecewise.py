"""Functions made of parabolas."""

import math

import numpy as np
import pytest

from crankmbs.numerics.piecewise import Piecewise, total

TABLE = Piecewise.through((0.0, 1.0, 1.0, 3.0), (2.0, 4.0, -1.0, 0.0))
PARABOLA = Piecewise((0.0,), ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)))


def test_rows_are_joined_and_ends_held():
    x = [-5.0, 0.0, 0.5, 1.0, 2.0, 3.0, 9.0]
    np.testing.assert_allclose(TABLE(x), [2.0, 2.0, 3.0, -1.0, -0.5, 0.0, 0.0], atol=1e-15)
    assert TABLE.jumps == TABLE.breaks == (1.0,)
    assert TABLE.bends == (0.0, 1.0, 3.0)
    assert PARABOLA.bends == ()
    assert PARABOLA.breaks == (0.0,)


def test_a_jump_at_an_end_is_held_on_its_own_side():
    jump = Piecewise.through((0.0, 0.0, 1.0, 1.0), (5.0, 6.0, 7.0, 8.0))
    np.testing.assert_allclose(jump([-1.0, 0.0, 1.0, 2.0]), [5.0, 6.0, 8.0, 8.0])


@pytest.mark.parametrize(
    ("x", "after", "low", "high"),
    [
        (1.0, True, 1.0, 3.0),
        (1.0, False, 0.0, 1.0),
        (-2.0, True, -math.inf, 0.0),
        (3.0, True, 3.0, math.inf),
    ],
)
def test_a_piece_and_its_bounds(x, after, low, high):
    assert TABLE.piece(x, after=after)[1:] == (low, high)


@pytest.mark.parametrize("ends", [(-9.0, 9.0), (0.1, 0.9), (-math.inf, math.inf), (5.0, math.inf)])
def test_a_sum_is_that_of_its_parts(ends):
    knots, pieces = total([TABLE, PARABOLA], *ends)
    x = np.linspace(max(ends[0], -4.0) + 0.01, min(ends[1], 8.0) - 0.01, 40)
    a, b, c = pieces[np.searchsorted(knots, x, side="right")].T
    np.testing.assert_allclose(a + b * x + c * x**2, TABLE(x) + PARABOLA(x), atol=1e-13)


def test_its_largest_value_is_looked_for_at_the_knots():
    assert TABLE.largest == 4.0
    assert Piecewise((), ((-3.0, 1.0, 0.0),)).largest == 3.0
    assert not TABLE.is_constant
