"""Records over time: what is read from teeth and volts is the motion and the pressure put in."""

import numpy as np
import pytest
from command_line import crankmbs_, names, refused
from exports import FIRED, MOTORED
from records import SENSOR, Record, text_of, written

from crankmbs import InputError, UndecidedError, load_scene, read_pressure, read_speed
from validation.oracles.measured import loss_angle, pressure_of

GIVEN = {"wheel": "60-2", "sensor": SENSOR, "reference": "absolute"}
BAR, RPM = 1e5, np.pi / 30.0


def tdc(record, less=0.0):
    """Behind the first edge as it is seen, of any revolution."""
    return f"{(record.dead_centre - record.errors[0]) % 360.0 - less} deg"


def check_speed(speed, record):
    """The mean cycle's speed over the cycle angle, whose 360 degrees are the dead centre."""
    angle = np.degrees(speed.table.x) - 360.0 + record.dead_centre
    exact = record.speed(angle) / 6.0 * RPM
    apart = np.abs(np.array(speed.table.y) - exact)
    assert apart.max() <= speed.error < 0.02 * exact.mean()
    half = len(angle) // 2
    odd = 0.5 * (np.array(speed.table.y) - exact)
    assert np.abs(odd[:half] - odd[half:-1]).max() <= speed.half_order_error < speed.error


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"delay": 8e-4, "dead_centre": 25.0},
        {"seed": 2, "noise": 0.05},
        {"seed": 3, "teeth": 36, "missing": 1, "uneven": 0.1, "gap": (0.0, 0.0)},
        {"seed": 4, "uneven": 0.0, "dead_centre": 700.0},
    ],
)
def test_table_and_speed_are_those_put_in(tmp_path, options):
    record = Record(engine=FIRED, **options)
    given = {**GIVEN, "wheel": f"{record.teeth}-{record.missing}", "firing_tdc": tdc(record)}
    if record.delay:
        given["delay"] = f"{1e3 * record.delay} ms"
    found = read_pressure(written(tmp_path, text_of(**options)), **given)
    angle = np.degrees(found.table.x) - 360.0
    exact = pressure_of(FIRED, angle)
    right = float(str(found).split("mean cycle are then right to ")[1].split()[0])
    assert right < 0.5
    steepest = np.abs(np.gradient(exact, angle)).max()
    apart = np.abs(np.array(found.table.y) / BAR - exact).max()
    assert apart <= steepest * (right + 0.02) + 4.0 * record.noise  # samples are 0.36 degrees
    check_speed(found.speed, record)


def test_a_motored_dead_centre_is_found(tmp_path):
    record = Record(engine=MOTORED)
    found = read_pressure(
        written(tmp_path, text_of(engine=MOTORED)),
        **GIVEN,
        loss_angle=f"{loss_angle(MOTORED)} deg",
    )
    truth = (record.dead_centre - record.errors[0]) % 720.0
    assert found.cylinders[0].firing == pytest.approx(truth, abs=0.1)
    assert "by its motored peak" in str(found)


def test_a_fired_dead_centre_is_found_by_its_compression(tmp_path):
    record = Record(engine=FIRED)
    scene = load_scene("yi_diesel").with_(crank__radius="46 mm", rod__length="153.3333 mm")
    found = read_pressure(
        written(tmp_path, text_of()), scene, **GIVEN, compression_ratio=18.0, stroke=4
    )
    truth = (record.dead_centre - record.errors[0]) % 720.0
    (said,) = [each for each in found.sentences if "where the pressure shows it" in each]
    assert abs(found.cylinders[0].firing - truth) <= float(said.split(" +- ")[1].split()[0]) < 4.0
    assert "by its compression" in said


def test_one_sentence_asks_for_all_of_it(tmp_path):
    path = written(tmp_path, text_of())
    with pytest.raises(UndecidedError) as caught:
        read_pressure(path)
    for option in ('wheel="60-2"', "sensor=", "reference=", "firing_tdc=", "compression_ratio"):
        assert option in str(caught.value)
    with pytest.raises(UndecidedError, match="where the dead centre lies is not said"):
        read_pressure(path, **GIVEN)


def test_names_and_units_need_less(tmp_path):
    time, _, wheel = Record(engine=FIRED).columns
    bar = pressure_of(FIRED, Record(engine=FIRED).angle_at(time) - 385.0)
    rows = "\n".join(
        f"{1e3 * t:.3f};{w:.4f};{p:.4f}" for t, w, p in zip(time, wheel, bar, strict=True)
    )
    path = written(tmp_path, "Time [ms];Wheel [V];PCYL1 [bar(a)]\n" + rows)
    with pytest.raises(UndecidedError) as caught:
        read_pressure(path, firing_tdc="24 deg")
    assert "sensor" not in str(caught.value)
    assert "reference" not in str(caught.value)
    found = read_pressure(path, wheel="60-2", firing_tdc=tdc(Record(engine=FIRED)))
    assert np.max(found.table.y) / BAR == pytest.approx(bar.max(), rel=1e-3)


def test_an_encoder_has_its_mark(tmp_path):
    record = Record(engine=FIRED, teeth=180, missing=0, uneven=0.0)
    time, volts, pulses = record.columns
    mark = (np.mod(record.angle_at(time) + 0.3, 360.0) < 1.0).astype(float)
    rows = "\n".join(
        f"{t:.5f};{v:.5f};{w:.4f};{m:g}"
        for t, v, w, m in zip(time, volts, pulses, mark, strict=True)
    )
    path = written(tmp_path, "Time [s];P [V];A [V];Z [V]\n" + rows)
    given = {**GIVEN, "wheel": "180", "firing_tdc": "25 deg"}
    found = read_pressure(path, index="Z", **given)
    check_speed_loosely(found.speed, record)
    with pytest.raises(InputError, match="has no gap, so no tooth is the first"):
        read_pressure(path, **given)


def check_speed_loosely(speed, record):
    angle = np.degrees(speed.table.x) - 360.0 + record.dead_centre
    np.testing.assert_allclose(speed.table.y, record.speed(angle) / 6.0 * RPM, rtol=2e-3)


def broken(change):
    """The record's columns, changed by a function of them, as text."""
    columns = change(*(column.copy() for column in Record(engine=FIRED).columns))
    return (
        "\n".join("\t".join(f"{v:.6e}" for v in row) for row in zip(*columns, strict=True)) + "\n"
    )


def between(time, begin, end, values, new):
    values[(time > begin) & (time < end)] = new
    return values


def doubled(t, v, w):
    k = np.flatnonzero((w > 3.9) & (t > 0.1))[0]
    w[k + 3 : k + 6] = -0.7
    return t, v, w


WRONG = {
    "a clock that jumps": (
        lambda t, v, w: (np.where(t > 0.1, t + 0.01, t), v, w),
        {},
        "line 5002: the clock goes from 0.1 to 0.11002 s, and its steps are 2e-05 s",
    ),
    "a tooth missing": (
        lambda t, v, w: (t, v, between(t, 0.10012, 0.10032, w, -0.7)),
        {},
        "57 rising edges, and 60-2 has 58: teeth are missing near 0.099",
    ),
    "a tooth doubled": (
        doubled,
        {},
        "59 rising edges, and 60-2 has 58: teeth are doubled near",
    ),
    "no gap": (
        lambda t, v, w: (t, v, np.sin(3600.0 * t)),
        {},
        "no gap of 2 teeth comes again in the rising edges",
    ),
    "another wheel": (lambda *c: c, {"wheel": "36-1"}, "58 rising edges, and 36-1 has 35"),
    "less than two cycles": (
        lambda t, v, w: (t[:4000], v[:4000], w[:4000]),
        {},
        "3 whole revolutions are less than two cycles of a 4-stroke engine",
    ),
    "no compression": (
        lambda t, v, w: (t, 0.58 + 0.001 * np.sin(40.0 * t), w),
        {},
        'the pressure of column "column 2" goes from 0.208 to 0.312 bar and never compresses',
    ),
    "a cycle without compression": (
        lambda t, v, w: (t, between(t, 0.1, 0.16, v, 0.595), w),
        {},
        "never compresses: it rises by ",
    ),
    "another dead centre": (
        lambda *c: c,
        {"firing_tdc": "200 deg"},
        "degrees from the dead centre given, 200; correct firing_tdc, or leave it out",
    ),
    "no number": (
        lambda t, v, w: (t, between(t, 0.1, 0.10003, v, np.nan), w),
        {},
        'line 5002: column "column 2" has no number',
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_read_is_refused(tmp_path, name):
    change, options, message = WRONG[name]
    with pytest.raises(InputError) as caught:
        read_pressure(
            written(tmp_path, broken(change)), **{**GIVEN, "firing_tdc": "25 deg", **options}
        )
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("wheel", "6-2", 'wheel: must be teeth less the missing ones, "60-2"'),
        ("sensor", "import os", "sensor: must be a formula in V with the unit"),
        ("sensor", "V.real bar", "sensor: must be a formula in V with the unit"),
        ("sensor", "2 * U bar", "sensor: must be a formula in V with the unit"),
        ("sensor", "2 * V mm", 'sensor: "1 mm" is no pressure here'),
        ("sensor", "1 V = 0 bar, 1 V = 3 bar", "sensor: two points have two voltages"),
        ("delay", "3 deg", 'delay: "3 deg" is no time here'),
    ],
)
def test_options_that_cannot_be(tmp_path, option, value, message):
    with pytest.raises(InputError) as caught:
        read_pressure(tmp_path / "none.txt", **{option: value})
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("seed", range(1, 6))
def test_speed_from_times_of_teeth_alone(tmp_path, seed):
    record = Record(engine=FIRED, seed=seed)
    path = written(tmp_path, "".join(f"{t:.9f}\n" for t in record.edges))
    first = record.errors[0]
    found = read_speed(path, "60-2", firing_tdc=f"{-first} deg")
    angle = np.degrees(found.table.x)
    turned = min((0.0, 360.0), key=lambda more: np.ptp(found.table.y / record.speed(angle + more)))
    apart = np.abs(np.array(found.table.y) - record.speed(angle + turned) / 6.0 * RPM)
    assert apart.max() <= found.error
    record_of_signal = written(tmp_path, text_of(seed=seed))
    same = read_speed(record_of_signal, "60-2", firing_tdc=f"{-first} deg")
    assert np.abs(np.subtract(same.table.y, found.table.y)).max() < 0.1 * found.error


def test_of_two_times_the_first_is_read_and_said(tmp_path):
    teeth = [k for k in range(36 * 9) if k % 36 < 35]
    rows = [f"{k / 1800:.9f},{k / 1.8:.6f}" for k in teeth]
    path = written(tmp_path, "\n".join(["time_s,time_ms", *rows]))
    found = read_speed(path, "36-1")
    said = '"time [s]" and "time [ms]" are times: "time [s]" is read'
    assert found.sentences[0] == said
    assert found.table.y[0] / RPM == pytest.approx(3000.0, rel=1e-3)


def test_bad_times_of_teeth(tmp_path):
    path = written(tmp_path, "0.1\n0.2\n0.15\n0.3\n")
    with pytest.raises(InputError, match=r"line 3: the times of the teeth must rise; 0\.15 s came"):
        read_speed(path, "60-2")
    with pytest.raises(UndecidedError, match="which wheel has these teeth is not said"):
        read_speed(path)
    even = written(tmp_path, "".join(f"{k / 1000}\n" for k in range(2000)))
    with pytest.raises(InputError, match="no gap of 2 teeth comes again"):
        read_speed(even, "60-2")


@pytest.mark.slow
def test_the_commands(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    record = Record(engine=FIRED)
    written(tmp_path, text_of())
    asked = refused("pressure", "record.txt")
    for option in ('--wheel "60-2"', "--sensor ", "--reference ", "--firing-tdc "):
        assert option in asked
    words = ["--wheel", "60-2", "--sensor", SENSOR, "--reference", "absolute"]
    words += ["--firing-tdc", tdc(record), "-o", "gas.csv", "--no-figures"]
    result = crankmbs_("pressure", "record.txt", *words)
    assert result.exit_code == 0, result.output
    assert names(tmp_path) == {"record.txt", "gas.csv", "gas_speed.csv"}
    assert 'speed = { file = "gas_speed.csv", interpolation = "cubic" }' in result.stdout
    result = crankmbs_("speed", "record.txt", "--wheel", "60-2", "-o", "speed.csv")
    assert result.exit_code == 0, result.output
    assert "crank angle 0 is the first rising edge; --firing-tdc is not given" in result.stdout
    assert refused("speed", "record.txt").startswith("file record.txt: which wheel")
    (tmp_path / "scene.toml").write_text(SCENE)
    result = crankmbs_("run", "scene.toml", "--no-figures")
    assert result.exit_code == 0, result.output


SCENE = """
[crank]
radius = "46 mm"
[rod]
length = "153.3333 mm"
[piston]
mass = "1.1 kg"
bore = "85.25 mm"
[gas]
pressure = "gas.csv"
ambient = "1 bar"
[motion]
speed = { file = "gas_speed.csv", interpolation = "cubic" }
[run]
until = "1 cycles"
"""
