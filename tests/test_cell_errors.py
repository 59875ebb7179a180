"""What cells of the crank angle err, against the formula in arrays."""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest

from crankmbs import Fuel, Governor, Load, Run, SpeedTable, Table, load_scene
from crankmbs.mechanics import pressure
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle import advance as crank_angle
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import plan_of
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.parts import Friction

PROPELLER = replace(load_scene("propeller"), run=Run(until="500 deg"))
DIESEL = replace(load_scene("yi_diesel_free"), run=Run(until="500 deg"))
GOVERNED = Fuel(governor=Governor(speed=300.0, kp=0.01, ki=0.1, max=1.2))
PRESSURE = DIESEL.gas.pressure
THIN = Table(PRESSURE.x[::30], PRESSURE.y[::30])
FIRED = replace(DIESEL, gas=replace(DIESEL.gas, pressure=THIN, motored=2e5), fuel=GOVERNED)
ROWS = SpeedTable(file=Table([0.0, 333.0, 600.0], [0.0, -80.0, -90.0]))
SCENES = {
    "affine": PROPELLER,
    "backwards": replace(PROPELLER, start=replace(PROPELLER.start, speed=-150.0), torque=()),
    "rows": replace(DIESEL, torque=(*DIESEL.torque, ROWS)),
    "fuel, pressed rings and drag": replace(
        FIRED, friction=Friction(ring_force=20.0, ring_pressure=0.02, viscous=30.0)
    ),
    "function": replace(DIESEL, torque=(Load(lambda t, theta, omega: -0.2 * omega),)),
}


def in_arrays(segment):
    """Energy missed at the end of every cell, and the relative errors there and inside."""
    rule, finer = segment.grid.rule, segment.grid.finer.rule
    terms = segment.grid.finer.same(segment.terms, segment.begin.theta, segment.sense)
    shares, width = segment.shares[:, None, :], segment.sense * terms.width[:, None]
    torque = terms.torque + (terms.combustion * shares).sum(axis=2)
    if terms.rubbed.shape[2]:
        pressed = np.abs(terms.rubbed + terms.combustion * shares).sum(axis=2)
        torque = torque - terms.against * pressed
    inside = rule.integrals(finer.nodes).T
    energy = segment.energy[:-1, None] + width * (segment.torque @ inside)
    t = segment.time[:-1, None] + terms.width[:, None] * (segment.slowness @ inside)
    slowness = np.sqrt(0.5 * terms.inertia / energy)
    omega = segment.sense / slowness
    torque = torque + segment.branch(t, omega) - (terms.drag * omega if terms.drags else 0.0)
    theta = terms.angles(segment.begin.theta, segment.sense, finer)
    torque = torque + sum(function(t, theta, omega) for function in segment.branch.functions)
    to_nodes, own = np.vstack([finer.matrix, finer.weights]).T, np.vstack([inside.T, rule.weights])
    gained = width * (torque @ to_nodes - segment.torque @ own.T)
    late = np.abs(width) * np.abs(slowness @ to_nodes - segment.slowness @ own.T)
    per_time = np.maximum((1.0 / segment.slowness).min(axis=1), 1.0 / segment.time[1:])
    both = np.abs(gained) / segment.energy[1:, None] + late * per_time[:, None]
    return gained[:, -1], both[:, -1], both.max(axis=1)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_compiled_errors_are_those_of_the_formula(scene):
    train = crank_train(scene)
    grid = grid_of(train, gauss(3))
    start = State(0.0, scene.start.angle, scene.start.speed, 0.0, begun(train))
    windows = list(crank_angle.advance(grid, start, plan_of(scene), 1e-9))
    seen = 0
    for segment in windows:
        expected, rounding = in_arrays(segment), 1e-13 * segment.energy.max()
        scales = (rounding, 1e-13, 1e-13)
        for found, error, scale in zip(segment.errors, expected, scales, strict=True):
            assert found == pytest.approx(error, rel=1e-6, abs=scale)
            seen += int(np.count_nonzero(np.abs(error) > 1e3 * scale))
    assert seen > 20


def test_a_table_of_all_cylinders_is_interpolated_once(monkeypatch):
    interpolate = Mock(wraps=pressure.interpolate)
    monkeypatch.setattr(pressure, "interpolate", interpolate)
    assert len(pressure.pressures_of(DIESEL)) == 4
    assert interpolate.call_count == 1
