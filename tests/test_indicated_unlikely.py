"""Measured pressures that no cylinder had: warned of, and real ones are not."""

import numpy as np
import pytest
from exports import FIRED, MOTORED, columns_of_cycles, cycles
from records import SENSOR, Record

from crankmbs import read_pressure

ANGLE = np.arange(-360.0, 360.0, 0.5)


def warned(tmp_path, values, **options):
    path = tmp_path / "export.csv"
    path.write_text(columns_of_cycles(ANGLE, values))
    return "\n".join(read_pressure(path, **{"reference": "absolute", **options}).warnings)


@pytest.mark.parametrize(
    ("factor", "said"),
    [
        (100.0, "bar, and engines fire below 300; check its unit"),  # kPa read as bar
        (0.1, "the compression begins at an absolute 0.1 bar"),  # MPa read as bar
        (0.0689, "the compression begins at an absolute 0.07 bar"),  # bar read as psi
        (0.01, "even turned over it reaches several bar; check its unit"),
        (0.3, ""),  # throttled
        (1.0, ""),
        (3.0, ""),
    ],
)
def test_a_level_that_no_engine_has(tmp_path, factor, said):
    text = warned(tmp_path, factor * cycles(FIRED, ANGLE, 5, noise=0.01))
    assert said in text
    assert ("check its unit" in text) is bool(said)


@pytest.mark.parametrize("engine", [FIRED, MOTORED])
@pytest.mark.parametrize("digits", [0, 1, 2, 4])
@pytest.mark.parametrize("noise", [0.0, 0.02, 0.3])
def test_a_peak_that_was_cut_off(tmp_path, engine, digits, noise):
    whole = cycles(engine, ANGLE, 10, noise=noise)
    assert "stands still" not in warned(tmp_path, np.round(whole, digits))
    cut = np.minimum(np.round(whole, digits), np.floor(0.9 * whole.max()))
    assert "stands still at its highest value" in warned(tmp_path, cut)


def test_a_converter_that_holds_its_samples_cuts_nothing_off(tmp_path):
    held = np.repeat(cycles(FIRED, ANGLE[::10], 10, noise=0.02), 10, axis=1)
    assert "stands still" not in warned(tmp_path, held)


@pytest.mark.parametrize("highest", [1.0, 0.9])
def test_volts_that_were_cut_off(tmp_path, highest):
    time, volts, wheel = Record(engine=FIRED, uneven=0.0, gap=(0.0, 0.0)).columns
    volts = np.minimum(volts, volts[0] + highest * np.ptp(volts))
    rows = (f"{t:.6e};{p:.4e};{w:.4e}" for t, p, w in zip(time, volts, wheel, strict=True))
    path = tmp_path / "record.txt"
    path.write_text("\n".join(rows))
    given = {"wheel": "60-2", "sensor": SENSOR, "firing_tdc": "25 deg"}
    found = read_pressure(path, reference="absolute", **given)
    assert any("stands still" in each for each in found.warnings) is (highest < 1.0)
