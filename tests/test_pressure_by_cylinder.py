"""A pressure for each cylinder, constants, and files of several cycles."""

from dataclasses import replace
from itertools import cycle
from math import pi

import numpy as np
import pytest
from scene_texts import FREE, edited, refusal

from crankmbs import CylinderTable, Extent, Gas, InputError, Result, Table, load_scene, simulate
from crankmbs.measures import measure
from crankmbs.mechanics.pressure import pressures_of, remarks
from crankmbs.mechanics.train import crank_train
from crankmbs.scene.write import scene_files
from validation.adapter import machine_of
from validation.checks.honest import scales, true_errors
from validation.oracles.pressure import evaluate_pressure

FOUR = load_scene("yi_diesel_free")
TURN, BAR = 2.0 * pi, 1e5
ANGLES = np.linspace(0.0, 2.0 * TURN, 73)[:-1]
RISE = 30e5 * np.exp(-(((ANGLES - 6.4) / 0.4) ** 2))
ONE = Table(ANGLES.tolist(), (1e5 + RISE).tolist())
STRONG = Table(ANGLES.tolist(), (1e5 + 1.5 * RISE).tolist())
CYCLES = Table(
    np.concatenate([ANGLES + k * 2.0 * TURN for k in range(3)]).tolist(),
    np.concatenate([1e5 + share * RISE for share in (0.8, 1.0, 1.3)]).tolist(),
)
SHORT = Extent(value=2.0, unit="cycle")


def with_gas(**changes):
    gas = Gas(**{"ambient": BAR, "interpolation": "cubic", **changes})
    return replace(FOUR, gas=gas, run=replace(FOUR.run, until=SHORT))


BY_CYLINDER = {
    "a table each": {"pressure": [ONE, STRONG, ONE, STRONG]},
    "columns at one instant": {
        "pressure": CylinderTable(ANGLES, [ONE.y, STRONG.y, ONE.y, RISE + 2e5])
    },
    "columns aligned": {
        "pressure": CylinderTable(ANGLES, [ONE.y, STRONG.y, ONE.y, RISE + 2e5]),
        "aligned": True,
    },
    "a sequence": {"pressure": CYCLES, "cycles": "sequence"},
    "a sequence and two single cycles": {
        "pressure": [CYCLES, STRONG, CYCLES, ONE],
        "cycles": "sequence",
    },
    "a mean": {"pressure": CYCLES, "cycles": "mean"},
    "a constant": {"pressure": "0.35 N/mm^2", "interpolation": "pchip"},
}


@pytest.mark.parametrize("name", BY_CYLINDER)
def test_each_cylinder_has_the_pressure_of_the_oracle(name):
    scene = with_gas(**BY_CYLINDER[name])
    angle = np.linspace(-40.0, 90.0, 1003)
    for ours, theirs in zip(pressures_of(scene), machine_of(scene).pressures, strict=True):
        exact = evaluate_pressure(theirs, angle.astype(np.longdouble)).astype(float)
        assert np.abs(ours(angle) - exact).max() < 1e-11 * np.abs(exact).max()


def test_columns_of_one_instant_stand_at_cylinder_ones_angle():
    scene = with_gas(pressure=CylinderTable(ANGLES, [ONE.y, STRONG.y, RISE + 2e5, ONE.y]))
    first, _, third, _ = pressures_of(scene)
    one, _, other, _ = scene.cylinders
    theta = ANGLES[20] - one.phase
    assert first(theta + one.phase) == pytest.approx(ONE.y[20] - BAR)
    assert third(theta + other.phase) == pytest.approx(RISE[20] + 1e5)


def test_a_sequence_runs_one_cycle_after_the_other_then_again():
    scene = with_gas(pressure=CYCLES, cycles="sequence")
    assert crank_train(scene).period == pytest.approx(6.0 * TURN)
    pressure, *_ = pressures_of(scene)
    peaks = pressure(ANGLES[37] + 2.0 * TURN * np.arange(-3, 6))
    shares = np.array([0.8, 1.0, 1.3] * 3)
    np.testing.assert_allclose(peaks, shares * RISE[37], rtol=1e-9)


@pytest.mark.parametrize("every", ["1 deg", "none"])
def test_a_run_of_a_sequence_is_summed_up_over_all_of_its_cycles(every):
    """The strongest of three is the third; a run of seven ends with the first."""
    scene = with_gas(pressure=CYCLES, cycles="sequence")
    found = measure(simulate(scene.with_(run__until="7 cycles", run__every=every)))
    assert found.window.kind == "last period"
    assert found.window.angle == pytest.approx(6.0 * TURN)
    highest = max(peak.value.value for peak in found.peaks if peak.name == "gauge pressure")
    assert highest == pytest.approx(pressures_of(scene)[0].peak[1], rel=1e-9)
    assert measure(simulate(scene)).window.kind == "last cycle"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "formulation"),
    list(zip(BY_CYLINDER, cycle(["minimal", "crank_angle"]), strict=False)),
)
def test_the_errors_are_stated_honestly(name, formulation):
    scene = with_gas(**BY_CYLINDER[name])
    scene = replace(scene, run=replace(scene.run, every=Extent(value=0.2, unit="rad")))
    result = simulate(scene, formulation=formulation)
    assert result.status == 0
    true, peaks = true_errors(result, scene)
    floor = {key: 1e-11 * scale for key, scale in scales(peaks).items()}
    worst = {
        key: error / (result.data[key].attrs["error_estimate"] + floor[key])
        for key, error in true.items()
    }
    assert max(worst.values()) < 2.0, worst


@pytest.mark.parametrize("name", ["a table each", "a sequence"])
def test_multibody_confirms_it(name):
    scene = with_gas(**BY_CYLINDER[name])
    scene = replace(scene, run=replace(scene.run, until=Extent(value=0.5, unit="cycle")))
    exact, bodies = (simulate(scene, formulation=one).data for one in ("crank_angle", "multibody"))
    for key in ("crank_speed", "main_bearing_force_x", "side_force", "gas_force"):
        apart = np.abs(exact[key].values - bodies[key].values).max()
        stated = exact[key].attrs["error_estimate"] + bodies[key].attrs["error_estimate"]
        assert apart <= 2.0 * stated
        assert apart < 2e-4 * np.abs(exact[key].values).max()


def test_the_mean_effective_pressure_is_that_of_each_cylinder():
    found = measure(simulate(with_gas(pressure=[ONE, STRONG, ONE, STRONG]))).imep
    one, strong, *others = (estimate.value for estimate in found)
    assert strong == pytest.approx(1.5 * one, rel=1e-9)
    assert others == pytest.approx([one, strong], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", BY_CYLINDER)
def test_written_read_and_saved_it_is_the_same(tmp_path, name):
    scene = with_gas(**BY_CYLINDER[name])
    for file, text in scene_files(scene, "mine").items():
        (tmp_path / file).write_text(text)
    back = load_scene(tmp_path / "mine.toml")
    for ours, theirs in zip(pressures_of(scene), pressures_of(back), strict=True):
        np.testing.assert_allclose(ours.coefficients, theirs.coefficients, rtol=1e-9, atol=1e-3)
    simulate(back).save(tmp_path / "saved")
    assert Result.load(tmp_path / "saved").scene == back


def test_a_jump_where_every_cycle_ends_survives_the_mean():
    rows = [(0, 2), (360, 5), (720, 1), (720, 4), (1080, 7), (1440, 3), (1440, 2)]
    table = Table([x * pi / 180 for x, _ in rows], [y * BAR for _, y in rows])
    gas = {"pressure": table, "cycles": "mean", "absolute": False, "ambient": None}
    pressure, *_ = pressures_of(with_gas(interpolation="linear", **gas))
    assert pressure(0.0) == pytest.approx(3 * BAR)
    assert pressure(TURN) == pytest.approx(6 * BAR)
    assert pressure(-1e-6) == pytest.approx(2 * BAR, rel=1e-5)


def test_a_closing_row_behind_several_cycles_is_dropped_and_said():
    last = CYCLES.y[0] + 1e4
    table = Table((*CYCLES.x, 6.0 * TURN), (*CYCLES.y, last), "rows.csv")
    scene = with_gas(pressure=table, cycles="sequence")
    said = "rows.csv: the closing row, 0.1 bar from the first one, is dropped"
    assert remarks(scene) == (said,)
    np.testing.assert_allclose(
        pressures_of(scene)[0].coefficients,
        pressures_of(with_gas(pressure=CYCLES, cycles="sequence"))[0].coefficients,
        rtol=1e-12,
    )


HEAD = "crank_angle_deg,pressure_bar_1,pressure_bar_2\n"


@pytest.mark.parametrize(
    ("value", "text", "message"),
    [
        (
            '["a.csv", "a.csv"]',
            "crank_angle_deg,pressure_bar\n0,1\n360,2\n",
            "gas.pressure: as many files as cylinders are needed, 1, or one for all; 2 came",
        ),
        (
            '"a.csv"',
            HEAD + "0,1,2\n360,2,3\n",
            "gas.pressure: as many columns as cylinders are needed, 1, or one for all; 2 came",
        ),
        (
            '["a.csv"]',
            HEAD + "0,1,2\n360,2,3\n",
            "gas.pressure: a.csv: a file of a list has one pressure column, of its own cylinder; "
            "give this one without a list",
        ),
        (
            '"a.csv"',
            HEAD.replace("_2", "_3") + "0,1,2\n360,2,3\n",
            "gas.pressure: file a.csv: the columns of the cylinders must be numbered from 1 up, "
            "each once; 1, 3 came",
        ),
        ("[]", "", "gas.pressure: must name a file for each cylinder; an empty list came"),
        (
            '"a.csv"\naligned = true',
            "crank_angle_deg,pressure_bar\n0,1\n360,2\n",
            "gas: aligned belongs to a file with a pressure column for each cylinder; remove it",
        ),
        (
            '"1 bar"\ninterpolation = "cubic"',
            "",
            "gas: zero, interpolation, closing and cycles belong to a pressure file; remove them "
            "beside a constant of 1 bar (a bare number is in Pa)",
        ),
        (
            '"1 mm"',
            "",
            'gas.pressure: "1 mm" is no pressure here: use Pa, kPa, MPa, bar or psi',
        ),
        (
            '"a.csv"\ncycles = "sequence"',
            "crank_angle_deg,pressure_bar\n0,1\n180,2\n360,2\n540,2\n720,1\n900,2\n",
            "gas: a.csv: the rows span 900 degrees, and several cycles must be whole ones of 720; "
            "540 degrees are missing; leave out the rows of the last cycle, or add what is missing",
        ),
        (
            '"a.csv"\ncycles = "mean"',
            "crank_angle_deg,pressure_bar\n0,1\n300,2\n600,2\n720,1\n1000,2\n1300,2\n",
            'gas: a.csv: for cycles = "mean" the rows of every cycle must be at the angles of '
            "the first; those of cycle 2 are not; resample the file, or give cycles = "
            '"sequence"',
        ),
    ],
)
def test_bad_pressures_by_cylinder(read, tmp_path, value, text, message):
    (tmp_path / "a.csv").write_text(text)
    assert refusal(read, edited(FREE, '"gas.csv"', value)) == message


def test_an_absolute_constant_cannot_be_negative():
    with pytest.raises(InputError, match="an absolute pressure cannot be negative; -5 Pa came"):
        Gas(pressure=-5.0, ambient="1 bar")
