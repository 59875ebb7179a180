"""The machinery of the claims: what is red, what a run writes, and that no scene is forgotten."""

from dataclasses import replace

import pytest

from crankmbs import load_scene, shipped_scenes
from crankmbs.choose import choose
from crankmbs.errors import FormulationError
from crankmbs.scene.scene import Scene
from validation import __main__ as command
from validation import judge as judging
from validation import reference
from validation.case import Case, Mutant, load_case, load_cases, shifted
from validation.claims import claims_page
from validation.judge import SEEN, Outcome, Skipped, Verdict, judge, seen
from validation.report import write_pages
from validation.results import read_rows, row_of, write_rows

CASES = {case.name: case for case in load_cases()}
CASE = CASES["s2_mean_speed"]


def checked(monkeypatch, check) -> Verdict:
    monkeypatch.setattr(judging, "_check_of", lambda case: check)
    return judge(CASE)


def raises(error):
    def check(case):
        raise error

    return check


@pytest.mark.parametrize(
    ("check", "word"),
    [
        (lambda case: Outcome(case.tolerance, "on the tolerance"), "holds"),
        (lambda case: Outcome(case.tolerance * 1.01, "beyond it"), "fails"),
        (lambda case: Outcome(float("nan"), "no number"), "fails"),
        (raises(Skipped("not here")), "skipped"),
        (raises(reference.MissingReference("no file")), "no reference"),
        (raises(ZeroDivisionError("oops")), "broken"),
    ],
)
def test_only_a_met_tolerance_is_green(monkeypatch, check, word):
    verdict = checked(monkeypatch, check)
    assert verdict.word == word
    assert verdict.green == (word == "holds")


@pytest.mark.parametrize(
    ("outcome", "status"),
    [
        (Outcome(0.0, "fine"), 0),
        (Outcome(1.0, "not fine"), 1),
        (Skipped("not here"), 1),
        (reference.MissingReference("no file"), 1),
    ],
)
def test_exit_status(monkeypatch, capsys, outcome, status):
    def check(case):
        if isinstance(outcome, Exception):
            raise outcome
        return outcome

    monkeypatch.setattr(judging, "_check_of", lambda case: check)
    monkeypatch.setattr(command, "load_cases", lambda: [CASE])
    assert command.main(["--quick"]) == status
    assert f"1 claims, {status} red" in capsys.readouterr().out


def test_rows_are_read_as_they_were_written(tmp_path):
    table = ("| a |", "|---|", "| 1, 2 |")
    verdict = Verdict(CASE, "fails", Outcome(float("inf"), 'said "so", and\nmore', table))
    rows = rows_of([verdict])
    write_rows(rows, tmp_path)
    (again,) = read_rows(tmp_path).values()
    assert replace(again, table=tuple(again.table), figures=tuple(again.figures)) == rows[CASE.name]
    assert read_rows(tmp_path / "nowhere") == {}


def test_named_claims_are_judged_and_the_rows_of_the_others_kept(monkeypatch, tmp_path, capsys):
    cases = [CASE, CASES["s1_table_3"], CASES["s2_special_angles"]]
    rows = rows_of([Verdict(case, "holds", Outcome(0.0, "before")) for case in cases[:2]])
    written = []
    monkeypatch.setattr(command, "load_cases", lambda: cases)
    monkeypatch.setattr(command, "read_rows", lambda: dict(rows))
    monkeypatch.setattr(command, "write_rows", lambda rows: written.append(dict(rows)))
    monkeypatch.setattr(command, "write_pages", lambda cases, rows: "the pages")
    assert command.main([CASES["s1_table_3"].name]) == 1
    said = capsys.readouterr().out
    assert "new: s2_special_angles" in said
    assert "the pages" not in said
    assert command.main(["s2_special_angles"]) == 0
    assert "the pages" in capsys.readouterr().out
    assert written[-1][CASE.name].detail == "before"
    assert written[-1]["s2_special_angles"].detail != "before"
    monkeypatch.setattr(command, "read_rows", lambda: written[-1])
    assert command.main(["--page"]) == 0


def test_claims_are_judged_in_processes(monkeypatch, capsys):
    monkeypatch.setattr(command, "load_cases", lambda: [CASE, CASES["s1_table_3"]])
    assert command.main(["--quick", "--processes", "2"]) == 0
    assert "2 claims, 0 red" in capsys.readouterr().out


def test_no_claim_at_all_is_red(monkeypatch):
    monkeypatch.setattr(command, "load_cases", list)
    assert command.main(["--quick"]) == 1


@pytest.mark.parametrize("lost", ["file", "row", "source"])
def test_a_reference_that_is_not_there(monkeypatch, tmp_path, lost):
    monkeypatch.setattr(reference, "FOLDER", tmp_path)
    if lost != "file":
        head = "# Source: here\n" if lost == "row" else ""
        (tmp_path / "s2_brix.csv").write_text(f"{head}rod_ratio,value\n0.2,1\n")
    assert judge(CASES["s2_brix"]).word == "no reference"


def test_every_reference_names_its_source():
    for path in reference.FOLDER.glob("*.csv"):
        head = path.read_text(encoding="utf-8").split("\n\n")[0]
        assert head.startswith("#"), path.name
        assert "Source: " in head, path.name


def rows_of(verdicts):
    made = {
        "seconds": 1,
        "date": "2000-01-01",
        "commit": "0",
        "environment": "a machine",
    }
    return {v.case.name: row_of(replace(v, mutant=SEEN), **made) for v in verdicts}


def test_report(tmp_path):
    green = Verdict(CASE, "holds", Outcome(1e-14, "fine", table=("| a |", "|---|", "| 1 |")))
    red = Verdict(CASES["khurmi_speed_printed"], "fails", Outcome(3.0, "too far"))
    cases = [green.case, red.case]
    report = write_pages(cases, rows_of([green, red]), tmp_path).read_text(encoding="utf-8")
    assert "1 of 2 claims hold." in report
    assert "- commit 0: 2 claims" in report
    assert f"- **fails**: [{red.case.claim}](CLAIMS.md#{red.case.name})" in report
    assert f"- prediction: [{red.case.name}](CLAIMS.md#{red.case.name})" in report
    claims = (tmp_path / "CLAIMS.md").read_text(encoding="utf-8")
    assert "| 1 |" in claims
    for case in cases:
        assert claims.count(f'<a id="{case.name}"></a>') == 1
        assert case.reason in claims
        assert case.source in claims


def test_the_report_shows_the_worst_of_each_kind(tmp_path):
    cases = [case for case in CASES.values() if case.check == "honest.stated_errors"][:2]
    verdicts = [Verdict(c, "holds", Outcome(e, "")) for c, e in zip(cases, (0.2, 0.7), strict=True)]
    report = write_pages(cases, rows_of(verdicts), tmp_path).read_text(encoding="utf-8")
    assert "| 2 | 2 | 0.7 |" in report
    worst = f"| [{cases[1].claim}](CLAIMS.md#{cases[1].name}) | 2 | true error over twice"
    assert worst in report
    assert f"CLAIMS.md#{cases[0].name}" not in report


def test_the_hard_cases_share_one_table():
    head = ("| case | kinetostatic |", "|---|---|")
    cases = [case for case in CASES.values() if case.check == "hard.every_formulation"]
    verdicts = [
        Verdict(case, "holds", Outcome(0.0, "right", (*head, f"| {case.claim} | right |")))
        for case in cases
    ]
    _, _, table = claims_page(cases, rows_of(verdicts)).partition("## Hard cases")
    assert table.count(head[0]) == 1
    assert all(table.count(f"| {case.claim} | right |") == 1 for case in cases)


def test_a_case_file_with_an_unknown_key(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text('clam = "typo"\n[mutant]\nparameter = "rod.length"\nfactor = 2.0\n')
    with pytest.raises(TypeError, match="clam"):
        load_case(path)


def test_shifting_reaches_into_a_scene():
    scene = load_scene("propeller")
    moved = shifted(scene, "torque.0.coefficient", lambda value: 2.0 * value)
    assert moved.torque[0].coefficient == 2.0 * scene.torque[0].coefficient
    assert replace(moved, torque=scene.torque) == scene


def test_a_shifted_parameter_is_seen_or_what_came_instead_is_said():
    assert seen(CASE) == SEEN
    parameter = CASE.mutant.parameter
    unmoved = replace(CASE, mutant=Mutant(parameter, 1.0))
    assert seen(unmoved).startswith(f"holds under {parameter} shifted: ")
    shorter = CASES["honest_turning_moment_crank_angle"]
    assert shorter.mutant.until is not None
    assert seen(replace(shorter, tolerance=-1.0)).startswith("fails shortened alone: ")


def test_a_claim_that_does_not_see_its_mutant_is_red(monkeypatch, capsys, tmp_path):
    (row,) = rows_of([Verdict(CASE, "holds", Outcome(0.0, "fine"))]).values()
    assert row.green
    assert not replace(row, mutant="holds under it").green
    monkeypatch.setattr(command, "load_cases", lambda: [CASE])
    monkeypatch.setattr(command, "seen", lambda case: "holds under it")
    monkeypatch.setattr(command, "write_rows", lambda rows: None)
    monkeypatch.setattr(command, "write_pages", lambda cases, rows: "the pages")
    assert command.main([CASE.name]) == 1
    assert "; holds under it\n1 claims, 1 red" in capsys.readouterr().out


def test_a_mutant_is_on_our_side_only():
    case = replace(CASE, mutated=True, mutant=Mutant("rod.length", 1.5))
    assert case.ours().rod.length == 1.5 * case.theirs().rod.length
    assert replace(case, mutated=False).ours() == case.theirs()


def is_smooth(scene: Scene) -> bool:
    """The oracles of the claims for every scene know neither friction nor fuel."""
    return scene.friction is None and scene.fuel is None


SMOOTH = [name for name in shipped_scenes() if is_smooth(load_scene(name))]
MASSLESS = {"turning_moment"}  # it has no joint forces


def _needed() -> set[tuple[str, str]]:
    needed = set()
    for name in SMOOTH:
        for formulation in ("kinetostatic", "crank_angle", "minimal", "multibody"):
            try:
                choose(load_scene(name), formulation)
            except FormulationError:
                continue
            needed.add((name, formulation))
    return needed


def test_every_shipped_scene_has_its_claims():
    """Stated errors in every formulation; multibody at constant and at free speed."""

    def of(case: Case) -> tuple[str, str]:
        return case.scene, case.word("formulation")

    honest = {of(case) for case in CASES.values() if case.check == "honest.stated_errors"}
    assert honest == _needed()
    multibody = [case for case in CASES.values() if case.check == "multibody.closed_form"]
    free = {case.scene for case in multibody if case.theirs().start is not None}
    prescribed = {case.scene for case in multibody if case.theirs().motion is not None}
    assert free == prescribed == set(SMOOTH) - MASSLESS
    rubbed = {case.check for case in CASES.values() if case.scene not in SMOOTH}
    assert {"friction.closes", "friction.confirmed", "friction.random_errors"} <= rubbed
    other = {case.scene for case in CASES.values() if case.check == "changing.stated_scene"}
    assert other == set(shipped_scenes()) - set(SMOOTH) - {"friction"}
