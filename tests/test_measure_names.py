"""Measures are taken by the names under which they are printed."""

import math
import re

import pytest
from command_line import crankmbs_

from crankmbs import Bearings, InputError, Shell, load_scene, sensitivity, simulate, sweep
from crankmbs.report.rows import tables
from crankmbs.sweep.columns import columns_of, row_of
from crankmbs.sweep.reading import reading_of

pytestmark = pytest.mark.slow

SHELL = Shell(diameter="60 mm", width="30 mm")
SHELLS = Bearings(crank_pin=SHELL, main_journal=SHELL)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("yi_diesel_free", {"run__until": "2 cycles"}),
        ("steam_engine", {"run__until": "2 cycles"}),
        ("two_stage_compressor", {"run__until": "2 cycles"}),
        ("friction", {"run__until": "2 cycles"}),
        ("coasting", {}),
        ("torque_driven", {}),
        ("validation/scenes/press.toml", {"run__until": "0.4 s"}),
        ("propeller", {"run__until": "2 cycles", "bearings": SHELLS}),
    ],
)
def test_every_measure_that_is_printed_is_taken_by_its_name(name, changes):
    scene = load_scene(name).with_(**changes)
    result, columns = simulate(scene), columns_of(scene)
    row = row_of(result, None)
    printed = tables(result, result.measures())
    names = [line[0] for table in printed for line in table.rows]
    for table in printed[1:]:  # as the heading and the line say it
        load = "specific load " if table.headings[0].startswith("specific") else ""
        joints = [line[0] for line in table.rows if "torque" not in line[0] and "[N" in line[0]]
        joints = [line[0] for line in table.rows] if load else joints
        of = [heading for heading in table.headings if heading in ("peak", "mean")]
        names += [f"{each} {load}{joint}" for each in of for joint in joints]
    names += [
        column.long_name
        for key, column in columns.items()
        if f"{key}_error" in columns and key != "lecture_deviation"
    ]
    values = {
        words: float(reading_of(words, columns).of(row)[0])
        for line in names
        for words in (line, line.partition(" [")[0])
    }
    assert all(map(math.isfinite, values.values()))


def test_a_name_is_of_what_it_says():
    scene = load_scene("yi_diesel_free").with_(run__until="2 cycles")
    result, columns = simulate(scene), columns_of(scene)
    row, measures = row_of(result, None), result.measures()

    def value(words):
        return float(reading_of(words, columns).of(row)[0])

    pins = [joint.peak.value for joint in measures.joints if joint.joint == "crank pin"]
    assert [value(f"crank pin {k} [N]") for k in (1, 2, 3, 4)] == pins
    assert value("peak crank pin force") == max(pins)
    assert value("drive power") == -value("brake power") == measures.power.value
    speeds = [measures.mean_speed.value, value("highest speed"), value("lowest speed")]
    assert speeds[1] > speeds[0] > speeds[2]
    assert (speeds[1] - speeds[2]) / speeds[0] == pytest.approx(value("fluctuation"))
    words = reading_of("largest error of side thrust by S0 (motion truncated), over its", columns)
    assert words.quantity == "side thrust"
    with pytest.raises(InputError, match="force, 5: there are 4; give a number from 1 to 4"):
        value("crank pin 5")


def test_a_figure_of_a_printed_name_has_a_plain_file_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = load_scene("propeller").with_(run__until="settled")
    sweep(scene, {"crank.inertia": [0.2, 0.3]}, out="s.zarr")
    shown = "coefficient of fluctuation, (max - min)/mean [1]", "|side force| [N]"
    done = crankmbs_("plot", "s.zarr", *(word for name in shown for word in ("--show", name)))
    assert done.exit_code == 0, done.output
    assert {file.name for file in (tmp_path / "results" / "s").iterdir()} == {
        "coefficient_of_fluctuation_max_min_mean_1.png",
        "side_force_N.png",
    }


def test_a_measure_that_is_zero_has_a_derivative_and_no_share():
    scene = load_scene("yi_diesel").with_(run__until="1 cycle")
    slope = sensitivity(scene, "motion.speed", "speed_gain")
    assert slope.reached.value == 0.0
    assert math.isnan(slope.elasticity)
    words = ["--vary", "motion.speed", "--of", "drift of the speed"]
    done = crankmbs_("sensitivity", "yi_diesel", *words)
    assert done.exit_code == 0, done.output
    assert re.search(r"drift of the speed \[rpm\] .* -$", done.stdout, re.MULTILINE)


@pytest.mark.parametrize("name", ["yi_diesel", "steam_engine", "friction", "misfire"])
def test_a_refusal_lists_the_names_that_are_printed(name):
    columns = columns_of(load_scene(name))
    with pytest.raises(InputError) as caught:
        reading_of("crank pin peek", columns)
    hint, _, listed = str(caught.value).partition("There are ")
    assert hint.endswith('; did you mean "largest crank pin force"? ')
    names, _, lectured = listed.partition(", and the error of a lecture formula, such as ")
    words = re.findall('"([^"]+)"', names)
    readings = [reading_of(each, columns) for each in words]
    assert readings[0].column == "crank_pin_peak"
    for each, reading in zip(words, readings, strict=True):
        assert reading.about.long_name.startswith(each)
    errors = {key.removesuffix("_error") for key in columns if key.endswith("_error")}
    measures = {key for key in errors if key in columns} - {"lecture_deviation", "relative"}
    assert sorted(reading.column for reading in readings) == sorted(measures)
    assert bool(lectured) == ("lecture_deviation" in columns)
    if lectured:
        assert reading_of(lectured.strip('"'), columns).quantity == "side thrust"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("side thrust by Greg", 'no lecture; did you mean "Grega"? There are "Grega", "untruncate'),
        (
            "side thurst by Yi",
            'is for "side thurst"; did you mean "side thrust"? There are "side',
        ),
    ],
)
def test_a_lecture_or_its_formula_that_there_is_not_is_refused(words, said):
    with pytest.raises(InputError, match=re.escape(said)):
        reading_of(words, columns_of(load_scene("yi_diesel")))


def test_an_option_is_named_where_its_measure_is_unknown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = load_scene("coasting").with_(run__until="1 rev")
    sweep(scene, {"crank.inertia": [0.2, 0.3]}, out="s.zarr")
    for words, option in ((["--show", "foo"], "--show foo: "), (["--over", "foo"], "--over: ")):
        done = crankmbs_("plot", "s.zarr", *words)
        assert done.exit_code == 2
        assert done.stderr.startswith(
            f'error: {option}"foo" is no measure of these cases; there ar'
        )


def test_of_swings_a_sweep_has_no_means_over_the_angle_turned():
    scene = load_scene("coasting").with_(start__speed="0 rpm", run__until="2 s")
    row = row_of(simulate(scene), None)
    assert not {"mean_speed", "piston_speed", "crank_torque", "external_torque"} & set(row)
    assert {"torque_max", "side_force_mean", "highest_speed"} < set(row)
