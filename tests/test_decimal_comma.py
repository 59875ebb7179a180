"""A comma that is a decimal sign, or separates two columns, where a file has one or the other."""

import numpy as np
import pytest

from crankmbs.delimited import read_sheet
from crankmbs.delimited.encoding import Text
from crankmbs.errors import InputError
from crankmbs.scene.tables import Header, read_table

ROWS = "0,2499\n0,2506\n1,0013\n"
ONE, TWO = [[0.2499], [0.2506], [1.0013]], [[0.0, 2499.0], [0.0, 2506.0], [1.0, 13.0]]


def read(text, **options):
    return read_sheet("teeth.csv", Text(text, "UTF-8"), **{"least": 1, **options}).values.tolist()


@pytest.mark.parametrize(
    ("text", "options", "values"),
    [
        (f"Zeit\ns\n{ROWS}", {}, ONE),
        (f"# teeth, by a wheel\nZeit\n{ROWS}", {}, ONE),
        (ROWS, {}, ONE),
        (f"time, s\n{ROWS}", {}, ONE),
        (ROWS, {"decimal": ","}, ONE),
        (ROWS, {"separator": ","}, TWO),
        (ROWS, {"decimal": "."}, TWO),
        ("t\n1,25\n1,15\n2,45\n", {}, [[1.25], [1.15], [2.45]]),
        ("t,u\n1,25\n2,35\n3,45\n", {}, [[1.0, 25.0], [2.0, 35.0], [3.0, 45.0]]),
        ("1,25\n2,35\n3,45\n", {"decimal": ","}, [[1.25], [2.35], [3.45]]),
        ("1,25\n2,35\n2,25\n", {}, [[1.0, 25.0], [2.0, 35.0], [2.0, 25.0]]),
        ("1,2.5\n2,3.5\n3,4.5\n", {}, [[1.0, 2.5], [2.0, 3.5], [3.0, 4.5]]),
        ('"0,5","1"\n"1,5","2"\n"2,5","3"\n', {"decimal": ","}, [[0.5, 1], [1.5, 2], [2.5, 3]]),
    ],
)
def test_a_comma_is_what_the_file_or_the_user_says(text, options, values):
    assert np.array_equal(read(text, **options), values)


def test_two_columns_of_a_table_need_no_further_word():
    assert read(ROWS, least=2) == TWO


def test_a_file_that_may_be_read_both_ways_is_refused():
    with pytest.raises(InputError) as refused:
        read("1,25\n2,35\n3,45\n")
    assert str(refused.value) == (
        'file teeth.csv: "1,25" may be two columns of whole numbers or one with decimal commas; '
        'give separator="," or decimal=","'
    )


def test_a_decimal_comma_never_separates():
    with pytest.raises(InputError, match="no rows of at least two numbers, with the decimal sign"):
        read(ROWS, least=2, decimal=",")


def test_semicolons_between_columns_are_named_with_a_way_out(tmp_path):
    file = tmp_path / "speed.csv"
    file.write_text("time_s;speed_rpm\n0,0;1500,0\n0,1;1510,0\n")
    header = Header({"time_s": 1.0}, {"speed_rpm": 1.0})
    way_out = "write it with commas between the columns and decimal points"
    with pytest.raises(InputError, match=f"came; {way_out}$"):
        read_table(file, header)
    file.write_text("time,speed_rpm\n0,1500\n")
    with pytest.raises(InputError, match=r'"time,speed_rpm" came$'):
        read_table(file, header)
