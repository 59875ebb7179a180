"""The store of a sweep is written as Zarr would, and read as it is asked for; of many cases nothing
is held at once."""

import tracemalloc

import numpy as np
import pytest
import zarr
from scipy.stats import qmc

from crankmbs import Sample, load_scene, load_sweep, sweep
from crankmbs.figures import sweep_figure
from crankmbs.sweep import summary as summaries
from crankmbs.sweep import workers
from crankmbs.sweep.block import Block, block_size
from crankmbs.sweep.cases import cases_of
from crankmbs.sweep.chunks import Chunks
from crankmbs.sweep.plan import plan_of
from crankmbs.sweep.summary import summary

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")
RANGES = {"crank.inertia": "0.05..0.5 kg m^2", "rod.length": "0.14..0.2 m:log"}


def numbered(job):
    """A block whose mean speed is the crank's inertia, and whose imep is NaN."""
    inertia = np.array([values[0] for values in job.values])
    shape = (len(inertia), 1)
    rows = {
        "mean_speed": inertia,
        "imep": np.full(shape, np.nan),
        "side_force_peak": inertia[:, None],
    }
    rows |= {"mean_speed_error": 1e-9 * inertia, "side_force_peak_error": np.zeros(shape)}
    return Block(rows, np.zeros(len(inertia), np.int8), ("reached its end",) * len(inertia))


@pytest.fixture
def stub(monkeypatch):
    monkeypatch.setattr(workers, "solved", numbered)


# ------------------------------------------------------------------------------------------ cases


@pytest.mark.parametrize("rows", [range(5), range(7, 20), range(63, 64)])
def test_a_sample_drawn_in_blocks_is_the_sequence(rows):
    sample = Sample(RANGES, 64, seed=3)
    whole = qmc.Sobol(2, rng=3).random_base2(6)
    for _ in range(2):  # backwards too
        np.testing.assert_array_equal(sample.points(rows), whole[rows.start : rows.stop])


def test_a_grid_counts_its_last_knob_fastest():
    cases = cases_of(SCENE, {"crank.inertia": [0.1, 0.2], "rod.length": [0.15, 0.16, 0.17]})
    assert cases.values(range(2, 5)) == ((0.1, 0.17), (0.2, 0.15), (0.2, 0.16))


def test_of_many_cases_no_list_is_held():
    def most(count):
        tracemalloc.start()
        plan = plan_of(SCENE, Sample(RANGES, count), "measures")
        assert len(plan.job(plan.blocks - 1).values) > 0
        size = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return size

    most(2**18)  # what is made once
    assert most(2**22) < most(2**18) + 20_000


def test_blocks_are_few_files_of_a_bounded_size():
    assert [block_size(n, series=False) for n in (1, 1280, 10**9)] == [4, 10, 2048]
    assert block_size(10**9, series=True) == 256


# ------------------------------------------------------------------------------------------ bytes


@pytest.mark.parametrize(
    ("dtype", "nothing", "values"),
    [
        ("f8", np.nan, np.linspace(0.0, 1.0, 30).reshape(10, 3)),
        ("f8", np.nan, np.full((10, 3), np.nan)),
        ("i1", -128, np.arange(10)),
        (str, "", np.array([f"über {k}" for k in range(10)], dtype=object)),
    ],
)
def test_a_chunk_has_the_bytes_of_zarr(tmp_path, dtype, nothing, values):
    group = zarr.open_group(str(tmp_path / "s"), mode="w", zarr_format=2)
    sizes = {"shape": values.shape, "chunks": (4, *values.shape[1:])}
    ours, theirs = (
        group.create_array(name, dtype=dtype, fill_value=nothing, **sizes) for name in ("a", "b")
    )
    chunks = Chunks(tmp_path / "s" / "a", ours)
    for number in (0, 2):  # the last is not whole
        chunks.write(number, values[4 * number : 4 * number + 4])
        theirs[4 * number : 4 * number + 4] = values[4 * number : 4 * number + 4]
    found = [
        {file.name: file.read_bytes() for file in (tmp_path / "s" / name).iterdir()}
        for name in ("a", "b")
    ]
    assert found[0] == found[1]


# ---------------------------------------------------------------------------------------- reading


def test_a_column_is_read_when_it_is_asked_for(stub, tmp_path):
    sweep(SCENE, Sample(RANGES, 64), out=tmp_path / "s", executor=1)
    data = load_sweep(tmp_path / "s")
    for file in (tmp_path / "s" / "side_force_peak").glob("[0-9]*"):
        file.unlink()
    assert np.isnan(data["side_force_peak"].values).all()
    np.testing.assert_array_equal(data["mean_speed"], data["crank.inertia"])


def test_what_is_kept_nowhere_is_in_memory(stub):
    data = sweep(SCENE, Sample(RANGES, 8), executor=1)
    np.testing.assert_array_equal(data["mean_speed"], data["crank.inertia"])


@pytest.mark.parametrize(
    "at",
    [
        {"crank.inertia": 1},
        {"crank.inertia": slice(None, None, -2), "rod.length": 0},
        {"rod.length": [2, 0]},
        {"crank.inertia": slice(2, 2)},
        {"crank.inertia": -1, "rod.length": slice(1, 3), "cylinder": 0},
    ],
)
def test_a_part_of_a_grid_is_that_part_of_the_whole(stub, tmp_path, at):
    grid = {"crank.inertia": "0.1..0.5 kg m^2:5", "rod.length": "0.14..0.2 m:3"}
    sweep(SCENE, grid, out=tmp_path / "s", executor=1)
    whole, part = load_sweep(tmp_path / "s").load(), load_sweep(tmp_path / "s")
    for name in ("side_force_peak", "message"):
        np.testing.assert_array_equal(
            *(one[name].isel(at, missing_dims="ignore") for one in (part, whole))
        )
    expected = np.repeat(np.linspace(0.1, 0.5, 5)[:, None], 3, axis=1)
    np.testing.assert_allclose(whole["side_force_peak"][..., 0], expected)


def test_a_summary_reads_part_after_part(stub, tmp_path, monkeypatch):
    monkeypatch.setattr(summaries, "_CHUNKS", 1)
    sweep(SCENE, Sample(RANGES, 64), out=tmp_path / "s", executor=1)
    found, data = summary(tmp_path / "s"), load_sweep(tmp_path / "s")
    assert found.ended == {0: (64, "reached its end")}
    (speed,) = found.bounds
    assert speed.least == float(data["mean_speed"].min())
    assert speed.largest == float(data["mean_speed"].max())
    assert speed.error == float(data["mean_speed_error"].max())


def test_points_that_lie_on_one_another_are_drawn_once(stub):
    data = sweep(SCENE, Sample({"crank.inertia": "0.1..0.5 kg m^2"}, 4096), executor=1)
    figure = sweep_figure(data, "mean speed")
    drawn = figure.axes[0].lines[0].get_xydata()
    assert 490 <= len(drawn) <= 500
    np.testing.assert_allclose(np.ptp(drawn[:, 0]), np.ptp(data["crank.inertia"].values), rtol=1e-2)
