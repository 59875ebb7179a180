"""Loads that bend at rows of tables: crossed without a stop, and still exact."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from two_runs import differences

from crankmbs import (
    Constant,
    Quadratic,
    Run,
    SpeedTable,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.mechanics.torque import branch_of, course_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle import advance as crank_angle
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.motion.plan import plan_of
from crankmbs.numerics.collocation import gauss

SPEED = Table((-9.0, 2.0, 5.0, 5.0, 7.0, 9.0), (3.0, 1.0, 4.0, 2.0, 2.5, -1.0))
TIME = Table((0.0, 1.0, 1.0, 2.0, 3.0), (0.0, 4.0, 1.0, 2.0, 9.0))
LOADS = (SpeedTable(file=SPEED), TimeTable(file=TIME))
DIESEL = replace(load_scene("yi_diesel_free"), run=Run(until="0.1 s"))


def with_speed_table(rows, noise=0.0):
    """The load of the diesel engine as a dynamometer might have measured it, up to 4000 rpm."""
    speed = np.linspace(0.0, 418.9, rows)
    torque = -7.775e-4 * speed**2 + noise * np.random.default_rng(1).standard_normal(rows)
    return replace(DIESEL, torque=(SpeedTable(file=Table(speed.tolist(), torque.tolist())),))


def with_time_table(rows):
    time = np.linspace(0.0, 0.11, rows)
    sway = TimeTable(file=Table(time.tolist(), (20.0 * np.sin(90.0 * time)).tolist()))
    return replace(DIESEL, torque=(*DIESEL.torque, sway))


@pytest.mark.parametrize("table", [with_speed_table, with_time_table])
@pytest.mark.parametrize("rows", [25, 1000, 5000])
def test_rows_are_crossed_without_a_stop(rows, table):
    result = simulate(table(rows))
    assert result.status == 0
    assert result.cost.evaluations <= 3 * simulate(DIESEL).cost.evaluations


def test_a_fine_table_costs_what_its_curve_costs():
    result = simulate(with_speed_table(1000))
    assert result.cost.evaluations <= 1.01 * simulate(DIESEL).cost.evaluations


def speed_at_end(rows, grid, allowed):
    """Speed [rad/s] where one pass over the diesel engine ends in angle."""
    scene = replace(with_speed_table(rows), run=Run(until="1000 deg"))
    grid = replace(grid, train=crank_train(scene))
    start = State(0.0, scene.start.angle, scene.start.speed, 0.0)
    *_, last = crank_angle.advance(grid, start, plan_of(scene), allowed)
    return last.end.omega


@pytest.mark.parametrize("rows", [150, 400, 1000])
def test_what_little_kinks_miss_is_added(rows):
    grid = grid_of(crank_train(DIESEL), gauss(7)).finer
    cut = speed_at_end(rows, replace(grid, checks=False), 1e-13)
    missing = speed_at_end(rows, replace(grid, checks=False), 1e-7) / cut - 1.0
    added = speed_at_end(rows, grid, 1e-11) / cut - 1.0
    assert abs(added) <= 0.05 * abs(missing)


def braked(rows, noise):
    return replace(with_speed_table(rows, noise), run=Run(until="0.03 s"))


@cache
def stopping_at_rows(rows, noise):
    return simulate(braked(rows, noise), formulation="minimal", rtol=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("rtol", [1e-5, 1e-8, 1e-11])
@pytest.mark.parametrize(("rows", "noise"), [(60, 0.0), (200, 5.0)])
def test_minimal_that_stops_at_every_row_confirms_it(rows, noise, rtol):
    for_each = differences(simulate(braked(rows, noise), rtol=rtol), stopping_at_rows(rows, noise))
    assert max(each.share for each in for_each) <= 2.0


@pytest.mark.parametrize("t", [0.0, 0.3, 1.0, 1.5, 2.0, 2.9])
@pytest.mark.parametrize("omega", [-20.0, -3.0, -1.0, 3.0, 6.0, 8.0, 20.0])
def test_a_course_continues_a_branch(omega, t):
    loads = (*LOADS, Constant(torque=3.0), Viscous(coefficient=0.5), Quadratic(coefficient=0.25))
    branch = branch_of(loads, t, omega, rising=True)
    course = course_of(loads, branch, t)
    assert course.t_end >= branch.t_end
    assert course.omega_low <= branch.omega_low < branch.omega_high <= course.omega_high
    times = np.linspace(t, min(course.t_end, 3.0), 29)[1:-1]
    speeds = np.linspace(max(course.omega_low, -30.0), min(course.omega_high, 30.0), 29)[1:-1]
    exact = sum(load(times, times, speeds) for load in loads)
    np.testing.assert_allclose(course(times, speeds), exact, rtol=1e-13, atol=1e-13)


def test_a_course_is_the_sum_of_the_loads_between_jumps():
    course = course_of(LOADS, branch_of(LOADS, 1.2, 6.0, rising=True), 1.2)
    assert (course.t_end, course.omega_low, course.omega_high) == (3.0, 5.0, np.inf)
    assert (course.times.tolist(), course.speeds.tolist()) == ([2.0], [7.0, 9.0])
    t, omega = np.array([1.3, 1.9, 2.5, 2.9]), np.array([5.5, 6.5, 8.0, 20.0])
    exact = np.interp(t, TIME.x[2:], TIME.y[2:]) + np.interp(omega, SPEED.x[3:], SPEED.y[3:])
    np.testing.assert_allclose(course(t, omega), exact, rtol=1e-14)
    np.testing.assert_allclose(course.slope(omega), [0.25, 0.25, -1.75, 0.0], rtol=1e-14)


def test_a_course_ends_where_a_table_jumps():
    assert course_of(LOADS, branch_of(LOADS, 0.4, 6.0, rising=True), 0.4).t_end == 1.0


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_cells_cut_are_parts_of_cells(sense):
    scene = load_scene("propeller")
    grid = grid_of(crank_train(scene), gauss(5))
    terms = grid.terms(3.0, sense, 40, np.inf)
    marks = terms.turned[[7, 7, 20]] + np.array([0.25, 0.5, 0.5]) * terms.width[[7, 7, 20]]
    cut = grid.cut(terms, 3.0, sense, np.append(marks, terms.turned[11]))
    assert len(cut.width) == 43
    assert cut.cell.tolist() == np.insert(terms.cell, [7, 7, 20], terms.cell[[7, 7, 20]]).tolist()
    np.testing.assert_array_equal(np.setdiff1d(cut.turned, terms.turned), np.sort(marks))
    assert np.array_equal(cut.inertia[24:], terms.inertia[21:])
    work = [np.sum(s.width * (s.torque @ grid.rule.weights)) for s in (terms, cut)]
    assert work[0] == pytest.approx(work[1], rel=1e-9)
