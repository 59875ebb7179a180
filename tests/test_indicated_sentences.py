"""What is refused in a measured file is named as it is, with the way out."""

import numpy as np
import pytest
from exports import FIRED, columns_of_cycles, cycles
from records import Record

from crankmbs import InputError, UndecidedError, read_pressure, read_speed
from validation.oracles.measured import pressure_of

ANGLE = np.arange(-360.0, 360.0, 1.0)


def refusal(tmp_path, text, read=read_pressure, **options):
    path = tmp_path / "export.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises((InputError, UndecidedError)) as caught:
        read(path, **options)
    return str(caught.value)


def rows(angle, *columns):
    return "\n".join(
        ",".join(f"{cell:.9g}" for cell in row) for row in zip(angle, *columns, strict=True)
    )


def test_the_width_of_smoothing_is_limited_in_degrees(tmp_path):
    text = columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 3))
    said = refusal(tmp_path, text, smooth="31 deg")
    assert said == "smooth: must be at most 30 degrees; 31 came"
    assert "at most 3 degrees; 4 came" in refusal(tmp_path, text, loss_angle="4 deg")
    read_pressure(tmp_path / "export.csv", reference="absolute", smooth="29 deg")


@pytest.mark.parametrize(
    ("unit", "factor", "absolute"),
    [("N/mm²", 0.1, False), ("bar(abs)", 1.0, True), ("kp/cm²", 1.0197162, False)],
)
def test_units_as_they_are_written(tmp_path, unit, factor, absolute):
    path = tmp_path / "export.csv"
    bar = pressure_of(FIRED, ANGLE)
    path.write_text(f"CA [deg],p [{unit}]\n" + rows(ANGLE, factor * bar), encoding="utf-8")
    found = read_pressure(path, **({} if absolute else {"reference": "absolute"}))
    assert found.absolute
    assert np.max(found.table.y) / 1e5 == pytest.approx(bar.max(), rel=1e-6)


def test_an_unknown_unit_is_called_so(tmp_path):
    text = "CA [deg],p [furlong]\n" + rows(ANGLE, pressure_of(FIRED, ANGLE))
    said = refusal(tmp_path, text)
    assert 'the pressures of column "p [furlong]" have a unit that is not known' in said


def test_a_column_of_speeds_is_no_wheel(tmp_path):
    time = np.arange(0.0, 0.4, 1e-4)
    bar = pressure_of(FIRED, np.mod(18000.0 * time, 720.0) - 360.0)
    text = "t [s],p [bar],n [rpm]\n" + rows(time, bar, 3000.0 + np.sin(400.0 * time))
    said = refusal(tmp_path, text)
    assert "no column is left for the signal of a wheel" in said


def test_a_speed_over_the_angle_has_no_teeth(tmp_path):
    text = "crank_angle_deg,speed_rpm\n" + rows(np.arange(720.0), np.full(720, 1500.0))
    said = refusal(tmp_path, text, read_speed, wheel="60-2")
    assert "the file is over the crank angle" in said
    assert "[motion] takes" in said


def test_angles_that_begin_again_every_revolution(tmp_path):
    angle = np.arange(7200.0)
    text = "CA [deg],p [bar]\n" + rows(angle % 360.0, pressure_of(FIRED, angle % 720.0 - 360.0))
    said = refusal(tmp_path, text, stroke=4, reference="absolute")
    assert "go on to 720; stroke=2 is for a two-stroke engine" in said


def test_teeth_missing_beside_each_other(tmp_path):
    edges = np.delete(Record(engine=FIRED).edges, [200, 201])
    said = refusal(tmp_path, "\n".join(f"{t:.9f}" for t in edges), read_speed, wheel="60-2")
    assert "at one of the two, teeth are missing beside each other" in said
    assert "pitches" not in said


@pytest.mark.parametrize("which", ["mean", "all"])
def test_a_table_below_zero_names_what_is_not_taken_yet(tmp_path, which):
    values = cycles(FIRED, ANGLE, 2)
    values[1, 100] = -50.0
    path = tmp_path / "export.csv"
    path.write_text(columns_of_cycles(ANGLE, values))
    found = read_pressure(path, reference="absolute", cycles=which)
    with pytest.raises(InputError, match="none is below zero") as caught:
        found.save(tmp_path / "table.csv")
    assert ('cycles="mean"' in str(caught.value)) is (which == "all")
