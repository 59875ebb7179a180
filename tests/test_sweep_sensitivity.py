"""Sobol's indices of measures whose law is known, and the command for them and for derivatives."""

import re

import numpy as np
import pytest
from command_line import crankmbs_, refused
from scipy import stats
from swept import block_of

from crankmbs import InputError, load_scene, sobol_indices
from crankmbs.sweep import workers

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")
SMOOTH = load_scene("yi_diesel").with_(run__until="1 cycles", gas=None, gravity=None)
# a side force in proportion to the piston's mass and the square of the speed
LIGHT = SMOOTH.with_(rod__mass=0.0, rod__center_of_mass=0.0, rod__inertia=0.0)
MASS, SPEED = "piston.mass", "motion.speed"
CUBE = {"crank.inertia": "-1..1", "rod.length": "-1..1", "piston.mass": "-1..1"}


def ishigami(x, y, z):
    return (
        np.sin(np.pi * x)
        + 7.0 * np.sin(np.pi * y) ** 2
        + 0.1 * (np.pi * z) ** 4 * np.sin(np.pi * x)
    )


@pytest.fixture
def ishigamis(monkeypatch):
    """The mean speed is Ishigami's function of three knobs, with an error of its own."""

    def solved(job):
        values = np.array([given[:3] for given in job.values])
        errors = np.full(len(values), 1e-9)
        return block_of(job, mean_speed=ishigami(*values.T), mean_speed_error=errors)

    monkeypatch.setattr(workers, "solved", solved)


def within(estimate, exact):
    return abs(estimate.value - exact) <= estimate.error


def test_the_indices_of_ishigami_are_printed_ones(ishigamis):
    """Ishigami and Homma 1990, a = 7, b = 0.1: 0.3139, 0.4424, 0 and 0.5576, 0.4424, 0.2437."""
    (found,) = sobol_indices(SCENE, CUBE, "mean speed", n=1024, executor=1)
    assert (found.status, found.runs, found.knobs) == (0, 5120, tuple(CUBE))
    for one, exact in zip(found.first, (0.3139, 0.4424, 0.0), strict=True):
        assert within(one, exact)
    for one, exact in zip(found.total, (0.5576, 0.4424, 0.2437), strict=True):
        assert within(one, exact)
    assert all(one.error < 0.1 for one in (*found.first, *found.total))


def test_they_are_those_of_scipy(ishigamis):
    (found,) = sobol_indices(SCENE, CUBE, "mean speed", n=64, seed=5, executor=1)
    ranges = [stats.uniform(-1.0, 2.0)] * 3
    scipys = stats.sobol_indices(func=lambda x: ishigami(*x), n=64, dists=ranges, rng=5)
    np.testing.assert_allclose([one.value for one in found.first], scipys.first_order, atol=1e-12)
    np.testing.assert_allclose([one.value for one in found.total], scipys.total_order, atol=1e-12)
    boot = scipys.bootstrap()
    for ours, theirs in ((found.first, boot.first_order), (found.total, boot.total_order)):
        errors = [one.error / 1.96 for one in ours]
        np.testing.assert_allclose(errors, theirs.standard_error, rtol=0.25)


def test_a_product_of_two_has_the_indices_of_its_closed_form():
    """Of Y = m w^2: S_m = V(m) E(w^2)^2 / V(Y), S_w = E(m)^2 V(w^2) / V(Y), and what both lack of 1
    is added to each total."""
    vary = {MASS: "1..2 kg", SPEED: "100..300 rad/s", "crank.inertia": "1..2 kg m^2"}
    (found,) = sobol_indices(LIGHT, vary, ["peak side force"], n=32, executor=1)
    mean, square = 1.5, (300.0**3 - 100.0**3) / 3.0 / 200.0
    of_mass, of_square = 1.0 / 12.0, (300.0**5 - 100.0**5) / 5.0 / 200.0 - square**2
    variance = of_mass * square**2 + mean**2 * of_square + of_mass * of_square
    first = of_mass * square**2 / variance, mean**2 * of_square / variance
    for k in (0, 1):
        assert within(found.first[k], first[k])
        assert within(found.total[k], 1.0 - first[1 - k])
    assert found.first[2].value == pytest.approx(0.0, abs=1e-9)
    assert found.total[2].value == pytest.approx(0.0, abs=1e-9)


def test_the_error_of_the_measure_is_in_that_of_the_index(monkeypatch):
    def solved(job):
        values = np.array([given[0] for given in job.values])
        errors = np.full(len(values), 1e-2)
        return block_of(job, mean_speed=values, mean_speed_error=errors)

    monkeypatch.setattr(workers, "solved", solved)
    (found,) = sobol_indices(SCENE, CUBE, "mean speed", n=64, executor=1)
    assert found.first[1].value == 0.0
    assert found.first[1].error == pytest.approx(8e-2 * 3.0**0.5, rel=1e-2)


def test_a_knob_without_effect_on_anything_gives_no_indices():
    vary = {"crank.mass": "1..2 kg", "crank.inertia": "1..2 kg m^2"}
    (found,) = sobol_indices(SMOOTH, vary, "peak side force", n=4, executor=1)
    assert (found.status, np.isnan(found.first[0].value)) == (1, True)
    assert found.message == "largest |side force| is the same in all 16 runs"


def test_runs_without_the_measure_are_counted_and_placed():
    vary = {"rod.length": "0.03..0.2 m", MASS: "1..2 kg"}
    (found,) = sobol_indices(SMOOTH, vary, "peak side force", n=8, executor=1)
    said = r"(\d+) of 32 runs have no largest \|side force\|, and indices need all; the first at "
    said += r"rod\.length = 0\.0\d+ m, piston\.mass = 1\.\d+ kg: rod\.length must be at least .*"
    match = re.fullmatch(said, found.message)
    assert found.status == 1
    assert 0 < int(match[1]) < 32
    assert found.message.endswith("; narrow the ranges")


@pytest.mark.parametrize(
    ("vary", "words", "said"),
    [
        ({MASS: "1..2 kg"}, {}, "vary must be two names or more and their ranges"),
        ({MASS: "1..2 kg", "rod.length": "1..2 m:4"}, {}, "rod.length: must be two bounds"),
        (
            CUBE,
            {"n": 100},
            "from 2 on, or Sobol's points are not balanced; 100",
        ),
        (CUBE, {"n": 1}, "n must be a power of two from 2 on"),
        (CUBE, {"seed": -1}, "seed must be a whole number from 0"),
        (CUBE, {"measures": "fluctation"}, 'did you mean "coefficient of fluctuation"?'),
    ],
)
def test_what_has_no_indices_is_refused(vary, words, said):
    with pytest.raises(InputError, match=re.escape(said)):
        sobol_indices(SCENE, vary, **({"measures": "fluctuation"} | words))


def test_the_command_shows_derivatives_and_indices():
    words = ["sensitivity", "yi_diesel", "--of", "peak side force"]
    done = crankmbs_(*words, "--vary", "piston.mass", "--vary", "rod.length")
    assert done.exit_code == 0, done.output
    line = r"largest \|side force\| \[N\] +1678\.\d+ +piston\.mass \[kg\] +1\.14158 +-?\d"
    assert re.search(line, done.stdout)
    ranges = ["--vary", "piston.mass=1..2 kg", "--vary", "rod.length=0.14..0.2 m"]
    done = crankmbs_(*words, *ranges, "--n", "4", "--workers", "1")
    assert done.exit_code == 0, done.output
    assert "largest |side force|, from 16 runs\n\nknob " in done.stdout
    assert "\npiston.mass = 1..2 kg " in done.stdout
    assert "settled or not" not in done.stdout  # the speed is prescribed
    short = ["--vary", "piston.mass=1..2 kg", "--vary", "rod.length=0.03..0.2 m"]
    done = crankmbs_(*words, *short, "--n", "4", "--workers", "1")
    assert (done.exit_code, "16 runs have no" in done.stdout) == (3, True)
    assert "give one kind" in refused(*words, "--vary", "rod.length", *ranges)
