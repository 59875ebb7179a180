"""What is found in measured pressures is what was put into them: an oracle that shares no code."""

import numpy as np
import pytest
from exports import FIRED, HEADER, MOTORED, columns_of_cycles, cycles, text

from crankmbs import CylinderTable, Gas, InputError, load_scene, read_pressure
from validation.oracles.measured import (
    Engine,
    loss_angle,
    mean_effective_pressure,
    pressure_of,
)

ANGLE = np.arange(-360.0, 360.0, 0.5)
LOSS = f"{loss_angle(MOTORED)} deg"


def found(tmp_path, content, encoding="utf-8", scene=None, **options):
    path = tmp_path / "export.csv"
    path.write_text(content, encoding=encoding)
    return read_pressure(path, scene, **options)


@pytest.mark.parametrize("dead_centre", [-1.3, -0.35, 0.0, 0.1, 0.8])
@pytest.mark.parametrize(("noise", "count"), [(0.0, 1), (0.05, 20), (0.2, 100)])
def test_a_motored_dead_centre_is_found(tmp_path, dead_centre, noise, count):
    values = cycles(MOTORED, ANGLE, count, noise=noise, dead_centre=dead_centre)
    there = found(
        tmp_path, columns_of_cycles(ANGLE, values), reference="absolute", loss_angle=LOSS
    ).cylinders[0]
    assert there.fired is False
    centre = there.dead_centre
    assert centre.middle == pytest.approx(dead_centre, abs=0.03)
    assert centre.low <= dead_centre <= centre.high
    assert centre.half < 0.1


@pytest.mark.parametrize(
    "engine", [FIRED, Engine(heat=15.0, loss=0.05), Engine(heat=8.0, loss=0.2)]
)
@pytest.mark.parametrize("dead_centre", [-1.0, 0.0, 1.0])
def test_a_fired_dead_centre_is_an_interval(tmp_path, engine, dead_centre):
    values = cycles(engine, ANGLE, 5, noise=0.02, dead_centre=dead_centre)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute").cylinders[0]
    assert there.fired is True
    assert there.dead_centre.low <= dead_centre <= there.dead_centre.high
    assert there.dead_centre.half < 4.0


def test_the_dead_centre_is_moved_only_on_request(tmp_path):
    values = cycles(MOTORED, ANGLE, 1, dead_centre=0.5)
    content = columns_of_cycles(ANGLE, values)
    kept = found(tmp_path, content, reference="absolute", loss_angle=LOSS)
    assert any('firing_tdc="0.50 deg" takes the one found' in each for each in kept.warnings)
    moved = found(tmp_path, content, reference="absolute", loss_angle=LOSS, firing_tdc="0.5 deg")
    assert not moved.warnings
    exact = mean_effective_pressure(MOTORED)
    assert moved.cylinders[0].imep[0] / 1e5 == pytest.approx(exact, abs=2e-3)
    assert kept.cylinders[0].imep[0] / 1e5 == pytest.approx(exact, abs=0.5)
    assert abs(kept.cylinders[0].imep[0] / 1e5 - exact) > 0.1  # what half a degree costs
    low, high = (imep / 1e5 for imep in kept.cylinders[0].imep_within)
    assert low - 2e-3 < exact < high + 2e-3  # and what stands beside it
    beside = (
        f" with the file's dead centre, from {low:.4g} to {high:.4g} bar with the dead centre "
        "where it may lie"
    )
    assert any(beside in sentence for sentence in kept.sentences)


@pytest.mark.parametrize("engine", [MOTORED, FIRED])
def test_imep_is_the_area_of_the_cycle(tmp_path, engine):
    values = cycles(engine, ANGLE, 1)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute").cylinders[0]
    exact = mean_effective_pressure(engine)
    assert there.imep[0] / 1e5 == pytest.approx(exact, abs=2e-4 * 70.0 / 10.0)


def test_an_offset_of_each_cycle_is_taken_off_by_the_inlet(tmp_path):
    values = cycles(FIRED, ANGLE, 10, noise=0.02, offset=-3.0)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="inlet 1.02 bar")
    assert there.absolute
    put_in = 3.0 * (1.0 + 0.1 * np.arange(10))
    assert there.cylinders[0].offset / 1e5 == pytest.approx(put_in, abs=0.03)


def test_an_offset_of_each_cycle_is_taken_off_by_the_compression(tmp_path):
    values = cycles(FIRED, ANGLE, 10, noise=0.02, offset=-3.0)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="polytrope 1.335")
    put_in = 3.0 * (1.0 + 0.1 * np.arange(10))
    assert there.cylinders[0].offset / 1e5 == pytest.approx(put_in, abs=0.1)
    apart = there.cylinders[0].offset / 1e5 - put_in
    assert np.ptp(apart) < 0.05  # from cycle to cycle the exponent does not matter


def test_an_exact_polytrope_gives_its_offset_exactly(tmp_path):
    from validation.oracles.measured import relative_volume

    closed = np.abs(ANGLE) < 180.0
    pressure = np.where(closed, relative_volume(MOTORED, ANGLE) ** -1.3 * 43.0, 1.0)
    values = (pressure - 5.0)[None]
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="polytrope 1.3")
    assert there.cylinders[0].offset[0] / 1e5 == pytest.approx(5.0, abs=1e-4)


@pytest.mark.parametrize(("offset", "absolute"), [(0.0, True), (-1.0, False)])
def test_the_compression_tells_gauge_from_absolute(tmp_path, offset, absolute):
    values = cycles(FIRED, ANGLE, 3, noise=0.02) + offset
    there = found(tmp_path, columns_of_cycles(ANGLE, values))
    assert there.absolute is absolute
    assert any("as the compression shows" in each for each in there.sentences)


def test_the_unit_tells_gauge_from_absolute(tmp_path):
    values = cycles(FIRED, ANGLE, 1)
    assert found(tmp_path, columns_of_cycles(ANGLE, values, head="", reference="(a)")).absolute
    gauge = columns_of_cycles(ANGLE, values - 1.0, head="", reference="g")
    assert not found(tmp_path, gauge).absolute


@pytest.mark.parametrize(("word", "offset"), [("abs", 0.0), ("gauge", -1.0)])
def test_the_name_tells_gauge_from_absolute(tmp_path, word, offset):
    content = text([ANGLE, pressure_of(FIRED, ANGLE) + offset], ["CA", f"p_{word} [bar]"])
    there = found(tmp_path, content)
    assert there.absolute is (word == "abs")
    assert there.sentences[1].endswith(" (as the heading says)")


@pytest.mark.parametrize(
    ("offset", "reference", "against"),
    [
        (
            0.0,
            "gauge",
            "asks for -0.12 to 0.25 bar more: the dead centre is off, or they are absolute)",
        ),
        (
            -1.0,
            "absolute",
            "asks for 0.88 to 1.25 bar more: the dead centre is off, or they are gauge)",
        ),
        (-1.0, "gauge 1 bar", ""),
        (
            -1.0,
            "gauge 0.6 bar",
            "asks for 0.88 to 1.25 bar more: the dead centre is off, or the reference is wrong)",
        ),
        (
            -0.5,
            "absolute",
            "asks for 0.38 to 0.75 bar more: the dead centre is off, or they are neither absolute "
            "nor gauge)",
        ),
        (-0.5, "polytrope 1.32", ""),
    ],
)
def test_a_reference_is_held_against_the_compression(tmp_path, offset, reference, against):
    content = columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 1) + offset)
    there = found(tmp_path, content, reference=reference)
    assert (len(there.warnings) == 1) is bool(against), there.warnings
    assert all(each.endswith(against) and ", though a poly" in each for each in there.warnings)
    if against and reference == "absolute":
        said = str(there)
        assert "the dead centre is not checked: its compression would show it -" in said
        assert "if the reference is right; check the dead centre first" in said
        assert "firing_tdc" not in said
        assert "with the dead centre where it may lie" not in said


@pytest.mark.parametrize("noise", [0.01, 0.1, 0.5])
def test_noise_is_measured(tmp_path, noise):
    values = cycles(FIRED, ANGLE, 10, noise=noise)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute").cylinders[0]
    assert there.noise / 1e5 == pytest.approx(noise, rel=0.1)


STEPS = {
    "1 and 0.1 about the dead centre": np.repeat([1.0, 0.1, 1.0], [300, 1500, 270]),
    "2 and 0.5": np.repeat([2.0, 0.5, 2.0], [150, 300, 135]),
    "2 and 0.1": np.repeat([2.0, 0.1, 2.0], [150, 1500, 135]),
    "jittered": 0.5 + 0.2 * np.sin(np.arange(1440.0)),
    "10": np.full(72, 10.0),
}


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("noise", [0.05, 0.5])
def test_noise_is_measured_whatever_the_steps(tmp_path, steps, noise):
    angle = np.round(-360.0 + np.append(0.0, np.cumsum(STEPS[steps])), 4)
    angle = angle[angle < 359.9]
    content = columns_of_cycles(angle, cycles(FIRED, angle, 20, noise=noise))
    there = found(tmp_path, content, reference="absolute")
    assert there.cylinders[0].noise / 1e5 == pytest.approx(noise, rel=0.1)
    assert "no noise" not in str(there)


def test_a_mean_cycle_lowers_the_peak(tmp_path):
    late = [Engine(heat=15.0, burns=begin) for begin in (-8.0, -4.0, 0.0, 4.0)]
    values = np.array([pressure_of(each, ANGLE) for each in late])
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute")
    expected = np.mean(values.max(axis=1)) - values.mean(axis=0).max()
    assert there.cylinders[0].lowered / 1e5 == pytest.approx(expected, abs=1e-3)
    assert expected > 1.0
    assert f"mean cycle's peak is {expected:.3g} bar below the mean of the peaks" in str(there)


def test_smoothing_is_on_request_and_says_what_it_moved(tmp_path):
    values = cycles(FIRED, ANGLE, 5, noise=0.3)
    content = columns_of_cycles(ANGLE, values)
    rough = found(tmp_path, content, reference="absolute").cylinders[0]
    assert rough.moved is None
    there = found(tmp_path, content, reference="absolute", smooth="6 deg")
    peak, _, imep = there.cylinders[0].moved
    assert peak == pytest.approx(np.max(there.cylinders[0].mean) - np.max(rough.mean), abs=1.0)
    assert imep == pytest.approx(np.mean(there.cylinders[0].imep) - np.mean(rough.imep), abs=1.0)
    assert "smoothing moves the peak of the mean cycle by " in str(there)
    clean = pressure_of(FIRED, ANGLE)
    off = [np.std(each.mean / 1e5 - clean) for each in (rough, there.cylinders[0])]
    assert off[1] < 0.6 * off[0]


ORDER = (0.0, 180.0, 540.0, 360.0)  # by which cylinders 1 to 4 fire behind the first


def four(*, own=False, count=3, step=0.5, noise=0.01):
    """Four cylinders over the angle of the first, or each over its own."""
    angle = np.arange(0.0, 720.0 * count, step)
    rng = np.random.default_rng(5)
    lags = (0.0,) * 4 if own else ORDER
    made = [
        (1.0 - 0.02 * k) * pressure_of(FIRED, angle - 360.0 - lag)
        + noise * rng.standard_normal(len(angle))
        for k, lag in enumerate(lags)
    ]
    names, units = ["CA", *(f"PCYL{k}" for k in range(1, 5))], ["deg", *["bara"] * 4]
    return text([angle % 720.0, *made], names, units, head=HEADER)


def test_every_cylinder_has_its_firing_dead_centre(tmp_path):
    there = found(tmp_path, four())
    assert [each.firing % 720.0 for each in there.cylinders] == [360.0, 540.0, 180.0, 0.0]
    assert [each.lag for each in there.cylinders] == pytest.approx(
        ORDER,
        abs=1.5,  # a sensitivity 2 to 6 % too low puts a flank later
    )
    for k, each in enumerate(there.cylinders):
        exact = (1.0 - 0.02 * k) * mean_effective_pressure(FIRED)
        assert np.mean(each.imep) / 1e5 == pytest.approx(exact, abs=0.01)


@pytest.mark.parametrize("own", [False, True])
def test_the_table_is_what_a_scene_reads(tmp_path, own):
    there = found(tmp_path, four(own=own))
    assert isinstance(there.table, CylinderTable)
    assert there.aligned is own
    gas = Gas(pressure=there.table, ambient="1 bar", aligned=there.aligned)
    for k, table in enumerate(gas.tables):
        angle = np.degrees(table.x)
        lag = 0.0 if own else ORDER[k]
        exact = (1.0 - 0.02 * k) * pressure_of(FIRED, angle - 360.0 - lag)
        assert np.array(table.y) / 1e5 == pytest.approx(exact, abs=0.05)


def test_a_written_table_is_read_by_a_scene(tmp_path):
    there = found(tmp_path, four())
    path = there.save(tmp_path / "table.csv")
    lines = path.read_text().splitlines()
    assert lines[0] == f"# cylinder pressure from {tmp_path / 'export.csv'}"
    assert '# pressure = "table.csv"' in lines
    scene = (tmp_path / "scene.toml").write_text(
        """
[crank]
radius = "46 mm"
[rod]
length = "153.3333 mm"
[piston]
mass = "1.1 kg"
bore = "85.25 mm"
[layout]
firing_order = [1, 2, 4, 3]
[gas]
pressure = "table.csv"
ambient = "1 bar"
[motion]
speed = "2000 rpm"
[run]
until = "1 cycles"
"""
    )
    assert scene
    gas = load_scene(tmp_path / "scene.toml").gas
    assert gas.pressure.y[2] == pytest.approx(there.table.y[2], rel=1e-8)


def test_a_sequence_follows_the_engine(tmp_path):
    there = found(tmp_path, four(count=5), cycles="all")
    assert there.cycles == "sequence"
    angle = np.degrees(there.table.x)
    assert angle[-1] - angle[0] == pytest.approx(3 * 720.0 - 0.5)
    for k, row in enumerate(there.table.y):
        exact = (1.0 - 0.02 * k) * pressure_of(FIRED, angle - 360.0 - ORDER[k])
        assert np.array(row) / 1e5 == pytest.approx(exact, abs=0.06)
    one = found(tmp_path, four(count=5), cycles=2)
    assert len(one.table.x) == 1440
    assert one.table.y[0] == there.table.y[0][1440:2880]


def test_the_offset_of_a_scene_moves_the_true_dead_centre(tmp_path):
    scene = load_scene("yi_diesel")
    there = found(
        tmp_path,
        columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 1)),
        scene=scene,
        reference="absolute",
    )
    top = np.degrees(np.arcsin(scene.piston.offset / (scene.crank.radius + scene.rod.length)))
    peak = np.degrees(there.table.x[int(np.argmax(there.table.y))])
    assert peak == pytest.approx(360.0 + top + 12.0, abs=0.5)


def test_the_header_is_compared_with_the_scene(tmp_path):
    head = HEADER.replace("92", "95").replace("18", "16,5")
    content = columns_of_cycles(ANGLE, cycles(FIRED, ANGLE, 1), head=head)
    there = found(tmp_path, content, scene=load_scene("yi_diesel"), reference="absolute")
    assert (
        "warning: the file's header gives a stroke of 95 mm, the scene 92.0036 mm; the scene's is "
        "used: is it the same engine?"
    ) in there.warnings


def test_what_cannot_be_is_warned_of(tmp_path):
    backwards = cycles(FIRED, ANGLE, 1)[:, ::-1]
    there = found(tmp_path, columns_of_cycles(ANGLE, backwards), reference="absolute")
    assert any("before the dead centre: check the dead centre" in w for w in there.warnings)
    late = cycles(MOTORED, ANGLE, 1, dead_centre=2.0)
    there = found(tmp_path, columns_of_cycles(ANGLE, late), reference="absolute")
    assert any("motored, and the gas gives work to the piston" in w for w in there.warnings)
    low = cycles(FIRED, ANGLE, 1) - 3.0
    there = found(tmp_path, columns_of_cycles(ANGLE, low), reference="absolute")
    assert any("an absolute pressure falls to -1.98" in w for w in there.warnings)
    with pytest.raises(InputError, match=r"the table's column 1 falls to -1\.98 bar"):
        there.save(tmp_path / "table.csv")
    drifting = cycles(FIRED, ANGLE, 1) + 0.01 * ANGLE
    there = found(tmp_path, columns_of_cycles(ANGLE, drifting), reference="gauge")
    assert any("the signal drifts" in w for w in there.warnings)


def test_half_cycles_of_a_four_stroke_engine_are_no_two_stroke_ones(tmp_path):
    angle = np.arange(-360.0, 720.0 * 5 - 360.0, 0.5)
    pressure = pressure_of(FIRED, angle)
    halves = text([angle, pressure], ["CA", "PCYL1"], ["deg", "bar(a)"], head=HEADER)
    there = found(tmp_path, halves, stroke=2)
    assert there.warnings == (
        "warning: cylinder 1: every second cycle compresses nothing: its dead centre is 0.1 bar "
        "above its lowest pressure, that of the others 52.5 bar; these are the halves of "
        "four-stroke cycles, which stroke=4 reads",
    )
    assert there.sentences[-2].endswith("; check the stroke first")
    assert not found(tmp_path, halves).warnings
    turn = np.arange(-180.0, 180.0, 0.5)
    fails = [pressure_of(each, turn) for each in [FIRED, MOTORED] * 5]
    misfiring = text([np.tile(turn, 10), np.concatenate(fails)], ["CA", "PCYL1"], ["deg", "bar(a)"])
    assert not any("every second" in each for each in found(tmp_path, misfiring, stroke=2).warnings)


def test_every_cycle_is_judged_and_no_table_goes_below_zero(tmp_path):
    values = cycles(FIRED, ANGLE, 5)
    values[3, 100] = -2.0  # a spike that the mean hides
    content = columns_of_cycles(ANGLE, values)
    mean = found(tmp_path, content, reference="absolute")
    assert (
        "warning: cylinder 1: an absolute pressure falls to -2 bar, -310 degrees from the dead "
        "centre in cycle 4, below zero in 1 of 5 cycles: check the reference, and the signal for "
        "spikes"
    ) in mean.warnings
    mean.save(tmp_path / "mean.csv")
    every = found(tmp_path, content, reference="absolute", cycles="all")
    with pytest.raises(InputError) as caught:
        every.save(tmp_path / "all.csv")
    assert str(caught.value) == (
        "all.csv: the absolute pressure of the table's column 1 falls to -2 bar at a crank "
        "angle of 2210 degrees, and none is below zero; where the signal has spikes take "
        'cycles="mean", other cycles or smooth="3 deg", where its zero is off another reference, '
        'such as reference="inlet 1.0 bar"'
    )
    assert not (tmp_path / "all.csv").exists()


def test_an_inverted_signal_is_turned_over_on_request(tmp_path):
    values = -cycles(FIRED, ANGLE, 1)
    there = found(tmp_path, columns_of_cycles(ANGLE, values), reference="absolute", invert=True)
    assert there.cylinders[0].peaks[0] / 1e5 == pytest.approx(
        pressure_of(FIRED, ANGLE).max(), abs=1e-3
    )
