"""A sweep is the same wherever it is computed, and what is finished survives what ends it."""

import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import crankmbs_, names, refused
from deadly import braking, deadly

from crankmbs import InputError, Load, OutputError, load_scene, load_sweep, sweep
from crankmbs.sweep import workers
from crankmbs.sweep.cluster import cluster_executor
from crankmbs.sweep.plan import plan_of
from crankmbs.sweep.run import fill
from crankmbs.sweep.workers import Workers

pytestmark = pytest.mark.slow

SCENE = load_scene("yi_diesel").with_(run__until="1 cycles")
GRID = {"rod.length": "0.15..0.2 m:12"}
COASTING = load_scene("coasting").with_(run__until="0.01 s")
DEADLY = "the worker that computed this case ended, again and again"
COMMAND = "import sys; from crankmbs.cli import main; sys.argv[0] = 'crankmbs'; main()"
PLAIN = ["sweep", "yi_diesel", "--workers", "1", "--vary", "rod.length=0.15..0.2 m:20"]


def files(folder):
    """The bytes of every file, by its place."""
    found = (file for file in sorted(folder.rglob("*")) if file.is_file())
    return {str(file.relative_to(folder)): file.read_bytes() for file in found}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone") / "sweep.zarr"
    sweep(SCENE, GRID, out=folder, executor=1)
    return folder


def test_two_processes_write_the_bytes_of_one(alone, tmp_path):
    before = dict(os.environ)
    sweep(SCENE, GRID, out=tmp_path / "two", executor=2)
    assert files(tmp_path / "two") == files(alone)
    assert dict(os.environ) == before


def test_a_store_that_lacks_its_mark_alone_is_marked(alone, tmp_path):
    shutil.copytree(alone, tmp_path / "two")
    (tmp_path / "two" / ".zmetadata").unlink()
    sweep(SCENE, GRID, out=tmp_path / "two", executor=2)
    assert files(tmp_path / "two") == files(alone)


def test_threads_write_the_bytes_of_one(alone, tmp_path):
    with ThreadPoolExecutor(2) as threads:
        sweep(SCENE, GRID, out=tmp_path / "two", executor=threads)
    assert files(tmp_path / "two") == files(alone)


def test_cases_solved_together_are_the_same_by_two_workers(tmp_path):
    scene = load_scene("propeller").with_(run__until="settled")
    vary = {"crank.inertia": "0.1..0.5 kg m^2:36"}
    sweep(scene, vary, out=tmp_path / "two", executor=2)
    sweep(scene, vary, out=tmp_path / "one", executor=1)
    assert files(tmp_path / "two") == files(tmp_path / "one")


class Lazy(ThreadPoolExecutor):
    """Counts what it was handed and has not given back."""

    waiting = most = 0

    def submit(self, *words, **named):
        self.waiting += 1
        self.most = max(self.most, self.waiting)
        future = super().submit(*words, **named)
        future.add_done_callback(self._given)
        return future

    def _given(self, _: Future[object]) -> None:
        self.waiting -= 1


def test_no_more_blocks_wait_than_keep_workers_busy(tmp_path):
    vary = {"crank.inertia": [0.1 + 0.01 * k for k in range(40)]}
    with Lazy(1) as lazy:
        sweep(COASTING, vary, executor=lazy)
    assert lazy.most == 2


# ------------------------------------------------------------------------------------ interrupted


def blocks(out):
    """The files of the blocks that are finished; a write that was killed leaves a *.partial."""
    return [file for file in out.glob("status/*") if file.name.isdigit()]


def begun(out, how):
    """Exit status and stderr of a sweep that got this signal when some blocks were written, and how
    many were there."""
    command = [sys.executable, "-c", COMMAND, *PLAIN, "-o", str(out)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        while len(blocks(out)) < 2:
            assert running.poll() is None
            time.sleep(0.01)
        running.send_signal(how)
        _, said = running.communicate()
    return running.returncode, said, len(blocks(out))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "sweep.zarr"
    assert crankmbs_(*PLAIN, "-o", str(folder)).exit_code == 0
    return files(folder)


def test_a_killed_sweep_is_resumed_from_its_last_block_to_the_same_bytes(whole, tmp_path):
    out = tmp_path / "sweep.zarr"
    status, _, done = begun(out, signal.SIGKILL)
    assert status == -signal.SIGKILL
    with pytest.raises(
        OutputError, match=f"{done} of 5 blocks are finished; crankmbs sweep --resume"
    ):
        load_sweep(out)
    (out / f"measures/0.{'0' * 32}.partial").write_bytes(b"half")
    kept = {file: file.stat().st_mtime_ns for file in blocks(out)}
    assert "exists already; give --resume" in refused(*PLAIN, "-o", str(out))
    assert crankmbs_(*PLAIN, "-o", str(out), "--resume").exit_code == 0
    assert files(out) == whole
    assert all(file.stat().st_mtime_ns == at for file, at in kept.items())


def test_a_start_that_is_killed_leaves_no_hidden_folder(whole, tmp_path):
    out = tmp_path / "sweep.zarr"
    command = [sys.executable, "-c", COMMAND, *PLAIN, "-o", str(out)]
    with subprocess.Popen(command) as running:
        while not out.exists():
            assert running.poll() is None
            time.sleep(0.001)
        running.kill()
    assert names(tmp_path) == {"sweep.zarr"}
    assert crankmbs_(*PLAIN, "-o", str(out), "--resume").exit_code == 0
    assert files(out) == whole


def test_an_interrupted_sweep_says_how_to_resume(whole, tmp_path):
    out = tmp_path / "sweep.zarr"
    status, said, _ = begun(out, signal.SIGINT)
    assert status == 130
    assert said == f"{out} has all finished blocks; --resume computes the others\ninterrupted\n"
    assert crankmbs_(*PLAIN, "-o", str(out), "--resume").exit_code == 0
    assert files(out) == whole


def test_workers_that_are_interrupted_while_they_start_are_silent(tmp_path):
    out = tmp_path / "s"
    words = ["sweep", "yi_diesel", "--workers", "2", "--vary", "rod.length=0.15..0.2 m:4000"]
    command = [sys.executable, "-c", COMMAND, *words, "-o", str(out)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        while not (started := [k for k in children_of(running.pid) if is_loading(k)]):
            assert running.poll() is None
            time.sleep(0.001)
        for _ in range(50):  # while they load, which a terminal's interrupt would meet by chance
            for worker in started:
                os.kill(int(worker), signal.SIGINT)
            time.sleep(0.005)
        running.send_signal(signal.SIGINT)
        _, said = running.communicate()
    assert running.returncode == 130
    assert said == "interrupted\n"
    assert not list(tmp_path.iterdir())


def is_loading(process):
    """Whether it is a worker, no copy of this process any more, that imports what it needs."""
    with suppress(OSError):
        folder = Path(f"/proc/{process}")
        is_worker = "spawn_main" in (folder / "cmdline").read_text()
        return is_worker and "numpy" in (folder / "maps").read_text()
    return False


def children_of(process):
    return Path(f"/proc/{process}/task/{process}/children").read_text().split()


def test_processes_end_with_the_one_that_writes(tmp_path):
    words = ["sweep", "yi_diesel", "--workers", "2", "--vary", "rod.length=0.15..0.2 m:4000"]
    command = [sys.executable, "-c", COMMAND, *words, "-o", str(tmp_path / "s")]
    with subprocess.Popen(command) as running:
        while not [*tmp_path.glob("s/status/[0-9]*")]:
            assert running.poll() is None
            time.sleep(0.05)
        children = children_of(running.pid)
        running.kill()
    assert len(children) >= 2
    for _ in range(500):
        if not any(Path(f"/proc/{child}/exe").exists() for child in children):
            break
        time.sleep(0.02)
    assert not [child for child in children if Path(f"/proc/{child}/exe").exists()]


@pytest.mark.parametrize(
    ("scene", "vary", "keep", "said"),
    [
        (SCENE.with_(piston__mass=2.0), GRID, "measures", "of another scene"),
        (SCENE, {"rod.length": "0.15..0.2 m:13"}, "measures", "of other cases"),
        (SCENE, {"rod.length": [0.1]}, "series", "of other cases and that stores other things"),
        (SCENE, GRID, "measures", "this sweep is complete; give another folder"),
    ],
)
def test_another_sweep_is_not_resumed(alone, scene, vary, keep, said):
    before = files(alone)
    with pytest.raises(InputError, match=said):
        sweep(scene, vary, out=alone, keep=keep, executor=1)
    assert files(alone) == before


def test_a_sweep_by_another_version_is_not_resumed(tmp_path, monkeypatch):
    out = tmp_path / "s"
    with pytest.raises(RuntimeError, match="enough"):
        fill(plan_of(SCENE, GRID, "measures"), out, 1, enough)
    with monkeypatch.context() as later:
        later.setattr(metadata, "version", lambda _: "9.9")
        with pytest.raises(InputError, match="holds a sweep by another version of crankmbs; give"):
            sweep(SCENE, GRID, out=out, executor=1)
    sweep(SCENE, GRID, out=out, executor=1)


def enough(count):
    if count:
        raise RuntimeError("enough")


def test_what_cannot_be_written_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot be written \(.*\); choose another folder"):
        sweep(SCENE, GRID, out=tmp_path / "file" / "s", executor=1)


# --------------------------------------------------------------------------------- workers that end


def test_a_case_that_ends_its_worker_twice_is_a_row(tmp_path):
    scene = replace(COASTING, torque=(Load(deadly),))
    speeds = [50.0, 60.0, 95.0, 70.0, 80.0, 85.0]
    found = sweep(scene, {"start.speed": speeds}, executor=2)
    assert found["status"].values.tolist() == [0, 0, -2, 0, 0, 0]
    assert str(found["message"].values[2]) == DEADLY
    assert np.isfinite(found["mean_speed"].values).tolist() == [True, True, False] + [True] * 3


class KilledWorker(Exception):
    """What Dask says of a task that ended several workers."""


class Deadly(Executor):
    """Ends the worker of every block with this speed, as a cluster that starts it anew."""

    def submit(self, work, /, *given, **_):
        future: Future[object] = Future()
        if given and (95.0,) in given[0].values:
            future.set_exception(KilledWorker())
        else:
            future.set_result(work(*given))
        return future


def test_a_case_that_ends_the_workers_of_a_cluster_is_a_row(monkeypatch):
    monkeypatch.setattr(workers, "_ready", lambda: None)
    speeds = [50.0, 60.0, 95.0, 70.0, 80.0]
    found = sweep(COASTING, {"start.speed": speeds}, executor=Deadly())
    assert found["status"].values.tolist() == [0, 0, -2, 0, 0]
    assert str(found["message"].values[2]) == DEADLY


def test_a_load_of_a_module_is_computed_in_processes():
    scene = replace(load_scene("propeller").with_(run__until="1 cycles"), torque=(Load(braking),))
    vary = {"crank.inertia": [0.2 + 0.01 * k for k in range(8)]}
    xr.testing.assert_identical(sweep(scene, vary, executor=2), sweep(scene, vary, executor=1))


def test_a_load_that_processes_cannot_import_is_refused(tmp_path):
    scene = replace(COASTING, torque=(Load(lambda t, theta, omega: 0.0),))
    vary = {"start.speed": [50.0 + k for k in range(8)]}
    with pytest.raises(InputError, match="a load cannot be sent to other processes"):
        sweep(scene, vary, executor=2, out=tmp_path / "s")
    assert sweep(scene, vary, executor=1)["status"].values.tolist() == [0] * 8


def test_a_script_without_a_guard_is_told_of_it(tmp_path):
    script = tmp_path / "mine.py"
    script.write_text(
        "import crankmbs\n"
        "scene = crankmbs.load_scene('yi_diesel')\n"
        "crankmbs.sweep(scene, {'piston.mass': '1..2 kg:9'}, executor=2)\n"
    )
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False
    )
    # a worker ended while it loads leaves semaphores, and Python's tracker may say so afterwards
    said = [s for s in done.stderr.splitlines() if s.startswith("crankmbs.errors.InputError: ")]
    assert len(said) == 1
    assert "the workers could not start: " in said[0]
    assert 'put its call under if __name__ == "__main__":' in said[0]


def test_an_executor_that_was_shut_down_is_refused(tmp_path):
    threads = ThreadPoolExecutor(1)
    threads.shutdown()
    with pytest.raises(InputError, match="executor: it takes no work"):
        sweep(SCENE, GRID, executor=threads, out=tmp_path / "s")


# ---------------------------------------------------------------------------------------- cluster


@pytest.fixture(scope="module")
def scheduler():
    """The address of a Dask scheduler on this machine with two workers in their own processes."""
    distributed = pytest.importorskip("distributed", reason="of the extra cluster")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        yield cluster.scheduler_address


def test_a_cluster_writes_the_bytes_of_one(scheduler, alone, tmp_path):
    with cluster_executor(scheduler) as executor:
        sweep(SCENE, GRID, out=tmp_path / "s", executor=executor)
    assert files(tmp_path / "s") == files(alone)


def test_all_workers_of_a_cluster_are_kept_busy(scheduler):
    """However many processors the machine has that asks."""
    with cluster_executor(scheduler) as executor:
        assert Workers(executor).at_once == 4 * 2


def test_the_command_takes_a_cluster(scheduler, whole, tmp_path):
    words = [word for word in PLAIN if word not in ("--workers", "1")]
    done = crankmbs_(*words, "-o", str(tmp_path / "s"), "--cluster", scheduler)
    assert done.exit_code == 0, done.output
    assert files(tmp_path / "s") == whole


def test_an_unreachable_scheduler_is_one_sentence(tmp_path):
    words = [word for word in PLAIN if word not in ("--workers", "1")]
    said = refused(*words, "-o", str(tmp_path / "s"), "--cluster", "tcp://127.0.0.1:1")
    assert said.startswith("tcp://127.0.0.1:1: no scheduler answers; start one with")
    assert not list(tmp_path.iterdir())
    assert "both say where" in refused(*PLAIN, "-o", "s", "--cluster", "tcp://127.0.0.1:1")


def test_few_blocks_are_computed_where_they_are_asked_for(monkeypatch):
    monkeypatch.setattr(workers, "_processes", None)
    plan = plan_of(SCENE, GRID, "measures")
    few = [plan.boxes[2], plan.boxes[0]]
    assert [box for box, _ in workers.computed(plan.job, few, None)] == few
