"""The commands ``lesson`` and ``lessons``: the page of a lesson, and which there are."""

from __future__ import annotations

from pathlib import Path

import typer

from crankmbs.cli.folder import writable
from crankmbs.cli.progress import progress
from crankmbs.lessons import LESSONS, check_lesson, write_lesson, write_lessons
from crankmbs.scene.read import load_scene

__all__ = ["list_lessons", "make_lesson"]


def make_lesson(name: str | None, folder: Path, about: str | None) -> None:
    """Write the page of a lesson into a folder, or without a name all and their index; about the
    scene of a name or file, or about those that they have by themselves.

    Raises
    ------
    CrankmbsError : no such lesson, a bad scene, or a folder that cannot be written; before anything
        runs
    """
    if name is not None:
        check_lesson(name)
    scene = None if about is None else load_scene(about)
    writable(folder)
    with progress(f"lesson {name}" if name else "lessons"):
        file = write_lesson(name, folder, scene) if name else write_lessons(folder, scene)
    typer.echo(f"wrote {file}; open it in a browser")


def list_lessons() -> None:
    """Print the lessons in their order."""
    width = max(map(len, LESSONS))
    for number, (name, title) in enumerate(LESSONS.items(), start=1):
        typer.echo(f"{number}  {name:<{width}}  {title}")
