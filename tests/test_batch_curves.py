"""Peaks and sums of curves that cases solved together have."""

import numpy as np
import pytest

from crankmbs.batch import peaks
from crankmbs.numerics.collocation import gauss
from crankmbs.numerics.lagrange import at_nodes
from crankmbs.numerics.magnitudes import impulses, magnitudes

pytestmark = pytest.mark.slow

WIDTHS = np.array([0.05, 0.3, 0.05, 0.02, 0.03, 0.05, 0.01, 0.2])


def laid_out(functions, width, stages, alike=1, count=1, jumps=()):
    """Curves of ``count`` equal cases whose components are functions of the angle and of the cell,
    with ``jumps`` beside some of these, and the sizes of their polynomials, densely, shape (cells,
    places)."""
    rule, edges = gauss(stages), np.append(0.0, np.cumsum(width))
    angle = edges[:-1, None] + width[:, None] * rule.nodes
    cell = np.indices(angle.shape)[0]
    values = np.array([[f(angle, cell) for f in each] for each in functions])  # (r, c, m, s)
    beside = np.isin(np.arange(len(width)), jumps)
    sizes, nodes = np.sqrt((values**2).sum(axis=1)), peaks.sparse_nodes(width, stages, beside)
    seen = sizes.reshape(len(sizes), -1)[:, nodes]
    curves = peaks.Curves(
        (count, len(values)),
        alike,
        lambda some: np.stack([seen.T for _ in range(count)[some]], axis=1),
        nodes // stages,
        lambda which: values[which.curve, :, which.cell].T.copy(),
    )
    dense = at_nodes(stages).basis(np.linspace(0.0, 1.0, 3001))
    return curves, np.sqrt(((values @ dense.T) ** 2).sum(axis=1))


def sought(functions, width=WIDTHS, stages=8, jumps=()):
    """Size of the peak of one curve, angle, and what it may miss; its largest size, densely. There
    a rule with more nodes must have it, too."""
    curves, dense = laid_out([functions], width, stages, jumps=jumps)
    found = peaks.find_peaks(curves)
    finer, _ = laid_out([functions], width, stages + 2, jumps=jumps)
    there = peaks.sizes_at(finer, found)
    assert np.abs(there - found.size) <= 2.0 * found.missed + 1e-13 * found.size
    cell = found.cell[0, 0]
    angle = np.cumsum(width)[cell] + (found.place[0, 0] - 1.0) * width[cell]
    return (found.size[0, 0], angle, found.missed[0, 0]), dense.max()


def test_a_peak_may_lie_in_the_cell_beside_the_nearest_node():
    edge, nodes = 0.05, gauss(8).nodes
    there = edge + 0.2 * nodes[0] * 0.3  # nearer to the last node of the first cell
    (peak, turned, missed), _ = sought([lambda angle, cell: np.cos(angle - there)])
    assert abs(peak - 1.0) < 1e-14 + missed
    assert abs(turned - there) < 1e-7


def test_a_peak_between_two_jumps_is_found_where_the_middle_of_its_cell_is_as_high_as_beside():
    def steep(angle, cell):
        return np.where(cell == 2, 0.93 + 4.0 * (angle - 0.375), np.where(cell == 6, 1.0, 0.93))

    (peak, turned, _), highest = sought([steep], jumps=(1, 2, 3, 5, 6, 7))
    assert highest == pytest.approx(1.03, rel=1e-12)
    assert peak == pytest.approx(1.03, rel=1e-12)
    assert turned == pytest.approx(0.4, abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_of_two_peaks_that_are_nearly_equal_the_higher_one_is_found(sign):
    width = np.full(90, 4.0 / 90)

    def two(angle, cell):
        return sign * (np.cos(2.0 * np.pi * angle / 2.0 - 1.2) + 1e-9 * angle)

    (peak, turned, missed), _ = sought([two], width=width)
    assert missed < 1e-12
    assert abs(turned - (2.0 + 1.2 / np.pi)) < 1e-6
    assert abs(peak - (1.0 + 1e-9 * turned)) < 1e-14 + missed


def test_a_peak_beside_the_end_of_a_cell_that_is_less_exact_is_within_what_may_be_missed():
    """Its polynomial is lower there than the cell behind, smoother, has at its begin."""
    edge, before, width = 0.3, 0.001, np.array([0.3, 0.02, 0.1])

    def bell(angle, cell):
        return 1.0 / (1.0 + ((angle - edge + before) / 0.15) ** 2)

    (peak, turned, missed), _ = sought([bell], width=width)
    assert turned == edge
    assert 4e-5 < 1.0 - peak < missed


def wave(random, often, jumps):
    """Some function of the angle, with jumps between cells."""
    size, phase, mean, many = random.normal(size=4)
    level = jumps * random.normal(size=200)
    return lambda angle, cell: mean + size * np.cos(often * many * angle + phase) + level[cell]


@pytest.mark.parametrize("stages", [5, 6, 8, 10])
@pytest.mark.parametrize("jumps", [0.0, 0.03, 1.0])
def test_no_peak_escapes(stages, jumps):
    """Of curves that turn their sign no more often than loads and pressures do, in narrow cells, of
    which some nodes are seen, and in wide ones."""
    for seed in range(60):
        random = np.random.default_rng([seed, stages])
        width = random.uniform(0.005, 0.2, 60) if seed % 3 else np.full(120, 0.0175)
        waves = [wave(random, 4.0, jumps) for _ in range(1 + seed % 2)]
        (peak, _, _), dense = sought(waves, width, stages)
        assert dense * (1.0 - 1e-13) <= peak <= dense * (1.0 + 1e-4)


def test_a_peak_between_two_seen_nodes_may_lie_in_either_cell():
    width = np.array([0.05, 0.02, 0.05, 0.05])
    for there in np.linspace(0.0, 0.17, 35):
        (peak, _, missed), dense = sought(
            [lambda angle, _, x=there: np.cos(3.0 * (angle - x))], width
        )
        assert abs(peak - dense) < 1e-6 * dense
        assert peak >= dense * (1.0 - 1e-14) - missed


def test_what_is_nothing_but_rounding_is_sought_in_one_cell():
    random = np.random.default_rng(3)
    noise = 1e-17 * random.normal(size=(len(WIDTHS), 8))
    whole, rest = lambda angle, cell: np.cos(angle), lambda angle, cell: noise
    curves, _ = laid_out([[whole], [rest]], WIDTHS, 8, alike=2)
    assert np.count_nonzero(peaks._candidates(curves).curve == 1) == 1
    assert 0.0 < peaks.find_peaks(curves).size[0, 1] < 1e-15


def test_a_curve_without_numbers_has_no_peak_and_hides_none():
    none = lambda angle, cell: np.full_like(angle, np.nan)  # noqa: E731
    curves, dense = laid_out(
        [[none], [lambda angle, cell: np.cos(angle - 0.4)]], WIDTHS, 8, count=3
    )
    found = peaks.find_peaks(curves)
    assert np.isnan(found.size[:, 0]).all()
    assert np.isnan(peaks.sizes_at(curves, found)[:, 0]).all()
    np.testing.assert_allclose(found.size[:, 1], dense[1].max(), rtol=1e-9)
    again = peaks.find_peaks(curves._replace(always=np.array([[1, 7], [7, 0], [2, 3]])))
    for one, other in zip(found, again, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)


@pytest.mark.parametrize("stages", [5, 8])
def test_a_size_that_bends_is_summed_on_both_sides(stages):
    nodes = gauss(stages).nodes

    def whole(force, density):
        return magnitudes(
            at_nodes(stages), np.stack([force, 0.0 * force, density], axis=1)[..., None]
        )[0]

    for zero in (1e-9, 0.02, 0.37, 0.5, nodes[2], 0.999):
        end, before = (x**3 / 3.0 + (1.0 - zero) * x**2 / 2.0 - zero * x for x in (1.0, zero))
        assert abs(whole(nodes - zero, 1.0 + nodes) - (end - 2.0 * before)) < 2e-15
    ends = [x**3 / 3.0 - 0.45 * x**2 + 0.18 * x for x in (0.0, 0.3, 0.6, 1.0)]
    twice = np.abs(np.diff(ends)).sum()
    assert abs(whole((nodes - 0.3) * (nodes - 0.6), 1.0 + 0.0 * nodes) - twice) < 2e-15
    assert abs(whole(-1.0 - nodes, nodes) - 5.0 / 6.0) < 1e-15


def test_where_two_components_nearly_vanish_cells_are_halved():
    nodes, miss, zero = gauss(8).nodes, 1e-2, 0.37
    rows = np.stack([nodes - zero, np.full(8, miss), np.ones(8)], axis=1)[..., None]
    before, whole = (
        0.5 * (x * np.hypot(x, miss) + miss**2 * np.arcsinh(x / miss)) for x in (-zero, 1.0 - zero)
    )
    assert abs(magnitudes(at_nodes(8), rows)[0] - (whole - before)) < 1e-9


def test_impulses_of_many_cells_are_those_of_each():
    """Whether a magnitude bends, is straight, or has one component."""
    random = np.random.default_rng(5)
    nodes = gauss(8).nodes
    slopes, zeros = random.normal(size=(2, 3, 4, 2, 6, 1))
    forces = slopes * (nodes - 2.0 * zeros)
    forces[:, 3, 1] = 0.0
    spent = 1.0 + random.uniform(size=(3, 6, 1)) * nodes
    found = impulses(at_nodes(8), forces, np.sqrt((forces**2).sum(axis=2)), spent)
    fine, weights = (np.repeat(each, 1) for each in np.polynomial.legendre.leggauss(2000))
    basis = at_nodes(8).basis(0.5 * (1.0 + fine))
    size = np.sqrt(((forces @ basis.T) ** 2).sum(axis=2)) * (spent @ basis.T)[:, None]
    np.testing.assert_allclose(found, (size @ (0.5 * weights)).sum(axis=2), rtol=3e-6)
