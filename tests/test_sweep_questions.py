"""What a sweep answers: which value gives what is wanted, or the least."""

import re
import shlex
import sys

import pytest
from command_line import crankmbs_, names, refused

from crankmbs import (
    Estimate,
    InputError,
    flywheel,
    load_scene,
    minimize,
    sensitivity,
    sobol_indices,
    solve,
)
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.reading import reading_of
from crankmbs.sweep.solve import Asked

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")
SMOOTH = load_scene("yi_diesel").with_(run__until="1 cycles", gas=None, gravity=None)


def test_the_inertia_for_a_fluctuation_is_the_flywheel():
    (root,) = solve(SCENE, {"crank.inertia": "0.1..1 kg m^2:log"}, "fluctuation = 1 %").roots
    other = flywheel(SCENE, 0.01).inertia
    assert abs(root.value.value - other.value) <= root.value.error + other.error
    assert root.value.error < 1e-7
    assert root.reached.value == pytest.approx(0.01, abs=1e-9)


def test_every_root_in_the_range_is_found():
    """Without gas and weight the side force does not know on which side the cylinder stands."""
    found = solve(SMOOTH, {"piston.offset": "-9..10 mm"}, "peak side force = 1700 N")
    low, high = (root.value for root in found.roots)
    assert found.status == 0
    assert low.value < 0.0 < high.value
    assert abs(low.value + high.value) <= 2.0 * (low.error + high.error)
    assert found.scanned.shape == (2, 17)


def test_roots_between_two_points_of_the_scan_are_found():
    """The least side force stands at no offset, between two points; there it bends."""
    vary = {"piston.offset": "-9..10 mm"}
    found = solve(SMOOTH, vary, "peak side force = 1475 N")
    low, high = (root.value for root in found.roots)
    assert -0.6875e-3 < low.value < 0.0 < high.value < 0.5e-3
    assert abs(low.value + high.value) <= 2.0 * (low.error + high.error)
    below = solve(SMOOTH, vary, "peak side force = 1400 N")
    assert (below.roots, below.status) == ((), 1)
    assert abs(below.nearest.value.value) <= 1e-6 * 19e-3


def test_out_of_reach_is_the_nearest_and_said():
    found = solve(SCENE, {"crank.inertia": "0.2..0.4 kg m^2"}, "fluctuation = 5 %")
    assert (found.roots, found.status) == ((), 1)
    assert found.nearest.value.value == pytest.approx(0.2)
    assert found.nearest.reached.value == pytest.approx(found.scanned[1].max())
    nothing = solve(SCENE, {"rod.length": "1..9 mm"}, "fluctuation = 5 %")
    assert (nothing.nearest, nothing.status) == (None, 1)
    assert nothing.message == "no case in the range has the measure"


def test_a_peak_that_bends_is_least_where_it_bends():
    found = minimize(SMOOTH, {"piston.offset": "-8..5 mm"}, "peak side force")
    assert abs(found.values["piston.offset"]) < 1e-6 * 13e-3
    assert (found.status, found.units) == (0, {"piston.offset": "m"})


def test_a_least_value_fulfils_its_conditions():
    """More inertia costs nothing here but the condition: the least lies on the bound."""
    vary = {"crank.inertia": "0.1..1 kg m^2:log"}
    found = minimize(SCENE, vary, "peak main bearing force", ["fluctuation >= 1 %"])
    (wanted,) = solve(SCENE, vary, "fluctuation = 1 %").roots
    (condition,) = found.conditions
    assert condition.reached.value == pytest.approx(0.01, rel=2e-6)
    assert found.values["crank.inertia"] == pytest.approx(wanted.value.value, rel=1e-5)
    free = minimize(SCENE, vary, "peak main bearing force")
    assert free.values["crank.inertia"] == pytest.approx(1.0)
    assert free.message == "found, at a bound of crank.inertia: beyond it there may be less"
    assert found.message == "found"
    assert free.reached.value < found.reached.value


@pytest.mark.parametrize("most", [1.0, 0.5])
def test_along_a_kink_it_goes_on_to_the_least(monkeypatch, most):
    """100 |x - y^2| + (y - 0.9)^2, whose valley is a kink along a curve; also where y has a bound.
    A descent by quadratic models stops at once where it comes upon it."""

    class Valley:
        def __init__(self, scene, knobs, readings):
            self.known, self.readings = {}, readings

        def at(self, x, y):
            both = 100.0 * abs(x - y * y) + (y - 0.9) ** 2, y
            read = tuple(Estimate(value, 0.0) for value in both[: len(self.readings)])
            return self.known.setdefault((x, y), read)

    monkeypatch.setattr(sys.modules["crankmbs.sweep.minimize"], "Asked", Valley)
    vary = {"piston.offset": "0..1 m", "crank.inertia": "0..1 kg m^2"}
    wanted = ["fluctuation <= 0.5"] * (most < 1.0)
    found = minimize(SCENE, vary, "peak side force", wanted)
    y = min(0.9, most)
    assert found.reached.value == pytest.approx((y - 0.9) ** 2, abs=1e-3)
    reached = found.values["crank.inertia"]
    assert reached == pytest.approx(y, abs=0.03)
    assert found.values["piston.offset"] == pytest.approx(reached**2, abs=1e-4)


def test_conditions_that_nothing_fulfils_are_said():
    vary = {"crank.inertia": "0.2..0.4 kg m^2"}
    found = minimize(SCENE, vary, "peak main bearing force", ["fluctuation <= 0.1 %"])
    assert found.status == 1
    assert found.message == "nothing in the ranges fulfils the conditions"
    assert found.values["crank.inertia"] == pytest.approx(0.4, rel=1e-5)


def test_a_sensitivity_is_the_derivative():
    """Without a rod's mass, gas and weight the side force is in proportion to the piston's mass,
    and to the square of the speed."""
    light = SMOOTH.with_(rod__mass=0.0, rod__center_of_mass=0.0, rod__inertia=0.0)
    for name, power in (("piston.mass", 1.0), ("motion.speed", 2.0)):
        found = sensitivity(light, name, "peak side force")
        exact = power * found.reached.value / found.value
        assert abs(found.derivative.value - exact) <= found.derivative.error
        assert found.derivative.error < 1e-6 * exact
        assert found.elasticity == pytest.approx(power, rel=1e-9)


def test_a_sensitivity_is_the_slope_at_a_root():
    vary = {"crank.inertia": "0.2..0.4 kg m^2"}
    less, more = (
        solve(SCENE, vary, f"fluctuation = {wanted}").roots[0].value.value
        for wanted in (0.009999, 0.010001)
    )
    at = SCENE.with_(crank__inertia=0.5 * (less + more))
    slope = sensitivity(at, "crank.inertia", "fluctuation").derivative
    assert slope.value == pytest.approx(2e-6 / (more - less), rel=2e-4)


def test_where_a_peak_bends_a_sensitivity_knows_nothing(monkeypatch):
    def bent(_, share):
        return (Estimate(abs(share - 0.5) * 8e-3 * SCENE.rod.length, 0.0),)

    monkeypatch.setattr(Asked, "at", bent)
    found = sensitivity(SCENE, "rod.length", "fluctuation").derivative
    assert abs(found.value) < 1e-9
    assert found.error >= 1.0


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: solve(SCENE, {"rod.length": "1..2 m"}, "fluctuation"), "is no condition: write"),
        (lambda: solve(SCENE, {"rod.length": "1..2 m"}, "fluctuation < 1 %"), "is no condition"),
        (
            lambda: solve(SCENE, {"rod.length": "1..2 m"}, "fluctation = 1 %"),
            '"fluctation" is no measure of these cases; did you mean "coefficient of fluctuation"',
        ),
        (
            lambda: solve(SCENE, {"rod.length": "1..2 m"}, "mean speed = 3 kg"),
            'mean speed: "3 kg" is no angular speed here',
        ),
        (
            lambda: solve(SCENE, {"rod.length": "1..2 m"}, "fluctuation = 3 kg"),
            'fluctuation: must be a share, such as "1 %" or 0.01; "3 kg" came',
        ),
        (lambda: solve(SCENE, {}, "fluctuation = 1 %"), "vary must be one name and its range"),
        (
            lambda: solve(SCENE, {"rod.length": "1..2 m:4"}, "fluctuation = 1 %"),
            "rod.length: must be two bounds",
        ),
        (
            lambda: solve(load_scene("misfire"), {"fuel.seed": "1..9"}, "fluctuation = 1 %"),
            "fuel.seed: is a whole number",
        ),
        (
            lambda: solve(SMOOTH, {"rod.length": "1..2 m"}, "fluctuation = 1 %"),
            "fluctuation: with [motion] the speed is prescribed, and what is varied does not "
            "change it; free the crank with [start] and its loads, [[torque]], as crankmbs "
            "flywheel does by itself, or vary motion.speed",
        ),
        (lambda: sensitivity(SMOOTH, "rod.length", "mean speed"), "mean speed: with [motion]"),
        (
            lambda: minimize(
                SMOOTH, {"rod.length": "1..2 m"}, "peak side force", ["fluctuation < 1"]
            ),
            "fluctuation: with [motion]",
        ),
        (
            lambda: sobol_indices(
                SMOOTH, {"rod.length": "1..2 m", "rod.mass": "1..2 kg"}, "fluctuation", n=2
            ),
            "fluctuation: with [motion] the speed is prescribed",
        ),
        (lambda: minimize(SCENE, {}, "fluctuation"), "vary: needs ranges of numbers"),
        (lambda: sensitivity(SCENE, "piston.offset", "fluctuation"), "is 0 in this scene"),
        (lambda: sensitivity(SCENE, "settled_speed", "fluctuation"), "must be a number that a"),
        (lambda: sensitivity(SCENE, "rod.lenght", "fluctuation"), 'did you mean "length"?'),
        (
            lambda: minimize(SCENE, {"rod.length": "1..2 m"}, "fluctuation", ["mean speed = 3"]),
            '"mean speed = 3" is no condition: write one such as "fluctuation <= 1 %"',
        ),
    ],
)
def test_a_question_that_cannot_be_is_refused(call, said):
    with pytest.raises(InputError, match=re.escape(said)):
        call()


@pytest.mark.parametrize(
    ("words", "column"),
    [
        ("fluctuation", "fluctuation"),
        ("mean speed", "mean_speed"),
        ("peak crank pin force", "crank_pin_peak"),
        ("largest side force", "side_force_peak"),
        ("mean main bearing force", "main_bearing_mean"),
        ("main_bearing_peak", "main_bearing_peak"),
        ("side thrust by s1", "lecture_deviation"),
    ],
)
def test_measures_are_named_in_words(words, column):
    assert reading_of(words, columns_of(SCENE)).column == column


# ------------------------------------------------------------------------------- figures, commands


def test_the_commands_draw_and_solve(tmp_path):
    store = str(tmp_path / "s.zarr")
    words = ["sweep", "yi_diesel", "--vary", "rod.length=0.03..0.2 m:4", "-o", store]
    done = crankmbs_(*words)
    assert done.exit_code == 0, done.output
    assert "4 cases over rod.length\n3 reached their end\n" in done.stdout
    assert "1 cannot be built; the first: rod.length must be at least" in done.stdout
    also = re.search(
        r"\nalso stored, of each cylinder and lecture formula; to see it: (.*); an", done.stdout
    )
    assert also
    assert crankmbs_(*shlex.split(also[1])[1:], "-o", str(tmp_path / "also")).exit_code == 0
    one_value = ["--vary", "run.until=1 cycle"]
    none = ["sweep", "yi_diesel", "--vary", "rod.length=0.03..0.04 m:2", *one_value]
    none += ["-o", f"{store}_none"]
    done = crankmbs_(*none)
    assert done.exit_code == 3
    assert "2 cases over rod.length\nnone reached its end\n2 cannot be built; the" in done.stdout
    shown = ["--show", "side thrust by S1", "--show", "peak side force"]
    assert crankmbs_("plot", store, *shown, "-o", str(tmp_path / "f")).exit_code == 0
    assert names(tmp_path / "f") == {"side_thrust_by_S1.png", "peak_side_force.png"}
    metres = crankmbs_("sweep", "yi_diesel", "--vary", "rod.length=100..200:2", "-o", f"{store}_m")
    assert "also stored" not in crankmbs_(*none[:-1], f"{store}_no").stdout
    assert "2 reached their end\nwarning: rod.length: a rod of 100 m is " in metres.stdout
    assert "warning" not in done.stdout
    said = refused("plot", store, *shown[:2], "--limit", "5 N", "-o", str(tmp_path / "g"))
    assert said.startswith("--show side thrust by S1: --limit: ")
    assert "--show speed: " in refused("plot", store, "--show", "speed", "-o", str(tmp_path / "g"))
    assert not (tmp_path / "g").exists()
    one = str(tmp_path / "one.png")
    assert crankmbs_("plot", store, *shown[:2], "-o", one).stdout == f"wrote {one}\n"
    assert (tmp_path / "one.png").read_bytes()[1:4] == b"PNG"
    assert "is one file, and 2 figures come" in refused("plot", store, *shown, "-o", one)


def test_the_command_solves():
    vary = ["--vary", "rod.length=0.12..0.2 m"]
    done = crankmbs_("solve", "yi_diesel", *vary, "--for", "side thrust by S1 = 25 %")
    assert (done.exit_code, "1 found" in done.stdout) == (0, True), done.output
    done = crankmbs_("solve", "yi_diesel", *vary, "--for", "peak side force = 1 N")
    assert done.exit_code == 3
    assert "no value in the range gives this; the nearest of those tried:" in done.stdout
    condition = ["--subject-to", "peak side force <= 5 kN"]
    done = crankmbs_("solve", "yi_diesel", *vary, "--minimize", "peak crank pin force", *condition)
    assert done.exit_code == 0, done.output
    assert "<= 5000" in done.stdout
    free = crankmbs_(
        "solve",
        "propeller",
        "--vary",
        "crank.inertia=0.2..0.3 kg m^2",
        "--for",
        "fluctuation = 1.2 %",
    )
    assert "measured over the last cycle, settled or not" in free.stdout
    assert "give --for" in refused("solve", "yi_diesel", *vary)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "--vary says what is varied, as"),
        (["--vary", "rod.length"], "--vary: must be a name and its values"),
        (["--vary", "rod.length=0.1..0.2 m:2", "--vary", "rod.length=3"], "is varied twice"),
        (["--vary", "rod.length=0.1..0.2 m:2", "--cases", "c.csv"], "both came"),
        (["--cases", "c.csv", "--sample", "sobol"], "--sample spreads cases over ranges"),
        (["--vary", "rod.length=0.1..0.2 m", "--sample", "sobl"], '--sample: must be "sobol"'),
        (["--vary", "rod.length=0.1..0.2 m", "--sample", "sobol", "--n", "0"], "--n: must be a"),
        (["--vary", "rod.length=0.1..0.2 m:2", "--keep", "all"], '--keep: must be "measures"'),
        (["--vary", "rod.length=0.1..0.2 m:2", "--workers", "0"], "--workers: must be a number"),
        (["--vary", "rod.length=0.1..0.2 m:2", "--resume"], "--resume: there is no"),
    ],
)
def test_options_that_cannot_be_are_refused(words, said, tmp_path):
    assert said in refused("sweep", "yi_diesel", "-o", str(tmp_path / "s.zarr"), *words)
    assert not list(tmp_path.iterdir())
