"""A sweep has for each case what a run of that scene alone has, under its own label."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from deadly import failing

from crankmbs import (
    InputError,
    Load,
    OutputError,
    compare,
    load_scene,
    load_sweep,
    simulate,
    sweep,
)
from crankmbs.mechanics.carried import carried_over

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")
ENGINE = load_scene("yi_diesel")
GRID = {"crank.inertia": "0.2..0.4 kg m^2:3", "rod.length": [0.15, 0.16]}


@pytest.fixture(scope="module")
def grid():
    return sweep(SCENE, GRID, executor=1)


@pytest.mark.always
def test_a_case_has_the_measures_of_its_scene_alone():
    found = sweep(ENGINE, {"rod.length": [0.15, 0.16]}, executor=1).isel({"rod.length": 0})
    result = simulate(carried_over(ENGINE.with_(rod__length=0.15), ENGINE))
    measures = result.measures()
    for name in ("mean_speed", "fluctuation", "crank_torque", "indicated_power"):
        one = getattr(measures, name)
        assert (float(found[name]), float(found[f"{name}_error"])) == tuple(one)
    pin = next(one for one in measures.joints if one.joint == "crank pin")
    assert float(found["crank_pin_peak"][0]) == pin.peak.value
    assert float(found["crank_pin_peak_angle"][0]) == pin.cycle_angle
    assert float(found["imep"][0]) == measures.imep[0].value
    row = compare(result).row("side thrust", "S1 (motion and forces truncated)")
    deviation = found["lecture_deviation"].sel(lecture=row.reference, quantity="side thrust")
    assert float(deviation) == pytest.approx(row.size.largest / row.peak, rel=1e-2)
    assert (int(found["status"]), str(found["message"].values)) == (0, result.message)


def test_a_settled_case_agrees_with_its_scene_alone_within_both_errors(grid):
    found = grid.isel({"crank.inertia": 1, "rod.length": 0})
    inertia = float(found["crank.inertia"])
    result = simulate(carried_over(SCENE.with_(crank__inertia=inertia, rod__length=0.15), SCENE))
    measures = result.measures()
    for name in ("mean_speed", "fluctuation", "crank_torque", "indicated_power"):
        one = getattr(measures, name)
        assert abs(float(found[name]) - one.value) <= float(found[f"{name}_error"]) + one.error
    assert (int(found["status"]), str(found["message"].values)) == (0, result.message)


def test_it_is_labelled_by_what_is_varied(grid):
    assert grid["fluctuation"].dims == ("crank.inertia", "rod.length")
    assert grid["crank.inertia"].attrs["units"] == "kg m^2"
    np.testing.assert_allclose(grid["crank.inertia"], [0.2, 0.3, 0.4])
    assert grid["main_bearing_peak"].attrs["units"] == "N"
    assert grid["status"].dtype.kind == "i"


def test_a_deviation_of_a_lecture_does_not_depend_on_the_samples():
    coarse, fine = (
        sweep(ENGINE.with_(run__every=every), {"rod.length": [0.15]}, executor=1).squeeze()
        for every in ("30 deg", "0.1 deg")
    )
    apart = fine["lecture_deviation"] - coarse["lecture_deviation"]
    assert int(apart.notnull().sum()) > 40
    stated = coarse["lecture_deviation_error"] + fine["lecture_deviation_error"]
    assert bool((abs(apart) <= stated).where(apart.notnull(), True).all())
    assert float(stated.max()) < 1e-6


def test_a_scene_that_cannot_be_is_a_row():
    found = sweep(ENGINE, {"rod.length": [0.16, 0.01]}, executor=1)
    assert found["status"].values.tolist() == [0, 2]
    assert "must be at least crank.radius" in str(found["message"].values[1])
    assert np.isfinite(found["mean_speed"].values[0])
    assert np.isnan(found["mean_speed"].values[1])


def test_a_rod_as_long_as_the_crank_is_a_row_without_a_warning():
    found = sweep(SCENE, {"rod_ratio": "0..1:3"}, executor=1)
    assert found["status"].values.tolist() == [2, 0, 2]
    zero, _, one = found["message"].values.tolist()
    assert zero == "rod_ratio: must be above 0 and at most 1; 0 came"
    assert one.startswith("rod.length: a rod as long as the crank lets the piston rest for half")


def test_strict_says_how_many_cannot_be_and_why(tmp_path):
    said = "^2 of 4 scenes cannot be built; the first at rod.length = 0.01: rod.length must be at "
    with pytest.raises(InputError, match=said):
        sweep(ENGINE, {"rod.length": [0.15, 0.01, 0.16, 0.02]}, strict=True, out=tmp_path / "s")
    assert not list(tmp_path.iterdir())


def test_a_load_that_fails_is_a_row():
    scene = replace(load_scene("coasting"), torque=(Load(failing),))
    found = sweep(scene, {"start.speed": ["900 rpm"]}, executor=1)
    assert found["status"].values.tolist() == [-1]
    assert "on purpose" in str(found["message"].values[0])


def test_another_number_of_cylinders_is_a_row():
    orders = [load_scene("yi_diesel_free").layout]
    found = sweep(SCENE, {"layout": orders}, executor=1)
    assert "keeps the number of cylinders, 1; 4 came" in str(found["message"].values[0])


def test_series_are_those_of_the_run(tmp_path):
    found = sweep(ENGINE, {"motion.speed": ["3000 rpm", "3200 rpm"]}, keep="series", executor=1)
    data = simulate(ENGINE).data
    last = found.isel({"motion.speed": 1})
    count = data.sizes["time"]
    for name in ("time", "crank_angle", "side_force"):
        np.testing.assert_array_equal(last[f"series_{name}"][:count], data[name])
    assert np.isnan(last["series_time"].values[count:]).all()
    assert float(last["series_side_force_error"]) == data["side_force"].attrs["error_estimate"]


def test_series_of_unknown_length_are_refused():
    with pytest.raises(InputError, match=r"run\.every: series of all cases are kept where"):
        sweep(load_scene("coasting"), {"crank.inertia": [0.1]}, keep="series")
    longer = {"run.until": ["1 cycles", "9 cycles"]}
    found = sweep(ENGINE, longer, keep="series", executor=1)
    assert found["status"].values.tolist() == [0, 2]
    assert "6482 came" in str(found["message"].values[1]) or "6481 came" in str(
        found["message"].values[1]
    )


def test_a_store_opens_in_xarray_too(tmp_path):
    sweep(ENGINE, {"rod.length": [0.15, 0.16]}, out=tmp_path / "s.zarr", executor=1)
    with xr.open_zarr(tmp_path / "s.zarr") as plain:
        np.testing.assert_allclose(plain["rod.length"], [0.15, 0.16])
        measures = plain["measures"]
        assert measures.dims == ("rod.length", "measure")
        loaded = load_sweep(tmp_path / "s.zarr")
        for name in ("fluctuation", "fluctuation_error", "crank_pin_peak", "lecture_deviation"):
            array = "_".join((*loaded[name].dims[1:], "measures"))
            stored = plain[array].sel({array.removesuffix("s"): name})
            np.testing.assert_array_equal(stored, loaded[name])
        assert plain["message"].values.tolist() == loaded["message"].values.tolist()


def test_what_is_no_sweep_is_refused(tmp_path):
    with pytest.raises(OutputError, match="no such sweep"):
        load_sweep(tmp_path / "none")
    with pytest.raises(OutputError, match="no sweep of crankmbs"):
        load_sweep(tmp_path)
