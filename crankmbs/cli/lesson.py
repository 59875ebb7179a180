"""The commands ``lesson`` and ``lessons``: the page of a lesson, and which there are."""

from __future__ import annotations

from pathlib import Path

import typer

from crankmbs.cli.folder import writable
from crankmbs.cli.progress import progress
from crankmbs.lessons import LESSONS, check_lesson, write_lesson

__all__ = ["list_lessons", "make_lesson"]


def make_lesson(name: str, folder: Path) -> None:
    """Write the page of a lesson into a folder.

    Raises
    ------
    CrankmbsError : no such lesson, or a folder that cannot be written; before anything runs
    """
    check_lesson(name)
    writable(folder)
    with progress(f"lesson {name}"):
        file = write_lesson(name, folder)
    typer.echo(f"wrote {file}; open it in a browser")


def list_lessons() -> None:
    """Print the lessons in their order."""
    width = max(map(len, LESSONS))
    for number, (name, title) in enumerate(LESSONS.items(), start=1):
        typer.echo(f"{number}  {name:<{width}}  {title}")
