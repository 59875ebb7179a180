"""The physical mutants: each can be made, each has its result, and a few are really run red."""

import ast
from dataclasses import replace

import pytest

from validation.mutants.__main__ import main
from validation.mutants.page import write_page
from validation.mutants.plan import ROOT, Guards, load_mutants
from validation.mutants.results import Row, read_rows, score, write_rows
from validation.mutants.scratch import Scratch

pytestmark = pytest.mark.slow

MUTANTS = load_mutants()
NAMED = {mutant.name: mutant for mutant in MUTANTS}
GREEN = Guards(claims=("s1_table_3",))


def tried(mutant, verdict="killed", by="tests/x.py"):
    return Row(mutant.name, verdict, by, 1, "2000-01-01", "0", mutant.digest)


def test_there_are_enough_and_names_are_unique():
    assert len(NAMED) == len(MUTANTS) >= 150


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_changes_one_place_of_its_file_and_is_python(mutant):
    source = (ROOT / mutant.file).read_text(encoding="utf-8")
    changed = mutant.applied(source)
    if mutant.file.endswith(".py"):
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(source))
    else:  # a template, that its guards fill in
        assert changed != source


def test_a_text_that_is_not_there_once_is_refused():
    with pytest.raises(ValueError, match="stands 2 times"):
        MUTANTS[0].applied(2 * MUTANTS[0].find)


def test_hardly_any_survive():
    dead, counted = score(MUTANTS, read_rows())
    assert dead >= 0.97 * counted


@pytest.mark.parametrize("name", ["table_3_in_grams", "gravity_not_turned_into_the_bank"])
def test_a_mutant_turns_a_claim_red_and_leaves_the_source_as_it_was(tmp_path, name):
    mutant, scratch = NAMED[name], Scratch(tmp_path)
    path = tmp_path / mutant.file
    before = path.read_text(encoding="utf-8"), path.stat().st_mtime_ns
    claims = Guards(claims=mutant.guards.claims)
    with scratch.mutated(mutant):
        assert path.read_text(encoding="utf-8") != before[0]
        red = scratch.first_red(claims)
    assert red is not None
    assert red.guard in claims.claims
    assert (path.read_text(encoding="utf-8"), path.stat().st_mtime_ns) == before


def test_without_a_mutant_nothing_is_red_and_a_guard_that_never_ends_is(tmp_path):
    scratch = Scratch(tmp_path)
    assert scratch.first_red(GREEN) is None
    assert not scratch.first_red(GREEN, limit=0.01).ended


def test_the_command_keeps_the_other_results_and_writes_both(tmp_path, monkeypatch, capsys):
    page, table = tmp_path / "page.md", tmp_path / "results.csv"
    monkeypatch.setattr("validation.mutants.__main__.RESULTS", table)
    monkeypatch.setattr("validation.mutants.__main__.PAGE", page)
    rows = [tried(mutant) for mutant in MUTANTS]
    write_rows(rows, table)
    assert main(["--page"]) == 0
    text = page.read_text(encoding="utf-8")
    assert all(f"| {name} |" in text for name in NAMED)
    assert "run: 2000-01-01, on 1 commits" in capsys.readouterr().out
    write_rows(rows[1:], table)
    assert main(["--page"]) == 1
    assert "1 mutants have no result" in capsys.readouterr().out
    write_rows([replace(rows[0], mutant="another"), *rows[1:]], table)
    assert main(["--page"]) == 1


def test_a_survivor_is_named_and_counts_against_the_score(tmp_path):
    rows = {mutant.name: tried(mutant) for mutant in MUTANTS}
    rows["power_doubled"] = tried(NAMED["power_doubled"], "survived", "")
    dead, counted = score(MUTANTS, rows)
    assert counted - dead == 1
    text = write_page(MUTANTS, rows, tmp_path / "page.md").read_text(encoding="utf-8")
    assert "**power_doubled** survives" in text
