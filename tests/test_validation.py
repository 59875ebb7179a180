"""The machinery of the claims: what is red, what a run writes, and that no scene is forgotten."""

from dataclasses import replace

import pytest

from crankmbs import load_scene, shipped_scenes
from crankmbs.choose import choose
from crankmbs.errors import FormulationError
from validation import __main__ as command
from validation import judge as judging
from validation import reference
from validation.case import Case, Mutant, load_case, load_cases, shifted
from validation.judge import Outcome, Skipped, Verdict, judge
from validation.report import write_report

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


def test_report(monkeypatch, tmp_path):
    green = Verdict(CASE, "holds", Outcome(1e-14, "fine", table=("| a |", "|---|", "| 1 |")))
    red = Verdict(CASES["khurmi_speed_printed"], "fails", Outcome(3.0, "too far"))
    text = write_report([green, red], tmp_path).read_text(encoding="utf-8")
    assert "1 of 2 claims hold." in text
    assert "| 1 |" in text
    assert "mutants turn a test or a claim red" in text
    assert "**fails**" in text
    for case in (green.case, red.case):
        assert text.count(f'<a id="{case.name}"></a>') == 1
        assert case.reason in text
        assert case.source in text


def test_the_hard_cases_share_one_table(tmp_path):
    head = ("| case | kinetostatic |", "|---|---|")
    cases = [case for case in CASES.values() if case.check == "hard.every_formulation"]
    verdicts = [
        Verdict(case, "holds", Outcome(0.0, "right", (*head, f"| {case.claim} | right |")))
        for case in cases
    ]
    text = write_report(verdicts, tmp_path).read_text(encoding="utf-8")
    _, _, table = text.partition("## Hard cases")
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


def test_a_mutant_is_on_our_side_only():
    case = replace(CASE, mutated=True, mutant=Mutant("rod.length", 1.5))
    assert case.ours().rod.length == 1.5 * case.theirs().rod.length
    assert replace(case, mutated=False).ours() == case.theirs()


# the oracles of the claims for every scene know no friction; it has claims of its own
SMOOTH = [name for name in shipped_scenes() if load_scene(name).friction is None]


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
    assert free == prescribed == set(SMOOTH)
    rubbed = {case.check for case in CASES.values() if case.scene not in SMOOTH}
    assert {"friction.closes", "friction.confirmed", "friction.random_errors"} <= rubbed
