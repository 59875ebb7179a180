"""What is varied is named as in every message, keeps its units, and brings what follows it."""

import math
import re

import numpy as np
import pytest

from crankmbs import InputError, Ramp, Sample, load_scene, sweep
from crankmbs.mechanics.carried import carried_over
from crankmbs.sweep.cases import cases_of
from crankmbs.sweep.knobs import interval_of, knob_of, number_at
from crankmbs.sweep.scenes import scene_of

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")
ENGINE = load_scene("yi_diesel")
GRID = {"crank.inertia": "0.2..0.4 kg m^2:3", "rod.length": [0.15, 0.16]}


@pytest.mark.parametrize(
    ("name", "given", "values"),
    [
        ("crank.inertia", "0.1..0.3 kg m^2:3", (0.1, 0.2, 0.3)),
        ("rod__length", "100..400 mm:3:log", (0.1, 0.2, 0.4)),
        ("start.speed", "60 rpm, 1 rad/s", (2.0 * math.pi, 1.0)),
        ("torque[1].coefficient", [1e-4], (1e-4,)),
        ("rod.inertia", "two-mass, 1e-3", ("two-mass", 1e-3)),
        ("gas.interpolation", "pchip,cubic", ("pchip", "cubic")),
        ("rod_ratio", "0.2..0.3:2", (0.2, 0.3)),
        ("run.until", "1..3 cycles:2", ("1 cycles", "3 cycles")),
        ("piston.mass", np.array([1.0, 2.0]), (1.0, 2.0)),
    ],
)
def test_values_are_named_with_their_units(name, given, values):
    found = tuple(knob_of(SCENE, name, given).values.tolist())
    assert found == pytest.approx(values) if isinstance(values[0], float) else found == values


def test_whole_numbers_stay_whole():
    scene = load_scene("misfire")
    assert knob_of(scene, "fuel.seed", "1..5:5").values.tolist() == [1, 2, 3, 4, 5]
    (drawn,) = cases_of(scene, Sample({"fuel.seed": "1..4"}, 256)).knobs
    assert np.unique(drawn.values, return_counts=True)[1].tolist() == [64, 64, 64, 64]


def test_a_file_is_read_once_for_all_cases(tmp_path):
    table = tmp_path / "gas.csv"
    table.write_text("crank_angle_deg,pressure_bar\n0,1\n300,1\n360,40\n420,2\n")
    (value,) = knob_of(ENGINE, "gas.pressure", str(table)).values
    table.unlink()
    assert scene_of(ENGINE, ["gas.pressure"], [value]).gas.pressure.y[2] == 40e5


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        ("rod.lenght", "1..2:3", 'rod.lenght: a Rod has no "lenght"; did you mean "length"?'),
        ("rod_rato", "1..2:3", 'did you mean "rod_ratio"?'),
        ("rod.length", "1..2 kg:3", 'rod.length: "1 kg" is no length here: use m, cm, mm or in'),
        ("rod.length", "1..2 m", "rod.length: a range needs how many values it has, from 2 to"),
        ("rod.length", "1..2 m:1", "a range needs how many values it has"),
        ("rod.length", "1..2 m:3:lin", "a range needs how many values it has"),
        ("rod.length", "-1..2 m:3:log", "both bounds must be of one sign, not 0"),
        ("start.speed", "1..2:3", "start.speed: "),
        ("rod_ratio", "0.1..0.2 mm:2", 'rod_ratio: takes numbers without a unit; "mm" came'),
        ("rod_ratio", "light", 'rod_ratio: "light" is no number; write values as'),
        ("gas.interpolation", "pchop", 'must be "pchip", "linear", "cubic" or "step"'),
        ("gas.pressure", "none.csv", "gas.pressure: file none.csv is missing"),
        ("rod.length", [], "rod.length: must have from 1 to 100000 values; 0 came"),
        ("rod.length", 0.2, "rod.length: must be a text or a sequence of values; 0.2 came"),
    ],
)
def test_values_that_cannot_be_are_refused_by_name(name, given, said):
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        knob_of(SCENE, name, given)
    assert "\n" not in str(caught.value)


def test_a_sample_needs_ranges_without_a_count():
    assert interval_of(SCENE, "rod.length", "1..2 m:log").log
    with pytest.raises(InputError, match=r"rod\.length: must be two bounds"):
        sweep(SCENE, Sample({"rod.length": "1..2 m:3"}, 4))


@pytest.mark.parametrize("method", ["sobol", "latin"])
def test_a_sample_fills_its_ranges_evenly(method):
    vary = {"rod.length": "0.1..0.3 m", "crank.inertia": "0.01..1 kg m^2:log"}
    rod, crank = cases_of(SCENE, Sample(vary, 64, method, seed=3)).knobs
    assert np.histogram(rod.values, 8, (0.1, 0.3))[0].tolist() == [8] * 8
    assert np.histogram(np.log10(crank.values), 8, (-2, 0))[0].tolist() == [8] * 8
    again = cases_of(SCENE, Sample(vary, 64, method, seed=3))
    assert again.fingerprint == cases_of(SCENE, Sample(vary, 64, method, seed=3)).fingerprint
    assert again.fingerprint != cases_of(SCENE, Sample(vary, 64, method, seed=4)).fingerprint


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"n": 0}, "n must be a whole number from 1 to"),
        ({"n": True}, "n must be a whole number from 1 to"),
        ({"n": 4, "seed": -1}, "seed must be a whole number from 0 to"),
        ({"n": 4, "method": "random"}, 'method must be "sobol" or "latin"; "random" came'),
    ],
)
def test_a_sample_that_cannot_be_is_refused(given, said):
    with pytest.raises(InputError, match=said):
        Sample({"rod.length": "1..2 m"}, **given)


def test_cases_are_read_from_a_table(tmp_path):
    file = tmp_path / "cases.csv"
    file.write_text("# mine\ncrank.inertia [kg m^2],rod.length [mm],gas.interpolation\n")
    with pytest.raises(InputError, match="needs a header with names and a row for each case"):
        cases_of(SCENE, file)
    with file.open("a") as stream:
        stream.write("0.2,150,pchip\n0.3, 160,cubic\n")
    cases = cases_of(SCENE, file)
    assert (cases.count, cases.shape) == (2, (2,))
    assert cases.values([slice(1, 2)]) == ((0.3, 0.16, "cubic"),)
    with file.open("a") as stream:
        stream.write("0.2,,cubic\n")
    with pytest.raises(InputError, match="case 3 has 2 values under a header of 3"):
        cases_of(SCENE, file)
    with pytest.raises(InputError, match="of cases is missing"):
        cases_of(SCENE, tmp_path / "none.csv")


@pytest.mark.parametrize("vary", [{}, 3, None])
def test_nothing_to_vary_is_refused(vary):
    with pytest.raises(InputError, match="vary must name what is varied, such as"):
        sweep(SCENE, vary)


def test_a_knob_under_two_names_is_refused():
    with pytest.raises(InputError, match=r"rod\.length: is varied twice"):
        sweep(SCENE, {"rod.length": [0.15], "rod__length": [0.16]})


@pytest.mark.parametrize("executor", [0, True, "two", 1.5])
def test_an_executor_is_a_number_or_an_executor(executor):
    with pytest.raises(InputError, match="executor must be a number of workers from 1 to 512"):
        sweep(SCENE, GRID, executor=executor)


# ---------------------------------------------------------------------------------- derived knobs


def test_a_rod_ratio_keeps_stroke_mass_and_shape():
    scene = scene_of(ENGINE, ["rod_ratio"], [0.25])
    stretch = scene.rod.length / ENGINE.rod.length
    assert scene.crank == ENGINE.crank
    assert scene.rod.length == pytest.approx(4.0 * ENGINE.crank.radius, rel=1e-15)
    assert scene.rod.mass == ENGINE.rod.mass
    assert scene.rod.center_of_mass == pytest.approx(stretch * ENGINE.rod.center_of_mass)
    assert scene.rod.moment_of_inertia == pytest.approx(
        stretch**2 * ENGINE.rod.moment_of_inertia, rel=1e-14
    )


def test_with_another_geometry_the_gas_is_carried_over_the_volume():
    longer = scene_of(SCENE, ["rod.length"], [0.2])
    assert longer.gas != SCENE.gas
    assert longer == carried_over(SCENE.with_(rod__length=0.2), SCENE)
    heavier = scene_of(SCENE, ["piston.mass"], [2.0])
    assert heavier.gas == SCENE.gas


@pytest.mark.parametrize("wanted", [200.0, 300.0])
def test_loads_are_scaled_to_a_mean_speed(wanted):
    found = sweep(SCENE, {"settled_speed": [wanted]}, executor=1)
    assert float(found["mean_speed"][0]) == pytest.approx(wanted, rel=2e-8)
    scene = scene_of(SCENE, ["settled_speed"], [wanted])
    assert scene.torque[0].coefficient > SCENE.torque[0].coefficient
    assert scene.run == SCENE.run


@pytest.mark.parametrize(
    ("scene", "speed", "said"),
    [
        (ENGINE, 300.0, r"under \[motion\] vary motion.speed instead"),
        (load_scene("turning_moment"), 300.0, "no load of the scene depends on the speed"),
        (SCENE, -300.0, "must be a speed in the sense of start.speed"),
    ],
)
def test_a_settled_speed_that_no_load_gives_is_refused(scene, speed, said):
    with pytest.raises(InputError, match=said):
        scene_of(scene, ["settled_speed"], [speed])


def test_a_key_that_python_calls_otherwise_has_its_number():
    ramp = Ramp(start=100.0, to=200.0, over=1.0)
    scene = load_scene("yi_diesel").with_(motion__speed=ramp)
    assert number_at(scene, "motion.speed.from").values.tolist() == [100.0]
