"""What is no formula is refused, in a sentence that says the way out."""

import dataclasses
import math

import numpy as np
import pytest

from crankmbs import InputError, Run, compare, load_scene, simulate
from crankmbs.compare import LECTURES

*_, S1 = LECTURES


@pytest.fixture(scope="module")
def four():
    """Four cylinders, their speed free: 721 samples of the last cycle."""
    scene = load_scene("yi_diesel_free")
    return simulate(dataclasses.replace(scene, run=Run(until="2 cycles")))


@pytest.fixture(scope="module")
def coasting():
    """One cylinder without gas."""
    return simulate(dataclasses.replace(load_scene("coasting"), run=Run(until="1 rev")))


def named_g(function):
    function.__name__ = "torque_g"
    return {"g": function}


@pytest.mark.parametrize(
    ("formulas", "message"),
    [
        (2, r'must be functions by their labels, such as \{"my series": function\}; 2 came'),
        ({3: lambda phi: phi}, "label must be a text; 3 came"),
        ({"torque": 7}, "torque: must be a function; 7 came"),
        ({"run": lambda phi: phi}, "run: this is what another curve is called; choose another"),
        ({S1: lambda phi: phi}, "choose another label"),
        ({"mine": lambda phi: phi}, 'mine: .* "<lambda>" names none; there are piston displ'),
        ({"tork": lambda phi: phi}, 'names none; did you mean "torque"'),
        (named_g(lambda ph: ph), 'the parameter ph of torque_g is nothing .*; did you mean "phi"'),
        (named_g(lambda xyz: xyz), "xyz of torque_g is nothing it can be given; there are theta,"),
        (
            named_g(lambda crank_angle: 0),
            "crank_angle of torque_g .*; ask for theta, or for phi, of",
        ),
        (named_g(lambda phi, /: phi), "phi of torque_g must be given by name; leave out the /"),
        ({"torque": max}, "torque: the parameters of max cannot be read; put it into a func"),
        (named_g(lambda phi: phi[:-1]), r"must give \d+ numbers, one .* of shape \(\d+,\) came$"),
        (named_g(lambda phi: np.log(phi - 1e3)), r"finite numbers; nan came at \d+ of \d+ samp"),
        (named_g(lambda phi: 1.0 / (0.0 * phi)), "at theta = .* rad; give there what the formula"),
        (named_g(lambda phi: None), "torque_g must give real numbers; None came"),
        (named_g(lambda phi: "a"), 'must give real numbers; "a" came'),
        (named_g(lambda phi: 1j * phi), "must give real numbers; an array of shape"),
        (
            named_g(lambda phi: {}[1]),
            r"g: torque_g raises KeyError: 1; it is called with phi of sh",
        ),
        (
            {"frame force x": lambda phi: phi},
            r"of shape \(\d+, 4\) came; take every cylinder's values together, such as np.sum",
        ),
        ({"fluctuation": lambda phi: phi}, "the fluctuation is one finite number; an array of sh"),
        ({"fluctuation": lambda: math.nan}, "the fluctuation is one finite number; nan came"),
    ],
)
def test_what_is_no_formula_is_refused_in_a_sentence(four, formulas, message):
    with pytest.raises(InputError, match=message):
        compare(four, formulas)


def test_a_number_that_the_scene_does_not_have_is_named(coasting):
    with pytest.raises(InputError, match=r"piston_area: the scene has neither piston.bore nor"):
        compare(coasting, {"torque": lambda piston_area: piston_area})
    scene = dataclasses.replace(load_scene("yi_diesel"), run=Run(until="1 rev"))
    with pytest.raises(InputError, match=r"start_omega: the scene has no \[start\], so that"):
        compare(simulate(scene), {"torque": lambda start_omega: start_omega})
