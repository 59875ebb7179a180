"""The highest value, between the samples and wherever it lies."""

import numpy as np
import pytest

from crankmbs.measures.peak import highest, rise

SHAPES = {
    "smooth": lambda t: np.exp(-((t / 6.0) ** 2)),
    "kink": lambda t: 1.0 - 0.05 * np.abs(t) - 0.01 * t,
    "jump up": lambda t: np.where(t < 0.0, 0.0, 1.0 - 0.05 * t),
    "jump down": lambda t: np.where(t <= 0.0, 1.0 + 0.05 * t, 0.0),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("shift", [0.0, 0.01, 0.2, 0.5, 0.77, 0.99])
def test_rise_covers_a_peak_between_samples_and_is_no_idle_caution(shape, shift):
    samples = SHAPES[shape](np.arange(-20.0, 20.0) + shift)
    found = rise(samples, int(np.argmax(samples)))
    missing = 1.0 - samples.max()
    assert missing <= 1.3 * found + 1.5e-4
    # where the true rise cannot be known it is what one interval can bring
    assert found <= 1.3 * missing + (0.06 if "jump" in shape else 1e-3)


@pytest.mark.parametrize("at", [0, 1, 2, 38, 39])
def test_rise_near_an_end_uses_the_samples_there_are(at):
    t = np.arange(40.0) - at - 0.3
    assert rise(1.0 - 0.01 * t**2, at) == pytest.approx(9e-4 if at < 39 else 0.0, rel=0.05)


def test_rise_of_a_single_sample_is_zero():
    assert rise(np.ones(1), 0) == 0.0


@pytest.mark.parametrize("top", [0.1, 0.3, 0.5, 0.7, 0.9, 1.3])
def test_a_peak_right_after_a_jump_may_rise_above_its_sample(top):
    """The farther samples lie before the jump and say nothing about the peak behind it."""
    x = np.arange(-4.0, 5.0)
    values = np.where(x < 0.0, -500.0, 1000.0 - 8.0 * (x - top) ** 2)
    at = int(np.argmax(values))
    missed = 1000.0 - values[at]
    assert missed <= rise(values, at) <= missed + 20.0


FORCES = {
    "two maxima": lambda t: np.maximum(
        1.0 - 900.0 * (t - 0.23) ** 2, 0.999 - 2e5 * (t - 0.615) ** 2
    ),
    "the later one": lambda t: np.maximum(
        0.999 - 900.0 * (t - 0.23) ** 2, 1.0 - 900.0 * (t - 0.615) ** 2
    ),
    "bend": lambda t: 1.0 - 20.0 * np.abs(t - 0.377),
    "jump up": lambda t: np.where(t < 0.377, 0.0, 1.0 - (t - 0.377)),
    "jump down": lambda t: np.where(t <= 0.377, 1.0 + (t - 0.377), 0.0),
    "constant": lambda t: np.ones_like(t),
    "at the beginning": lambda t: 1.0 - t,
    "at the end": lambda t: t,
}


@pytest.mark.parametrize("force", FORCES)
@pytest.mark.parametrize("count", [51, 173])
def test_the_highest_value_is_found_wherever_it_lies(force, count):
    time = np.linspace(0.0, 1.0, count) ** 1.1
    rows = lambda t: np.stack([FORCES[force](t), -FORCES[force](t)])  # noqa: E731
    when, top = highest(time, rows(time), rows)
    assert top[0] == pytest.approx(1.0, abs=1e-12)
    assert FORCES[force](when[0]) == top[0]
    assert highest(time, rows(time), None)[1][0] == rows(time)[0].max()
