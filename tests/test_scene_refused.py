"""Scenes built in Python that cannot be: one sentence each."""

import math

import numpy as np
import pytest
from scene_texts import scene

from crankmbs import (
    Constant,
    Crank,
    Cylinder,
    Extent,
    Gas,
    InputError,
    Layout,
    Motion,
    Oscillation,
    Piston,
    Ramp,
    Rod,
    Run,
    Scene,
    SpeedTable,
    Table,
)
from crankmbs.errors import SceneError


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Crank(radius=-1, inertia=0.1), "radius: must be above 0; -1 came"),
        (lambda: Crank(radius="-1 mm", inertia=0.1), 'radius: must be above 0; "-1 mm" came'),
        (lambda: Crank(radius=math.nan, inertia=0.1), "radius: must be finite; nan came"),
        (
            lambda: Crank(radius=True, inertia=0.1),
            'radius: must be a number in SI units, or text such as "46 mm"; true came',
        ),
        (
            lambda: Crank(inertia=1),
            'radius: this argument is missing; give it, such as radius="46 mm"',
        ),
        (
            lambda: scene(crank=Crank(radius=0.046)),
            "crank.inertia: this key is missing; a free crank needs it, only a prescribed speed, "
            "motion, does without",
        ),
        (lambda: Crank(radius=1, inertia=1, mas=1), 'mas: unknown argument; did you mean "mass"?'),
        (
            lambda: Crank(radius=1, inertia=1, mass=2, center_of_mass=1),
            "inertia about the crank axis must be at least mass * center_of_mass^2 = 2 kg m^2; "
            "1 came",
        ),
        (lambda: Piston(mass=1, bore=0.1, area=0.1), "give bore or area, not both; both came"),
        (lambda: Rod(length=1, inertia="lumped"), 'inertia: must be "two-mass"; "lumped" came'),
        (
            lambda: Run(until=0.75),
            "until: must be an angle or a time with its unit, such as "
            '"20 cycles", "10 rev" or "0.75 s"; 0.75 came',
        ),
        (lambda: Extent(value=0.0, unit="s"), "must be finite and above 0; 0 s came"),
        (
            lambda: Extent(value=1.0, unit="m"),
            'unit must be "rad", "cycle" or "s"; "m" came',
        ),
        (
            lambda: Oscillation(mean=-1.0, amplitude=1.0, order=1.0),
            "amplitude must be below the mean speed, or the crank stops; 1 and -1 rad/s came",
        ),
        (
            lambda: Run(until={"value": 1.0}),
            "until.unit: this argument is missing; it has no default",
        ),
        (
            lambda: Run(until={"value": 1.0, "unit": "s", "x": 1}),
            "until.x: unknown argument",
        ),
        (
            lambda: Run(until={"value": -1.0, "unit": "s"}),
            "until: must be finite and above 0; -1 s came",
        ),
        (
            lambda: Gas(pressure=[1.0, [2.0]], ambient=1e5),
            "pressure: must be the name of a CSV file or a Table(crank angles [rad], pressures "
            '[Pa]), a list of them, or a pressure such as "1 bar"; [2.0] came',
        ),
        (
            lambda: scene(torque=[Constant(torque=1.0), 3]),
            "torque[2]: must be one of Constant, Viscous, Quadratic, TimeTable, SpeedTable, "
            "AngleTable; 3 came",
        ),
        (
            lambda: Gas(pressure=np.zeros((5, 2)), ambient=1e5),
            "pressure: must be the name of a CSV file or a Table(crank angles [rad], pressures "
            '[Pa]), a list of them, or a pressure such as "1 bar"; an array of shape (5, 2) came',
        ),
        (
            lambda: SpeedTable(file=math.sin),
            "file: must be the name of a CSV file or a Table(speeds [rad/s], torques [N m]); "
            "a function came",
        ),
        (
            lambda: scene(torque=lambda t, omega: -omega),
            "torque: must be a tuple or list of Constant, Viscous, Quadratic, TimeTable, "
            "SpeedTable or AngleTable; a function came",
        ),
        (
            lambda: scene(torque=[lambda t, omega: -omega]),
            "torque[1]: must be one of Constant, Viscous, Quadratic, TimeTable, SpeedTable, "
            "AngleTable; a function came",
        ),
        (
            lambda: Motion(speed=lambda t: 300.0),
            'speed: must be a number in rad/s, text such as "3200 rpm", or one of Oscillation, '
            "Ramp, SpeedFile; a function came",
        ),
        (
            lambda: Layout(cylinders=Cylinder()),
            "cylinders: must be a tuple or list of Cylinder; "
            "Cylinder(phase=0.0, bank=0.0, position=None, throw=None, ... came",
        ),
        (lambda: Layout(firing_order=3), "firing_order: must be a tuple or list; 3 came"),
        (
            lambda: Crank(0.046, 0.1),
            "Crank takes its values by name, Crank(radius=..., inertia=...); 2 came without",
        ),
        (
            lambda: Scene(crank=Crank(radius=1, inertia=1)),
            "rod: this argument is missing; give rod=Rod(length, mass, center_of_mass, inertia)",
        ),
        (
            lambda: Crank(radius=None, inertia=1),
            'radius: must be a number in SI units, or text such as "46 mm"; None came',
        ),
        (lambda: scene(title=3), "title: must be a str; 3 came"),
        (
            lambda: Gas(pressure=Table((0, 6), (1, 1)), absolute="no"),
            'absolute: must be True or False; "no" came',
        ),
        (
            lambda: Gas(pressure=Table((0, 360, 720), (1, 2, 1)), absolute=False),
            "table: the rows span 41253 degrees, more than the period of 720; check stroke, 4 "
            'came, or for a file of several cycles give cycles="mean" or "sequence"; a Table has '
            "its angles in radians",
        ),
        (
            lambda: Gas(pressure=Table((0, 6), (1, 1))),
            'an absolute pressure needs ambient, the crankcase side; give ambient="1 bar", or '
            "absolute=False when the file is gauge",
        ),
        (
            lambda: scene(start=None),
            "give motion (the speed is prescribed) or start (the crank is free), exactly one of "
            "the two; neither came",
        ),
        (lambda: Ramp(to=1.0, over=1.0), "start: this argument is missing; it has no default"),
        (lambda: Ramp(start=math.inf, to=1.0, over=1.0), "start: must be finite; inf came"),
        (
            lambda: Ramp(begin=1.0, to=1.0, over=1.0),
            "begin: unknown argument; known arguments are start, to, over",
        ),
        (
            lambda: scene(crank={"radius": -1, "inertia": 1}),
            "crank.radius: must be above 0; -1 came",
        ),
        (
            lambda: scene(crank=Rod(length=1)),
            "crank: must be given as Crank(radius, inertia, mass, center_of_mass); Rod(length=1.0, "
            "mass=0.0, center_of_mass=0.0, inertia=0.0) came",
        ),
    ],
)
def test_what_cannot_be_raises_one_sentence(build, message):
    with pytest.raises(InputError) as caught:
        build()
    assert str(caught.value) == message
    assert not isinstance(caught.value, SceneError)
