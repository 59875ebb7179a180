"""What a report was made with: the day, the version and commit, other packages, the machine."""

from __future__ import annotations

import subprocess
from datetime import UTC, datetime
from pathlib import Path

from crankmbs.work_precision.machine import about_machine

__all__ = ["about", "commit"]

_HERE = Path(__file__).parent


def about() -> tuple[str, ...]:
    """Lines of Markdown for the head of a report: neither a host's name nor a path."""
    machine, versions = about_machine()
    return (
        f"- date: {datetime.now(UTC):%Y-%m-%d}",
        f"- commit: {commit()}",
        f"- versions: {versions}",
        f"- machine: {machine}",
    )


def commit(folder: Path = _HERE) -> str:
    """The commit that a folder is at, and whether it has been changed since."""
    try:
        number = _git(folder, "rev-parse", "HEAD")
        changed = _git(folder, "status", "--porcelain")
    except (OSError, subprocess.CalledProcessError):
        return "unknown, not a git checkout"
    return f"{number}, with uncommitted changes" if changed else number


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.strip()
