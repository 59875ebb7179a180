"""A copy of the checkout in which mutants live and guards run; the checkout is never touched."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from validation.mutants.plan import ROOT, Guards, Mutant

__all__ = ["Red", "Scratch"]

_PARTS = ("crankmbs", "models", "tests", "validation", "pyproject.toml", "README.md")
_SECONDS = 10_000_000_000  # ns: times of byte code are in whole seconds
_PYTEST = (
    "-p",
    "xdist.plugin",
    "-p",
    "no:cacheprovider",
    "-x",
    "-q",
    "--tb=no",
    "-rfE",
    "-n",
    "0",
    "-m",
    "",
)


class Red(NamedTuple):
    """What turned red first, a test or a claim; the last of those that did not come to their end,
    by the time limit or a crash."""

    guard: str
    ended: bool


class Scratch:
    """A copy of the checkout in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._number = folder, 0
        unread = shutil.ignore_patterns("*.pyc")
        for part in (ROOT / name for name in _PARTS):
            if part.is_dir():
                shutil.copytree(part, folder / part.name, ignore=unread)
            else:
                shutil.copy2(part, folder / part.name)

    @contextmanager
    def mutated(self, mutant: Mutant) -> Iterator[None]:
        """The copy with one mutant in it; afterwards the file is as it was, its time too.

        No two mutants have one time: byte code knows its source by it.
        """
        path = self.folder / mutant.file
        before, text = path.stat(), path.read_text(encoding="utf-8")
        path.write_text(mutant.applied(text), encoding="utf-8")
        self._number += 1
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns + self._number * _SECONDS))
        try:
            yield
        finally:
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))

    def first_red(self, guards: Guards, limit: float | None = None) -> Red | None:
        """Run guards until one is red; None where all stay green. Beyond a time limit [s] that
        is red too.

        Raises
        ------
        RuntimeError : no guard ran, and why
        """
        commands = []
        if guards.claims:
            commands.append(["validation.mutants.claims", *guards.claims])
        if guards.tests:
            commands.append(["pytest", *_PYTEST, *guards.tests])
        for command in commands:
            red = self._run([sys.executable, "-m", *command], limit)
            if red is not None:
                return red
        return None

    def _run(self, command: list[str], limit: float | None) -> Red | None:
        surroundings = os.environ | {
            "PYTHONPATH": str(self.folder),
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # two fifths of the time of a quick guard
        }
        with subprocess.Popen(
            command,
            cwd=self.folder,
            env=surroundings,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as process:
            try:
                said, _ = process.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return Red(command[-1], ended=False)
        if process.returncode == 0:
            return None
        names = [
            line.split(" - ")[0].partition(" ")[2]
            for line in said.splitlines()
            if line.startswith(("FAILED ", "ERROR "))
        ]
        if names:
            return Red(names[0], ended=True)
        if process.returncode < 0:
            return Red(command[-1], ended=False)
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}:\n{said[-2000:]}")
