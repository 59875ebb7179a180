"""Cells of the crank angle: solved, chained and read to rounding."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from crankmbs import Quadratic, Run, Viscous, load_scene, simulate
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.motion.crank_angle.periods import period_of
from crankmbs.motion.crank_angle.solvers import Begin, lasting, solve
from crankmbs.numerics.collocation import carried, chain, gauss
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.scene.loads import Constant

COASTING = grid_of(CrankTrain(load_scene("coasting"), None), gauss(3))
DIESEL = grid_of(crank_train(load_scene("yi_diesel_free")), gauss(5))


@pytest.mark.parametrize("viscous", [0.0, 1e-13])
def test_clock_and_energy_lose_nothing_over_many_cells(viscous):
    """What rounding takes is the same in every pass, and their difference would not show it."""
    grid = replace(COASTING)
    grid.__dict__["weights_alone"] = False
    terms = grid.terms(0.0, 1.0, 4000, math.inf)
    branch = replace(branch_of((Constant(torque=0.1),), 0.0, 1.0, rising=True), c1=-viscous)
    cells = solve(grid, terms, branch, Begin(1.0, 50.0, 0.1, math.inf, 0.0))
    spent = terms.width * (cells.slowness @ grid.rule.weights)
    assert abs(cells.time[-1] - math.fsum([0.1, *spent])) <= 2.0 * math.ulp(cells.time[-1])
    gained = terms.width * (cells.torque @ grid.rule.weights)
    assert abs(cells.edges[-1] - math.fsum([50.0, *gained])) <= 2.0 * math.ulp(cells.edges[-1])


def test_weights_do_no_work_in_any_period():
    terms = COASTING.terms(0.0, 1.0, 4000, math.inf)
    period = len(COASTING.edges) - 1
    branch = branch_of((), 0.0, 1.0, rising=True)
    cells = solve(COASTING, terms, branch, Begin(1.0, 50.0, 0.0, math.inf, 0.0))
    assert np.ptp(cells.edges) > 1.0
    assert np.max(np.abs(cells.edges[::period] - 50.0)) <= 2.0 * math.ulp(50.0)
    once = period_of(COASTING, terms.first(period), branch, 1.0)
    assert abs(once.rise) <= 1e-30
    assert once.growth == 0.0


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_newton_and_affine_maps_agree(sense):
    """A viscous load that takes nothing sends the same cells through Newton's method."""
    loads = (Quadratic(coefficient=7e-4),)
    branch = branch_of(loads, 0.0, sense, rising=sense > 0.0)
    terms, begin = DIESEL.terms(0.3, sense, 2000, math.inf), Begin(sense, 9e3, 0.0, 1e9, 0.3)
    affine, newton = (solve(DIESEL, terms, b, begin) for b in (branch, replace(branch, c1=1e-300)))
    for mine, other in zip(affine, newton, strict=True):
        scale = np.max(np.abs(mine))
        np.testing.assert_allclose(mine, other, rtol=0.0, atol=1e-13 * scale)


def test_cells_end_before_rest_and_every_one_solves_its_equation():
    loads = (Viscous(coefficient=5.0),)
    branch = branch_of(loads, 0.0, 300.0, rising=True)
    terms = DIESEL.terms(0.0, 1.0, 4000, math.inf)
    cells = solve(DIESEL, terms, branch, Begin(1.0, 7e3, 0.0, math.inf, 0.0))
    m = lasting(0.01, DIESEL, terms.first(len(cells.torque)), cells)
    assert 300 < m < 4000
    part, rule = terms.first(m), DIESEL.rule
    energy = cells.edges[:m, None] + part.pace * (cells.torque[:m] @ rule.matrix.T)
    omega = np.sqrt(2.0 * energy / part.inertia)
    torque = part.torque - 5.0 * omega
    np.testing.assert_allclose(cells.torque[:m], torque, atol=1e-10 * np.max(np.abs(torque)))
    np.testing.assert_allclose(cells.slowness[:m], 1.0 / omega, rtol=1e-11)
    assert np.all(np.diff(cells.time[: m + 1]) > 0.0)


def test_cells_end_behind_the_one_that_passes_the_end_in_time():
    branch = branch_of((), 0.0, 1.0, rising=True)
    terms = COASTING.terms(0.0, 1.0, 500, math.inf)
    cells = solve(COASTING, terms, branch, Begin(1.0, 50.0, 0.0, 0.2, 0.0))
    assert cells.time[-2] < 0.2 <= cells.time[-1]


def test_a_chain_is_exact_to_rounding_of_its_edges():
    rng = np.random.default_rng(1)
    growth, rise = 1e-3 * rng.standard_normal(3000), rng.standard_normal(3000)
    exact = [np.longdouble(1000.0)]
    for g, r in zip(growth, rise, strict=True):
        exact.append(exact[-1] + (np.longdouble(g) * exact[-1] + r))
    edges = carried(growth, rise, 1000.0)
    ulps = np.abs(edges - np.array(exact)) / np.spacing(np.abs(edges))
    assert ulps.max() < 3.0
    assert np.abs(chain(growth, rise, 1000.0) - edges).max() > 0.0


def test_cells_are_split_by_their_worst_passage_and_where_an_error_is_no_number():
    """By 2 where three stages make 2^6 of an error at the end, or 2^4 of one inside."""
    local, cell = 1e-6, np.array([0, 1, 2, 3, 0, 1])
    allowed = local * np.diff(COASTING.edges)[cell]
    at_end = np.array([50.0, 1.0, math.nan, 0.9, 2.0, 1e9]) * allowed
    inside = np.array([0.5, 0.5, 0.5, 14.0, 0.5, 0.5]) * local
    fine = COASTING.refined(cell, at_end, inside, local)
    _, parts = np.unique(
        np.searchsorted(COASTING.edges, fine.edges[:-1], "right"), return_counts=True
    )
    assert parts[:4].tolist() == [2, 4, 2, 2]
    assert set(parts[4:]) == {1}
    enough = np.full(6, 1e-9)
    assert COASTING.refined(cell, enough * allowed, enough * local, local) is COASTING


def test_cells_last_as_long_as_their_energy():
    """Energy 1 at every edge, torque 0 outside, largest torque 1: 0.9 rad are allowed, 1.1 not."""
    grid = SimpleNamespace(scale=np.ones(4), least=np.full(4, 2.0))
    slow = np.full((4, 3), 0.1)
    terms = SimpleNamespace(cell=np.arange(4), torque=np.zeros((4, 3)))
    cells = SimpleNamespace(edges=np.ones(5), torque=np.zeros((4, 3)), slowness=slow)
    assert lasting(0.9, grid, terms, cells) == 4
    assert lasting(1.1, grid, terms, cells) == 0
    for k, slowness in ((2, 2.0), (1, math.nan)):
        slow[k, 1] = slowness
        assert lasting(0.9, grid, terms, cells) == k
    cells.edges[1] = math.nan
    assert lasting(0.9, grid, terms, cells) == 0


@pytest.mark.parametrize("stages", range(1, 10))
def test_a_cell_is_read_where_it_is_asked_for(stages):
    """Of energies and times that grow as x^s in cells of width 0.5, backwards."""
    places, x = ends_and_nodes(stages).places, np.linspace(0.0, 1.0, 11)
    at, grown = np.tile(places, (2, 1)), x**stages / stages
    time = np.array([[0.0], [5.0]]) + np.array([[5.0], [1.0]]) * at**stages
    angle = np.array([[1.0], [0.5]]) - 0.5 * at
    energy = np.array([[9.0], [3.0]]) - np.array([[6.0], [0.5 / stages]]) * at**stages
    cells = Cells(time, angle, angle, Acting(-1.0), np.empty((2, 0)), energy)
    second = np.ones(11, np.intp)
    np.testing.assert_allclose(cells.values(time, second, x), 5.0 + x**stages, rtol=1e-15)
    np.testing.assert_allclose(cells.values(energy, second, x), 3.0 - 0.5 * grown, rtol=1e-15)
    k, place = cells.located(0.5 - 0.5 * x, in_time=False)
    assert k.tolist() == [0] + 10 * [1]
    np.testing.assert_allclose(place[1:], x[1:], rtol=1e-15)
    k, place = cells.located(5.0 + x**stages, in_time=True)
    first = int(np.argmax(k))  # up to it the clock has not moved but for rounding
    assert np.max(x[:first] ** stages, initial=0.0) < 1e-13
    np.testing.assert_allclose(place[first:] ** stages, x[first:] ** stages, rtol=1e-14, atol=5e-15)


@pytest.mark.slow
@pytest.mark.parametrize("cycles", [1_000, 10_000, 100_000])
def test_the_time_of_a_long_free_run_errs_by_no_more_than_it_states(cycles):
    """Under weights alone every cycle takes as long as the first."""

    def last(count):
        run = Run(until=f"{count} cycles", every="none", rtol=1e-9)
        time = simulate(replace(load_scene("coasting"), run=run)).data["time"]
        return float(time[-1]), time.attrs["error_estimate"]

    (once, _), (time, error) = last(1), last(cycles)
    assert abs(time - cycles * once) <= error
