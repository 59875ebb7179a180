"""Bad [gas] in a scene gets one sentence."""

import pytest
from scene_texts import FREE, GAS, INDICATED, edited, refusal


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        # the gas
        (
            "absolute = false",
            "",
            "gas: an absolute pressure needs ambient, the crankcase side; give ambient = "
            '"1 bar", or absolute = false when the file is gauge',
        ),
        (
            "absolute = false",
            'absolute = false\nambient = "1 bar"',
            "gas: a gauge pressure has its ambient subtracted already; remove ambient, or give "
            "absolute = true",
        ),
        ("absolute = false", 'absolute = "no"', 'gas.absolute: must be true or false; "no" came'),
        ("absolute = false", "absolute = false\nstroke = 3", "gas.stroke: must be 2 or 4; 3 came"),
        (
            "absolute = false",
            "absolute = false\nstroke = 2",
            "gas: gas.csv: the rows span 480 degrees, more than the period of 360; check stroke, 2 "
            'came, or for a file of several cycles give cycles = "mean" or "sequence"',
        ),
        (
            "absolute = false",
            'absolute = false\ninterpolation = "cubik"',
            'gas.interpolation: must be "pchip", "linear", "cubic" or "step"; "cubik" came; did '
            'you mean "cubic"?',
        ),
        (
            "absolute = false",
            'absolute = false\ninterpolation = "spline"',
            'gas.interpolation: must be "pchip", "linear", "cubic" or "step"; "spline" came',
        ),
        (
            "absolute = false",
            'absolute = false\nzero = "tdc"',
            'gas.zero: must be "gas_exchange_tdc" or "firing_tdc"; "tdc" came',
        ),
        (
            '"gas.csv"',
            '"gaz.csv"',
            "gas.pressure: file gaz.csv is missing; paths are relative to the scene file",
        ),
        (
            '"gas.csv"',
            "true",
            "gas.pressure: must be the name of a CSV file, a list of them, or a pressure such as "
            '"1 bar"; true came',
        ),
        (
            'pressure = "gas.csv"',
            "",
            "gas: give pressure or indicator, exactly one of the two; neither came",
        ),
    ],
)
def test_a_bad_gas_gets_one_sentence(read, old, new, message):
    assert refusal(read, edited(FREE, old, new)) == message


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0,1\n", "a pressure table needs at least two rows"),
        (
            "0,1\n90,1\n45,2\n400,1\n",
            "crank angles must not decrease (two rows at one angle are a jump); in row 3 45 "
            "follows 90 degrees",
        ),
        (
            "0,1\n90,1\n90,2\n90,3\n400,1\n",
            "rows 2 to 4 all stand at 90 degrees; give two, a jump from the first pressure to the "
            "second",
        ),
        (
            "0,1\n90,1\n90.00000003,2\n400,1\n",
            "rows 2 and 3 lie 3e-08 degrees apart, too near to be told apart; give both the same "
            "angle for a jump, or drop one",
        ),
        (
            "0,1\n300,1\n721,1\n",
            "the rows span 721 degrees, more than the period of 720; check stroke, 4 came, or for "
            'a file of several cycles give cycles = "mean" or "sequence"',
        ),
        (
            "0,1\n300,1\n720,2\n",
            "the closing row, at 720 degrees, must equal the first one, as the pressure is "
            "periodic; it lies 1 bar from it, more than 0.01 bar (1 % of the range); drop the row, "
            "raise closing, or give two rows at 720 degrees for a jump",
        ),
        (
            "0,1\n361,1\n600,2\n",
            "a gap of 361 degrees without a row; the table must span the cycle of 720 degrees with "
            "no gap above its half",
        ),
        (
            "0,1\n180,1\n359,2\n",
            "a gap of 361 degrees without a row; the table must span the cycle of 720 degrees with "
            "no gap above its half; give stroke = 2 where the rows are those of a two-stroke cycle",
        ),
        (
            "0,1\n180,3\n360,1\n",
            "the rows close after 360 degrees, as a two-stroke cycle does; give stroke = 2, or the "
            "other half of the four-stroke cycle",
        ),
    ],
)
def test_a_bad_pressure_table(read, tmp_path, rows, message):
    (tmp_path / "bad.csv").write_text("crank_angle_deg,pressure_bar\n" + rows)
    assert refusal(read, edited(FREE, "gas.csv", "bad.csv")) == f"gas: bad.csv: {message}"


@pytest.mark.parametrize(
    "rows",
    [
        "0,1\n360,2\n",  # gaps of exactly half the period
        "0,1\n360,2\n720,1\n",  # a closing row
        "0,1\n360,2\n720,1.01\n",  # one as near as a measured cycle comes
        "0,1\n90,2\n90,3\n400,1\n",  # a jump
        "-180,1\n180,2\n",  # any start
        "500,1\n860,2\n1220,1\n",
    ],
)
def test_a_good_pressure_table(read, tmp_path, rows):
    (tmp_path / "good.csv").write_text("crank_angle_deg,pressure_bar\n" + rows)
    assert read(edited(FREE, "gas.csv", "good.csv")).gas.pressure.y[1] == 2e5


@pytest.mark.parametrize(
    ("name", "factor"),
    [("bar", 1e5), ("kPa", 1e3), ("Pa", 1.0), ("MPa", 1e6), ("kgf_cm2", 98066.5)],
)
def test_pressure_columns(read, tmp_path, name, factor):
    (tmp_path / "gas.csv").write_text(GAS.replace("bar", name))
    assert read(FREE).gas.pressure.y == (factor, 2.0 * factor, 3.0 * factor)


def test_an_absolute_pressure_cannot_be_negative(read, tmp_path):
    (tmp_path / "bad.csv").write_text(GAS.replace("240,2", "240,-2"))
    absolute = edited(edited(FREE, "gas.csv", "bad.csv"), "absolute = false", 'ambient = "1 bar"')
    assert refusal(read, absolute) == (
        "gas: bad.csv: an absolute pressure cannot be negative; -200000 Pa came at 240 degrees; "
        "correct what the pressures are measured from, or give absolute = false when the file is "
        "gauge"
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("= 10", "= 1", ".indicator.compression_ratio: must be above 1; 1 came"),
        ("= 10", '= "10"', '.indicator.compression_ratio: must be a number; "10" came'),
        ("= 1.3", "= 0", ".indicator.n_compression: must be above 0; 0 came"),
        ("n_expansion", "n_exp", '.indicator.n_exp: unknown key; did you mean "n_expansion"?'),
        ('"1.1 bar"', '"-1 bar"', '.indicator.exhaust_pressure: must be above 0; "-1 bar" came'),
        (
            'exhaust_pressure = "1.1 bar"',
            "",
            ": indicator: a four-stroke cycle needs its exhaust_pressure; none came",
        ),
        (
            '"50 bar"',
            '"19 bar"',
            ".indicator: peak_pressure must be at least what compression reaches, intake_pressure "
            "* compression_ratio^n_compression = 19.9526 bar; 19 bar came",
        ),
        (
            "= 10",
            "= 10\npre_expansion = 0.9",
            ".indicator.pre_expansion: must be at least 1; 0.9 came",
        ),
        (
            "= 10",
            "= 10\npre_expansion = 10",
            ".indicator: pre_expansion must be below the compression_ratio 10, or nothing is left "
            "to expand; 10 came",
        ),
        (
            'ambient = "1 bar"',
            "absolute = false",
            ": an indicator diagram is absolute; remove absolute = false",
        ),
        (
            'ambient = "1 bar"',
            'ambient = "1 bar"\ninterpolation = "cubic"',
            ": zero, interpolation, closing and cycles belong to a pressure file; remove them "
            "beside an indicator",
        ),
        (
            'ambient = "1 bar"',
            'ambient = "1 bar"\nclosing = "0.1 bar"',
            ": zero, interpolation, closing and cycles belong to a pressure file; remove them "
            "beside an indicator",
        ),
        (
            'ambient = "1 bar"',
            'ambient = "1 bar"\npressure = "gas.csv"',
            ": give pressure or indicator, exactly one of the two; both came",
        ),
    ],
)
def test_a_bad_indicator_diagram(read, old, new, message):
    assert refusal(read, edited(INDICATED, old, new)) == f"gas{message}"


def test_a_two_stroke_cycle_needs_no_exhaust_pressure(read):
    two = edited(INDICATED, 'exhaust_pressure = "1.1 bar"', "")
    assert read(edited(two, 'ambient = "1 bar"', 'ambient = "1 bar"\nstroke = 2')).gas.stroke == 2


def test_a_folder_is_no_pressure_table(read):
    assert refusal(read, edited(FREE, '"gas.csv"', '""')).endswith("cannot be read: Is a directory")
