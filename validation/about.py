"""What evidence was made with: the commit, the versions of the packages, the machine."""

from __future__ import annotations

import subprocess
from pathlib import Path

from crankmbs.work_precision.machine import about_machine

__all__ = ["commit", "environment"]

_HERE = Path(__file__).parent
_WRITTEN = (
    "validation/REPORT.md",
    "validation/CLAIMS.md",
    "validation/MEASURED.md",
    "validation/MUTANTS.md",
    "validation/details.json",
    "validation/measured.json",
    "validation/results.csv",
    "validation/figures/",
    "validation/mutants/results.csv",
)


def environment() -> str:
    """Versions and machine in one line, with neither a host's name nor a path."""
    machine, versions = about_machine()
    return f"{versions}; {machine}"


def commit(folder: Path = _HERE) -> str:
    """The commit of a checkout, with a plus where a file differs from it, but for the evidence that
    is written; "unknown" without git."""
    try:
        head = _git(folder, "rev-parse", "--short", "HEAD").strip()
        lines = _git(folder, "status", "--porcelain").splitlines()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{head}+" if any(not line[3:].startswith(_WRITTEN) for line in lines) else head


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout
