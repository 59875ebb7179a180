"""Tables of two columns: reading CSV, and what is refused."""

import math
import os
from pathlib import Path

import numpy as np
import pytest

from crankmbs.errors import InputError
from crankmbs.scene.forces import TravelTable
from crankmbs.scene.tables import Header, Table, read_table

COLUMNS = Header({"time_s": 1.0, "time_ms": 1e-3}, {"torque_Nm": 1.0})


def read(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "table.csv"
    path.write_bytes(text.encode(encoding))
    return read_table(path, COLUMNS)


@pytest.mark.parametrize(
    "text",
    [
        "time_s,torque_Nm\n0,1\n2,3\n",
        "time_s,torque_Nm\r\n0,1\r\n2,3\r\n",
        "time_s,torque_Nm\n0,1\n2,3",
        "# a comment, with a comma\n\ntime_s,torque_Nm\n  # another\n0,1\n\n2,3\n",
        "time_ms,torque_Nm\n0,1\n2000,3\n",
        "torque_Nm,note,time_s\n1,a,0\n3,,2\n",
        ' time_s , "torque_Nm"\n 0 , 1.0e0 \n"2",+3\n',
    ],
)
def test_two_columns_are_found(tmp_path, text):
    table = read(tmp_path, text)
    assert (table.x, table.y) == ((0.0, 2.0), (1.0, 3.0))
    assert table.source == str(tmp_path / "table.csv")


def test_a_byte_order_mark_is_no_part_of_the_header(tmp_path):
    assert read(tmp_path, "time_s,torque_Nm\n0,1\n", "utf-8-sig").y == (1.0,)


@pytest.mark.parametrize(
    ("text", "rest"),
    [
        ("", " is empty: it needs a header and rows"),
        ("# nothing\n", " is empty: it needs a header and rows"),
        (
            "time,torque_Nm\n0,1\n",
            ": the header must name exactly one column time_s | time_ms, with commas between the "
            'columns; "time,torque_Nm" came',
        ),
        (
            "time_s;torque_Nm\n0;1\n",
            ": the header must name exactly one column time_s | time_ms, with commas between the "
            'columns; "time_s;torque_Nm" came; write it with commas between the columns and '
            "decimal points",
        ),
        (
            "time_s,time_s,torque_Nm\n0,0,1\n",
            ": the header must name exactly one column time_s, with commas between the columns; "
            '"time_s,time_s,torque_Nm" came',
        ),
        (
            "time_s,torque_Nm,torque_Nm\n0,0,1\n",
            ": the header must name exactly one column torque_Nm, with commas between the "
            'columns; "time_s,torque_Nm,torque_Nm" came',
        ),
        (
            "# c\ntime_s,torque_Nm\n0,1\n0,5,1,5\n",
            ", line 4: 4 cells under a header of 2; commas separate the columns, the decimal sign "
            "is a point",
        ),
        (
            "time_s,torque_Nm\n0,\n",
            ", line 2: torque_Nm must be a finite number; an empty cell came",
        ),
        (
            "time_s,torque_Nm\n0\n",
            ", line 2: torque_Nm must be a finite number; an empty cell came",
        ),
        ("time_s,torque_Nm\nnan,1\n", ', line 2: time_s must be a finite number; "nan" came'),
        (
            "time_s,torque_Nm\n0,1\n1,inf\n",
            ', line 3: torque_Nm must be a finite number; "inf" came',
        ),
        ("time_s,torque_Nm\n0,1_0\n", ', line 2: torque_Nm must be a finite number; "1_0" came'),
        (
            "time_s,torque_Nm\n0,12 Nm\n",
            ', line 2: torque_Nm must be a finite number; "12 Nm" came',
        ),
        (
            "time_s,torque_Nm\n0," + "1" * 200_000 + "\n",
            ", line 2: cannot be read as CSV: field larger than field limit (131072)",
        ),
    ],
)
def test_what_is_refused(tmp_path, text, rest):
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert str(caught.value) == f"file {tmp_path / 'table.csv'}{rest}"


def test_two_ways_in_place_of_one_are_named(tmp_path):
    (tmp_path / "table.csv").write_text("displacement_mm,forward_kN,back_kN\n0,1,2\n")
    with pytest.raises(InputError) as caught:
        read_table(tmp_path / "table.csv", TravelTable.header)
    assert str(caught.value) == (
        f"file {tmp_path / 'table.csv'}: the header must name exactly one column force_N, or "
        "forward_N and back_N, with commas between the columns; "
        '"displacement_mm,forward_kN,back_kN" came'
    )


def test_an_open_quote_ends_with_its_line(tmp_path):
    assert read(tmp_path, 'time_s,torque_Nm\n0,"1\n2,3\n').y == (1.0, 3.0)


def test_a_missing_file(tmp_path):
    with pytest.raises(InputError, match=r"is missing; paths are relative to the scene file$"):
        read_table(tmp_path / "no.csv", COLUMNS)


def test_a_folder_is_no_table(tmp_path):
    with pytest.raises(InputError, match=r"cannot be read: Is a directory$"):
        read_table(tmp_path, COLUMNS)


def refused(path):
    with pytest.raises(InputError) as caught:
        read_table(path, COLUMNS)
    return str(caught.value)


def test_a_device_is_no_table():
    assert refused(Path("/dev/zero")) == (
        "file /dev/zero is a device, a pipe or a socket, which may have no end; save the table as "
        "a CSV file"
    )


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    assert "pipe.csv is a device, a pipe or a socket" in refused(tmp_path / "pipe.csv")


def test_a_table_beyond_all_size_is_not_read(tmp_path):
    path = tmp_path / "table.csv"
    with path.open("wb") as stream:
        stream.truncate(10**12)  # no block of it is on the disk
    assert refused(path) == (
        f"file {path} is larger than 32 MB, the most of a table; leave out the columns and rows "
        "that are not needed"
    )


def test_binary_is_no_table(tmp_path):
    path = tmp_path / "table.csv"
    path.write_bytes(b"\x89PNG\xff\x00")
    with pytest.raises(InputError, match=r"is no UTF-8 text; save the table as CSV in UTF-8; "):
        read_table(path, COLUMNS)


def test_a_name_that_cannot_be(tmp_path):
    with pytest.raises(InputError, match=r"is no file name$"):
        read_table(tmp_path / "a\0b", COLUMNS)


def test_table_takes_arrays_and_keeps_floats():
    table = Table(np.array([0, 1]), np.array([2.5, 3.0]))
    assert (table.x, table.y) == ((0.0, 1.0), (2.5, 3.0))
    assert hash(table) == hash(Table((0.0, 1.0), (2.5, 3.0)))


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([0.0, 1.0], [0.0], "2 abscissae but 1 ordinates"),
        ([0.0, math.nan], [0.0, 1.0], "every value must be finite"),
        ([0.0, "a"], [0.0, 1.0], r'x must be a sequence of numbers; \[0.0, "a"\] came'),
        ([0.0], 3.0, r"y must be a sequence of numbers; 3.0 came"),
        (np.zeros((2, 2)), [0.0, 1.0], "x must be a sequence of numbers"),
    ],
)
def test_table_refuses(x, y, message):
    with pytest.raises(InputError, match=message):
        Table(x, y)
