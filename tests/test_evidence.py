"""What is committed of claims and mutants is whole, and was measured for them as they are."""

from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest
from guards import COLLECTED

from validation import inputs
from validation.case import load_cases
from validation.judge import SEEN
from validation.kinds import KINDS, kind_of
from validation.mutants.page import write_page
from validation.mutants.plan import load_mutants
from validation.mutants.results import PAGE, untried
from validation.mutants.results import read_rows as read_mutants
from validation.report import CLAIMS, REPORT, write_pages
from validation.results import read_rows, stale

CASES = {case.name: case for case in load_cases()}
MUTANTS = {mutant.name: mutant for mutant in load_mutants()}
TESTS = Path(__file__).parent


def test_every_claim_has_its_row_and_was_judged_from_the_inputs_as_they_are():
    rows = read_rows()
    assert stale(list(CASES.values()), rows) == [], "judge them: python -m validation NAME ..."
    assert rows.keys() <= CASES.keys(), "python -m validation --page drops the others"


def test_every_claim_was_seen_to_turn_red():
    blind = {name: row.mutant for name, row in read_rows().items() if row.mutant != SEEN}
    assert blind == {}


def test_report_and_claims_are_those_of_the_rows(tmp_path):
    write_pages(list(CASES.values()), read_rows(), tmp_path)
    for page in (REPORT, CLAIMS):
        made = (tmp_path / page.name).read_text(encoding="utf-8")
        assert page.read_text(encoding="utf-8") == made, "python -m validation --page"


def test_every_figure_of_a_row_is_there():
    figures = {name for row in read_rows().values() for name in row.figures}
    assert all((REPORT.parent / "figures" / f"{name}.png").is_file() for name in figures)


def test_every_mutant_has_its_row_and_was_tried_as_it_is():
    rows = read_mutants()
    assert untried(MUTANTS.values(), rows) == [], "try them: python -m validation.mutants --missing"
    assert rows.keys() <= MUTANTS.keys(), "python -m validation.mutants --page drops the others"


def test_the_page_of_the_mutants_is_that_of_the_results(tmp_path):
    page = write_page(list(MUTANTS.values()), read_mutants(), tmp_path / "page.md")
    assert PAGE.read_text(encoding="utf-8") == page.read_text(encoding="utf-8")


def test_every_guard_is_a_claim_or_a_test_that_is_collected(request):
    collected = request.config.stash[COLLECTED]
    files = {name.partition("::")[0] for name in collected}
    if not files >= {f"tests/{path.name}" for path in TESTS.glob("test_*.py")}:
        pytest.skip("only some of the tests are collected")
    named = files | collected | {name.partition("[")[0] for name in collected}
    killed_by = {row.by for row in read_mutants().values() if row.verdict == "killed"}
    assert killed_by - collected - CASES.keys() == set()
    assert {test for mutant in MUTANTS.values() for test in mutant.guards.tests} <= named
    assert {claim for mutant in MUTANTS.values() for claim in mutant.guards.claims} <= CASES.keys()


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("hard_noise", "cases/hard_noise.toml"),
        ("hard_noise", "scenes/hard_noise.toml"),
        ("hard_noise", "scenes/hard_noise.csv"),
        ("hard_noise", "checks/hard.py"),
        ("hard_noise", "checks/honest.py"),
        ("s1_table_4", "reference/s1_table4_as_printed.csv"),
        ("s1_motion_curves", "reference/truncation_errors.csv"),
        ("run_up_minimal", "random_scenes.py"),
        ("mujoco_unlike", "mujoco/cylinders.csv"),
        ("mujoco_unlike", "random_unlike.py"),
    ],
)
def test_another_input_is_another_digest(name, part, monkeypatch):
    before, text = inputs.digest(CASES[name]), inputs._text
    assert any(
        path.as_posix().endswith(f"validation/{part}") for path in inputs.inputs(CASES[name])
    )

    def changed(path):
        return text(path) + "\n" * path.as_posix().endswith(f"validation/{part}")

    monkeypatch.setattr(inputs, "_text", changed)
    assert inputs.digest(CASES[name]) != before


def test_another_mutant_is_another_digest():
    mutant = MUTANTS["power_doubled"]
    others = {"file": "other.py", "find": f"{mutant.find} ", "replace": f"{mutant.replace} "}
    digests = {replace(mutant, **{part: text}).digest for part, text in others.items()}
    assert len(digests | {mutant.digest}) == 4
    assert replace(mutant, law="in other words").digest == mutant.digest


def test_every_check_is_of_one_kind_of_evidence():
    checks = {case.check for case in CASES.values()} | {
        case.check.partition(".")[0] for case in CASES.values()
    }
    assert all(set(kind.checks.split()) <= checks for kind in KINDS)
    assert {kind_of(case) for case in CASES.values()} == set(KINDS)


def test_a_check_of_no_kind_is_refused():
    with pytest.raises(ValueError, match=r"new\.check is of 0 kinds"):
        kind_of(replace(CASES["s2_brix"], check="new.check"))


RUN_BY_NAME = [
    ".".join(path.relative_to(TESTS.parent).with_suffix("").parts).removesuffix(".__main__")
    for path in sorted((TESTS.parent / "validation").rglob("*.py"))
    if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", RUN_BY_NAME)
def test_what_is_run_by_name_prints_its_help_and_computes_nothing(name, capsys):
    package = find_spec(name).submodule_search_locations
    module = import_module(f"{name}.__main__" if package else name)
    with pytest.raises(SystemExit) as ended:
        module.main(["--help"])
    assert not ended.value.code
    assert capsys.readouterr().out.startswith(f"usage: python -m {name} ")
