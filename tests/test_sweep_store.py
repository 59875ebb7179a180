"""The store of a sweep has each case in its place, and is read column by column; of many cases
nothing is held at once."""

import resource
import shutil
import tracemalloc
from contextlib import ExitStack, contextmanager, suppress
from itertools import product

import numpy as np
import pytest
import xarray as xr
from scipy.stats import qmc
from swept import block_of

from crankmbs import OutputError, Sample, load_scene, load_sweep, sweep
from crankmbs.figures import sweep_figure
from crankmbs.sweep import workers
from crankmbs.sweep.block import block_size
from crankmbs.sweep.cases import cases_of
from crankmbs.sweep.plan import plan_of
from crankmbs.sweep.run import fill
from crankmbs.sweep.summary import summary

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")
ENGINE = load_scene("yi_diesel")
RANGES = {"crank.inertia": "0.05..0.5 kg m^2", "rod.length": "0.14..0.2 m:log"}


def numbered(job):
    """A block whose mean speed is the crank's inertia."""
    inertia = np.array([values[0] for values in job.values])
    return block_of(
        job,
        mean_speed=inertia,
        mean_speed_error=1e-9 * inertia,
        side_force_peak=inertia[:, None],
        side_force_peak_error=np.zeros((len(inertia), 1)),
    )


@pytest.fixture
def stub(monkeypatch):
    monkeypatch.setattr(workers, "solved", numbered)


# ------------------------------------------------------------------------------------------ cases


@pytest.mark.parametrize("count", [1, 5, 63, 64])
def test_a_sample_is_the_beginning_of_the_sequence(count):
    whole = qmc.Sobol(2, rng=3).random_base2(6)
    np.testing.assert_array_equal(Sample(RANGES, count, seed=3).points(), whole[:count])


def test_a_grid_counts_its_last_knob_fastest():
    cases = cases_of(SCENE, {"crank.inertia": [0.1, 0.2], "rod.length": [0.15, 0.16, 0.17]})
    assert cases.values([slice(2), slice(1, 3)]) == (
        (0.1, 0.16),
        (0.1, 0.17),
        (0.2, 0.16),
        (0.2, 0.17),
    )


def test_of_many_cases_no_more_is_held_than_the_numbers_of_their_knobs():
    def held(count):
        tracemalloc.start()
        plan = plan_of(SCENE, Sample(RANGES, count), "measures")
        assert len(plan.job(plan.boxes[-1]).values) > 0
        size = tracemalloc.get_traced_memory()[0]
        tracemalloc.stop()
        return size - 8 * len(RANGES) * count - 1000 * len(plan.boxes)

    held(2**18)  # what is made once
    assert held(2**22) < held(2**18) + 20_000


@pytest.mark.parametrize(
    "counts", [(1,), (60,), (3, 7), (7, 3), (2, 1000), (5, 1, 90), (2, 3, 4, 5), (4000, 3)]
)
@pytest.mark.parametrize("keep", ["measures", "series"])
def test_blocks_are_successive_cases_and_parts_of_the_grid(counts, keep):
    names = ("piston.mass", "rod.mass", "crank.inertia", "rod.inertia")
    values = [np.linspace(0.5, 0.6, n).tolist() for n in counts]
    plan = plan_of(ENGINE, dict(zip(names, values, strict=False)), keep)
    numbers = np.arange(plan.cases.count).reshape(counts)
    blocks = [numbers[box].ravel() for box in plan.boxes]
    assert np.concatenate(blocks).tolist() == numbers.ravel().tolist()
    every = list(product(*values[: len(counts)]))
    for box, block in zip(plan.boxes, blocks, strict=True):
        assert plan.job(box).values == tuple(every[k] for k in block)
    most = max(map(len, blocks))
    assert len(blocks) <= max(2 * 128, 3 * plan.cases.count / most)


def test_blocks_are_few_files_of_a_bounded_size():
    assert [block_size(n, series=False) for n in (1, 1280, 10**9)] == [4, 10, 2048]
    assert block_size(10**9, series=True) == 256


# ---------------------------------------------------------------------------------------- reading


def test_a_column_is_read_when_it_is_used(stub, tmp_path):
    sweep(SCENE, Sample(RANGES, 64), out=tmp_path / "s", executor=1)
    data = load_sweep(tmp_path / "s")
    for file in (tmp_path / "s" / "cylinder_measures").glob("[0-9]*"):
        file.unlink()
    assert np.isnan(data["side_force_peak"].values).all()
    np.testing.assert_array_equal(data["mean_speed"], data["crank.inertia"])


@contextmanager
def full_device():
    """No file can grow meanwhile, as on a full device."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_full_device_leaves_no_store(tmp_path):
    with full_device(), pytest.raises(OutputError, match="s: cannot be written"):
        sweep(SCENE, {"crank.inertia": [0.2, 0.3]}, out=tmp_path / "s", executor=1)
    assert not list(tmp_path.iterdir())


def filled_up(plan, path, blocks):
    """Fill a store on a device that is full after so many blocks."""
    with ExitStack() as stack:

        def report(count, left=[blocks]):  # noqa: B006
            left[0] -= count > 0
            if left[0] == 0:
                stack.enter_context(full_device())

        fill(plan, path, 1, report)


def test_a_device_that_becomes_full_leaves_finished_blocks_or_nothing(stub, tmp_path):
    plan = plan_of(SCENE, {"crank.inertia": "0.1..0.5 kg m^2:100"}, "measures")
    assert len(plan.boxes) == 4
    for blocks in (0, 2):
        with pytest.raises(OutputError, match="s: cannot be written"):
            filled_up(plan, tmp_path / "s", blocks)
        assert (tmp_path / "s").exists() == (blocks > 0)
    with pytest.raises(OutputError, match="s: 2 of 4 blocks are finished"):
        load_sweep(tmp_path / "s")
    fill(plan, tmp_path / "s", 1, lambda _: None)
    np.testing.assert_allclose(load_sweep(tmp_path / "s")["mean_speed"], np.linspace(0.1, 0.5, 100))


def test_a_store_that_was_not_laid_out_to_its_end_is_laid_out_anew(stub, tmp_path):
    """As after a kill: whatever is missing of a store without a finished block."""
    plan = plan_of(SCENE, {"crank.inertia": [0.2, 0.3], "rod.length": "0.15..0.2 m:3"}, "measures")
    fill(plan, tmp_path / "whole", 1, lambda _: None)
    whole = load_sweep(tmp_path / "whole").load()
    for gone in (".zattrs", "status", "measures", "measure/0", "*"):
        with suppress(KeyboardInterrupt):
            fill(plan, tmp_path / "s", 1, interrupted)
        assert not (tmp_path / "s").exists()
        shutil.copytree(tmp_path / "whole", tmp_path / "s")
        for left in (tmp_path / "s").glob("[!.]*" if gone in ("*", ".zattrs") else gone):
            shutil.rmtree(left) if left.is_dir() else left.unlink()
        for left in (".zmetadata", gone if gone == ".zattrs" else "none"):
            (tmp_path / "s" / left).unlink(missing_ok=True)
        for left in (tmp_path / "s").glob("status/[0-9]*"):
            left.unlink()
        fill(plan, tmp_path / "s", 1, lambda _: None)
        xr.testing.assert_identical(load_sweep(tmp_path / "s"), whole)
        shutil.rmtree(tmp_path / "s")


def interrupted(count):
    raise KeyboardInterrupt


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


def test_a_summary_reads_block_after_block(stub, tmp_path):
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
