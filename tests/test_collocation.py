"""Gauss rules: exact for polynomials, and of the order they declare."""

import numpy as np
import pytest

from crankmbs.numerics.collocation import chain, gauss

STAGES = range(1, 10)


@pytest.mark.parametrize("stages", STAGES)
def test_polynomials_are_integrated_exactly(stages):
    rule = gauss(stages)
    for degree in range(2 * stages):
        assert rule.weights @ rule.nodes**degree == pytest.approx(1.0 / (degree + 1), rel=1e-13)
    for degree in range(stages):
        inside = rule.nodes ** (degree + 1) / (degree + 1)
        np.testing.assert_allclose(rule.matrix @ rule.nodes**degree, inside, atol=1e-15)


@pytest.mark.parametrize("stages", STAGES)
def test_between_the_nodes(stages):
    rule, x = gauss(stages), np.linspace(0.0, 1.0, 11)
    values = rule.nodes ** (stages - 1)
    np.testing.assert_allclose(rule.integrals(x) @ values, x**stages / stages, atol=1e-15)
    np.testing.assert_allclose(rule.integrals(np.ones(1))[0], rule.weights, atol=1e-15)


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_order(stages):
    """y' = y cos(x) over [0, 3]: halving the step divides the error by 2^(2 stages)."""
    rule = gauss(stages)

    def error(steps):
        h, y = 3.0 / steps, 1.0
        for k in range(steps):
            rate = np.cos((k + rule.nodes) * h)
            inside = np.linalg.solve(np.eye(stages) - h * rule.matrix * rate, np.full(stages, y))
            y += h * rule.weights @ (rate * inside)
        return abs(y - np.exp(np.sin(3.0)))

    errors = np.array([error(steps) for steps in (8, 16, 32)])
    slopes = np.log2(errors[:-1] / errors[1:])
    assert errors[-1] > 1e-12
    assert np.ptp(slopes) < 0.2
    assert slopes[-1] == pytest.approx(2 * stages, abs=0.2)


@pytest.mark.parametrize("stiff", [0.0, 1e-4, 0.09, 0.11, 30.0])
@pytest.mark.parametrize("cases", [(), (3,), (20,)])
def test_maps_and_chain_solve_the_collocation(stiff, cases):
    """Sweeps or elimination, one case or many: both fulfil the collocation's equations."""
    rule, rng = gauss(4), np.random.default_rng(5)
    turned = 0.1 + rng.random((*cases, 7, 4))
    push, rate = rng.standard_normal((2, *turned.shape))
    rate *= stiff / np.max(np.abs(turned * rate))
    start = 1.0 + rng.random(cases)
    maps = rule.maps(turned, push, rate)
    edges = chain(maps.growth, maps.rise, start)
    nodes = maps.gain * edges[..., :-1, None] + maps.shift
    slopes = turned * (push + rate * nodes)
    np.testing.assert_allclose(edges[..., 0], start)
    scale = 1e-13 * np.max(np.abs(nodes))
    np.testing.assert_allclose(nodes, edges[..., :-1, None] + slopes @ rule.matrix.T, atol=scale)
    np.testing.assert_allclose(np.diff(edges), slopes @ rule.weights, atol=scale)
