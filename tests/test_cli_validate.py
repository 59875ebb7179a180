"""The command ``validate``: what it prints and writes, its figures, and its exit status."""

import csv
import dataclasses
import math
import re

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import crankmbs.figures.compare as drawing
from crankmbs import Run, budget, compare, load_scene, simulate
from crankmbs.cli import app
from crankmbs.compare import CAUSES, CLOSED_FORM, LECTURES, QUANTITIES, short_name
from crankmbs.display import displayed
from crankmbs.figures import budget_figure, comparison_figure

pytestmark = pytest.mark.slow

FOLDING = """
[crank]
radius = "100 mm"
inertia = "0.01 kg m^2"

[rod]
length = "100 mm"

[piston]
mass = "0.3 kg"

[start]
angle = "0 deg"
speed = "100 rpm"

[run]
until = "1 rev"
"""

ALWAYS = [name for name in CAUSES if name not in ("friction", "forces")]


def validate(*arguments):
    return CliRunner().invoke(app, ["validate", *map(str, arguments)])


def lines_of(file):
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def diesel(tmp_path_factory):
    """The printed text and the folder of one command."""
    folder = tmp_path_factory.mktemp("diesel")
    options = ["--formulation", "kinetostatic", "--no-figures", "--verbose", "--out", folder]
    outcome = validate("yi_diesel", *options)
    assert outcome.exit_code == 0, outcome.output
    return outcome.stdout, folder


def causes_of(text):
    """The rows of the table of causes: cells by quantity and heading."""
    _, _, table = text.partition("\n\nquantity ")
    heading, _, *lines = f"quantity {table}".partition("\n\n")[0].splitlines()
    headings = re.split(r"\s{2,}", heading)
    rows = [re.split(r"\s{2,}", line) for line in lines if re.search(r"  -?\d", line)]
    return {row[0]: dict(zip(headings, row, strict=True)) for row in rows}


@pytest.fixture(scope="module")
def four():
    scene = dataclasses.replace(load_scene("yi_diesel_free"), run=Run(until="2 cycles"))
    return simulate(scene)


@pytest.mark.parametrize("name", ["grega_lecture", "steam_engine", "turning_moment", "yi_diesel"])
def test_it_answers_on_one_screen_and_writes_nothing(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = validate(name)
    assert outcome.exit_code == 0, outcome.output
    lines = outcome.stdout.splitlines()
    assert len(lines) <= 45
    assert max(map(len, lines)) <= 120
    assert list(tmp_path.iterdir()) == []


def test_the_causes_add_up_to_the_largest_error(diesel):
    found = causes_of(diesel[0])
    thrust = found["side thrust [N]"]
    assert thrust["error [%]"] == "-16.30"
    assert (thrust["at [deg]"], thrust["Grega [%]"]) == ("658", "15.59")
    assert list(found)[:2] == ["side thrust [N]", "piston pin force y [N]"]
    for row in found.values():
        parts = [float(row[name]) for name in ("series", "two-mass rod")]
        assert sum(parts) == pytest.approx(float(row["error [%]"]), abs=0.011)
    assert "gravity" not in thrust


def test_one_sentence_of_advice_says_what_the_best_refinement_leaves(diesel):
    text = " ".join(diesel[0].split())
    assert (
        "advice: with the rod's moment of inertia in place of two masses the error of the side "
        "thrust falls from 16.3 % to 5.7 %" in text
    )


def test_it_says_what_the_closed_form_is_evaluated_at_and_whose_error_is_largest(diesel):
    text = " ".join(diesel[0].split())
    assert "Newton-Euler at the run's own angle, speed and acceleration; gives this run its" in text
    assert re.search(r"num\. error \S+ % of the peak at most \([a-z ]+ of kinetostatic\)", text)
    assert "last cycle, cylinder 1 of 1, mean speed 3200.00 rpm" in text


def test_verbose_has_every_reference_and_the_largest_of_each_cause(diesel):
    text, _ = diesel
    for reference in (CLOSED_FORM, *LECTURES):
        assert f"{short_name(reference)} [%]" in text
    for quantity, about in QUANTITIES.items():
        assert text.count(f"\n{quantity} [{displayed(about.units)[1]}] ") == 2
    words = " ".join(text.split())
    assert "lie at different angles and do not add" in words
    assert "side thrust: off by up to 16.3 % of the peak, at 658 degrees: the two-mass" in words


def test_a_settled_scene_is_compared(tmp_path):
    outcome = validate("propeller", "--until", "settled")
    assert outcome.exit_code == 0, outcome.output
    assert "run          crank_angle, settled" in outcome.stdout


def test_it_writes_both_tables(diesel):
    _, folder = diesel
    files = ["budget.csv", "budget_peaks.csv", "comparison.csv"]
    assert sorted(file.name for file in folder.iterdir()) == files
    assert len(lines_of(folder / "comparison.csv")) == len(QUANTITIES) * (1 + len(LECTURES))
    causes = [line["cause"] for line in lines_of(folder / "budget_peaks.csv")]
    assert causes == [*ALWAYS, "total"] * len(QUANTITIES)


def test_multibody_is_compared_unless_told_otherwise(tmp_path):
    outcome = validate("coasting", "--until", "0.02 s", "--no-figures", "--out", tmp_path)
    assert outcome.exit_code == 0, outcome.output
    text = " ".join(outcome.stdout.split())
    assert "run multibody, reached the end of the run" in text
    (own,) = re.findall(r"the run is within (\S*) % of it", text)
    assert 0.0 < float(own) < 1e-3
    assert "left out: gas torque: the scene has no gas" in outcome.stdout
    assert "compared whole run, cylinder 1 of 1" in text
    errors = [
        float(line["max_percent"])
        for line in lines_of(tmp_path / "comparison.csv")
        if line["reference"] == CLOSED_FORM
    ]
    assert 0.0 < max(errors) < 1e-10  # in per cent


def test_a_run_that_ends_early_is_compared_and_exits_with_3(tmp_path):
    scene = tmp_path / "folding.toml"
    scene.write_text(FOLDING)
    outcome = validate(scene, "--formulation", "auto", "--no-figures", "--out", tmp_path)
    assert outcome.exit_code == 3, outcome.output
    text = " ".join(outcome.stdout.split())
    assert "whole run but for where the rod folds onto the crank, " in text
    _, _, missing = text.partition("left out of 'series': ")
    assert "side thrust" in missing
    assert "rod ratio" in missing


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["yi_diesel", "--cylinder", "2"], "cylinder must be from 1 to 1; 2 came"),
        (["yi_diesel", "--cylinder", "0"], "cylinder must be from 1 to 1; 0 came"),
        (["yi_diesel", "--until", "no end"], "--until"),
        (["yi_diesel", "--rtol", "1"], "--rtol"),
        (["yi_diesel", "--cost-cap", "0"], "cost_cap must be a time above 0 s"),
        (["no_such_scene"], "no_such_scene"),
        (["misfire"], "remove [fuel]"),
    ],
)
def test_bad_input_is_refused_before_anything_runs(tmp_path, arguments, message):
    outcome = validate(*arguments, "--no-figures", "--out", tmp_path)
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("error: ")
    assert message in outcome.stderr
    assert list(tmp_path.iterdir()) == []


def test_figures_are_drawn_of_what_can_be_compared(tmp_path, monkeypatch):
    families = {"torque": ("torque", "gas torque"), "gas": ("gas torque",)}
    monkeypatch.setattr(drawing, "FAMILIES", families)
    outcome = validate("coasting", "--formulation", "auto", "--until", "1 cycle", "--out", tmp_path)
    assert outcome.exit_code == 0, outcome.output
    drawn = sorted(file.name for file in tmp_path.glob("*.png"))
    assert drawn == ["budget_torque.png", "comparison_torque.png"]
    with Image.open(tmp_path / drawn[0]) as picture:
        assert picture.size == (2000, 1125)


def test_every_quantity_has_a_figure():
    shown = [quantity for family in drawing.FAMILIES.values() for quantity in family]
    assert sorted(shown) == sorted(QUANTITIES)


def curves(ax):
    """The labelled curves of a panel."""
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def test_a_comparison_figure_has_the_run_above_and_the_errors_below(four):
    comparison = compare(four, cylinder=2)
    figure = comparison_figure(comparison, ("piston displacement", "side thrust"))
    tops, bottoms = figure.axes[:2], figure.axes[2:]
    s1 = list(LECTURES)[-1]
    assert list(curves(tops[1])) == ["run"]
    assert list(curves(bottoms[0])) == ["Grega and Yi et al."]  # they differ in forces alone
    assert list(curves(bottoms[1])) == ["Grega", "Yi et al."]
    for ax, quantity, scale in (
        (tops[0], "piston displacement", 1e3),
        (tops[1], "side thrust", 1e-3),
    ):
        drawn = curves(ax)["run"].get_ydata()
        assert np.allclose(drawn, comparison.simulated[quantity] * scale, rtol=1e-12)
    row = comparison.row("side thrust", s1)
    error = curves(bottoms[1])["Yi et al."].get_ydata()
    assert np.allclose(error, 100.0 * row.error / row.peak, rtol=1e-12)
    labels = ["[mm]", "[kN]", "error [% of peak]", "error [% of peak]"]
    assert [ax.get_ylabel() for ax in (*tops, *bottoms)] == labels
    assert list(tops[0].get_gridspec().get_height_ratios()) == [1.0, 2.0]
    assert "cylinder 2" in figure.get_supxlabel()


def test_marks_close_to_one_another_are_all_legible():
    """Three narrow panels of a V engine: dead centres 60 degrees apart, some of two lines."""
    scene = load_scene("v_twin")
    result = simulate(dataclasses.replace(scene, run=Run(until="3 cycle", every="5 deg")))
    names = ("piston displacement", "piston velocity", "piston acceleration")
    figure = comparison_figure(compare(result), names)
    figure.draw_without_rendering()
    for ax in figure.axes[:3]:
        boxes = [text.get_window_extent() for text in ax.texts] + [
            ax._left_title.get_window_extent()
        ]
        assert len(boxes) > 4
        for number, one in enumerate(boxes):
            assert not any(one.overlaps(other) for other in boxes[:number])


def test_a_formula_of_one_s_own_looks_like_none_of_the_causes_beside_it():
    def side_thrust(phi, gas_force, rod_ratio):
        return gas_force * rod_ratio * np.sin(phi)

    rubs = simulate(load_scene("compressor").with_(friction={"ring_force": "50 N"}))
    figure = budget_figure(budget(rubs, {"mine": side_thrust}), ("side thrust",), "mine")
    top, bottom = figure.axes
    mine, causes = curves(top)["mine"], curves(bottom)
    assert "friction" in causes
    assert all(line.get_color() != mine.get_color() for line in causes.values())


def test_the_curves_of_a_budget_figure_add_up_to_the_thick_one(four):
    split = budget(four)
    figure = budget_figure(split, ("torque",))
    top, bottom = figure.axes
    drawn = {label: line.get_ydata() for label, line in curves(bottom).items()}
    total = drawn.pop("sum of the causes")
    assert list(drawn) == ["series", "constant speed", "two-mass rod"]
    assert np.allclose(sum(drawn.values()), total, rtol=0.0, atol=1e-12)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == ["run", "formula of Yi et al.", "sum of the causes", *drawn]
    assert "too small: datum, gravity, solver" in figure.get_supxlabel()
    above = {label: line.get_ydata() for label, line in curves(top).items()}
    torque = split.split("torque")
    scale = torque.peak * np.max(np.abs(above["run"])) / np.max(np.abs(torque.simulated))
    share = 100.0 * (above["formula of Yi et al."] - above["run"]) / scale
    assert np.allclose(share, total, rtol=0.0, atol=1e-11)
    degrees = curves(bottom)["series"].get_xdata()
    assert (degrees[0], degrees[-1]) == pytest.approx((0.0, 720.0))


def headline_of(figure):
    return [text.get_text() for text in figure.texts[:2]]


def test_a_slide_is_headed_by_its_largest_error_with_its_number(four):
    split = budget(four)
    worst = split.split("side thrust")
    share, at = worst.share(worst.total), math.degrees(worst.total.size.angle)
    assert headline_of(budget_figure(split, ("rod force", "side thrust"))) == [
        f"Side thrust: error of Yi et al. up to {share:.1f} %",
        f"of the peak, at {at:.0f} degrees; the two-mass rod costs up to "
        f"{worst.share(worst.cause('two-mass rod')):.1f} %",
    ]
    comparison = compare(four)
    row = max(
        (comparison.row("side thrust", name) for name in list(LECTURES)[1:]),
        key=lambda row: row.size.largest,
    )
    share = 100.0 * row.size.largest / row.peak
    first, second = headline_of(comparison_figure(comparison, ("rod force", "side thrust")))
    assert first == f"Side thrust: error of {short_name(row.reference)} up to {share:.1f} %"
    assert second.startswith(f"of the peak, at {math.degrees(row.size.angle):.0f} degrees")


def test_nothing_of_a_slide_covers_its_headline_or_legend(four):
    for figure in (
        comparison_figure(compare(four), ("torque", "gas torque")),
        budget_figure(budget(four), ("tangential force", "radial force")),
    ):
        figure.draw_without_rendering()
        legend = figure.legends[0].get_window_extent()
        lowest = min(text.get_window_extent().y0 for text in figure.texts[:2])
        assert legend.y1 <= lowest
        for ax in figure.axes:
            assert ax.get_tightbbox().y1 <= legend.y0
        width, height = figure.get_size_inches()
        assert width / height == pytest.approx(16.0 / 9.0)
        texts = [text for ax in figure.axes for text in (*ax.get_xticklabels(), *ax.texts)]
        smallest = min(text.get_fontsize() for text in texts)
        assert smallest >= 72.0 * height / 34.0  # of the height, for a reader far off


def test_a_force_of_all_cylinders_is_not_said_to_be_of_one(four):
    names = ("main bearing force x", "main bearing force y")
    for figure in (
        comparison_figure(compare(four, cylinder=2), names),
        budget_figure(budget(four, cylinder=2), names),
    ):
        assert "cylinder" not in figure.get_supxlabel().removeprefix(four.scene.title)


def test_nothing_to_draw_is_no_figure():
    scene = dataclasses.replace(load_scene("coasting"), run=Run(until="1 rev"))
    result = simulate(scene)
    assert comparison_figure(compare(result), ("gas torque",)) is None
    assert budget_figure(budget(result), ("gas torque",)) is None
