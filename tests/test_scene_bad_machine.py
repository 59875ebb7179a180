"""A bad key, number or machine in a scene gets one sentence."""

import pytest
from scene_texts import FREE, edited, refusal

KEYS = (
    "crank, rod, piston, run, layout, gas, fuel, gravity, friction, bearings, motion, start, "
    "torque, force, title, source"
)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        # keys
        ("title", '"a b" = 1\ntitle', f'"a b": unknown key; known keys are {KEYS}'),
        ("title", '"" = 1\ntitle', f'"": unknown key; known keys are {KEYS}'),
        ("radius", "radus", 'crank.radus: unknown key; did you mean "radius"?'),
        ("[gas]", "[gass]", 'gass: unknown key; did you mean "gas"?'),
        (
            "title",
            "wholly_different",
            f"wholly_different: unknown key; known keys are {KEYS}",
        ),
        (
            "coefficient",
            "coeficient",
            'torque[1].coeficient: unknown key; did you mean "coefficient"?',
        ),
        ("[run]", "[run]\nRtol = 1e-8", 'run.Rtol: unknown key; did you mean "rtol"?'),
        (
            'radius = "46 mm"',
            "",
            'crank.radius: this key is missing; give it, such as radius = "46 mm"',
        ),
        ("radius", "stroke", "crank.stroke: unknown key; give radius, half the stroke"),
        (
            'inertia = "0.02 kg m^2"',
            "",
            "crank.inertia: this key is missing; a free crank needs it, only a prescribed speed, "
            "[motion], does without",
        ),
        (
            'coefficient = "9.5e-5 N m s^2"',
            "",
            "torque[1].coefficient: this key is missing; give it, such as coefficient = "
            '"7.8e-4 N m s^2"',
        ),
        (
            '[rod]\nlength = "150 mm"',
            "",
            'rod: this key is missing; add [rod] with length, such as length = "153 mm"; it may '
            "have mass, center_of_mass, inertia",
        ),
        (
            "title",
            "gravity = 9.81\ntitle",
            "gravity: must be a table with acceleration, angle; 9.81 came",
        ),
        (
            "[rod]",
            "[[rod]]",
            "rod: must be a table with length, mass, center_of_mass, inertia; "
            '[{"length": "150 mm"}] came',
        ),
        (
            "[[torque]]",
            "[torque]",
            "torque: must be a list; write [[torque]]; a table with kind, coefficient came",
        ),
        # numbers and units
        ('"46 mm"', "1" + "0" * 400, f"crank.radius: must be finite; 1{'0' * 55} ... came"),
        ('"46 mm"', f"0x{'f' * 5000}", "crank.radius: must be finite; a huge number came"),
        ('"46 mm"', "nan", "crank.radius: must be finite; nan came"),
        ('"46 mm"', "-inf", "crank.radius: must be finite; -inf came"),
        (
            '"46 mm"',
            "true",
            'crank.radius: must be one number and one unit, such as "46 mm"; true came',
        ),
        (
            '"46 mm"',
            "[1]",
            'crank.radius: must be one number and one unit, such as "46 mm"; [1] came',
        ),
        (
            '"46 mm"',
            "2020-01-01",
            'crank.radius: must be one number and one unit, such as "46 mm"; 2020-01-01 came',
        ),
        ('"46 mm"', '"-46 mm"', 'crank.radius: must be above 0; "-46 mm" came'),
        ('"46 mm"', '"0 mm"', 'crank.radius: must be above 0; "0 mm" came'),
        (
            '"46 mm"',
            '"46 kg"',
            'crank.radius: "46 kg" is no length here: use m, cm, mm or in',
        ),
        ('"46 mm"', '"1e308 km"', 'crank.radius: must be finite; "1e308 km" came'),
        (
            '"46 mm"',
            '"1,5 mm"',
            'crank.radius: "1,5 mm" is not a quantity: write one number and one unit, such as '
            '"46 mm"; the decimal sign is a point',
        ),
        ('"1.14 kg"', '"-1 kg"', 'piston.mass: must be at least 0; "-1 kg" came'),
        ('"0.02 kg m^2"', '"-1 kg m^2"', 'crank.inertia: must be at least 0; "-1 kg m^2" came'),
        ('"0 deg"', "90", 'start.angle: needs a unit, such as "30 deg"; 90 came'),
        ('"3200 rpm"', "335.1", 'start.speed: needs a unit, such as "3200 rpm"; 335.1 came'),
        (
            '"3200 rpm"',
            '"3200 kg"',
            'start.speed: "3200 kg" is no angular speed here: use rpm, rad/s or deg/s',
        ),
        (
            '"3200 rpm"',
            '"53 Hz"',
            'start.speed: "53 Hz" is no angular speed here: use rpm, rad/s or deg/s',
        ),
        (
            '"3200 rpm"',
            '{ mean = "3200 rpm" }',
            'start.speed: must be one number and one unit, such as "3200 rpm"; a table with mean '
            "came",
        ),
        ('"one cylinder"', "1", "title: must be a text in quotes; 1 came"),
        # the machine
        (
            '"150 mm"',
            '"40 mm"',
            "rod.length must be at least crank.radius + |piston.offset| = 0.046 m, or the crank "
            "cannot turn; 0.04 m came",
        ),
        (
            '"46 mm"',
            "46",
            "rod.length must be at least crank.radius + |piston.offset| = 46 m, or the crank "
            'cannot turn; 0.15 m came; a bare number is in metres, give "46 mm" where that is '
            "meant",
        ),
        (
            'area = "57 cm^2"',
            'offset = "-105 mm"\narea = "57 cm^2"',
            "rod.length must be at least crank.radius + |piston.offset| = 0.151 m, or the crank "
            "cannot turn; 0.15 m came",
        ),
        (
            'area = "57 cm^2"',
            "",
            "piston.bore: with [gas] the piston needs its bore, or its area; neither came",
        ),
        (
            'area = "57 cm^2"',
            'area = 1\nbore = "8 cm"',
            "piston: give bore or area, not both; both came",
        ),
        (
            '"0.02 kg m^2"',
            '1e-3\nmass = "5 kg"\ncenter_of_mass = "-20 mm"',
            "crank: inertia about the crank axis must be at least mass * center_of_mass^2 = 0.002 "
            "kg m^2; 0.001 came",
        ),
        (
            '"0.02 kg m^2"',
            "0",
            "crank.inertia: a free crank needs an inertia above 0, or nothing resists it at the "
            "dead centres; 0 came",
        ),
        (
            '"150 mm"',
            '"150 mm"\ninertia = "two mass"',
            'rod.inertia: must be "two-mass"; "two mass" came; did you mean "two-mass"?',
        ),
        ('"150 mm"', '"150 mm"\ninertia = -1', "rod.inertia: must be at least 0; -1 came"),
        (
            '"150 mm"',
            '"150 mm"\nmass = 1\ncenter_of_mass = "-1 cm"\ninertia = "two-mass"',
            'rod: two masses at its pins, by inertia = "two-mass" and in the lectures, need a '
            "center_of_mass between the pins, 0 to 0.15 m; "
            "-0.01 m came",
        ),
        # the cylinders
        *[
            ("[gas]", f"[layout]\n{layout}\n[gas]", f"layout{message}")
            for layout, message in [
                (
                    "firing_order = [1, 3, 3]",
                    ": firing_order must name each of the cylinders 1 to 3 once; [1, 3, 3] came",
                ),
                (
                    "firing_order = [0, 1]",
                    ": firing_order must name each of the cylinders 1 to 2 once; [0, 1] came",
                ),
                ("firing_order = []", ".firing_order: must have at least 1 entry; [] came"),
                ("firing_order = 4", ".firing_order: must be a list; 4 came"),
                ("firing_order = [1.0]", ".firing_order[1]: must be a whole number; 1.0 came"),
                ("firing_order = [true]", ".firing_order[1]: must be a whole number; true came"),
                ("cylinders = []", ".cylinders: must have at least 1 entry; [] came"),
                (
                    "cylinders = [1]",
                    ".cylinders[1]: must be a table with phase, bank, position, throw, radius, "
                    "rod, piston; 1 came",
                ),
                (
                    "cylinders = [{ phase = 90 }]",
                    '.cylinders[1].phase: needs a unit, such as "30 deg"; 90 came',
                ),
                (
                    'cylinders = [{ fase = "0 deg" }]',
                    '.cylinders[1].fase: unknown key; did you mean "phase"?',
                ),
                ("", ": give firing_order or cylinders, exactly one of the two; neither came"),
                (
                    "firing_order = [1]\ncylinders = [{}]",
                    ": give firing_order or cylinders, exactly one of the two; both came",
                ),
            ]
        ],
        # gravity
        (
            "[gas]",
            '[gravity]\nacceleration = "-1 m/s^2"\n[gas]',
            'gravity.acceleration: must be at least 0; "-1 m/s^2" came',
        ),
        (
            "title",
            "[[[",
            "not valid TOML: Invalid initial character for a key part (at line 2, column 3)"
            "; crankmbs new NAME writes a scene to compare with",
        ),
        (
            '"46 mm"',
            '"46 mm"\nradius = 1',
            "not valid TOML: Cannot overwrite a value (at line 6, column 11)"
            "; radius is given twice in its table, leave one of the two out",
        ),
    ],
)
def test_a_bad_value_gets_one_sentence(read, old, new, message):
    assert refusal(read, edited(FREE, old, new)) == message


@pytest.mark.parametrize("value", ["46 mm", "1" * 5000, "[" * 100_000, "'46 mm", "1__0"])
def test_what_toml_cannot_hold(read, value):
    assert refusal(read, edited(FREE, '"46 mm"', value)).startswith("not valid TOML: ")


@pytest.mark.parametrize("bare", ["46 mm", "46mm", "-4.6e-2 m"])
@pytest.mark.parametrize("end", ["", "  # of the throw"])
def test_a_quantity_without_its_quotes(read, bare, end):
    message = refusal(read, edited(FREE, '"46 mm"', bare + end))
    assert message.startswith("not valid TOML: ")
    assert message.endswith(f'; a quantity with a unit is written in quotes, here "{bare}"')


def test_a_quantity_without_its_quotes_in_braces(read):
    message = refusal(read, edited(FREE, '"46 mm"', '{ value = 46 mm, of = "it" }'))
    assert message.endswith('is written in quotes, here "46 mm"')


def test_a_rod_shorter_than_the_crank_is_said_before_its_centre_of_mass(read):
    rod = '"45 mm"\nmass = 1\ncenter_of_mass = "46 mm"\ninertia = "two-mass"'
    message = refusal(read, edited(FREE, '"150 mm"', rod))
    assert message.startswith("rod.length must be at least crank.radius + |piston.offset| = 0.046")
