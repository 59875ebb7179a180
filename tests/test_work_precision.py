"""Speed against error: the reference, the errors, the rounds, and what is written and drawn."""

import csv
import dataclasses
from pathlib import Path

import numpy as np
import pytest

from crankmbs import Motion, Run, load_scene
from crankmbs.figures.work_precision import work_precision_figure
from crankmbs.work_precision import (
    END,
    MOTION,
    WorkPrecision,
    rounds,
    save_work_precision,
)
from crankmbs.work_precision.contender import Answer, Contender, ContenderFailed
from crankmbs.work_precision.formulations import formulations_of
from crankmbs.work_precision.reference import reference_of
from crankmbs.work_precision.rounds import Row, play
from crankmbs.work_precision.trace import Trace, differences

pytestmark = pytest.mark.slow

KNOWN = Path(__file__).parent.parent / "validation" / "reference" / "end_states.csv"
SHORT = dataclasses.replace(load_scene("coasting"), run=Run(until="50 ms", every="5 deg"))
REACTIONS = ("main bearing", "crank pin", "piston pin", "side force")


@pytest.fixture(scope="module")
def reference():
    return reference_of(SHORT)


def row(contender, setting, error, time, *, is_peer=False):
    errors = {END: error} if is_peer else dict.fromkeys((END, MOTION, *REACTIONS), error)
    times = (0.5 * time, time, 3.0 * time)
    return Row(contender, is_peer, "rtol", setting, errors, None if is_peer else error, 7, times)


@pytest.fixture
def outcome(reference):
    rows = (
        row("crank_angle", 1e-3, 1e-5, 0.01),
        row("crank_angle", 1e-9, 1e-18, 0.03),
        row("peer", 1e-6, 2e-4, 0.5, is_peer=True),
    )
    return WorkPrecision(reference, rows, ("other: not here",), ("machine", "versions"))


@pytest.mark.parametrize("name", ["coasting", "propeller"])
def test_the_reference_ends_where_20_digits_say(name):
    scene = load_scene(name)
    with KNOWN.open() as stream:
        lines = csv.DictReader(line for line in stream if not line.startswith("#"))
        (known,) = (line for line in lines if line["case"] == name)
    found = reference_of(scene)
    end = Trace(
        *(np.array([float(known[key])]) for key in ("time_s", "theta_rad", "omega_rad_per_s"))
    )
    assert differences(end, found.trace, found.start)[END] <= found.floors[END]
    assert max(found.floors.values()) < 2e-12
    assert "rtol 1e-13, two passes of different order agree within " in found.sentence()


def test_with_a_prescribed_speed_the_reference_is_algebra_and_the_drive_a_reaction():
    scene = dataclasses.replace(
        SHORT, start=None, motion=Motion(speed="1000 rpm"), run=Run(until="1 rev")
    )
    found = reference_of(scene)
    assert found.sentence().startswith("kinetostatic, algebra")
    assert tuple(found.floors) == (END, MOTION, *REACTIONS, "drive torque")
    names = [contender.name for contender in formulations_of(scene, found)]
    assert names == ["kinetostatic", "multibody"]


def test_differences_are_of_the_angle_at_equal_times_the_speed_and_forces_as_vectors():
    time = np.linspace(0.0, 1.0, 11)
    force = np.column_stack([3.0 * np.ones(11), 4.0 * np.ones(11)])
    right = Trace(time, 2.0 + 10.0 * time, 10.0 * np.ones(11), {"pin": force})
    late = Trace(time + 1e-4, right.theta, right.omega, {"pin": force + np.array([0.0, 0.05])})
    found = differences(late, right, 2.0)
    assert found == pytest.approx({END: 1e-4, MOTION: 1e-4, "pin": 0.01})
    faster = dataclasses.replace(right, omega=right.omega + np.eye(1, 11, 3)[0])
    assert differences(faster, right, 2.0) == pytest.approx({END: 0.0, MOTION: 0.1, "pin": 0.0})
    assert differences(faster.end(), right, 2.0) == pytest.approx({END: 0.0})


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("ahead", [1e-3, -1e-3])
def test_ends_on_either_side_of_a_grid_angle_are_compared_on_what_both_sampled(first, ahead):
    """Also where only the last cycle is kept, and the one begins a sample later."""

    def passing(grid, end):
        theta = np.append(grid, end).astype(float)
        time = np.append(grid / 10.0, 1.0)  # at 10 rad/s; the end is at 1 s for both
        return Trace(time, theta, np.full(len(theta), 10.0), {"pin": theta[:, None]})

    near = passing(np.arange(0, 10), 10.0 - 1e-3)
    far = passing(np.arange(first, 11), 10.0 + 1e-3)
    one, other = (far, near) if ahead > 0.0 else (near, far)
    found = differences(one, other, 0.0)
    assert found == pytest.approx({END: 2e-4, MOTION: 2e-4, "pin": 2e-4}, rel=1e-3)


@pytest.mark.parametrize("index", range(5))
def test_every_formulation_errs_by_no_more_than_twice_what_it_states(reference, index):
    contender = formulations_of(SHORT, reference)[index]
    answer = contender.run(1e-5)
    found = differences(answer.trace, reference.trace, reference.start)
    assert max(found.values()) <= 2.0 * answer.stated + 2e-11
    assert answer.evaluations > 0
    assert ("end only" in contender.name) == (tuple(found) == (END,))


def test_at_an_end_on_a_dead_centre_what_is_stated_is_of_the_motion():
    """One sample there has no peaks: forces and velocities are hardly more than their errors."""
    scene = load_scene("propeller").with_(run__until="2 rev")
    reference = reference_of(scene)
    _, end_only, *_ = formulations_of(scene, reference)
    assert end_only.name == "crank_angle, end only"
    answer = end_only.run(1e-3)
    (error,) = differences(answer.trace, reference.trace, reference.start).values()
    assert error <= 2.0 * answer.stated + 1e-13 < 1e-6


def test_a_formulation_that_stops_early_is_named(reference):
    done = dataclasses.replace(reference.result, status=1)
    (contender, *_) = formulations_of(SHORT, dataclasses.replace(reference, result=done))
    with pytest.raises(ContenderFailed, match="reached the end of the run"):
        contender.run(1e-5)


def contender(run, settings=(1e-3, 1e-5, 1e-7), name="one"):
    trace = Trace(np.array([0.0, 1.0]), np.array([0.0, 2.0]), np.array([2.0, 2.0]))
    return Contender(name, "rtol", settings, lambda setting: run(setting, trace), trace)


def test_contenders_take_turns_after_a_run_that_is_not_counted(monkeypatch):
    monkeypatch.setattr(rounds, "_RESOLVED", 0.0)
    played = []

    def running(name):
        def run(setting, trace):
            played.append((name, setting))
            return Answer(trace, 5, setting)

        return contender(run, (1e-3, 1e-5), name)

    rows, notes = play((running("a"), running("b")), 0.0)
    first = [("a", 1e-3), ("a", 1e-3), ("a", 1e-5), ("b", 1e-3), ("b", 1e-3), ("b", 1e-5)]
    turn = [("a", 1e-3), ("a", 1e-5), ("b", 1e-3), ("b", 1e-5)]
    assert played == first + 4 * turn
    assert notes == ()
    assert [len(one.times) for one in rows] == [5] * 4
    assert rows[0].errors == {END: 0.0, MOTION: 0.0}
    assert (rows[0].evaluations, rows[0].stated) == (5, 1e-3)


def test_the_time_of_a_row_is_the_median():
    assert row("a", 1.0, 1.0, 0.2).time == 0.2


def test_what_takes_too_long_is_neither_refined_nor_repeated(monkeypatch):
    monkeypatch.setattr(rounds, "_PATIENCE", 0.0)
    rows, notes = play((contender(lambda setting, trace: Answer(trace, 1)),), 0.0, longest=0.0)
    assert [(one.setting, len(one.times)) for one in rows] == [(1e-3, 1)]
    assert notes == ("one, rtol 0.001: took 0 s; nothing finer was run",)


def test_what_states_more_than_asked_is_not_refined():
    rows, notes = play((contender(lambda setting, trace: Answer(trace, 1, 2e-5)),), 0.0)
    assert [one.setting for one in rows] == [1e-3, 1e-5]
    assert notes == ("one, rtol 1e-05: states 2.0e-05, no less; nothing finer was run",)


def test_what_fails_is_named_with_its_settings_and_the_others_go_on():
    def run(setting, trace):
        if setting > 1e-6:
            raise ContenderFailed("too coarse")
        return Answer(trace, 1)

    rows, notes = play((contender(run),), 0.0)
    assert [one.setting for one in rows] == [1e-7]
    assert notes == ("one, rtol 0.001, 1e-05: too coarse",)


def test_time_to_is_the_least_that_keeps_the_end_within_the_error(outcome):
    assert outcome.time_to("crank_angle", 1e-3) == 0.01
    assert outcome.time_to("crank_angle", 1e-6) == 0.03
    assert outcome.time_to("peer", 1e-6) is None


def test_the_file_has_every_row_and_says_under_what_it_was_measured(outcome, tmp_path):
    lines = save_work_precision(outcome, tmp_path).read_text().splitlines()
    said = [line for line in lines if line.startswith("# ")]
    assert said[0] == f"# reference: {outcome.reference.sentence()}"
    assert said[1:] == ["# other: not here", "# machine", "# versions"]
    rows = list(csv.DictReader(line for line in lines if line not in said))
    assert [one["contender"] for one in rows] == ["crank_angle", "crank_angle", "peer"]
    first, _, peer = rows
    assert (first["knob"], first["setting"], first["peer"]) == ("rtol", "0.001", "0")
    assert (first["error_end"], first["error_crank_pin"]) == ("1.000e-05", "1.000e-05")
    cost = {"time_s": "1.000e-02", "time_min_s": "5.000e-03", "time_max_s": "3.000e-02"}
    assert {name: first[name] for name in cost} == cost
    assert (first["runs"], first["evaluations"]) == ("3", "7")
    assert (peer["peer"], peer["stated"], peer["error_motion"]) == ("1", "", "")


def test_the_figure_has_a_panel_for_every_error_and_a_line_for_every_contender(outcome):
    figure = work_precision_figure(outcome)
    titles = [ax.get_title(loc="left") for ax in figure.axes]
    assert titles == ["state at the end", "motion over the run", *REACTIONS]
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert list(lines) == ["crank_angle", "peer"]
    floor = outcome.reference.floors[END]
    assert np.array_equal(lines["crank_angle"].get_xydata(), [[1e-5, 0.01], [floor, 0.03]])
    assert [line.get_label() for line in figure.axes[1].lines] == ["crank_angle"]
    for ax in figure.axes:
        assert ax.get_xlim()[0] < floor < 1e-5 < ax.get_xlim()[1]
        assert ax.get_ylim() == (1e-3, 1.0)
    assert {ax.get_xscale() for ax in figure.axes} == {"log"}
    assert figure.get_supxlabel().endswith("machine\nversions")


def test_what_it_was_measured_on_is_no_formula(outcome):
    figure = work_precision_figure(dataclasses.replace(outcome, machine=("$x^{$",)))
    figure.draw_without_rendering()
    assert figure.get_supxlabel().endswith("\n$x^{$")
