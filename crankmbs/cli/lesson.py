"""The commands ``lesson`` and ``lessons``: the page of a lesson, and which there are."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, Option, echo

from crankmbs.cli.folder import writable
from crankmbs.cli.progress import progress

__all__ = ["lesson", "lessons"]


def lesson(
    name: Annotated[
        str | None,
        Argument(
            metavar="NAME", help="Its name, as lessons lists them; without it all, with an index."
        ),
    ] = None,
    out: Annotated[
        Path,
        Option("--out", "-o", metavar="DIR", help="Folder of the page."),
    ] = Path("lessons"),
    scene: Annotated[
        str | None,
        Option("--scene", metavar="SCENE", help="Which it is about; default its own."),
    ] = None,
) -> None:
    """Write a lesson: figures that compute while you drag them, formulas, and questions."""
    from crankmbs.lessons import check_lesson, write_lesson, write_lessons
    from crankmbs.scene.read import load_scene

    if name is not None:
        check_lesson(name)
    about = None if scene is None else load_scene(scene)
    writable(out)
    with progress(f"lesson {name}" if name else "lessons"):
        file = write_lesson(name, out, about) if name else write_lessons(out, about)
    echo(f"wrote {file}; open it in a browser")


def lessons() -> None:
    """List the lessons."""
    from crankmbs.lessons import LESSONS

    width = max(map(len, LESSONS))
    for number, (name, title) in enumerate(LESSONS.items(), start=1):
        echo(f"{number}  {name:<{width}}  {title}")
