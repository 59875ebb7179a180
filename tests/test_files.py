"""Files that appear together or not at all: two runs at once, killed runs, a full disk."""

import dataclasses
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from command_line import names

from crankmbs import OutputError, Result, Run, load_scene, simulate
from crankmbs.result import record
from crankmbs.storage.files import together, write_in_one_move

pytestmark = pytest.mark.slow

SHORT = dataclasses.replace(load_scene("coasting"), run=Run(until="30 deg"))
ELSE = "choose another folder"
HARD_LIMITS = pytest.mark.skipif(sys.platform == "win32", reason="no limits of a process there")


@pytest.fixture(scope="module")
def first():
    return simulate(SHORT)


@pytest.fixture(scope="module")
def second():
    return simulate(dataclasses.replace(SHORT, run=Run(until="60 deg")))


def write(*files):
    """Write each of these files, its own name in it."""
    for file in files:
        file.write_text(file.parent.name)


def assert_one_run(folder, result):
    """The data and the table in the folder are those of one run."""
    loaded = Result.load(folder).data["time"].values
    table = np.loadtxt(folder / "motion.csv", delimiter=",", skiprows=1)
    assert loaded.tolist() == result.data["time"].values.tolist()
    assert len(table) == len(loaded)


@pytest.mark.parametrize("step", ["write_saved", "write_csv"])
def test_two_runs_into_one_folder_do_not_mix(step, first, second, tmp_path, monkeypatch):
    """The second comes while the first one writes."""
    plain, order = getattr(record, step), [second]

    def interrupted(*given):
        plain(*given)
        if order:
            order.pop().save(tmp_path)

    monkeypatch.setattr(record, step, interrupted)
    first.save(tmp_path)
    assert_one_run(tmp_path, first)
    assert names(tmp_path) == {"result.nc", "motion.csv"}


def test_files_are_moved_while_no_other_run_moves_its_own(first, second, tmp_path, monkeypatch):
    plain = Path.replace
    others: list[threading.Thread] = []
    moved = []

    def late(file, target):
        plain(file, target)
        if threading.current_thread() is threading.main_thread():
            moved.append(target)
        if len(moved) == 2 and threading.current_thread() is threading.main_thread():
            assert_one_run(tmp_path, first)  # the other one waits until this is done
        if not others:
            others.append(threading.Thread(target=second.save, args=(tmp_path,)))
            others[0].start()
            others[0].join(1.0)  # it would be done by then

    monkeypatch.setattr(Path, "replace", late)
    first.save(tmp_path)
    others[0].join()
    assert len(moved) == 2
    assert_one_run(tmp_path, second)
    assert names(tmp_path) == {"result.nc", "motion.csv"}


def test_what_fails_leaves_the_files_of_the_run_before(first, second, tmp_path, monkeypatch):
    first.save(tmp_path)
    full = OSError(28, "No space left on device")
    monkeypatch.setattr(record, "write_csv", lambda *_: (_ for _ in ()).throw(full))
    with pytest.raises(OutputError) as caught:
        second.save(tmp_path)
    assert str(caught.value) == f"{tmp_path}: cannot be written (No space left on device); {ELSE}"
    assert_one_run(tmp_path, first)
    assert names(tmp_path) == {"result.nc", "motion.csv"}


def test_a_folder_in_the_way_is_found_before_anything_is_moved(first, tmp_path):
    (tmp_path / "result.nc").mkdir()
    with pytest.raises(OutputError, match=r"cannot be written \(result\.nc is a folder there\)"):
        first.save(tmp_path)
    assert names(tmp_path) == {"result.nc"}


def test_a_file_that_cannot_be_made_is_named_at_its_place(tmp_path):
    target = tmp_path / ("x" * 300)
    with pytest.raises(OutputError) as caught:
        write_in_one_move(target, write)
    assert str(caught.value) == f"{target}: cannot be written (File name too long); {ELSE}"


def test_a_block_in_a_block_joins_it(tmp_path):
    with together(tmp_path) as part:
        write_in_one_move(part / "a", write)
        with together(part) as same:
            write(same / "b")
        assert same == part
        assert names(tmp_path) == {part.name}
    assert names(tmp_path) == {"a", "b"}


KILLED = """
import os, signal, sys
from pathlib import Path
from crankmbs.result import record
from crankmbs.storage.files import together
with together(Path(sys.argv[1])) as part:
    (part / "result.nc").write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@HARD_LIMITS
def test_what_a_killed_run_has_left_goes_with_the_next_one(tmp_path):
    done = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    assert done.returncode == -signal.SIGKILL
    assert len(names(tmp_path)) == 1
    (tmp_path / ".part-abc_defg.csv").write_text("left by an older version")
    (tmp_path / ".part-of-mine").write_text("no part")
    with together(tmp_path) as part:
        assert names(tmp_path) == {part.name, ".part-of-mine"}


def test_the_part_of_a_run_that_is_writing_stays(tmp_path):
    with together(tmp_path) as part:
        write(part / "a")
        with together(tmp_path) as other:
            write(other / "b")
        assert names(tmp_path) == {part.name, "b"}
    assert names(tmp_path) == {"a", "b"}


FULL = """
import resource, signal, sys
resource.setrlimit(resource.RLIMIT_FSIZE, ({bytes}, {bytes}))
from crankmbs.cli import main
sys.argv = ["crankmbs", *{words}]
main()
"""


@HARD_LIMITS
@pytest.mark.parametrize("most", [30_000, 600_000], ids=["netCDF", "CSV"])
def test_a_full_disk_is_one_sentence(most, tmp_path):
    """A limit of the files' size stands for the disk's: the write that goes beyond it fails."""
    out = tmp_path / "results" / "coasting"
    words = ["run", "coasting", "--no-figures", "--out", str(out)]
    code = FULL.format(bytes=most, words=words)
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    assert done.stderr == f"error: {out}: cannot be written (File too large); {ELSE}\n"
    assert names(tmp_path) == set()
