"""[gas] reads a file as an indicating system writes it, where it is told how."""

import dataclasses

import pytest
from scene_texts import FREE, edited, refusal

from crankmbs import CylinderTable
from crankmbs.scene.write import scene_files

EXPORT = """Engine;OM 4
Crank Angle;PCYL1;PCYL2;PINT
deg;bar;bar;bar
-360,0;1,0;1,5;0,9
-120,0;2,0;2,5;0,9
120,0;3,0;3,5;0,9
"""


def given(lines):
    return edited(FREE, "absolute = false", f"absolute = false\n{lines}")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_column_is_read_by_its_name(read, tmp_path, encoding):
    (tmp_path / "gas.csv").write_text(EXPORT.replace("OM", "Ölmotor"), encoding=encoding)
    gas = read(given('columns = "PCYL2"')).gas
    assert gas.pressure.y == pytest.approx((1.5e5, 2.5e5, 3.5e5))
    assert gas.pressure.x == pytest.approx((-6.283185307179586, -2.0943951023931953, 2.0943951))


def test_a_range_of_columns_is_one_a_cylinder(read, tmp_path):
    (tmp_path / "gas.csv").write_text(EXPORT)
    layout = "[layout]\nfiring_order = [1, 2]\n\n[gas]"
    gas = read(edited(given('columns = "PCYL1..2"'), "[gas]", layout)).gas
    assert isinstance(gas.pressure, CylinderTable)
    assert gas.pressure.y[1] == pytest.approx((1.5e5, 2.5e5, 3.5e5))


def test_the_angle_is_read_by_its_name(read, tmp_path):
    rows = [f"{p};{angle};{angle}" for angle, p in ((-360, 1.0), (-120, 2.0), (120, 3.0))]
    (tmp_path / "gas.csv").write_text("\n".join(["p/bar;CA/rad;Position", *rows]))
    gas = read(given('columns = "p"\nangle = "position"')).gas
    assert gas.angle is None
    assert gas.pressure.x[0] == pytest.approx(-6.283185307179586)
    (tmp_path / "gas.csv").write_text("\n".join(["p/bar;;Position", *rows]))
    assert refusal(read, given('columns = "p"')) == (
        "gas.pressure: file gas.csv: no column is a crank angle by its name or its unit, and the "
        'first is a pressure; name it, such as angle = "CA"'
    )


def test_the_usual_headings_lead_to_columns(read, tmp_path):
    (tmp_path / "gas.csv").write_text("Angle/deg,Pressure/bar\n-360,1\n-120,2\n120,3\n")
    message = refusal(read, FREE)
    assert message == (
        "gas.pressure: file gas.csv: the header must name exactly one column crank_angle_deg, "
        'with commas between the columns; "Angle/deg,Pressure/bar" came; columns = "..." with the '
        "pressure's heading reads a file that has other headings or separators"
    )
    assert read(given('columns = "Pressure"')).gas.pressure.y == pytest.approx((1e5, 2e5, 3e5))


def test_what_says_how_to_read_is_done_with_reading(read, tmp_path):
    (tmp_path / "gas.csv").write_text(EXPORT)
    scene = read(given('columns = "PCYL1"\nseparator = ";"\ndecimal = ","\nskip = 1'))
    assert (scene.gas.columns, scene.gas.separator, scene.gas.skip) == (None, None, None)
    assert dataclasses.replace(scene.gas, closing=1.0).pressure == scene.gas.pressure
    for name, text in scene_files(scene, "again").items():
        (tmp_path / name).write_text(text)
    assert read((tmp_path / "again.toml").read_text()).gas.pressure.y == scene.gas.pressure.y


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (
            'columns = "PCYL9"',
            'gas.pressure: file gas.csv: no column is named "PCYL9"; the columns are Crank Angle, '
            'PCYL1, PCYL2, PINT; did you mean "PCYL2"?',
        ),
        (
            'columns = "PCYL4..1"',
            'gas.pressure: columns: a range goes up, as "PCYL1..4" does, over at most 10000 '
            'columns; "PCYL4..1" came',
        ),
        (
            'columns = "Crank Angle"',
            "gas.pressure: file gas.csv: no column of pressures; name some, such as columns = "
            '"PCYL1..4"',
        ),
        (
            'columns = "PCYL1"\nangle = "Crank Angel"',
            'gas.pressure: file gas.csv: no column is named "Crank Angel"; the columns are Crank '
            'Angle, PCYL1, PCYL2, PINT; did you mean "Crank Angle"?',
        ),
        ("columns = 3", "gas.columns: must be a text in quotes; 3 came"),
        (
            'separator = "semi"',
            'gas.separator: must be ";", ",", "|" or "tab", "blank"; "semi" came',
        ),
        ('decimal = "-"', 'gas.decimal: must be "." or ","; "-" came'),
        ("skip = -1", "gas.skip: must be at least 0; -1 came"),
    ],
)
def test_a_bad_way_to_read(read, tmp_path, lines, message):
    (tmp_path / "gas.csv").write_text(EXPORT)
    assert refusal(read, given(lines)) == message


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "deg;bar;bar;bar\n",
            "",
            'gas.pressure: file gas.csv: column "PCYL1" has no unit of pressure, neither in its '
            "name nor in a row below the names; crankmbs pressure reads it with --unit",
        ),
        (
            "2,0;2,5",
            "-9999;2,5",
            'gas.pressure: file gas.csv: column "PCYL1" has no number in row 2 below its '
            "headings; crankmbs pressure deals with missing cells",
        ),
        (
            "2,0;2,5",
            "2,x;2,5",
            "gas.pressure: file gas.csv, line 5: cell 2 must be a number with the decimal sign "
            '",", or empty; "2,x" came; correct it, or give separator and decimal',
        ),
    ],
)
def test_a_bad_export(read, tmp_path, old, new, message):
    rows = "".join(f"{240 * k - 360},0;1,0;1,5;0,9\n" for k in range(3))
    (tmp_path / "gas.csv").write_text(EXPORT.replace(old, new))
    if "x" in new:  # a table is known by three rows
        text = EXPORT.replace("120,0;3,0", f"{rows}120,0;3,x")
        (tmp_path / "gas.csv").write_text(text)
        message = message.replace("line 5", "line 9").replace("2,x", "3,x")
    assert refusal(read, given('columns = "PCYL1"')) == message


def test_only_a_file_is_read_in_a_way(read):
    scene = edited(given('columns = "PCYL1"'), '"gas.csv"', '"1 bar"')
    assert refusal(read, scene) == "gas: columns: belongs to a pressure file; remove it"
