"""The report can be cited: what it was made with, what each case runs, what turns it red."""

import re
import socket
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from validation.about import about, commit
from validation.case import Mutant, load_cases
from validation.judge import Outcome, Verdict
from validation.report import write_report

pytestmark = pytest.mark.slow

CASES = {case.name: case for case in load_cases()}


def written(case, folder, **parts):
    verdict = Verdict(case, "holds", Outcome(0.0, "fine", **parts))
    return write_report([verdict], folder).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("mutant", "said"),
    [
        (Mutant("rod.length", 1.0 + 1e-10), "1.0000000001 (1 + 1e-10), which shifts 0.14 by +1.4e"),
        (Mutant("piston.mass", 1.25), "1.25, which shifts 0.42 by +0.105"),
        (Mutant("rod.length", -1.0), "-1.0, which shifts 0.14 by -0.28"),
    ],
)
def test_the_factor_of_a_mutant_can_be_seen(mutant, said, tmp_path):
    text = written(replace(CASES["s2_special_angles"], mutant=mutant), tmp_path)
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
        ("hard_thousand_revolutions", "`only_to = { multibody = inf }`, `constant_speed = true`"),
        ("s1_motion_curves", '`curves = ["piston_displacement", "piston_velocity", "piston_acc'),
        ("hard_stiff_load", "changed: `"),
    ],
)
def test_a_case_says_what_it_runs(name, line, tmp_path):
    assert line in written(CASES[name], tmp_path)


def test_the_head_says_when_and_with_what(tmp_path):
    head, _, _ = written(CASES["s2_brix"], tmp_path).partition("claims hold")
    assert re.search(r"^- date: \d{4}-\d\d-\d\d$", head, re.MULTILINE)
    assert re.search(r"^- commit: ([0-9a-f]{40}|unknown)", head, re.MULTILINE)
    versions = next(line for line in about() if "versions" in line)
    assert re.findall(r"(Python|numpy|scipy|numba|exudyn|crankmbs) \d", versions) == [
        "Python",
        "crankmbs",
        "numpy",
        "scipy",
        "numba",
        "exudyn",
    ]
    assert re.search(r"^- machine: .+, \d+ cores, ", head, re.MULTILINE)
    assert socket.gethostname() not in head
    assert str(Path.home()) not in head


def git(folder, *arguments):
    who = ["-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", "-C", folder, *who, *arguments], check=True, capture_output=True)


def test_a_commit_says_whether_something_was_changed_since(tmp_path):
    assert commit(tmp_path) == "unknown, not a git checkout"
    git(tmp_path, "init")
    git(tmp_path, "commit", "--allow-empty", "-m", "first")
    assert re.fullmatch("[0-9a-f]{40}", commit(tmp_path))
    (tmp_path / "new").touch()
    assert re.fullmatch("[0-9a-f]{40}, with uncommitted changes", commit(tmp_path))
