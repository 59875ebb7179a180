"""What a result and a scene show of themselves, and what can be asked of a result by a method."""

import dataclasses
import math
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from matplotlib.figure import Figure

import crankmbs
from crankmbs import InputError, Motion, Run, load_scene, simulate
from crankmbs.compare import OBSERVABLES, short_name
from crankmbs.digits import digits, error_digits
from crankmbs.display import displayed
from crankmbs.measures import measure
from crankmbs.scene.units import RPM
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.reading import reading_of

FIRED = load_scene("propeller")
SHORT = dataclasses.replace(FIRED, run=Run(until="2 cycles"))
HOSTILE = '</td><script>alert("&")</script><img src=x onerror=alert(1)>'


@pytest.fixture(scope="module")
def short():
    return simulate(SHORT)


class Markup(HTMLParser):
    """Collects tags and text; what does not close is told."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.open, self.text = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


ALLOWED = {"div", "p", "b", "table", "tr", "th", "td", "img"}


def shown(thing, pictures=1):
    found = Markup(thing._repr_html_())
    assert not found.open
    assert set(found.tags) <= ALLOWED
    assert found.tags.count("img") == pictures
    return " ".join(found.text)


def test_a_comparison_and_a_budget_show_themselves_as_tables(short):
    text = shown(crankmbs.compare(short), pictures=0)
    row = crankmbs.compare(short).row("side thrust", "S1 (motion and forces truncated)")
    assert digits(100.0 * row.size.largest / row.peak, most=3) in text
    assert "closed form [%]" in text
    text = shown(crankmbs.budget(short), pictures=0)
    assert "constant speed" in text
    assert "the error of the side thrust falls from" in text


def test_a_comparison_has_a_dataframe_in_the_units_of_people(short):
    def mean_speed(mean_omega):
        return mean_omega + RPM

    formulas = {"crank speed": lambda mean_omega: mean_omega, "mine": mean_speed}
    found = crankmbs.compare(short, formulas)
    table = found.to_dataframe()
    assert table.index.is_unique
    assert len(table) == len(found.rows) + len(found.numbers)
    for row in found.rows:
        scale, unit = displayed(OBSERVABLES[row.quantity].units)
        line = table.loc[(f"{row.quantity} [{unit}]", short_name(row.reference))]
        sizes = np.array([row.size.largest, row.size.rms])
        assert line["run"] == row.peak / scale
        assert line[["difference", "RMS difference"]].tolist() == (sizes / scale).tolist()
        shares = line[["difference [%]", "RMS difference [%]"]].to_numpy()
        np.testing.assert_allclose(shares, 100.0 * sizes / row.peak)
        assert line["angle [deg]"] == math.degrees(row.size.angle)
    line = table.loc[("mean speed [rpm]", "mine")]
    assert line["difference"] == pytest.approx(1.0)
    assert line["run"] == found.numbers[0].simulated.value / RPM
    assert line["difference [%]"] == pytest.approx(100.0 / line["run"])
    assert math.isnan(line["angle [deg]"])
    text = shown(found, pictures=0)
    for words in ("crank speed [rpm]", "piston displacement [mm]", "mean speed by mine [rpm]"):
        assert words in text


def test_what_is_printed_of_them_is_a_line(short):
    texts = [repr(crankmbs.compare(short)), repr(crankmbs.budget(short))]
    texts.append(repr(crankmbs.confirm(short)))
    assert "closed form" in texts[0]
    assert "the error of the" in texts[1] or "off by up to" in texts[1]
    assert "exudyn's rigid bodies agree to" in texts[2]
    assert all("\n" not in text and len(text) < 400 for text in texts)


@pytest.mark.parametrize("name", ["Grega", "S0", "S0 (motion truncated)"])
def test_a_reference_is_found_by_what_it_is_called_anywhere(short, name):
    comparison, split = crankmbs.compare(short), crankmbs.budget(short)
    assert comparison.row("side thrust", name).reference == "S0 (motion truncated)"
    s1 = {"Grega": "Yi et al.", "S0": "S1"}.get(name, "S1 (motion and forces truncated)")
    assert split.split("side thrust", s1) == split.split("side thrust")


def test_rows_of_a_comparison_and_of_a_budget_are_lines_too(short):
    comparison, split = crankmbs.compare(short), crankmbs.budget(short).split("side thrust")
    texts = repr(comparison.rows[0]), repr(split), repr(split.total), repr(split.causes)
    assert all("array" not in text for text in texts)
    assert all(len(text) < 400 for text in texts[:3])
    assert "side thrust by S0" in repr(comparison.row("side thrust", "S0"))


def test_tables_say_of_what_their_angles_are_and_name_formulas_alike(short):
    for table in (crankmbs.compare(short), crankmbs.budget(short)):
        text = shown(table, pictures=0)
        assert "cycle angle of the cylinder, of the main bearing the crank angle" in text
        assert "Yi et al." in text
        assert "S1 (" not in text


def test_a_result_shows_its_measures_with_errors_and_a_figure(short):
    text, speed = shown(short), short.measures().mean_speed
    assert "reached the end of the run" in text
    assert "mean speed [rpm]" in text
    assert digits(speed.value * 30.0 / np.pi) in text
    assert "piston pin" in text


def test_the_text_of_a_scene_is_never_markup():
    scene = dataclasses.replace(SHORT, title=HOSTILE, source=HOSTILE)
    result = simulate(scene)
    for thing in (scene, result):
        assert HOSTILE in shown(thing)  # as text, once parsed
    assert HOSTILE in shown(result.measures(), pictures=0)
    assert HOSTILE in shown(result.at("60 deg"), pictures=0)


def test_measures_and_readings_show_themselves_in_the_units_of_people(short):
    measures, state = short.measures(), short.at("60 deg")
    text = shown(measures, pictures=0)
    for words in ("mean speed [rpm]", "indicated power [kW]", "gauge pressure [bar]", "crank pin"):
        assert words in text
    driven = simulate(load_scene("torque_driven")).measures()
    assert "not periodic: the speed changes by +131 rpm" in shown(driven, pictures=0)
    assert error_digits(measures.mean_speed.error * 30.0 / np.pi) in text
    text = shown(state, pictures=0)
    for words in ("at 60 deg of the last cycle", "crank speed [rpm]", "rod angle [deg]", "F_oj"):
        assert words in text


def test_their_dataframes_have_errors_beside_values(short):
    measures, state = short.measures(), short.at("60 deg")
    table = measures.to_dataframe()
    speed = table.loc["mean speed [rpm]"]
    assert speed["value"] == measures.mean_speed.value / RPM
    assert speed["error"] == measures.mean_speed.error / RPM
    (pin,) = (force for force in measures.joints if force.joint == "crank pin")
    largest = table.loc["largest crank pin force [N]"]
    assert largest["value"] == pin.peak.value
    assert largest["cycle angle [deg]"] == pytest.approx(math.degrees(pin.cycle_angle))
    columns = columns_of(SHORT)
    assert len({reading_of(name, columns).column for name in table.index}) == len(table)
    table = state.to_dataframe()
    assert len(table) == len(state.readings)
    assert "M_k = F_T r - m r^2 alpha" in table.attrs["remarks"][2]
    for reading in state.readings:
        scale, unit = displayed(reading.units)
        row = table.loc[f"{reading.quantity.replace('_', ' ')} [{unit}]"]
        assert (row["value"], row["error"]) == (reading.value / scale, reading.error / scale)
        assert row["symbol"] == reading.symbol


def test_a_dataframe_of_measures_says_its_window_and_leaves_out_what_run_leaves_out(short):
    assert short.measures().to_dataframe().attrs["window"] == "last cycle"
    driven = simulate(load_scene("torque_driven")).measures()
    table = driven.to_dataframe()
    assert not driven.steady
    assert table.attrs["window"] == driven.window.kind
    assert not any("fluctuation" in name or "efficiency" in name for name in table.index)
    assert any("fluctuation" in name for name in short.measures().to_dataframe().index)


def test_a_dataframe_of_many_cylinders_has_a_line_for_each():
    result = simulate(load_scene("yi_diesel_free").with_(run__until="1 cycles"))
    measures, state = result.measures().to_dataframe(), result.at("60 deg").to_dataframe()
    forces = result.data["side_force"].sel(time=result.at("60 deg").time, method="nearest").values
    for k in range(1, 5):
        assert f"largest crank pin force {k} [N]" in measures.index
        at = state.loc[f"side force {k} [N]", "value"]
        assert at == pytest.approx(forces[k - 1], rel=1e-6)


@pytest.mark.parametrize(
    "name", ["yi_diesel_free", "v_twin", "torque_driven", "run_up", "friction"]
)
def test_a_scene_shows_its_machine(name):
    scene = load_scene(name)
    text = shown(scene)
    assert "crank" in text
    assert scene.title in text
    assert f"until {scene.run.until.value:g}" in text


@pytest.mark.parametrize(
    ("parts", "status"),
    [
        ({"run": Run(until="0.1 deg", every="0.1 deg")}, 0),
        ({"run": Run(until="3 rev", every="none")}, 0),
        ({"start": None, "torque": (), "motion": Motion(speed=0.0), "run": Run(until="1 s")}, 0),
        ({"start": crankmbs.Start(angle=0.0, speed=0.0), "torque": (), "gas": None}, 1),
    ],
)
def test_every_result_shows_itself(parts, status):
    result = simulate(dataclasses.replace(FIRED, **parts))
    assert result.status == status
    assert f"status {status}" in shown(result)
    assert f"status {status}" in repr(result)


def test_a_repr_is_one_short_line(short):
    wordy = dataclasses.replace(SHORT, title="line\n" * 1000)
    for thing in (short, SHORT, simulate(wordy), wordy):
        assert len(repr(thing)) < 250
        assert "\n" not in repr(thing)


def test_a_method_gives_what_the_function_gives(short):
    assert short.measures() == measure(short)
    assert short.at("60 deg") == crankmbs.at_angle(short, "60 deg")


def test_a_dataframe_is_the_samples_in_degrees(short):
    frame = short.to_dataframe()
    assert frame.index.name == "crank_angle [deg]"
    np.testing.assert_array_equal(frame.index, np.degrees(short.data["crank_angle"].values))
    np.testing.assert_array_equal(frame["time [s]"], short.data["time"].values)
    rate = np.degrees(short.data["rod_angular_speed"].values[:, 0])
    np.testing.assert_allclose(frame["rod_angular_speed 1 [deg/s]"], rate, rtol=1e-15)
    assert not [heading for heading in frame.columns if "rad" in heading]
    error = short.data["crank_speed"].attrs["error_estimate"]
    stated = frame.attrs["error_estimate"]
    assert stated["crank_speed [deg/s]"] == pytest.approx(np.degrees(error))
    assert set(stated) == {frame.index.name, *frame.columns}


def test_a_dataframe_has_a_column_for_each_cylinder():
    scene = dataclasses.replace(load_scene("yi_diesel_free"), run=Run(until="10 deg"))
    result = simulate(scene)
    frame = result.to_dataframe()
    for k in range(4):
        np.testing.assert_array_equal(
            frame[f"side_force {k + 1} [N]"], result.data["side_force"][:, k]
        )


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["speed", "motion", "forces", "polar", "torque", "orders"])
def test_a_plot_is_a_figure_that_a_notebook_shows(short, kind):
    figure = short.plot(kind)
    assert isinstance(figure, Figure)
    assert figure._repr_png_()[:4] == b"\x89PNG"


def test_a_polar_plot_is_of_the_joint_asked_for(short):
    titles = [
        short.plot("polar", joint).axes[0].get_title() for joint in ("main_bearing", "piston_pin")
    ]
    assert titles[0].startswith("main bearing")
    assert titles[1].startswith("piston pin")


def test_cycles_are_drawn_from_four_on(short):
    with pytest.raises(InputError, match="drawn from 4 on, and this run has 2;"):
        short.plot("cycles")
    longer = simulate(dataclasses.replace(FIRED, run=Run(until="4 cycles", every="5 deg")))
    assert longer.plot("cycles").axes[-1].get_xlabel() == "cycle"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("sped",), 'or "polar"; "sped" came; did you mean "speed"?'),
        (("polar", "crankpin"), '"piston_pin"; "crankpin" came; did you mean "crank_pin"?'),
        ((["speed"],), 'or "polar"; \\["speed"\\] came'),
    ],
)
def test_a_plot_that_there_is_not_is_refused(short, arguments, said):
    with pytest.raises(InputError, match=said):
        short.plot(*arguments)


@pytest.mark.slow
def test_nothing_that_draws_is_loaded_before_it_is_asked_for():
    code = (
        "import sys, crankmbs; crankmbs.simulate(crankmbs.load_scene('yi_diesel'));"
        "assert 'matplotlib' not in sys.modules; crankmbs.figures.plot;"
        "assert 'matplotlib' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.slow
def test_the_floors_above_a_result_are_imported_by_its_methods_alone():
    code = (
        "import sys, types; package = types.ModuleType('crankmbs'); "
        f"package.__path__ = [{crankmbs.__path__[0]!r}]; sys.modules['crankmbs'] = package;"
        "import crankmbs.result;"
        "above = {'measures', 'compare', 'figures', 'report', 'simulate'};"
        "loaded = {name.split('.')[1] for name in sys.modules if name.startswith('crankmbs.')};"
        "assert 'result' in loaded and not loaded & above"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
