"""What a step cannot be told, and where one comes to no end: refused or said, and nothing moves."""

import math
from dataclasses import replace

import pytest
from test_stepping import COASTING, fuelled, wheel

import crankmbs.motion.stepwise.free as free
from crankmbs import (
    FormulationError,
    InputError,
    Load,
    Piston,
    SpeedTable,
    Start,
    Stepper,
    Table,
    load_scene,
)

FREE, DRIVEN = Stepper(COASTING), Stepper(load_scene("yi_diesel"))
REFUSED = {
    "no time": (FREE, (0.0,), {}, "dt: must be a time above 0 s; 0 came"),
    "backwards": (FREE, (-1e-3,), {}, "dt: must be a time above 0 s; -0.001 came"),
    "no number": (FREE, ("1 ms",), {}, 'dt: must be a time .*, a finite number; "1 ms" came'),
    "endless": (FREE, (math.inf,), {}, "dt: must be a time .*, a finite number; inf came"),
    "true": (FREE, (True,), {}, "dt: must be a time"),
    "nan": (FREE, (1e-3,), {"load": math.nan}, r"load: must be a torque \[N m\], a finite number"),
    "huge": (FREE, (1e-3,), {"load": 1e300}, "overflows; 1e\\+300 came"),
    "driven": (DRIVEN, (1e-3,), {"load": 5.0}, r"load: with \[motion\] the drive is an answer"),
    "no fuel": (FREE, (1e-3,), {"fuel": 0.5}, r"fuel: the scene has no \[fuel\]"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_a_step_cannot_be_told_is_refused(name):
    stepper, at, given, sentence = REFUSED[name]
    before = stepper.save()
    with pytest.raises(InputError, match=sentence):
        stepper.advance(*at, **given)
    assert stepper.save() == before


@pytest.mark.parametrize("fuel", [-0.1, 101.0, "0.5", math.nan, True])
def test_a_share_that_cannot_be_is_refused(fuel):
    with pytest.raises(InputError, match="fuel: must be "):
        Stepper(fuelled()).advance(1e-3, fuel=fuel)


def test_a_step_lost_in_the_rounding_of_the_time_is_refused():
    stepper = Stepper(wheel())
    stepper.advance(1e6)
    with pytest.raises(InputError, match=r"dt: does not change the time, 1e\+06 s, by a digit"):
        stepper.advance(1e-12)


def test_what_cannot_be_stepped_is_refused():
    with pytest.raises(InputError, match=r'scene must be a Scene.*"coasting" came'):
        Stepper("coasting")
    scene = replace(COASTING, run=replace(COASTING.run, formulation="multibody"))
    with pytest.raises(FormulationError, match=r"'multibody' cannot step over time.*\"auto\""):
        Stepper(scene)


def test_it_stops_at_a_fold():
    rod = replace(COASTING.rod, length=COASTING.crank.radius)
    stepper = Stepper(replace(COASTING, rod=rod, piston=Piston(mass=1.0)))
    state = stepper.advance(0.5)
    assert (state.status, state.time < 0.5) == (1, True)
    assert state.message.startswith("the rod folds onto the crank at 89.9999 degrees")
    assert stepper.advance(0.5)[:4] == state[:4]


def test_a_speed_from_which_no_motion_leads_ends_a_step_until_a_load_helps():
    drives = SpeedTable(file=Table((0.0, 20.0, 20.0, 40.0), (8.0, 8.0, -8.0, -8.0)))
    stepper = Stepper(wheel(drives, speed=10.0))
    state = stepper.advance(1.0)
    assert (state.status, state.crank_speed) == (1, 20.0)
    assert "drives the speed back from both sides" in state.message
    assert state.time == pytest.approx(0.625, rel=1e-12)
    assert stepper.advance(0.5, load=10.0).crank_speed == pytest.approx(22.0, rel=1e-12)


def test_a_load_that_fails_says_where():
    def fails(t, theta, omega):
        return 1.0 if t < 0.1 else math.nan

    state = Stepper(wheel(Load(fails))).advance(0.5)
    assert (state.status, state.time) == (-1, 0.0)
    assert "torque[1]: fails gives nan at t = " in state.message


def test_a_step_that_takes_too_long_says_so(monkeypatch):
    monkeypatch.setattr(free, "_ALLOWED", 2000)
    stepper = Stepper(replace(COASTING, start=Start(angle=1.0, speed=0.0)))  # it swings
    before, state = stepper.state, stepper.advance(10.0)
    assert (state.status, state[:4]) == (-1, before[:4])
    assert state.message.startswith("the step is not taken: the 2000 evaluations")
    assert stepper.advance(1e-3).status == 0
