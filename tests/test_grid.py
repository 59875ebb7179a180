"""Cells of the crank angle: no knot inside, tables true, the cell ahead in both directions."""

from dataclasses import replace
from fractions import Fraction
from itertools import accumulate

import numpy as np
import pytest
from references import worst_ratio

from crankmbs import load_scene, simulate
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.units import DEGREE
from validation.random_scenes import random_scene

SCENE = load_scene("v_twin")
PRESSURE = pressures_of(SCENE)
GRID = grid_of(CrankTrain(SCENE, PRESSURE), gauss(4))


def test_no_knot_lies_inside_a_cell():
    knots = crank_angle_knots(CrankTrain(SCENE, PRESSURE))
    gap = np.min(np.abs(knots[:, None] - GRID.edges), axis=1)
    assert gap.max() <= 1e-12
    assert np.all(np.diff(GRID.edges) > 0.0)
    assert np.diff(GRID.edges).max() <= 6.0 * DEGREE * (1 + 1e-9)
    assert (GRID.edges[0], GRID.edges[-1]) == (0.0, SCENE.period)


def test_tables_hold_what_the_angle_gives():
    at = GRID.edges[:-1, None] + np.diff(GRID.edges)[:, None] * GRID.rule.nodes
    inertia, _, torque = reduce(CrankTrain(SCENE, PRESSURE), at)
    np.testing.assert_array_equal(GRID.tables[0], inertia)
    np.testing.assert_array_equal(GRID.tables[1], torque)


def test_cells_are_cut_into_equal_parts():
    parts = np.ones(len(GRID.edges) - 1, dtype=np.intp)
    parts[3] = 4
    cut = GRID.split(parts)
    assert len(cut.edges) == len(GRID.edges) + 3
    quarter = np.diff(GRID.edges)[3] / 4
    np.testing.assert_allclose(np.diff(cut.edges)[3:7], quarter, rtol=1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("theta", [0.0, 0.37, 12.1, -40.2])
def test_cell_at_is_the_one_ahead(theta, sense):
    k = GRID.cell_at(theta, sense)
    ahead = (theta + sense * 1e-9) % SCENE.period
    assert GRID.edges[k] <= ahead <= GRID.edges[k + 1]


def test_without_gas():
    coasting = load_scene("coasting")
    grid = grid_of(CrankTrain(coasting, None), gauss(3))
    np.testing.assert_allclose(np.diff(grid.edges), 6.0 * DEGREE, rtol=1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_angle_turned_is_that_of_the_cells_however_many(sense):
    """A sum of their widths would be off by a hundred roundings, the same in every pass."""
    terms = GRID.terms(0.37, sense, 4000, sense * 1e9)
    edges = [Fraction(float(edge)) for edge in GRID.edges]
    widths = [edges[k + 1] - edges[k] for k in terms.cell[1:].tolist()]
    exact = list(accumulate(widths, initial=Fraction(float(terms.width[0]))))
    off = [abs(float(Fraction(float(u)) - e)) for u, e in zip(terms.turned[1:], exact, strict=True)]
    assert max(off) <= 2.0 * np.spacing(terms.turned[-1])


def test_terms_end_at_their_bound():
    terms = GRID.terms(0.37, 1.0, 4000, 40.0)
    assert terms.turned[-1] == 40.0 - 0.37
    assert terms.width[-1] == terms.turned[-1] - terms.turned[-2]
    assert len(terms.width) == len(terms.turned) - 1


def test_two_rules_do_not_err_alike_where_a_rod_hardly_escapes_its_fold():
    """It is longer than it must be by 2e-6 of the radius, and swings over within 0.1 degrees: in
    cells of 6 degrees the difference of two rules was a twentieth of their errors."""
    scene = random_scene(8164)
    result = simulate(scene, formulation="crank_angle", rtol=1e-4)
    assert result.status == 0
    assert worst_ratio(result) <= 2.0


@pytest.mark.parametrize(("offset", "folds"), [(0.0, 2), (0.01, 1), (-0.01, 1)])
def test_cells_are_narrow_around_a_fold_that_the_rod_escapes(offset, folds):
    scene = load_scene("coasting")
    radius = scene.crank.radius
    rod = replace(scene.rod, length=radius + abs(offset) + 1e-5 * radius)
    scene = replace(scene, rod=rod, piston=replace(scene.piston, offset=offset))
    edges = grid_of(CrankTrain(scene, None), gauss(3)).edges
    width = np.sqrt(2e-5)
    beside = np.min(np.abs(edges[:, None] - np.pi * np.array([0.5, 1.5])), axis=1)
    near = (beside > 0.0) & (beside < 1.01 * width)
    assert np.count_nonzero(near) == 2 * folds
    assert np.all(np.diff(edges) <= 2.0 * np.maximum(beside[1:], beside[:-1]))
