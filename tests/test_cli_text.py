"""Numbers and tables as text, and the sign of life of a long run."""

import io
import math
import sys
import time

import pytest

import crankmbs.cli.progress
from crankmbs.cli.progress import progress
from crankmbs.cli.text import cells, table
from crankmbs.digits import digits, error_digits
from crankmbs.display import with_unit
from crankmbs.measures import Estimate


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_shows_on_a_terminal_after_its_patience(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(crankmbs.cli.progress, "_PATIENCE", 0.0)
    with progress("working [1]"):
        for _ in range(500):
            if "working [1]" in terminal.getvalue():
                break
            time.sleep(0.01)
    assert "working [1]" in terminal.getvalue()


@pytest.mark.parametrize("stream", [Terminal, io.StringIO])
def test_progress_is_silent_when_quick_or_not_on_a_terminal(monkeypatch, stream):
    stderr = stream()
    monkeypatch.setattr(sys, "stderr", stderr)
    monkeypatch.setattr(crankmbs.cli.progress, "_PATIENCE", 1000.0 if stream is Terminal else 0.0)
    with progress("working"):
        pass
    assert "working" not in stderr.getvalue()


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1234.5678, 0.0, "1234.57"),
        (1234.5678, 0.3, "1234.57"),
        (1234.5678, 3.0, "1234.6"),
        (1234.5678, 20.0, "1235"),
        (-1234.5678, 2000.0, "-1200"),
        (12.0, 5000.0, "0"),
        (0.0, 0.1, "0"),
        (-0.004, 0.1, "0"),
        (9.9996, 0.01, "10.000"),
        (0.0999999999, 1e-15, "0.100000"),
        (1.234567e-9, 1e-12, "1.2346e-09"),
        (1.234567e9, 0.0, "1.23457e+09"),
        (float("nan"), 0.0, "-"),
    ],
)
def test_digits_end_at_the_error(value, error, text):
    assert digits(value, error) == text


def test_errors_have_two_digits_rounded_up():
    assert [error_digits(e) for e in (0.0123, 123.0, 4.0, 1.23e-9)] == [
        "0.013",
        "130",
        "4.0",
        "1.3e-09",
    ]


def test_tables_are_aligned():
    assert table(["a", "bb"], [["long", "1"], ["b", "22"]]).splitlines() == [
        "a     bb",
        "----  --",
        "long   1",
        "b     22",
    ]


@pytest.mark.parametrize("value", [1234.5678, 20.049999, -0.0312345])
@pytest.mark.parametrize("error", [0.3, 0.019, 7.1e-3])
def test_what_is_printed_does_not_exclude_the_truth(value, error):
    truth = value + 0.95 * error
    assert abs(float(digits(value, error)) - truth) <= float(error_digits(error))


@pytest.mark.parametrize(
    ("units", "per", "heading", "value"),
    [
        ("rad/s", "1", "x [rpm]", "30.0000"),
        ("W", "1", "x [kW]", "0.00314159"),
        ("Pa", "1", "x [bar]", "3.14159e-05"),
        ("rad", "1", "x [deg]", "180.000"),
        ("N m", "1", "x [N m]", "3.14159"),
        ("1", "1", "x", "3.14159"),
        ("rad/s", "m", "x [rpm]", "0.0300000"),
    ],
)
def test_numbers_are_printed_in_the_units_that_people_read(units, per, heading, value):
    assert with_unit("x", units) == heading
    assert cells(Estimate(math.pi, 0.0), units, per)[0] == value
