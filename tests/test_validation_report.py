"""Evidence can be cited: what it was made with, what each case runs, what turns it red."""

import re
import socket
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from validation.about import commit, environment
from validation.case import Mutant, load_cases
from validation.claims import claims_page
from validation.judge import SEEN, Outcome, Verdict
from validation.results import row_of

pytestmark = pytest.mark.slow

CASES = {case.name: case for case in load_cases()}


def written(case):
    made = {
        "seconds": 1,
        "date": "2000-01-01",
        "commit": "0",
        "environment": "a machine",
    }
    row = row_of(Verdict(case, "holds", Outcome(0.0, "fine"), SEEN), **made)
    return claims_page([case], {case.name: row})


@pytest.mark.parametrize(
    ("mutant", "said"),
    [
        (Mutant("rod.length", 1.0 + 1e-10), "1.0000000001 (1 + 1e-10), which shifts 0.14 by +1.4e"),
        (Mutant("piston.mass", 1.25), "1.25, which shifts 0.42 by +0.105"),
        (Mutant("rod.length", -1.0), "-1.0, which shifts 0.14 by -0.28"),
    ],
)
def test_the_factor_of_a_mutant_can_be_seen(mutant, said):
    text = written(replace(CASES["s2_special_angles"], mutant=mutant))
    assert f"- turns red with: `{mutant.parameter}` times {said}" in text


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_every_mutant_shifts_a_number(case):
    assert case.mutated_value() * (case.mutant.factor - 1.0) != 0.0


@pytest.mark.parametrize(
    ("name", "line"),
    [
        (
            "multibody_yi_diesel_free_constant_speed",
            "scene: `yi_diesel_free`, constant speed, 1 cy",
        ),
        ("s2_brix", 'scene: `yi_diesel`; changed: `piston.offset = "0 mm"`'),
        ("s2_brix", 'parameters: `rod_ratio = "0.30"`'),
        (
            "hard_thousand_revolutions",
            "`only_to = { minimal = inf, multibody = inf }`, `constant_speed = true`",
        ),
        ("s1_motion_curves", '`curves = ["piston_displacement", "piston_velocity", "piston_acc'),
        ("hard_stiff_load", "changed: `"),
    ],
)
def test_a_case_says_what_it_runs(name, line):
    assert line in written(CASES[name])


def test_the_environment_names_versions_and_machine():
    versions, machine = environment().split("; ")
    assert re.findall(r"(Python|numpy|scipy|numba|exudyn|crankmbs) \d", versions) == [
        "Python",
        "crankmbs",
        "numpy",
        "scipy",
        "numba",
        "exudyn",
    ]
    assert re.search(r"\d+ cores, ", machine)
    assert socket.gethostname() not in machine
    assert str(Path.home()) not in machine


def git(folder, *arguments):
    who = ["-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", "-C", folder, *who, *arguments], check=True, capture_output=True)


def test_a_commit_says_whether_something_was_changed_since(tmp_path):
    assert commit(tmp_path) == "unknown"
    git(tmp_path, "init")
    (tmp_path / "validation").mkdir()
    (tmp_path / "validation" / "cases").touch()
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-m", "first")
    assert re.fullmatch("[0-9a-f]{7,}", commit(tmp_path))
    (tmp_path / "validation" / "results.csv").touch()
    assert re.fullmatch("[0-9a-f]{7,}", commit(tmp_path))
    (tmp_path / "new").touch()
    assert re.fullmatch(r"[0-9a-f]{7,}\+", commit(tmp_path))
