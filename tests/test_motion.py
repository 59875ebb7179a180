"""A motion as it was solved: read anywhere, summed over, and its largest values."""

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from crankmbs import InputError, Result, Viscous, load_scene, simulate
from crankmbs.errors import OutputError
from crankmbs.measures.estimate import ROUNDING
from crankmbs.measures.nodes import nodes_of
from crankmbs.measures.peaks import run_peaks
from crankmbs.motion.free import recorder
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.report.rows import unsteady
from crankmbs.storage.netcdf import read_netcdf, write_netcdf

_ROWS = ("time", "theta", "omega", "alpha")
FREE = ["crank_angle", "minimal"]
SCENES = {
    "propeller": "2 cycles",
    "misfire": "3 cycles",
    "v_twin": "1.2 cycles",
    "run_down": "0.4 s",
    "run_up": "0.4 s",
    "torque_driven": "0.5 s",
}


def scene(name, **changes):
    return load_scene(name).with_(run__until=SCENES[name], **changes)


@cache
def solved(name, formulation):
    return simulate(scene(name), formulation=formulation)


@pytest.mark.parametrize("stages", [1, 4, 7])
def test_polynomials_through_values_are_those_polynomials(stages):
    through, degree = ends_and_nodes(stages), np.arange(stages + 2)
    factors = np.random.default_rng(stages).standard_normal(stages + 2)
    rows = (through.places[:, None] ** degree @ factors)[None]
    x, zeros = np.linspace(0.0, 1.0, 23), np.zeros(23, dtype=np.intp)
    expected = x[:, None] ** degree @ factors
    np.testing.assert_allclose(through.values(rows, zeros, x), expected, atol=1e-13)
    slopes = degree[1:] * x[:, None] ** (degree[1:] - 1) @ factors[1:]
    found = through.values(rows @ through.slopes.T, zeros, x)
    np.testing.assert_allclose(found, slopes, atol=1e-11)
    integral = float(factors[:stages] @ (1.0 / (degree[:stages] + 1.0)))
    known = through.places[:, None] ** degree[:stages] @ factors[:stages]
    assert through.weights @ known == pytest.approx(integral, abs=1e-13)


def test_the_inverse_of_a_monotone_polynomial():
    through = ends_and_nodes(3)
    rows = np.array([through.places**3, 2.0 - through.places**2])
    k, values = np.array([0, 1, 0, 0]), np.array([0.125, 1.75, 1.0, 0.0])
    np.testing.assert_allclose(through.inverse(rows, k, values), [0.5, 0.5, 1.0, 0.0], atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("name", SCENES)
def test_at_its_samples_it_is_the_samples(name, formulation):
    result = solved(name, formulation)
    motion, data = result.passes.answer, result.data
    states = motion.at(data["time"].values, in_time=True)
    turned = float(np.max(np.abs(data["crank_angle"].values)))
    np.testing.assert_allclose(states.theta, data["crank_angle"], rtol=0.0, atol=1e-12 * turned)
    fastest = float(np.max(np.abs(data["crank_speed"].values)))
    np.testing.assert_allclose(states.omega, data["crank_speed"], rtol=0.0, atol=1e-10 * fastest)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("name", ["propeller", "run_up", "run_down"])
def test_the_acceleration_is_the_rate_of_the_speed(name, formulation):
    """By central differences, but across what jumps: the median is smooth."""
    motion = solved(name, formulation).passes.answer
    rng, h = np.random.default_rng(1), 1e-6
    time = rng.uniform(motion.begin + h, motion.end - h, 200)
    before, here, after = (motion.at(time + d, in_time=True) for d in (-h, 0.0, h))
    rate = (after.omega - before.omega) / (2.0 * h)
    off = np.abs(rate - here.alpha) / np.max(np.abs(here.alpha))
    assert np.median(off) < 1e-6
    assert np.mean(off < 1e-4) > 0.9
    pace = (after.theta - before.theta) / (2.0 * h)
    np.testing.assert_allclose(pace, here.omega, atol=1e-6 * np.max(np.abs(here.omega)))


def test_by_angle_and_by_time_it_is_one_motion():
    motion = simulate(scene("propeller")).passes.answer
    angle = np.linspace(0.3, motion.turned - 0.2, 57)
    by_angle = motion.at(angle, in_time=False)
    np.testing.assert_allclose(motion.at(by_angle.time, in_time=True).theta, angle, rtol=1e-13)
    assert np.all(np.diff(by_angle.time) > 0.0)


@pytest.mark.parametrize("turned", [0.3, 4.0 * math.pi, 7.77])
def test_its_end_turns_through_an_angle(turned):
    motion = simulate(scene("propeller")).passes.answer
    last = motion.last(turned)
    assert last.turned == pytest.approx(turned, abs=1e-12)
    assert last.end == motion.end
    assert motion.at(np.array([last.begin]), in_time=True).theta[0] == pytest.approx(
        motion.turned - turned, abs=1e-11
    )
    assert motion.last(1e3) is None


@pytest.mark.parametrize("small", [0.0, 1e-9, 1e-3, 0.3, 10.0])
def test_a_magnitude_that_comes_near_zero_is_integrated_all_the_same(small):
    nodes = nodes_of(simulate(load_scene("yi_diesel")).passes.answer)
    angle = nodes.samples.theta
    parts = np.array([[np.cos(3.0 * angle + 0.1), np.full_like(angle, small)]])
    (found,) = nodes.magnitude(parts)
    begin, end = float(angle.min()), float(angle.max())
    zeros = [(math.pi * (k + 0.5) - 0.1) / 3.0 for k in range(12)]
    edges = [begin, *zeros, end]
    exact = sum(
        quad(lambda t: math.hypot(math.cos(3.0 * t + 0.1), small), a, b, epsabs=1e-12)[0]
        for a, b in pairwise(edges)
    )
    speed = float(nodes.samples.omega[0])
    assert found == pytest.approx(exact / speed, rel=1e-9)


def test_the_integral_is_over_time_and_not_over_cells():
    result = simulate(load_scene("coasting").with_(run__until="1 cycle"))
    nodes = nodes_of(result.passes.answer)
    speed = nodes.variables["crank_speed"]
    assert float(nodes.integral(np.ones_like(speed))) == pytest.approx(result.passes.answer.end)
    assert float(nodes.integral(speed)) == pytest.approx(4.0 * math.pi, rel=1e-12)


@pytest.mark.parametrize("place", [1.0, 2.0, math.radians(90.0) + 1e-7, 7.3])
def test_a_largest_value_lies_anywhere(place):
    nodes = nodes_of(simulate(load_scene("yi_diesel")).passes.answer)
    tops = nodes.tops(lambda v: np.array([2.0 - (v["crank_angle"] - place) ** 2]))
    rounded = ROUNDING * float(tops.sizes[0])
    assert tops.value[0] == pytest.approx(2.0, abs=rounded)
    assert tops.angle[0] == pytest.approx(place, abs=math.sqrt(rounded))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_largest_value_at_a_knot_is_that_of_its_own_side(side):
    """Rising to a knot and dropping there, or jumping up there and falling: exact, no hair off."""
    motion = simulate(load_scene("yi_diesel")).passes.answer
    nodes, knot = nodes_of(motion), float(motion.cells[0].angle[40, 0])

    def saw(variables):
        ahead = side * (variables["crank_angle"] - knot)
        return np.array([np.where(ahead < 0.0, 5.0 + 1e3 * ahead, 0.0)])

    tops = nodes.tops(saw)
    assert tops.value[0] == pytest.approx(5.0, abs=1e-9)
    assert tops.angle[0] == pytest.approx(knot, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["misfire", "run_down", "v_twin"])
def test_saved_and_loaded_it_is_the_same_motion(name, tmp_path):
    result = simulate(scene(name))
    result.save(tmp_path)
    again = Result.load(tmp_path)
    for one, other in (
        (result.passes.answer, again.passes.answer),
        *zip(result.passes.checks, again.passes.checks, strict=True),
    ):
        time = np.linspace(one.begin, one.end, 301)
        before, after = (motion.at(time, in_time=True) for motion in (one, other))
        rows = [(getattr(before, name), getattr(after, name)) for name in _ROWS]
        rows += [(before.computed[name], after.computed[name]) for name in before.computed]
        for old, new in rows:
            size = float(np.max(np.abs(old)))
            np.testing.assert_allclose(new, old, rtol=0.0, atol=1e-12 * size)
    assert again.measures() == result.measures()


@pytest.mark.slow
def test_a_result_of_an_earlier_version_is_refused(tmp_path):
    file = simulate(scene("propeller")).save(tmp_path) / "result.nc"
    data = read_netcdf(file, {})
    variables = {name: (one.dims, one.values, one.attrs) for name, one in data.variables.items()}
    about = data.attrs["crankmbs"].replace('"share"', '"nothing"')
    write_netcdf(variables, file, crankmbs=about)
    with pytest.raises(OutputError, match=r"earlier version.*run its scene again: crankmbs run"):
        Result.load(tmp_path)


@pytest.mark.slow
def test_by_angle_a_motion_that_turns_back_is_refused():
    result = simulate(load_scene("run_down"))
    assert not result.passes.answer.turns_one_way
    with pytest.raises(InputError, match="rests or turns back"):
        result.interp(crank_angle=[1.0])
    unchecked = replace(result, motion=lambda: result.passes._replace(checks=()))
    assert unchecked.measures().mean_speed.error == math.inf


@pytest.mark.parametrize(
    ("most", "part"), [(550_000, "the whole run"), (20_000, "what is kept of the run")]
)
def test_what_is_kept_of_a_run_is_checked(monkeypatch, most, part):
    """The pass of higher order holds more numbers: it was kept from later on, and the largest force
    had an error as large as itself."""
    monkeypatch.setattr(recorder, "_MOST_HELD", most)
    monkeypatch.setattr(recorder, "_A_SAMPLE", 1)
    result = simulate(load_scene("propeller").with_(torque=(), run__until="80 rev"))
    answer, (check,) = result.passes.answer, result.passes.checks
    assert (answer.begin == 0.0) == (part == "the whole run")
    assert check.begin <= answer.begin
    assert all(peak.value.error < 1e-6 * abs(peak.value.value) for peak in run_peaks(result))
    assert f"peaks are of {part}" in unsteady(result, result.measures())


@pytest.mark.slow
def test_of_a_long_run_with_few_samples_the_end_is_kept(monkeypatch):
    """Its events and cycles all the same, by following it once more."""
    monkeypatch.setattr(recorder, "_MOST_HELD", 20_000)
    long = load_scene("yi_diesel_free").with_(run__until="30 cycles", run__every="1 cycle")
    long = replace(long, torque=(Viscous(coefficient=0.26),))
    result = simulate(long)
    kept = result.passes.answer
    assert 0.5 * result.data["time"].values[-1] < kept.begin
    assert kept.last(long.period) is not None
    assert result.cycles.sizes["cycle"] == 30
    with pytest.raises(InputError, match=r"within what is kept of the run, 0\.\d+ to"):
        result.interp(time=[0.001])
    monkeypatch.undo()
    whole = simulate(long)
    assert whole.passes.answer.begin == 0.0
    assert whole.measures() == result.measures()
    assert whole.cycles.equals(result.cycles)
