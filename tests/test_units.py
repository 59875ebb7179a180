"""Quantity strings: what is read, and what is refused and how."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import constants

from crankmbs.errors import InputError, shown
from crankmbs.scene.unit_table import PREFIXES, UNITS, factor
from crankmbs.scene.units import EXAMPLES, extent, quantity


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("46 mm", "length", 0.046),
        ("46mm", "length", 0.046),
        (" +.5e1  cm ", "length", 0.05),
        ("-1.2972 mm", "length", -1.2972e-3),
        ("1. m", "length", 1.0),
        ("5 µm", "length", 5e-6),
        ("5 \N{GREEK SMALL LETTER MU}m", "length", 5e-6),
        ("2 dam", "length", 20.0),
        ("3 daN m", "torque", 30.0),
        ("3 pm", "length", 3e-12),
        ("20 Nm", "torque", 20.0),
        ("2 kNm", "torque", 2000.0),
        ("2 N\N{DOT OPERATOR}m", "torque", 2.0),
        ("9.81 m s⁻²", "acceleration", 9.81),
        ("2 m/s / s", "acceleration", 2.0),
        ("2 m/s s", "length", 2.0),  # from the left
        ("2 lb in^2", "inertia", 2.0 * 0.45359237 * 0.0254**2),
        ("3 N m/rpm", "viscous coefficient", 90.0 / math.pi),
        ("2 PS", "power", 2.0 * 75.0 * 9.80665),
        ("2 min", "time", 120.0),
        ("2 in", "length", 0.0508),
        ("5.8422e-3 kg m^2", "inertia", 5.8422e-3),
        ("5.8422e-3 kg*m**2", "inertia", 5.8422e-3),
        ("5 kg·m²", "inertia", 5.0),
        ("57.08 cm^2", "area", 57.08e-4),
        ("1 kgf/cm^2", "pressure", 98066.5),
        ("1 bar", "pressure", 1e5),
        ("7.775e-4 N m s^2", "quadratic coefficient", 7.775e-4),
        ("0.26 N m s/rad", "viscous coefficient", 0.26),
        ("2 kN m", "torque", 2000.0),
        ("9.81 m/s^2", "acceleration", 9.81),
        ("9.81 m s^-2", "acceleration", 9.81),
        ("180 deg", "angle", math.pi),
        ("0.3 rad", "angle", 0.3),
        ("0.25 rev", "angle", math.pi / 2.0),
        ("30 rpm", "angular speed", math.pi),
        ("335.1 rad/s", "angular speed", 335.1),
        ("180 deg/s", "angular speed", math.pi),
        ("750 ms", "time", 0.75),
        ("3 kg", "mass", 3.0),
    ],
)
def test_quantity(text, dimension, value):
    assert quantity(text, dimension) == pytest.approx(value, rel=4e-16)


@pytest.mark.parametrize("dimension", sorted(set(EXAMPLES) - {"extent"}))
def test_every_example_is_read(dimension):
    assert quantity(EXAMPLES[dimension].strip('"'), dimension) > 0.0


NOT_A_QUANTITY = 'is not a quantity: write one number and one unit, such as "46 mm"'


@pytest.mark.parametrize(
    ("text", "rest"),
    [
        ("mm", NOT_A_QUANTITY),
        ("", NOT_A_QUANTITY),
        ("46", NOT_A_QUANTITY),
        ("9**9**9 mm", NOT_A_QUANTITY),
        ("2*3 mm", NOT_A_QUANTITY),
        ("(46) mm", NOT_A_QUANTITY),
        ("46 mm\n", NOT_A_QUANTITY),
        ("0x10 mm", "is no length here"),
        ("1e mm", "is no length here"),
        ("1 000 mm", "is no length here"),
        ("1_000 mm", NOT_A_QUANTITY),
        ("nan mm", NOT_A_QUANTITY),
        ("inf mm", NOT_A_QUANTITY),
        ("1,5 mm", f"{NOT_A_QUANTITY}; the decimal sign is a point"),
        ("\N{MINUS SIGN}5 mm", f'{NOT_A_QUANTITY}; the minus sign is the plain "-"'),
        ("\N{EN DASH}5 mm", f'{NOT_A_QUANTITY}; the minus sign is the plain "-"'),
        ("46 m m", "is no length here"),
        ("46 mm^2", "is no length here: use m, cm, mm or in"),
        ("46 ft in", "is no length here"),
        ("46 pt", "is no length here"),  # pico only of what has prefixes
        ("46 kkm", "is no length here"),
        ("46 Km", "is no length here"),
        ("46 m/", "is no length here"),
        ("46 /m", "is no length here"),
        ("46 mm 3", "is no length here"),
        ("46 mm + 3 mm", "is no length here"),
        ("46 m^9^9^9", "is no length here"),
        ("46 m**9**9**9", "is no length here"),
        ("46 km²²²²²²²²²", "is no length here"),
        ("46 m^10", "is no length here"),
        ("46 ²", "is no length here"),
        ("46 furlongs_per", "is no length here"),
        ("46 nan m", "is no length here"),
        ("46 lambda", "is no length here"),
        ("46 __import__", "is no length here"),
        ("3200 kg", "is no length here"),
    ],
)
def test_length_refused(text, rest):
    with pytest.raises(InputError) as caught:
        quantity(text, "length")
    assert str(caught.value).startswith(f"{shown(text)} {rest}")


@pytest.mark.parametrize("text", ["1e999 mm", "-1e999 mm"])
def test_beyond_the_largest_float(text):
    with pytest.raises(InputError, match=r"^must be finite; .* came$"):
        quantity(text, "length")


@pytest.mark.parametrize(
    "text", ["50 Hz", "3200 1/min", "3200 rev/min", "3200 / min", "3200 RPM", "1 cycle", "3 kg"]
)
def test_angular_speed_takes_three_units(text):
    with pytest.raises(InputError) as caught:
        quantity(text, "angular speed")
    assert str(caught.value) == (f'"{text}" is no angular speed here: use rpm, rad/s or deg/s')


def test_a_number_glued_to_a_slash_is_no_quantity():
    with pytest.raises(InputError, match="is not a quantity"):
        quantity("1/min", "angular speed")


@pytest.mark.parametrize("text", ["1 cycle", "1 turn", "30 °C", "30 mm", "30 degrees"])
def test_angle_takes_three_units(text):
    with pytest.raises(InputError, match=r"is no angle here: use rad, deg or rev$"):
        quantity(text, "angle")


@pytest.mark.parametrize("text", ["30°", "30 °", "+30.0°"])
def test_a_degree_sign_is_deg(text):
    assert quantity(text, "angle") == quantity("30 deg", "angle")
    assert quantity(text + "/s", "angular speed") == quantity("30 deg/s", "angular speed")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("20 cycles", (20.0, "cycle")),
        ("1 cycle", (1.0, "cycle")),
        ("10 rev", (20.0 * math.pi, "rad")),
        ("180 deg", (math.pi, "rad")),
        ("3 rad", (3.0, "rad")),
        ("0.75 s", (0.75, "s")),
        ("75 ms", (0.075, "s")),
        ("1 min", (60.0, "s")),
    ],
)
def test_extent(text, expected):
    assert extent(text) == pytest.approx(expected)


@pytest.mark.parametrize("text", ["20 mm", "20 turns", "20 Hz"])
def test_extent_refused(text):
    with pytest.raises(InputError) as caught:
        extent(text)
    assert str(caught.value) == f'"{text}" is no angle or time: use cycles, rev, deg, rad or s'


def test_a_huge_string_is_refused_at_once_and_cut():
    with pytest.raises(InputError) as caught:
        quantity("1 " + "m " * 1_000_000, "length")
    assert len(str(caught.value)) < 200


@pytest.mark.slow
@given(st.text(max_size=30), st.sampled_from(sorted(EXAMPLES)))
def test_any_text_is_a_number_or_an_input_error(text, dimension):
    read = extent if dimension == "extent" else lambda given: (quantity(given, dimension),)
    outcome: float | str
    try:
        outcome = read(text)[0]
    except InputError as error:
        outcome = str(error)
    assert isinstance(outcome, float) or "\n" not in outcome


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (True, "true"),
        (math.nan, "nan"),
        (-math.inf, "-inf"),
        ('a "b"\n', r'"a \"b\"\n"'),
        (46, "46"),
        ([1, 2], "[1, 2]"),
        ({"a": 1, "b": 2}, "a table with a, b"),
        ({}, "an empty table"),
    ],
)
def test_shown_as_a_scene_file_writes_it(value, expected):
    assert shown(value) == expected


@pytest.mark.parametrize("value", ["x" * 1000, list(range(1000)), {"k" * 1000: 1}, 10**100])
def test_shown_is_cut(value):
    assert len(shown(value)) <= 60


SCIPY = {
    "g": constants.gram,
    "bar": constants.bar,
    "t": 1e3 * constants.kilo * constants.gram,
    "min": constants.minute,
    "h": constants.hour,
    "kp": constants.kgf,
    "kgf": constants.kgf,
    "at": constants.kgf / constants.centi**2,
    "atm": constants.atm,
    "Torr": constants.torr,
    "PS": 75.0 * constants.kgf,
    "deg": constants.degree,
    "rev": 360.0 * constants.degree,
    "rpm": 360.0 * constants.degree / constants.minute,
    "in": constants.inch,
    "inch": constants.inch,
    "ft": constants.foot,
    "oz": constants.oz,
    "lb": constants.pound,
    "slug": constants.slug,
    "lbf": constants.lbf,
    "psi": constants.psi,
    "hp": constants.hp,
}
OF = {
    **dict.fromkeys(["g", "t", "oz", "lb", "slug"], "kg"),
    **dict.fromkeys(["N", "kp", "kgf", "lbf"], "kg m/s^2"),
    **dict.fromkeys(["Pa", "bar", "at", "atm", "Torr", "psi"], "kg/m s^-2"),
    **dict.fromkeys(["J", "Nm"], "kg m^2 s^-2"),
    **dict.fromkeys(["W", "PS", "hp"], "kg m^2/s^3"),
    **dict.fromkeys(["min", "h"], "s"),
    **dict.fromkeys(["in", "inch", "ft"], "m"),
    **dict.fromkeys(["deg", "rev"], "rad"),
    "rpm": "s^-1",
}


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_is_what_scipy_has(unit):
    assert factor(unit, OF[unit]) == pytest.approx(SCIPY.get(unit, 1.0), rel=1e-15)


@pytest.mark.parametrize("prefix", PREFIXES)
def test_a_prefix_is_what_scipy_has(prefix):
    names = {"P": "peta", "T": "tera", "G": "giga", "M": "mega", "k": "kilo", "h": "hecto"}
    names |= {"da": "deka", "d": "deci", "c": "centi", "m": "milli", "n": "nano", "p": "pico"}
    assert PREFIXES[prefix] == getattr(constants, names.get(prefix, "micro"))
    assert factor(f"{prefix}s", "s") == PREFIXES[prefix]


@pytest.mark.parametrize("dimension", sorted(set(EXAMPLES) - {"extent"}))
def test_the_units_that_a_refusal_names_are_read(dimension):
    with pytest.raises(InputError) as caught:
        quantity("1 furlong", dimension)
    _, _, units = str(caught.value).partition(": use ")
    for unit in re.split(", | or ", units):
        assert quantity(f"1 {unit}", dimension) > 0.0
