"""A command that is interrupted, whose output cannot be written, or that finds no memory: a status
and no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import RUNNING, crankmbs_, names, refused

pytestmark = pytest.mark.slow

FULL = Path("/dev/full")
NEEDS_FULL = pytest.mark.skipif(not FULL.exists(), reason="this system has no /dev/full")
COMMAND = "import sys; from crankmbs.cli import main; sys.argv[0] = 'crankmbs'; main()"


def run(*words, stdout, stderr=subprocess.PIPE, python=()):
    command = [sys.executable, *python, "-c", COMMAND, *words]
    return subprocess.run(command, stdout=stdout, stderr=stderr, text=True, check=False)


def run_into_a_closed_pipe(*words):
    reader, writer = os.pipe()
    os.close(reader)
    with open(writer, "w") as stdout:  # noqa: PTH123
        return run(*words, stdout=stdout)


def test_a_run_whose_reader_has_gone_ends_quietly_with_its_files_written(tmp_path):
    done = run_into_a_closed_pipe("run", "coasting", "--no-figures", "--out", str(tmp_path))
    assert (done.returncode, done.stderr) == (141, "")
    assert names(tmp_path) == {"result.nc", "motion.csv", "cycles.csv"}


def test_help_whose_reader_has_gone_ends_quietly():
    done = run_into_a_closed_pipe("--help")
    assert (done.returncode, done.stderr) == (141, "")


@NEEDS_FULL
@pytest.mark.parametrize("word", ["scenes", "--version"])
def test_a_full_device_is_one_sentence(word):
    with FULL.open("w") as stdout:
        done = run(word, stdout=stdout)
    assert done.returncode == 2
    assert done.stderr == (
        "error: standard output cannot be written (No space left on device); send it elsewhere\n"
    )


@NEEDS_FULL
@pytest.mark.parametrize("python", [["-E"], ["-u"]], ids=["buffered", "unbuffered"])
def test_the_status_is_right_where_not_even_the_message_can_be_written(python):
    words = ("check", "no such scene")
    with FULL.open("w") as stderr:
        done = run(*words, stdout=subprocess.PIPE, stderr=stderr, python=python)
    assert (done.returncode, done.stdout) == (2, "")


def test_too_little_memory_is_one_sentence(tmp_path, monkeypatch):
    def full(*_, **__):
        raise MemoryError

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(RUNNING, "simulate", full)
    assert refused("run", "coasting") == (
        "this machine has not enough memory for it; give a wider run.every, or "
        'every = "none" to keep the last cycle alone'
    )
    assert names(tmp_path) == set()


def test_an_error_that_is_none_of_the_output_keeps_its_own_words(tmp_path, monkeypatch):
    def missing(*_, **__):
        raise FileNotFoundError(2, "No such file or directory", "part")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(RUNNING, "simulate", missing)
    result = crankmbs_("run", "coasting")
    assert isinstance(result.exception, FileNotFoundError)


INTERRUPTED = """
import signal, sys
from crankmbs.cli import main
import crankmbs.scene.read

def loaded(path):
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt as interrupt:
        raise {error} from {cause}

crankmbs.scene.read.load_scene = loaded
sys.argv = ["crankmbs", "check", "propeller"]
main()
"""


@pytest.mark.parametrize("cause", ["interrupt", "None"])
@pytest.mark.parametrize("error", ["ImportError('initialization failed')", "SystemError()"])
def test_an_interrupt_is_one_whatever_a_library_makes_of_it(error, cause):
    """As one of those in C that are just being imported."""
    code = INTERRUPTED.format(error=error, cause=cause)
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
