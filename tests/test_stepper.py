"""Steps over time: the reduced equation against the arrays, the method against SciPy's, exits."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import DOP853

from crankmbs import Gravity, Piston, Rod, Start, load_scene
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.motion.minimal import stepper
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.stretch import Equation

COASTING = load_scene("coasting")
UNBALANCED = replace(
    COASTING,
    crank=replace(COASTING.crank, center_of_mass=-0.02),
    gravity=Gravity(acceleration=9.81, angle=2.0),
)
SCENES = {name: load_scene(name) for name in ("coasting", "propeller", "torque_driven", "v_twin")}
SCENES["unbalanced"] = UNBALANCED


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("name", SCENES)
def test_the_reduced_equation_is_the_one_of_the_arrays(name, sense):
    scene = SCENES[name]
    pressure = pressures_of(scene)
    reduced = Reduced(CrankTrain(scene, pressure))
    angles = np.linspace(-13.0, 27.0, 301)
    found = np.array([reduced(a, reduced.around(a, sense).pieces) for a in angles.tolist()]).T
    for values, exact in zip(found, reduce(CrankTrain(scene, pressure), angles), strict=True):
        assert np.abs(values - exact).max() <= 1e-12 * np.abs(exact).max()


def test_knots_lie_around_the_angle_on_either_side():
    scene = load_scene("propeller")
    reduced = Reduced(crank_train(scene))
    knot = reduced.around(-4.0, 1.0).high
    before, after = reduced.around(knot, -1.0), reduced.around(knot, 1.0)
    assert before.high == after.low == knot
    assert before.low < knot < after.high
    middles = 0.5 * (before.low + knot), 0.5 * (knot + after.high)
    for pieces, middle in zip((before.pieces, after.pieces), middles, strict=True):
        torque = reduce(crank_train(scene), middle)[2]
        assert reduced(middle, pieces)[2] == pytest.approx(float(torque), rel=1e-12)


@pytest.mark.parametrize("turns", range(-3, 4))
@pytest.mark.parametrize("offset", [0.0, -0.01, 0.01])
def test_a_trial_step_that_lands_on_a_fold_does_not_divide_by_zero(offset, turns):
    rod = Rod(
        length=COASTING.crank.radius + abs(offset), mass=1.0, center_of_mass=0.02, inertia=0.1
    )
    reduced = Reduced(
        CrankTrain(replace(COASTING, rod=rod, piston=Piston(mass=1.0, offset=offset)), None)
    )
    pieces = reduced.around(0.0, 1.0).pieces
    for quarter in (0.5, 1.5):
        fold = (quarter + 2.0 * turns) * np.pi
        for angle in (np.nextafter(fold, -99.0), fold, np.nextafter(fold, 99.0)):
            inertia = reduced(float(angle), pieces)[0]
            assert inertia >= COASTING.crank.inertia


def equation_of(name):
    scene = replace(load_scene(name), start=Start(angle=0.4, speed=20.0))
    reduced = Reduced(crank_train(scene))
    branch = branch_of(scene.torque, 0.0, 20.0, rising=True)
    return Equation(reduced, reduced.around(0.4, 1.0), branch)


@pytest.mark.parametrize("name", ["coasting", "propeller"])
def test_a_step_is_that_of_scipy(name):
    equation, y, width = equation_of(name), np.array([0.4, 20.0, 0.0]), 2e-3
    begins, widths, rows = np.empty(1), np.empty(1), np.empty((1, 8, 3))
    start, limits = (0.1, width, 0.0), np.array([-9.0, 9.0, -9.0, 9.0, 0.0, -99.0, 99.0])
    steps, t, *_ = stepper.travel(
        equation.system, (1e-3, 20.0, 1.0, 1), start, y, limits, (begins, widths, rows)
    )
    assert (steps, t, widths[0]) == (1, 0.1 + width, width)
    solver = DOP853(equation, 0.1, [0.4, 20.0, 0.0], 1.0, first_step=width, rtol=1e-2, atol=1e9)
    solver.step()
    assert y == pytest.approx(solver.y, rel=1e-14)
    dense, row = solver.dense_output(), rows[0]
    for x in (0.0, 0.3, 0.8, 1.0):
        value = 0.0
        for i in range(7):
            value = (value + row[7 - i]) * (x if i % 2 == 0 else 1.0 - x)
        assert row[0] + value == pytest.approx(dense(0.1 + x * width), rel=1e-13, abs=1e-13)


def test_the_step_fits_the_error():
    """A thousandth of the tolerance: about 10^(3/8) times as many steps of order 8."""
    counts = []
    for tolerance in (1e-7, 1e-10, 1e-13):
        steps = np.empty(999), np.empty(999), np.empty((999, 8, 3))
        y, limits = np.array([0.4, 20.0, 0.0]), np.array([-1e9, 1e9, -1e9, 1e9, 0.0, -99.0, 99.0])
        control = (tolerance, 20.0, 1.0, 1)
        system = equation_of("coasting").system
        counts.append(stepper.travel(system, control, (0.0, 1e-3, 0.0), y, limits, steps)[0])
    assert 2.0 < counts[1] / counts[0] < 2.8
    assert 2.0 < counts[2] / counts[1] < 2.8


def motion(theta, omega):
    """A row as of the stepper: coefficients of x, x (1 - x), x^2 (1 - x) after the value at 0."""
    row = np.zeros((8, 3))
    row[: len(theta), 0], row[: len(omega), 1] = theta, omega
    return row, row[0] + row[1]


ANYWHERE = np.array([-9.0, 9.0, -9.0, 9.0, 0.0, -99.0, 99.0])


@pytest.mark.parametrize(
    ("theta", "omega", "limits", "exit_at"),
    [
        ((1.0, 4.0), (4.0, 0.0), {}, (1.0, -1)),
        ((1.0, 4.0), (4.0, 0.0), {1: 2.0}, (0.25, 1)),
        ((1.0, -4.0), (-4.0, 0.0), {0: 0.0, 2: -1.0}, (0.25, 0)),
        ((1.0, 4.0), (4.0, 0.0), {1: 5.0}, (1.0, 1)),  # exactly at the end
        ((2.0, 4.0), (4.0, 0.0), {1: 2.0}, (1.0, -1)),  # it starts on it and goes on
        ((0.0, 1.0), (3.0, -4.0), {}, (0.75, 4)),  # a reversal
        ((0.0, 1.0), (3.0, 4.0), {6: 4.0, 1: 0.9}, (0.25, 6)),  # the first of two
        ((0.0, 1.0), (0.0, 1.0, -2.0), {}, (0.5, 4)),  # from rest backwards, and back
        ((0.0, 1.0), (0.0, 1.0), {}, (1.0, -1)),  # from rest, and on
        ((0.0, 1.0), (4.0, 1.0), {6: 4.0}, (1.0, -1)),  # it rises from its bound
        ((1.0, 0.0, 4.0), (4.0, -8.0), {1: 1.75}, (0.25, 1)),  # passed just before a reversal
        ((1.0, 0.0, 4.0), (4.0, -8.0), {1: 2.1}, (0.5, 4)),  # not reached before it
        ((0.0, 1.0), (3.0, 0.0, 4.0), {6: 3.75}, (0.25, 6)),  # the speed comes back
        ((0.0, 1.0), (0.0, -1.0, 4.0), {}, (0.75, 4)),  # from rest, and back
        ((0.0, 1.0), (3.0, 0.25, 4.0), {6: 4.12875}, (0.525, 6)),  # for a moment only
        ((0.0, 1.0), (3.0, -3.9, 4.0), {5: 3.0}, (0.025, 5)),  # it rises from its bound, and back
    ],
)
def test_the_first_exit(theta, omega, limits, exit_at):
    bounds = ANYWHERE.copy()
    bounds[list(limits)] = list(limits.values())
    x, which = stepper.first_exit(*motion(theta, omega), bounds)
    assert which == exit_at[1]
    assert x == pytest.approx(exit_at[0], abs=1e-12)


def test_it_lands_where_it_is_and_not_where_mere_errors_point():
    creeping, slope = np.array([0.3, -1e-9, 0.0]), np.array([-1e-9, 1e-12, 0.0])
    assert stepper.land(2.0, creeping, slope, 1, 0.0, 1e-3) == 2.0
    assert creeping.tolist() == [0.3, 0.0, 0.0]
    passing, slope = np.array([0.3, -4.0, 0.0]), np.array([-4.0, 5.0, 0.0])
    assert stepper.land(2.0, passing, slope, 0, 0.3 - 4e-6, 1e-3) == 2.0 + 1e-6
    assert passing == pytest.approx([0.3 - 4e-6, -4.0 + 5e-6, 0.0], abs=1e-15)
    turning, slope = np.array([0.3, -1e-7, 0.0]), np.array([-1e-7, 40.0, 0.0])
    stepper.land(2.0, turning, slope, 0, 0.3 - 1e-15, 1e-3)
    assert turning.tolist() == [0.3 - 1e-15, 0.0, 0.0]
