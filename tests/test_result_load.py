"""What is no saved result is refused in one sentence, whatever it is; only this file is opened."""

import dataclasses
import json
import math
import shutil

import h5py
import numpy as np
import pytest

from crankmbs import Load, OutputError, Quadratic, Result, Run, load_scene, simulate
from crankmbs.scene.shipped import models_folder

SCENE = load_scene("yi_diesel_free")  # with tables, loads and several cylinders
TABLE = str(models_folder() / "pressure" / "yi_diesel.csv")


@pytest.fixture(scope="module")
def result():
    return simulate(dataclasses.replace(SCENE, run=Run(until="30 deg")))


@pytest.fixture(scope="module")
def saved(result, tmp_path_factory):
    return result.save(tmp_path_factory.mktemp("saved")) / "result.nc"


@pytest.fixture
def file(saved, tmp_path):
    """A copy to spoil."""
    return shutil.copy(saved, tmp_path / "foreign.nc")


def refused(file):
    with pytest.raises(OutputError) as caught:
        Result.load(file)
    said = f"{file}: no readable result of crankmbs; give the result.nc that save wrote"
    assert str(caught.value) == said


def test_a_saved_result_is_read_to_the_last_bit(result, saved):
    loaded = Result.load(saved)
    assert loaded.data.identical(result.data)
    assert dataclasses.replace(loaded, data=result.data) == result


def at(about, *keys):
    """What is nested below these keys."""
    for key in keys:
        about = about[key]
    return about


@pytest.mark.parametrize(
    ("keys", "value"),
    [
        (["scene"], None),
        (["scene"], "scene.toml"),
        (["scene", "gas", "pressure"], TABLE),
        (["scene", "gas", "pressure", "x"], "0123"),
        (["scene", "gas", "pressure", "y"], [1.0]),
        (["scene", "crank", "radius"], -1.0),
        (["scene", "layout"], {"firing_order": [1]}),
        (["formulation"], 7),
        (["reasons"], "none"),
        (["status"], 2),
        (["status"], None),
        (["cost"], {"wall_time": 1.0}),
        (["cost", "steps"], "many"),
        (["error"], [1.0, 2.0]),
    ],
)
def test_what_is_said_beside_the_data_is_checked(file, keys, value):
    with h5py.File(file, "a") as raw:
        about = json.loads(raw.attrs["crankmbs"])
        at(about, *keys[:-1])[keys[-1]] = value
        raw.attrs["crankmbs"] = json.dumps(about)
    refused(file)


@pytest.mark.parametrize("scene", ["motion", "torque"])
def test_no_table_of_a_scene_is_read_from_elsewhere(file, scene, tmp_path):
    (tmp_path / "table.csv").write_text("time_s,speed_rpm,torque_Nm\n0,800,1\n9,900,1\n")
    path = {"file": str(tmp_path / "table.csv")}
    with h5py.File(file, "a") as raw:
        about = json.loads(raw.attrs["crankmbs"])
        about["scene"]["torque"] = [{"kind": "time_table", **path}] if scene == "torque" else []
        if scene == "motion":
            about["scene"] |= {"start": None, "motion": {"speed": path}}
        raw.attrs["crankmbs"] = json.dumps(about)
    refused(file)


@pytest.mark.parametrize(
    "text",
    [None, 3.0, "", "{}", "[]", "null", "{", "9" * 5000, "[" * 100_000],
    ids=lambda text: str(text)[:5] or "empty",
)
def test_what_is_no_description_at_all(file, text):
    with h5py.File(file, "a") as raw:
        del raw.attrs["crankmbs"]
        if text is not None:
            dtype = h5py.string_dtype() if isinstance(text, str) else None
            raw.attrs.create("crankmbs", text, dtype=dtype)
    refused(file)


def missing(raw):
    del raw["side_force"]


def huge(raw):
    """745 GB in a few bytes."""
    raw.create_dataset("more", (100_000_000_000,), "f8", chunks=(1000,))


def beyond_counting(raw):
    raw.create_dataset("more", (2**62, 8), "f8", chunks=(1, 1))


def group(raw):
    raw.create_group("more")


def text(raw):
    raw["more"] = ["a", "b"]


def soft_link(raw):
    raw["more"] = h5py.SoftLink("/time")


def external_link(raw):
    raw["more"] = h5py.ExternalLink("other.nc", "/time")


def external_storage(raw):
    raw.create_dataset("more", (8,), "f8", external=[(TABLE, 0, 64)])


def virtual(raw):
    layout = h5py.VirtualLayout((3,), "f8")
    layout[:] = h5py.VirtualSource("other.nc", "time", (3,))
    raw.create_virtual_dataset("more", layout)


def whole_numbers(raw):
    replaced(raw, np.ones(raw["crank_speed"].shape, dtype="i4"))


def other_shape(raw):
    replaced(raw, np.ones(7))


def replaced(raw, values):
    attrs = dict(raw["crank_speed"].attrs)
    del raw["crank_speed"]
    raw["crank_speed"] = values
    raw["crank_speed"].attrs.update({name: attrs[name] for name in ("units", "error_estimate")})


def other_unit(raw):
    raw["crank_speed"].attrs["units"] = "rpm"


def no_error(raw):
    del raw["crank_speed"].attrs["error_estimate"]


def days(raw):
    raw["time"].attrs["units"] = "days since 1900-01-01"


SPOILED = [missing, huge, beyond_counting, group, text, soft_link, external_link]
SPOILED += [external_storage, virtual, whole_numbers, other_shape, other_unit, no_error, days]


@pytest.mark.parametrize("spoil", SPOILED)
def test_data_that_are_not_those_of_a_run(file, spoil):
    with h5py.File(file, "a") as raw:
        spoil(raw)
    refused(file)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.9, 0.999])
def test_a_truncated_file(file, saved, share):
    whole = saved.read_bytes()
    file.write_bytes(whole[: int(share * len(whole))])
    refused(file)


@pytest.mark.slow
@pytest.mark.parametrize("status", [-1, 0, 1])
def test_an_infinite_error_is_kept(status, result, tmp_path):
    error = dataclasses.replace(result.error, estimated=np.inf)
    unsure = dataclasses.replace(result, error=error, status=status)
    loaded = Result.load(unsure.save(tmp_path))
    assert (loaded.error, loaded.status) == (error, status)


def test_what_names_no_file_is_refused_in_a_sentence():
    with pytest.raises(OutputError, match="named by its folder or file; 3 came"):
        Result.load(3)


@pytest.mark.parametrize("more", [(), (Quadratic(coefficient=1e-4),)], ids=["alone", "with more"])
def test_peaks_of_a_function_that_jumps_are_those_before_it_was_saved(more, tmp_path):
    """Of it only the values in the cells are kept, none of them from beyond a jump."""
    switched = Load(
        lambda t, theta, omega: 30.0 if theta % math.tau < 1.0 else -10.0,
        kink_angles=(0.0, 1.0),
        period=math.tau,
    )
    scene = load_scene("coasting").with_(torque=(switched, *more), run__until="2 rev")
    run = simulate(scene)
    before, after = (
        {peak.name: peak.value for peak in one.measures().peaks}
        for one in (run, Result.load(run.save(tmp_path)))
    )
    assert after.keys() == before.keys()
    for name, (value, _) in before.items():
        assert after[name].value == pytest.approx(value, rel=1e-11)
