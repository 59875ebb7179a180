"""``validate`` with formulas of one's own and a chain of one's own."""

import csv
import re

import pytest
from typer.testing import CliRunner

import crankmbs.figures.compare as drawing
from crankmbs.cli import app

MINE = """
import numpy as np

from beside import HARMONIC


def acceleration_series(phi, mean_omega, crank_radius, rod_ratio):
    return crank_radius * mean_omega**2 * (np.cos(phi) + rod_ratio * np.cos(HARMONIC * phi))


def crank_speed_mean(theta, mean_omega):
    return mean_omega


def mean_speed_start(start_omega):
    return start_omega


def imep_none():
    return 0.0


def torque_wrong(phy):
    return phy


def torque_nan(phi):
    return phi - np.inf


def unnamed(phi):
    return phi


number = 3
"""


@pytest.fixture
def mine(tmp_path):
    (tmp_path / "beside.py").write_text("HARMONIC = 2\n")
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    return file


def validate(*arguments):
    return CliRunner().invoke(app, ["validate", *map(str, arguments)])


def lines_of(file):
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.slow
def test_a_formula_stands_in_every_table_and_file(mine, tmp_path, monkeypatch):
    monkeypatch.setattr(drawing, "FAMILIES", {"motion": ("piston acceleration",)})
    formulas = [
        f"--formula={mine}:{name}"
        for name in ("acceleration_series", "crank_speed_mean", "mean_speed_start")
    ]
    chain = ["--causes", "series, constant speed"]
    options = ["--formulation", "auto", "--until", "2 cycles", "--verbose"]
    options += ["--out", tmp_path / "out"]
    outcome = validate("yi_diesel_free", *formulas, *chain, *options)
    assert outcome.exit_code == 0, outcome.output
    text, label = outcome.stdout, "acceleration_series of mine.py"
    own, _, lectures = text.partition("formulas: those of Yi")
    _, heading, _, row = own.partition(f"\n{label} minus run, ")[2].splitlines()[:4]
    assert re.split(r"\s{2,}", heading)[2:] == [
        "error [%]",
        "at [deg]",
        "formula",
        "constant speed",
    ]
    assert row.startswith("piston acceleration [m/s^2] ")
    error, _, formula, constant = map(float, row.split()[4:])
    assert formula + constant == pytest.approx(error, abs=0.011)
    assert abs(error) > 1.0
    assert "\nside thrust [N] " in lectures
    words = " ".join(text.split())
    assert re.search(
        r"crank speed by crank_speed_mean of mine.py: off by up to \S+ % of the p", words
    )
    (number,) = re.findall(r"^mean speed by mean_speed_start of mine.py .*$", text, re.MULTILINE)
    assert " of mine.py [rpm]  3200.00  " in number
    assert "left out of 'the budget of crank_speed_mean of mine.py': crank speed: " in text
    rows = [r for r in lines_of(tmp_path / "out" / "comparison.csv") if "mine.py" in r["reference"]]
    assert [r["quantity"] for r in rows] == ["piston acceleration", "crank speed"]
    assert [r["cylinder"] for r in rows] == ["1", "all"]
    assert len(lines_of(tmp_path / "out" / "numbers.csv")) == 1
    budget = [r for r in lines_of(tmp_path / "out" / "budget.csv") if r["reference"] == label]
    assert len(budget) == 721
    pictures = sorted(file.name for file in (tmp_path / "out").glob("*.png"))
    assert pictures == [
        "budget_formula_1.png",
        "budget_motion.png",
        "comparison_formulas.png",
        "comparison_motion.png",
    ]


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("{}", "--formula: must be FILE:NAME, such as "),
        (":torque", 'must be FILE:NAME, such as "mine.py:torque_series"; ":torque" came'),
        ("nowhere.py:torque", "--formula: nowhere.py is no file; give the path of one"),
        ("{}:acceleration_serie", 'has no acceleration_serie; did you mean "acceleration_series"'),
        ("{}:xyz", "mine.py has no xyz; it has acceleration_series, crank_speed_mean,"),
        ("{}:number", "number of mine.py: must be a function; 3 came"),
        ("{}:unnamed", '"unnamed" names none; there are piston displacement,'),
        ("{}:torque_wrong", "parameter phy of torque_wrong is nothing it can be given; did you"),
    ],
)
def test_what_is_no_formula_is_refused_before_anything_runs(mine, tmp_path, formula, message):
    folder = tmp_path / "out"
    outcome = validate("yi_diesel", "--formula", formula.format(mine), "--out", folder)
    assert outcome.exit_code == 2, outcome.output
    assert outcome.stderr.startswith("error: ")
    assert message in outcome.stderr
    assert not folder.exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("def torque(phi:\n", "mine.py, line 1: SyntaxError: "),
        ("\nimport nothing_of_the_kind\n", "mine.py, line 2: ModuleNotFoundError: No module"),
        ("x = 1\n\nraise ValueError\n", "mine.py, line 3: ValueError; correct the file"),
        ("x = '\0'\n", "mine.py: "),
    ],
)
def test_a_file_that_python_cannot_run_is_named_with_its_line(mine, tmp_path, text, message):
    mine.write_text(text)
    outcome = validate("yi_diesel", "--formula", f"{mine}:torque", "--out", tmp_path / "out")
    assert outcome.exit_code == 2, outcome.output
    assert message in outcome.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--formula", "{}:torque_nan"], "torque_nan of mine.py: must give finite numbers; -inf"),
        (["--formula", "{}:mean_speed_start"], "start_omega: the scene has no [start]"),
    ],
)
def test_a_formula_that_fails_on_the_run_leaves_nothing_behind(mine, tmp_path, arguments, message):
    arguments = [each.format(mine) for each in arguments]
    options = ["--formulation", "auto", "--out", tmp_path / "out"]
    outcome = validate("yi_diesel", *arguments, *options)
    assert outcome.exit_code == 2, outcome.output
    assert message in outcome.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--causes", "series, two masses"], '"two masses" came; did you mean "two-mass rod"?'),
        (["--causes", ""], "--causes: a cause is series, datum, constant speed, two-mass rod,"),
        (["--causes", "series,series"], 'each cause once; "series" came twice'),
        (
            ["--formula", "{0}:imep_none", "--formula", "{0}:imep_none"],
            "imep_none of mine.py comes",
        ),
    ],
)
def test_other_bad_input_is_refused_before_anything_runs(mine, tmp_path, arguments, message):
    arguments = [each.format(mine) for each in arguments]
    outcome = validate("yi_diesel", *arguments, "--out", tmp_path / "out")
    assert outcome.exit_code == 2, outcome.output
    assert message in outcome.stderr
    assert not (tmp_path / "out").exists()
