"""A dead centre that is off is named, whatever else its pressures look like."""

import re

import numpy as np
import pytest
from exports import FIRED, MOTORED, columns_of_cycles, cycles

from crankmbs import InputError, UndecidedError, read_pressure
from validation.oracles.measured import Engine, loss_angle, mean_effective_pressure

ANGLE = np.arange(-360.0, 360.0, 0.5)
LOSS = f"{loss_angle(MOTORED)} deg"


def found(tmp_path, content, **options):
    path = tmp_path / "export.csv"
    path.write_text(content)
    return read_pressure(path, **options)


@pytest.mark.parametrize("dead_centre", [-6.0, 0.0, 6.0])
def test_a_level_by_polytrope_leaves_the_dead_centre_open(tmp_path, dead_centre):
    """The level takes up what a wrong dead centre does to the compression."""
    values = cycles(FIRED, ANGLE, 5, noise=0.02, dead_centre=dead_centre)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="polytrope 1.335")
    cylinder = there.cylinders[0]
    assert cylinder.dead_centre is None
    assert cylinder.imep_within is None
    said = str(there)
    assert "may be right" not in said
    assert (
        "the dead centre is not checked: the polytrope that gives the pressures their level fits a "
        "wrong dead centre as well"
    ) in said
    error = np.mean(cylinder.imep) / 1e5 - mean_effective_pressure(FIRED)
    assert -cylinder.imep_a_degree * dead_centre / 1e5 == pytest.approx(error, abs=0.15)
    assert f"; one degree later changes the imep by {cylinder.imep_a_degree / 1e5:+.2g}" in said


@pytest.mark.parametrize("dead_centre", [-9.0, 9.0])
def test_a_wrong_dead_centre_does_not_lead_to_a_polytrope(tmp_path, dead_centre):
    values = cycles(FIRED, ANGLE, 5, noise=0.02, dead_centre=dead_centre)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute")
    (against,) = (each for each in there.warnings if "though a polytrope" in each)
    assert " bar more: the dead centre is off, or they are " in against
    assert "polytrope 1.32" not in str(there)
    centre = there.cylinders[0].dead_centre
    assert centre.low <= dead_centre <= centre.high
    assert f"would show it {centre.middle:+.2f} +- {centre.half:.2f} degrees" in str(there)


@pytest.mark.parametrize("dead_centre", [-10.0, -8.5])
def test_a_late_dead_centre_does_not_make_a_signal_gauge(tmp_path, dead_centre):
    """What asks for one bar more may be gauge, or absolute and its dead centre off."""
    content = columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 5, dead_centre=dead_centre))
    with pytest.raises(UndecidedError) as caught:
        found(tmp_path, content)
    said = re.search(r"absolute with a dead centre (\S+) \+- (\S+) degrees", str(caught.value))
    middle, half = float(said[1]), float(said[2])
    assert middle - half <= dead_centre <= middle + half


def test_a_dead_centre_by_compression_rests_on_the_ratio(tmp_path):
    content = columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 5))
    there = found(tmp_path, content, reference="absolute", compression_ratio=14.0)
    (warned,) = there.warnings
    assert warned.endswith(", if the compression ratio of 14 and the reference are right")


@pytest.mark.parametrize("dead_centre", [-15.0, -5.0, 3.3, 5.0, 15.0])
@pytest.mark.parametrize("reference", ["absolute", "inlet 1.02 bar"])
def test_a_motored_cycle_is_one_wherever_its_dead_centre_lies(tmp_path, dead_centre, reference):
    values = cycles(MOTORED, ANGLE, 20, noise=0.05, dead_centre=dead_centre)
    content = columns_of_cycles(ANGLE, values)
    there = found(tmp_path, content, reference=reference, loss_angle=LOSS).cylinders[0]
    assert there.fired is False
    assert there.dead_centre.middle == pytest.approx(dead_centre, abs=0.03)
    exact = mean_effective_pressure(MOTORED)
    assert there.imep_within[0] / 1e5 - 0.02 < exact < there.imep_within[1] / 1e5 + 0.02
    alone = found(tmp_path, content, reference=reference)
    assert alone.cylinders[0].fired is not True
    assert any("dead centre" in each for each in alone.warnings)


@pytest.mark.parametrize("dead_centre", [0.0, 5.0])
def test_a_loss_angle_of_a_fired_cycle_is_not_dropped_in_silence(tmp_path, dead_centre):
    values = cycles(FIRED, ANGLE, 5, noise=0.02, dead_centre=dead_centre)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute", loss_angle=LOSS)
    assert there.cylinders[0].fired is True
    assert any("cylinder 1: loss_angle is not used" in each for each in there.warnings)


@pytest.mark.parametrize("dead_centre", [-3.0, 3.0])
def test_a_dead_centre_beside_the_true_one_is_no_other_reference(tmp_path, dead_centre):
    """An error that is common moves what the compression asks for by a quarter of a bar."""
    values = cycles(FIRED, ANGLE, 5, noise=0.02, dead_centre=dead_centre)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute")
    assert not any("though" in each for each in there.warnings)


@pytest.mark.parametrize("loss", [0.05, 0.1, 0.2])
def test_without_its_loss_angle_a_motored_dead_centre_is_an_interval(tmp_path, loss):
    engine = Engine(loss=loss)
    values = cycles(engine, ANGLE, 1, dead_centre=0.5)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute")
    centre = there.cylinders[0].dead_centre
    assert centre.low <= 0.5 <= centre.high
    assert centre.half < 0.6


def test_a_spike_is_no_dead_centre(tmp_path):
    values = cycles(FIRED, ANGLE, 5, noise=0.02)
    values[3, 1000] = 3e5
    with pytest.raises(InputError) as caught:
        found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute")
    assert (
        "its highest pressure, 3e+05 bar at 140 degrees in cycle 4, is a spike: the rows beside it "
    ) in str(caught.value)
    assert "firing_tdc" not in str(caught.value)


@pytest.mark.parametrize(("offset", "absolute"), [(0.0, True), (-1.0, False)])
@pytest.mark.parametrize("dead_centre", [-15.0, -8.0])
def test_a_motored_compression_tells_its_level_by_its_own_peak(
    tmp_path, dead_centre, offset, absolute
):
    values = cycles(MOTORED, ANGLE, 5, noise=0.02, dead_centre=dead_centre) + offset
    there = found(tmp_path, columns_of_cycles(ANGLE, values))
    assert there.absolute is absolute
