"""Exports in the manner of indicating systems are read at the first try."""

import numpy as np
import pytest
from exports import FIRED, columns_of_cycles, cycles, text
from indicated_exports import EXACT, EXPORTS, FULL, rows, simple

from crankmbs import Table, read_pressure
from crankmbs.scene.headings import Heading, headings_of
from validation.oracles.measured import pressure_of


@pytest.mark.parametrize("name", EXPORTS)
def test_it_is_read_as_it_stands(tmp_path, name):
    content, encoding = EXPORTS[name]
    path = tmp_path / "export.txt"
    path.write_bytes(content.encode(encoding))
    found = read_pressure(path, reference="absolute")
    assert [each.number for each in found.cylinders] == [1]
    assert isinstance(found.table, Table)
    angle = np.degrees(found.table.x)
    assert angle[0] == pytest.approx(0.0, abs=1e-6)
    exact = pressure_of(FIRED, angle - 360.0)
    assert np.array(found.table.y) / 1e5 == pytest.approx(exact, abs=2e-3)


def export(tmp_path, content):
    path = tmp_path / "export.csv"
    path.write_text(content)
    return path


def test_columns_are_chosen_by_name(tmp_path):
    path = export(
        tmp_path,
        rows([EXACT, 1.02 * EXACT, 0.98 * EXACT], ["PCYL1", "PCYL2", "PCYL3"], ["bar"] * 3),
    )
    one = read_pressure(path, columns="PCYL2", reference="absolute")
    assert [each.number for each in one.cylinders] == [2]
    two = read_pressure(path, columns="PCYL2..3", reference="absolute")
    assert [each.number for each in two.cylinders] == [2, 3]
    assert two.aligned


@pytest.mark.parametrize(
    "above",
    [
        "Angle/deg;Pressure/bar",
        "Crank angle / °CA;p / bar(a)",
        "angle in deg;pressure in bar",
        "Kurbelwinkel in °KW;Zylinderdruck in bar",
        "angle_deg;pressure_bar",
        "α/deg;p/bar",
        "angle [deg];pressure [bar]",
        "deg;bar",
    ],
)
def test_a_unit_stands_behind_its_quantity(tmp_path, above):
    path = export(tmp_path, rows([EXACT], ["PCYL1"], ["bar"]).split("\n", 2)[2])
    path.write_text(f"{above}\n{path.read_text()}", encoding="utf-8")
    found = read_pressure(path, reference="absolute")
    assert found.cylinders[0].peaks[0] == pytest.approx(1e5 * EXACT.max(), abs=10.0)
    said = str(found)
    assert ("cylinder 1: column 2, " in said) == (above == "deg;bar")


@pytest.mark.parametrize(
    ("above", "heading"),
    [
        ("J/deg", Heading("J/deg", "")),  # a quotient of units, and no angle
        ("heat release J/deg", Heading("heat release J/deg", "")),
        ("p in bar(g)", Heading("p", "bar", "gauge")),
        ("p/V", Heading("p", "v")),
        ("Zylinderdruck abs [bar]", Heading("Zylinderdruck abs", "bar", "absolute")),
        ("p_abs_bar", Heading("p_abs", "bar", "absolute")),
        ("p_gauge [kPa]", Heading("p_gauge", "kpa", "gauge")),
        ("Überdruck Zyl. 1 [bar]", Heading("Überdruck Zyl. 1", "bar", "gauge")),
        ("p rel. [bar(a)]", Heading("p rel.", "bar", "absolute")),  # the unit says it
        ("absorber pressure [bar]", Heading("absorber pressure", "bar")),
        ("gauge, abs [bar]", Heading("gauge, abs", "bar")),
        ("time_ms", Heading("time", "ms")),
        ("p_s", Heading("p_s", "")),  # an intake's pressure, and no time
    ],
)
def test_a_heading_is_a_name_and_a_unit(above, heading):
    assert headings_of([[above, "x"]], 2)[0] == heading


@pytest.mark.parametrize(
    ("above", "names", "units"),
    [
        (["CA,PCYL1,Speed", "deg,bar,rpm"], "CA PCYL1 Speed", "deg bar rpm"),
        (["cycle,crank_deg,P1,T", "1,deg,bar,degC"], "cycle crank_deg P1 T", "1 deg bar degc"),
        (["cycle,crank_deg,P1,T", "-,deg,V,degC"], "cycle crank_deg P1 T", "- deg v degc"),
        (["CA,speed", "deg,rpm"], "CA speed", "deg rpm"),
        (["Rig 3,12,x", "x,P1,n", "deg,V,rpm"], "x P1 n", "deg v rpm"),
        (["Rig 3,12,x", "deg,P1,n"], "deg P1 n", None),  # a name that is a unit, below a title
        (["Rig 3,test 12", "deg,P1"], "deg P1", None),
        (["deg,P1,rpm"], "deg P1 rpm", None),
        (["-,deg,bar,rpm"], "", "- deg bar rpm"),  # no names
        (["Ambient,1.02,bar", "CA [deg],P1 [bar],P2 [bar]"], "CA P1 P2", "deg bar bar"),
        (["Test,10,s,1.02,bar", "CA,P1,P2,P3,P4"], "CA P1 P2 P3 P4", None),
    ],
)
def test_a_row_of_units_has_those_of_other_columns_too(above, names, units):
    rows = [line.split(",") for line in above]
    found = headings_of(rows, len(rows[-1]))
    assert [each.name for each in found if each.name] == names.split()
    assert [each.unit for each in found] == (units or " " * (len(found) - 1)).split(" ")


def test_the_angle_may_be_named(tmp_path):
    names, units = ["PCYL1", "Position", "CA", "Theta"], ["bar", "", "deg", "deg"]
    columns = [EXACT, FULL, 2.0 * FULL, 2.0 * FULL]
    path = export(tmp_path, text(columns, names, units))
    found = read_pressure(path, reference="absolute", angle="Position")
    assert found.cylinders[0].peaks[0] == pytest.approx(1e5 * EXACT.max(), abs=10.0)
    assert "crank angles" not in str(found)
    path = export(tmp_path, text([EXACT, FULL, FULL], ["PCYL1", "CA", "Theta"], units[1:2] * 3))
    assert (
        '"CA" and "Theta" are crank angles: "CA" is read; angle="Theta" takes another'
        in read_pressure(path, unit="bar", reference="absolute").sentences
    )


def test_the_inlet_may_be_a_column(tmp_path):
    intake = np.full_like(FULL, 1.02)
    path = export(tmp_path, rows([EXACT - 7.0, intake], ["PCYL1", "PINT"], ["bar"] * 2))
    found = read_pressure(path, reference="inlet")
    assert found.cylinders[0].offset[0] / 1e5 == pytest.approx(7.0, abs=5e-3)


def test_the_statistics_of_the_file_are_named_and_left_out(tmp_path):
    content, _ = EXPORTS["mean, least and largest beside the cycles"]
    said = str(read_pressure(export(tmp_path, content), reference="absolute"))
    assert "mean of the cycles: PCYL1 mean, not in the table" in said
    assert "maximum of the cycles: PCYL1_MAX, not in the table" in said


@pytest.mark.parametrize("missing", ["", "-9999", "NaN", "n/a"])
def test_few_missing_cells_are_bridged_and_said(tmp_path, missing):
    content = rows([EXACT], ["PCYL1"], ["bar"]).split("\n")
    for k in (102, 103):
        content[k] = content[k].split(";")[0] + ";" + missing
    found = read_pressure(export(tmp_path, "\n".join(content)), reference="absolute")
    assert (
        "PCYL1: 2 missing cells of cycle 1, from -260 degrees, lie now on straight lines between "
        "their neighbours"
    ) in found.sentences
    exact = pressure_of(FIRED, np.degrees(found.table.x) - 360.0)
    assert np.array(found.table.y) / 1e5 == pytest.approx(exact, abs=2e-3)


def test_a_cycle_with_many_missing_cells_is_left_out_and_said(tmp_path):
    values = cycles(FIRED, FULL, 5)
    values[2, 100:120] = np.nan
    content = columns_of_cycles(FULL, values).replace("nan", "")
    found = read_pressure(export(tmp_path, content), reference="absolute")
    assert len(found.cylinders[0].pressure) == 4
    assert any(
        "1 of 5 cycles are left out for missing rows, or more than 3 missing cells in a row: 3" in s
        for s in found.sentences
    )


def test_a_two_stroke_cycle(tmp_path):
    angle = np.arange(-180.0, 180.0, 1.0)
    path = export(
        tmp_path, text([angle, pressure_of(FIRED, angle)], ["CA", "PCYL1"], ["deg", "bar(a)"])
    )
    found = read_pressure(path, stroke=2)
    assert found.stroke == 2
    assert np.degrees(found.table.x[int(np.argmax(found.table.y))]) == pytest.approx(12.0, abs=1.0)


def test_an_angle_that_counts_from_elsewhere_is_given(tmp_path):
    path = export(tmp_path, text([FULL + 77.5, EXACT], ["CA", "PCYL1"], ["deg", "bar(a)"]))
    found = read_pressure(path, firing_tdc="77.5 deg")
    exact = pressure_of(FIRED, np.degrees(found.table.x) - 360.0)
    assert np.array(found.table.y) / 1e5 == pytest.approx(exact, abs=2e-3)


def test_rows_without_names_are_angle_and_pressures(tmp_path):
    path = export(tmp_path, "\n".join(f"{a:g} {p:.4f}" for a, p in zip(FULL, EXACT, strict=True)))
    found = read_pressure(path, unit="bar", reference="absolute")
    assert "no column has a name: the first is read as the crank angle" in found.sentences
    exact = pressure_of(FIRED, np.degrees(found.table.x) - 360.0)
    assert np.array(found.table.y) / 1e5 == pytest.approx(exact, abs=2e-3)


@pytest.mark.parametrize(
    ("encoding", "name"),
    [
        ("utf-8", "UTF-8"),
        ("utf-8-sig", "UTF-8"),
        ("utf-16", "UTF-16"),
        ("utf-16-be", "UTF-16-BE"),
        ("utf-32", "UTF-32"),
        ("cp1252", "Windows-1252"),
    ],
)
def test_the_encoding_is_said(tmp_path, encoding, name):
    path = tmp_path / "export.csv"
    path.write_bytes(("Öl\n" + simple("bar", 1.0)).encode(encoding))
    said = read_pressure(path, reference="absolute").sentences[0]
    assert f", {name}, separated by semicolons, decimal comma; 4-stroke" in said


def test_a_reference_against_the_unit_is_warned_of(tmp_path):
    path = export(tmp_path, simple("barg", 1.0))
    found = read_pressure(path, reference="absolute")
    assert found.warnings == (
        "warning: cylinder 1: the pressures are absolute and stay as they are (as given, though "
        "the heading says gauge)",
    )


def test_cylinders_without_numbers_are_counted_as_they_are_chosen(tmp_path):
    names, units = ["Pressure B", "Pressure A", "Power"], ["bar(a)", "bar(a)", "kW"]
    path = export(tmp_path, rows([EXACT, 1.02 * EXACT, EXACT], names, units))
    found = read_pressure(path, columns="Pressure A, Pressure B")
    assert [(each.number, each.name) for each in found.cylinders] == [
        (1, "Pressure A"),
        (2, "Pressure B"),
    ]


def test_cycles_of_several_cylinders_stand_in_columns(tmp_path):
    names = [f"PCYL{c}_{k}" for c in (1, 2) for k in (1, 2, 3)]
    values = [*cycles(FIRED, FULL, 3), *(1.02 * cycles(FIRED, FULL, 3))]
    found = read_pressure(export(tmp_path, rows(values, names, ["bar(a)"] * 6)))
    assert [each.pressure.shape for each in found.cylinders] == [(3, 720), (3, 720)]
    assert found.aligned


@pytest.mark.parametrize("names", [["P1", "P2", "P3"], ["Cyl 1", "Cyl 2", "Cyl 3"]])
def test_short_names_are_cylinders(tmp_path, names):
    values = [EXACT, 1.02 * EXACT, 0.98 * EXACT, 0.0 * EXACT + 1.0]
    content = rows(values, [*names, "Cyl 1 inlet"], ["bar(a)"] * 4)
    found = read_pressure(export(tmp_path, content))
    assert [each.name for each in found.cylinders] == names


def test_columns_that_are_no_pressures_are_left_out_by_name(tmp_path):
    """A speed beside the pressure, once under names and once without any."""
    speed = 2000.0 + 10.0 * np.cos(np.radians(FULL))
    named = export(tmp_path, text([FULL, EXACT, speed], ["CA", "1", "2"], ["deg", "bar", "bar"]))
    one = read_pressure(named, columns="1", reference="absolute")
    assert one.cylinders[0].peaks[0] == pytest.approx(1e5 * EXACT.max(), abs=10.0)
    bare = export(tmp_path, text([EXACT * 0.0 + FULL, EXACT, speed], ["x"])[2:])
    one = read_pressure(bare, columns="PCYL1", unit="bar", reference="absolute")
    assert [each.number for each in one.cylinders] == [1]
    assert "the first is read as the crank angle, the others as PCYL1 to PCYL2" in str(one)
