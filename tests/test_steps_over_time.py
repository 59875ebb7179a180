"""Steps over time: the pieces of the reduced crank train against the arrays, and exits of steps."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import Cylinder, Gas, Gravity, Layout, Piston, Rod, Table, load_scene
from crankmbs.mechanics.friction import friction_torque, rubbing
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.minimal.exits import first_exit
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.mode import begun

COASTING = load_scene("coasting")
UNBALANCED = replace(
    COASTING,
    crank=replace(COASTING.crank, center_of_mass=-0.02),
    gravity=Gravity(acceleration=9.81, angle=2.0),
)
FREE = ("coasting", "propeller", "torque_driven", "v_twin", "misfire", "run_down")
SCENES = {name: load_scene(name) for name in FREE}
SCENES["unbalanced"] = UNBALANCED


@pytest.mark.parametrize("checks", [False, True])
@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("name", SCENES)
def test_the_pieces_are_the_arrays(name, sense, checks):
    train = crank_train(SCENES[name])
    mode = begun(train)
    pieces, angles = Reduced(train, checks).at(mode), np.linspace(-13.0, 27.0, 301)
    found = []
    for angle in angles.tolist():
        piece = pieces.around(angle, sense)
        assert piece.low <= angle <= piece.high
        found.append(piece(angle - piece.middle))
    shares = mode.shares or None
    inertia, slope, torque = reduce(train, angles, shares)
    torque = torque + friction_torque(train, angles, 0.0, sense, shares)
    exact = inertia, slope, torque, rubbing(train, angles).drag
    for values, one in zip(np.array(found).T, exact, strict=True):
        assert np.abs(values - one).max() <= 1e-12 * np.abs(one).max()


@pytest.mark.parametrize("apart", [1e-8, 3e-7, 3e-6])
def test_a_narrow_piece_between_two_jumps_knows_neither(apart):
    """Two cylinders jump one shortly after the other."""
    table = Table((0.0, 1.0, 4.0), (2e5, -1e5, 3e5))
    gas = Gas(pressure=table, absolute=False, stroke=2, interpolation="step")
    layout = Layout(cylinders=(Cylinder(), Cylinder(phase=apart)))
    piston = replace(COASTING.piston, area=1e-3)
    train = crank_train(replace(COASTING, gas=gas, layout=layout, piston=piston))
    piece = Reduced(train).at(begun(train)).around(1.0 - 0.5 * apart, 1.0)
    assert piece.high - piece.low == pytest.approx(apart, rel=1e-6)
    places = np.array([0.1, 0.5, 0.8])
    angles = piece.low + places * apart
    _, _, torque = reduce(train, angles)
    found = [piece(angle - piece.middle)[2] for angle in angles.tolist()]
    assert np.abs(found - torque).max() <= 1e-9 * np.abs(torque).max()


def test_knots_lie_around_the_angle_on_either_side():
    train = crank_train(load_scene("propeller"))
    pieces = Reduced(train).at(begun(train))
    knot = pieces.around(-4.0, 1.0).high
    before, after = pieces.around(knot, -1.0), pieces.around(knot, 1.0)
    assert before.high == pytest.approx(knot, abs=1e-14)
    assert after.low == pytest.approx(knot, abs=1e-14)
    assert before.low < knot < after.high


@pytest.mark.parametrize("turns", range(-3, 4))
@pytest.mark.parametrize("offset", [0.0, -0.01, 0.01])
def test_a_trial_step_that_lands_on_a_fold_is_a_number(offset, turns):
    length = COASTING.crank.radius + abs(offset)
    rod = Rod(length=length, mass=1.0, center_of_mass=0.02, inertia=0.1)
    train = crank_train(replace(COASTING, rod=rod, piston=Piston(mass=1.0, offset=offset)))
    pieces = Reduced(train).at(begun(train))
    for quarter in (0.5, 1.5):
        fold = (quarter + 2.0 * turns) * np.pi
        for angle in (np.nextafter(fold, -99.0), fold, np.nextafter(fold, 99.0)):
            for sense in (1.0, -1.0):
                piece = pieces.around(float(angle), sense)
                assert np.isfinite(piece(float(angle) - piece.middle)).all()


def motion(theta, omega):
    """A step by coefficients of 1, x, x (1 - x), x^2 (1 - x)."""
    powers = np.array(
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 1.0, 0.0], [0.0, 0.0, -1.0, 1.0], [0, 0, 0, -1]]
    )
    row = np.zeros((8, 3))
    for q, nested in enumerate((theta, omega)):
        row[:4, q] = powers[:, : len(nested)] @ nested
    return row


@pytest.mark.parametrize(
    ("theta", "omega", "angles", "speeds", "exit_at"),
    [
        ((1.0, 4.0), (4.0, 0.0), (-9.0, 9.0), (), (1.0, -1)),
        ((1.0, 4.0), (4.0, 0.0), (-9.0, 2.0), (), (0.25, 0)),
        ((1.0, -4.0), (-4.0, 0.0), (0.0, 9.0), (), (0.25, 0)),
        ((1.0, 4.0), (4.0, 0.0), (-9.0, 5.0), (), (1.0, 0)),  # exactly at the end
        ((2.0, 4.0), (4.0, 0.0), (2.0, 9.0), (), (1.0, -1)),  # it starts on it and goes on
        ((0.0, 1.0), (3.0, -4.0), (-9.0, 9.0), (), (0.75, 1)),  # a reversal
        ((0.0, 1.0), (3.0, 4.0), (-9.0, 0.9), (4.0,), (0.25, 1)),  # the first of two
        ((0.0, 0.0, -1.0), (0.0, 1.0, -2.0), (-9.0, 9.0), (), (0.5, 1)),  # from rest, and back
        ((0.0, 0.0, -1.0), (0.0, -1.0, 0.5), (-9.0, 9.0), (), (1.0, -1)),  # from rest, and on
        ((0.0, 1.0), (4.0, 1.0), (-9.0, 9.0), (4.0,), (1.0, -1)),  # it rises from its bound
        ((1.0, 0.0, 4.0), (4.0, -8.0), (-9.0, 1.75), (), (0.25, 0)),  # just before a reversal
        ((1.0, 0.0, 4.0), (4.0, -8.0), (-9.0, 2.1), (), (0.5, 1)),  # not reached before it
        ((0.0, 1.0), (3.0, 0.0, 4.0), (-9.0, 9.0), (3.75,), (0.25, 1)),  # the speed comes back
        ((0.0, 1.0), (3.0, 0.25, 4.0), (-9.0, 9.0), (4.12875,), (0.525, 1)),  # for a moment only
        ((0.0, 1.0), (3.0, -3.9, 4.0), (-9.0, 9.0), (3.0,), (0.025, 1)),  # it rises, and back
    ],
)
def test_the_first_exit(theta, omega, angles, speeds, exit_at):
    x, which, limit = first_exit(motion(theta, omega), angles, (0.0, *speeds))
    assert which == exit_at[1]
    assert x == pytest.approx(exit_at[0], abs=1e-12)
    assert which < 0 or limit in (*angles, 0.0, *speeds)


def test_a_speed_that_only_touches_its_bound_is_no_exit():
    """(x - 0.5)^2 touches zero."""
    row = np.zeros((8, 3))
    row[:3, 1], row[1, 0] = (0.25, -1.0, 1.0), 1.0
    assert first_exit(row, (-9.0, 9.0), (0.0,))[1] == -1
