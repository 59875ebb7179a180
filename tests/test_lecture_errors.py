"""The errors and orders stated in the docstrings, measured again."""

import inspect
import re
from decimal import Decimal

import numpy as np
import pytest

from crankmbs import lecture

RATIOS = (0.20, 0.25, 0.30, 0.33)
OFFSET = 0.0282
ANGLES = np.linspace(0.0, 2.0 * np.pi, 14401)


def rod(ratio, k):
    return {"crank_radius": 1.0, "rod_length": 1.0 / ratio, "offset": k}


def central(ratio):
    return {"crank_radius": 1.0, "rod_length": 1.0 / ratio}


def over_a_revolution(series, exact):
    return lambda ratio, k: np.max(np.abs(series(ratio, k) - exact(ratio, k)))


def tangential(ratio, k):
    force = lecture.rod_force(ANGLES, net_force=1.0, **rod(ratio, k))
    return lecture.tangential_force(ANGLES, rod_force=force, **rod(ratio, k))


def radial(ratio, k):
    force = lecture.rod_force(ANGLES, net_force=1.0, **rod(ratio, k))
    return lecture.radial_force(ANGLES, rod_force=force, **rod(ratio, k))


def acceleration(ratio, k):
    return lecture.piston_acceleration(ANGLES, omega=1.0, **rod(ratio, k))


def speed_error(ratio, k):
    guess = lecture.maximum_piston_speed_sqrt(omega=1.0, **central(ratio))
    strokes = [lecture.maximum_piston_speed(omega=1.0, **rod(ratio, side)) for side in (k, -k)]
    return max(abs(guess / speed - 1.0) for speed in strokes)


def quarter_error(ratio, k):
    exact = lecture.piston_displacement(np.arange(4) * 0.5 * np.pi, **rod(ratio, k))
    return np.max(np.abs(lecture.quarter_displacements_series(**central(ratio)) - exact))


GAS = {"piston_area": 1.0, "clearance_volume": 0.1}
MEASURED = {
    "cos_beta_series": over_a_revolution(
        lambda ratio, k: lecture.cos_beta_series(ANGLES, **central(ratio)),
        lambda ratio, k: lecture.cos_beta(ANGLES, **rod(ratio, k)),
    ),
    "secant_beta_series": over_a_revolution(
        lambda ratio, k: lecture.secant_beta_series(ANGLES, **central(ratio)),
        lambda ratio, k: 1.0 / lecture.cos_beta(ANGLES, **rod(ratio, k)),
    ),
    "tan_beta_series": over_a_revolution(
        lambda ratio, k: lecture.tan_beta_series(ANGLES, **rod(ratio, k)),
        lambda ratio, k: lecture.tan_beta(ANGLES, **rod(ratio, k)),
    ),
    "piston_displacement_series": over_a_revolution(
        lambda ratio, k: lecture.piston_displacement_series(ANGLES, **rod(ratio, k)),
        lambda ratio, k: lecture.piston_displacement(ANGLES, **rod(ratio, k)),
    ),
    "piston_velocity_series": over_a_revolution(
        lambda ratio, k: lecture.piston_velocity_series(ANGLES, omega=1.0, **rod(ratio, k)),
        lambda ratio, k: lecture.piston_velocity(ANGLES, omega=1.0, **rod(ratio, k)),
    ),
    "piston_acceleration_series": over_a_revolution(
        lambda ratio, k: lecture.piston_acceleration_series(ANGLES, omega=1.0, **rod(ratio, k)),
        acceleration,
    ),
    "inertia_force_series": over_a_revolution(
        lambda ratio, k: lecture.inertia_force_series(
            ANGLES, reciprocating_mass=1.0, omega=1.0, **rod(ratio, k)
        ),
        lambda ratio, k: lecture.inertia_force(
            reciprocating_mass=1.0, piston_acceleration=acceleration(ratio, k)
        ),
    ),
    "side_thrust_series": over_a_revolution(
        lambda ratio, k: lecture.side_thrust_series(ANGLES, net_force=1.0, **rod(ratio, k)),
        lambda ratio, k: lecture.side_thrust(ANGLES, net_force=1.0, **rod(ratio, k)),
    ),
    "rod_force_series": over_a_revolution(
        lambda ratio, k: lecture.rod_force_series(ANGLES, net_force=1.0, **central(ratio)),
        lambda ratio, k: lecture.rod_force(ANGLES, net_force=1.0, **rod(ratio, k)),
    ),
    "tangential_force_series": over_a_revolution(
        lambda ratio, k: lecture.tangential_force_series(ANGLES, net_force=1.0, **rod(ratio, k)),
        tangential,
    ),
    "radial_force_series": over_a_revolution(
        lambda ratio, k: lecture.radial_force_series(ANGLES, net_force=1.0, **rod(ratio, k)),
        radial,
    ),
    "cylinder_volume_series": over_a_revolution(
        lambda ratio, k: lecture.cylinder_volume_series(ANGLES, **GAS, **rod(ratio, k)),
        lambda ratio, k: lecture.cylinder_volume(ANGLES, **GAS, **rod(ratio, k)),
    ),
    "quarter_displacements_series": quarter_error,
    "maximum_piston_speed_sqrt": speed_error,
    "brix_correction_series": lambda ratio, k: abs(
        lecture.brix_correction_series(**central(ratio)) / lecture.brix_correction(**central(ratio))
        - 1.0
    ),
    "stroke_central": lambda ratio, k: (
        1.0 - lecture.stroke_central(crank_radius=1.0) / lecture.stroke(**rod(ratio, k))
    ),
    "top_dead_centre": lambda ratio, k: np.degrees(lecture.top_dead_centre(**rod(ratio, k))),
    "bottom_dead_centre": lambda ratio, k: np.degrees(
        lecture.bottom_dead_centre(**rod(ratio, k)) - np.pi
    ),
    "acceleration_minimum_angle_series": lambda ratio, k: np.degrees(
        abs(
            lecture.acceleration_minimum_angle(rod_ratio=ratio)
            - lecture.acceleration_minimum_angle_series(rod_ratio=ratio)
        )
    ),
}

LINE = re.compile(
    r"rror of .+? at lambda 0\.20, 0\.25, 0\.30, 0\.33: (?P<central>[-\d.e, ]+?)"
    r"(?:; with k 0\.0282: (?P<offset>[-\d.e, ]+?)(?: \(order (?P<order>\d)\))?)?\.(?: |$)"
)


def doc(name):
    return " ".join(inspect.getdoc(getattr(lecture, name)).split())


def stated():
    """Every error of a docstring: function, rod ratio, relative offset, text of the number."""
    for name in MEASURED:
        line = LINE.search(doc(name))
        yield from (
            (name, *pair, 0.0) for pair in zip(RATIOS, line["central"].split(", "), strict=True)
        )
        if line["offset"]:
            pairs = zip(RATIOS, line["offset"].split(", "), strict=True)
            yield from ((name, *pair, OFFSET) for pair in pairs)


def orders():
    """Every order of a docstring: function, order, relative offset."""
    for name in MEASURED:
        if found := re.search(r"order (\d) in lambda", doc(name)):
            yield name, int(found[1]), 0.0
        if (line := LINE.search(doc(name))) and line["order"]:
            yield name, int(line["order"]), OFFSET


def agrees(text, value):
    """Whether a value rounds to a printed number; a printed 0 is exact."""
    half_digit = 0.5 * 10.0 ** Decimal(text).as_tuple().exponent
    return abs(value - float(text)) <= (half_digit if float(text) else 1e-14)


def test_every_stated_error_is_measured():
    has_error = {
        name for name in lecture.__all__ if "rror of" in (getattr(lecture, name).__doc__ or "")
    }
    has_order = {
        name for name in lecture.__all__ if "in lambda" in (getattr(lecture, name).__doc__ or "")
    }
    assert has_error == set(MEASURED)
    assert has_order <= has_error


def test_every_series_states_its_error_or_its_sum():
    for name in lecture.__all__:
        text = getattr(lecture, name).__doc__ or ""
        if "Approximate" in text:
            assert name in MEASURED or re.search(r"order it is `\w+_series`", text), name


@pytest.mark.parametrize(("name", "ratio", "text", "k"), [*stated()])
def test_stated_error(name, ratio, text, k):
    assert agrees(text, MEASURED[name](ratio, k)), f"{MEASURED[name](ratio, k):.4e}"


@pytest.mark.parametrize("text", ["1.02e-3", "0.27", "4.6e-2"])
def test_one_digit_more_is_noticed(text):
    digit = 10.0 ** Decimal(text).as_tuple().exponent
    assert agrees(text, float(text))
    assert not agrees(text, float(text) + digit)
    assert not agrees(text, float(text) - digit)


@pytest.mark.parametrize(("name", "order", "k"), [*orders()])
def test_stated_order(name, order, k):
    # With an offset its lower order rules only well below k.
    ladder = (0.08, 0.04, 0.02) if k == 0.0 else (0.008, 0.004, 0.002)
    errors = np.array([MEASURED[name](ratio, k) for ratio in ladder])
    before, last = np.log2(errors[:-1] / errors[1:])
    assert errors.min() > 1e-12
    assert before == pytest.approx(last, abs=0.2)
    assert last == pytest.approx(order, abs=0.1)
