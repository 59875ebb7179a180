"""Peaks and sums of curves that cases solved together have."""

import numpy as np
import pytest

from crankmbs.batch import curves, means, peaks, straight
from crankmbs.numerics.collocation import gauss

WIDTHS = np.array([0.05, 0.3, 0.05, 0.02, 0.03, 0.05, 0.01, 0.2])


def laid_out(rows, level, width, stages):
    """What the walk needs of a curve whose rows are A, B, C, D, omega^2 and alpha over the angle,
    and the sizes of its polynomials, densely, shape (cells, places)."""
    rule, edges = gauss(stages), np.append(0.0, np.cumsum(width))
    nodes = edges[:-1, None] + width[:, None] * rule.nodes
    of, rest, motion = (
        np.array([[f(nodes).ravel() for f in each[k : k + 2]] for each in rows]) for k in (0, 2, 4)
    )
    course = np.concatenate([motion[0], motion[0, :1]])
    grid = curves.grid_of(width, rule.nodes, rule.to_legendre[-1])
    lines = [curves._lines(part, grid) for part in (of, rest)]
    track = np.empty((9, lines[0].shape[-1]))
    straight.straighten(course, rule.nodes, *grid[:2], track.reshape(3, 3, -1))
    values = of[:, 0] * (course[0] - level) + of[:, 1] * course[1] + rest[:, 0] + rest[:, 1] * level
    dense = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, 3001), stages - 1)
    between = (values.reshape(len(rows), -1, stages) @ rule.to_legendre.T) @ dense.T
    return (of, rest, *lines), grid, (course, track), np.sqrt(np.sum(between**2, axis=0))


def sought(rows, level=0.0, width=WIDTHS, stages=8):
    """What is found of such a curve, and its largest size; there a rule with more nodes must have
    it, too."""
    (of, rest, *lines), grid, (course, track), sizes = laid_out(rows, level, width, stages)
    curve = of, rest[:, None], lines[0], lines[1][:, None]
    motions, asked = (course[None], track[None], np.array([[level]])), plainly(len(rows))
    places, found = np.empty((1, 1, 2)), np.empty((1, 1, 3))
    peaks.find(True, asked, curve, grid, motions, (places, found))
    looked_at(rows, level, width, stages + 2, places, found)
    return found[0, 0], np.max(sizes)


def plainly(rows):
    """One curve of so many rows, as `peaks.find` takes it."""
    return np.array([[0, rows, 0, 0, 0, -1, -1, 0]])


def looked_at(rows, level, width, stages, places, found):
    """By another rule the sizes at the places of the peaks are the same but for what either errs,
    and so are the angles."""
    (of, rest, *_), grid, (course, _), _ = laid_out(rows, level, width, stages)
    curve, there = (of, rest[:, None], of, rest[:, None]), np.empty((1, 1, 3))
    motions, kept = (course[None], course[None], np.array([[level]])), places.copy()
    peaks.find(False, plainly(len(rows)), curve, grid, motions, (kept, there))
    (size, turned, _), (sought_size, sought_turned, tail) = there[0, 0], found[0, 0]
    assert abs(size - sought_size) <= 2.0 * tail + 1e-13 * sought_size
    assert turned == sought_turned
    np.testing.assert_array_equal(kept, places)


def tables_of(stages):
    rule = gauss(stages)
    return rule.matrix, rule.weights, rule.nodes, rule.to_legendre[-1].copy()


def flat(value):
    return lambda angle: np.full_like(angle, value)


def test_a_peak_may_lie_in_the_cell_beside_the_nearest_node():
    edge, nodes = 0.05, gauss(8).nodes
    there = edge + 0.2 * nodes[0] * 0.3  # nearer to the last node of the first cell
    none = flat(0.0)
    rows = [[none, none, lambda angle: np.cos(angle - there), none, none, none]]
    (peak, turned, tail), _ = sought(rows)
    assert abs(peak - 1.0) < 1e-14 + tail
    assert abs(turned - there) < 1e-7


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_of_two_peaks_that_are_nearly_equal_the_higher_one_is_found(sign):
    width, none = np.full(90, 4.0 / 90), flat(0.0)

    def two(angle):
        return sign * (np.cos(2.0 * np.pi * angle / 2.0 - 1.2) + 1e-9 * angle)

    (peak, turned, tail), _ = sought([[none, none, two, none, none, none]], width=width)
    assert tail < 1e-12
    assert abs(turned - (2.0 + 1.2 / np.pi)) < 1e-6
    assert abs(peak - (1.0 + 1e-9 * turned)) < 1e-14 + tail


def waves(random, often, pairs):
    """Rows as `laid_out` takes them, of waves."""

    def wave():
        size, phase = random.normal(), random.uniform(0.0, 6.0)
        mean, many = random.normal(), random.uniform(0.0, often)
        return lambda angle: mean + size * np.cos(many * angle + phase)

    motion = [wave(), wave()]
    return [[*(wave() for _ in range(4)), *motion] for _ in range(pairs)]


@pytest.mark.parametrize("seed", range(40))
def test_no_peak_escapes_the_bounds(seed):
    random = np.random.default_rng(seed)
    rows = waves(random, 12.0, 1 + seed % 2)
    (peak, _, _), dense = sought(rows, random.normal(), stages=5 + seed % 5)
    assert dense * (1.0 - 1e-14) <= peak <= dense * (1.0 + 1e-4)


@pytest.mark.parametrize("bent", range(-1, 6))
def test_no_cell_and_no_block_exceeds_its_bound(bent):
    """Of A, B, C, D, omega^2 and alpha all are bent, or one alone is: its rest is all there is."""
    for seed in range(12):
        random = np.random.default_rng(seed)
        rows, width = waves(random, 40.0, 1 + seed % 2), np.full(12, 0.08)
        for row in rows if bent >= 0 else ():
            row[:] = [f if k == bent else flat(random.normal()) for k, f in enumerate(row)]
        level, stages = random.normal(), 5 + seed % 5
        (_, _, of, rest), grid, (_, track), sizes = laid_out(rows, level, width, stages)
        every, room = (0, of.shape[-1]), np.empty((7, of.shape[-1]))
        for r in range(len(rows)):
            peaks._bound((r, False, level), (of[r], rest[r]), track, every, room)
        peaks._join(len(rows) == 2, float(np.sum(np.abs(grid[2][3]))), every, room)
        highest, starts = sizes.max(axis=1), grid[1]
        highest = np.append(highest, np.maximum.reduceat(highest, starts[:-1]))
        assert np.all(highest <= room[6] * (1.0 + 1e-14))


def test_what_two_lectures_say_alike_is_sought_once_and_the_quantity_by_itself():
    rest = np.random.default_rng(1).normal(size=(1, 5, 2, 6))
    rest[0, 1], rest[0, 3], rest[0, 4] = rest[0, 0], rest[0, 2], rest[0, 2]
    assert curves.twins(rest).tolist() == [[0, 1, 2, 2, 2]]


@pytest.mark.parametrize("stages", [5, 8])
def test_a_size_that_bends_is_summed_on_both_sides(stages):
    tables, nodes = tables_of(stages), gauss(stages).nodes
    for zero in (1e-9, 0.02, 0.37, 0.5, nodes[2], 0.999):
        found = means._split(nodes - zero, 1.0 + nodes, tables)
        whole, before = (x**3 / 3.0 + (1.0 - zero) * x**2 / 2.0 - zero * x for x in (1.0, zero))
        assert abs(found - (whole - 2.0 * before)) < 2e-15
    assert means._split((nodes - 0.3) * (nodes - 0.6), nodes, tables) < 0.0
    assert abs(means._split(-1.0 - nodes, nodes, tables) - 5.0 / 6.0) < 1e-15


def test_a_polynomial_has_its_large_values_at_its_nodes():
    """What stands for no distance from a node must not overflow."""
    tables, nodes = tables_of(8), gauss(8).nodes
    for node in nodes:
        assert means._value(node, 1e12 * nodes, tables) == pytest.approx(1e12 * node, rel=1e-14)


def test_where_two_components_nearly_vanish_cells_are_halved():
    rule, miss, zero = gauss(8), 1e-2, 0.37
    first, second = rule.nodes - zero, np.full(8, miss)
    curve, over = (first, second, np.hypot(first, second)), (np.ones(8), rule.weights)
    found = means._integral(curve, over, np.ones(1), tables_of(8))
    before, whole = (
        0.5 * (x * np.hypot(x, miss) + miss**2 * np.arcsinh(x / miss)) for x in (-zero, 1.0 - zero)
    )
    assert abs(found - (whole - before)) < 1e-9
