"""Loop closure against 50-digit evaluations of its two equations."""

import math

import mpmath
import numpy as np
import pytest

from crankmbs.mechanics.geometry import close_loop, dead_centres, top_position

ANGLES = np.concatenate([np.linspace(-8.0, 8.0, 23), [0.5 * math.pi, -0.5 * math.pi]])
MECHANISMS = [
    (0.046, 0.1533, 0.0),
    (0.046, 0.1533, 0.0013),
    (0.1, 0.13, -0.02),
    (0.1, 0.1 * (1 + 1e-3), 0.0),
    (0.1, 0.12 * (1 + 1e-6), 0.02),
    (0.1, 0.12 * (1 + 1e-9), -0.02),
]


def closed(phi, r, l, e):
    """beta and x at 50 digits."""
    sine = (mpmath.mpf(r) * mpmath.sin(phi) - e) / l
    return mpmath.asin(sine), r * mpmath.cos(phi) + l * mpmath.sqrt(1 - sine**2)


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize(("index", "name"), [(0, "beta"), (1, "x")])
@pytest.mark.parametrize(("order", "suffix"), [(0, ""), (1, "_1"), (2, "_2")])
def test_positions_and_derivatives(mechanism, index, name, order, suffix):
    ours = getattr(close_loop(ANGLES, *mechanism), name + suffix)
    with mpmath.workdps(50):
        derivatives = [
            mpmath.diff(lambda angle: closed(angle, *mechanism)[index], mpmath.mpf(phi), order)
            for phi in ANGLES
        ]
        exact = np.array([float(value) for value in derivatives])
    scale = np.maximum(np.abs(exact), 0.1 * np.abs(exact).max())
    assert np.max(np.abs(ours - exact) / scale) < 1e-12


def test_sines_and_cosines_belong_to_the_angles():
    loop = close_loop(ANGLES, 0.1, 0.13, -0.02)
    np.testing.assert_allclose(np.sin(loop.beta), loop.sin_beta, atol=1e-15)
    np.testing.assert_allclose(np.cos(loop.beta), loop.cos_beta, atol=1e-15)
    np.testing.assert_allclose(loop.sin_phi, np.sin(ANGLES))
    np.testing.assert_allclose(loop.cos_phi, np.cos(ANGLES))


@pytest.mark.parametrize("offset", [0.0, 0.02, -0.02])
def test_dead_centres_are_where_the_piston_turns(offset):
    top, bottom = dead_centres(0.1, 0.25, offset)
    loop = close_loop([top, bottom], 0.1, 0.25, offset)
    np.testing.assert_allclose(loop.x_1, 0.0, atol=1e-16)
    assert loop.x_2[0] < 0.0 < loop.x_2[1]
    assert loop.x[0] == pytest.approx(top_position(0.1, 0.25, offset), rel=1e-15)
    assert loop.x[1] == pytest.approx(math.sqrt(0.15**2 - offset**2), rel=1e-14)


def test_a_rod_as_long_as_the_crank_has_its_fold_for_a_bottom():
    assert dead_centres(0.1, 0.1, 0.0) == (0.0, math.pi)


@pytest.mark.parametrize("offset", [0.0, 0.02, -0.02])
@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 0.0])
def test_every_digit_holds_beside_a_fold(offset, distance):
    """At 0 the angle is the float next to the fold, which is no float."""
    phi = (1.5 if offset > 0.0 else 0.5) * math.pi - distance
    r, e = 0.125, math.copysign(2.0**-6, offset) if offset else 0.0
    loop = close_loop(phi, r, r + abs(e), e)
    with mpmath.workdps(80):
        exact = [
            mpmath.diff(lambda angle: closed(angle, r, r + abs(e), e)[0], mpmath.mpf(phi), order)
            for order in (1, 2)
        ]
    assert float(loop.beta_1) == pytest.approx(float(exact[0]), rel=1e-14)
    assert float(loop.beta_2) == pytest.approx(float(exact[1]), rel=1e-14, abs=1e-12)
