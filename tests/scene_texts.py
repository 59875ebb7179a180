"""Scenes to read and to break, and what a broken one says."""

import pytest

from crankmbs import Crank, Piston, Rod, Run, Scene, Start
from crankmbs.errors import SceneError

FREE = """
title = "one cylinder"

[crank]
radius = "46 mm"
inertia = "0.02 kg m^2"

[rod]
length = "150 mm"

[piston]
mass = "1.14 kg"
area = "57 cm^2"

[gas]
pressure = "gas.csv"
absolute = false

[start]
angle = "0 deg"
speed = "3200 rpm"

[[torque]]
kind = "quadratic"
coefficient = "9.5e-5 N m s^2"

[run]
until = "0.75 s"
"""
DRIVEN = (
    FREE[: FREE.index("[start]")] + '[motion]\nspeed = "3200 rpm"\n\n[run]\nuntil = "1 cycle"\n'
)
GAS = "crank_angle_deg,pressure_bar\n0,1\n240,2\n480,3\n"


def refusal(read, text):
    """The message that a bad scene gets, without the file's name in front."""
    with pytest.raises(SceneError) as caught:
        read(text)
    message = str(caught.value)
    assert message.startswith("scene.toml: ")
    assert "\n" not in message
    assert len(message) < 300
    return message.removeprefix("scene.toml: ")


def edited(scene, old, new):
    assert scene.count(old) == 1
    return scene.replace(old, new)


INDICATOR = """ambient = "1 bar"
[gas.indicator]
compression_ratio = 10
n_compression = 1.3
n_expansion = 1.25
intake_pressure = "1 bar"
exhaust_pressure = "1.1 bar"
peak_pressure = "50 bar"
"""
INDICATED = edited(FREE, 'pressure = "gas.csv"\nabsolute = false\n', INDICATOR)


def scene(**changes):
    """One cylinder that is free, built in Python, with other parts."""
    parts = {
        "crank": Crank(radius=0.046, inertia=0.02),
        "rod": Rod(length=0.15),
        "piston": Piston(mass=1.14, area=57e-4),
        "start": Start(angle=0.0, speed=335.1),
        "run": Run(until="0.75 s"),
    }
    return Scene(**{**parts, **changes})
