"""Five short lesson pages: the lectures' formulas, the simulation on top, questions with answers.

Each file but `parts`, `markup`, `page` and `runs` is one lesson.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from crankmbs.errors import InputError
from crankmbs.scene.sentences import did_you_mean
from crankmbs.storage.files import text_in_one_move

__all__ = ["LESSONS", "check_lesson", "write_lesson"]

LESSONS = {
    "displacement": "Displacement and the Brix correction",
    "acceleration": "Velocity and acceleration",
    "forces": "Forces and side thrust",
    "fluctuation": "Constant speed or not",
    "balance": "The engine with several cylinders",
}
"""The lessons in their order: name and title."""


def check_lesson(name: str) -> None:
    """Raise InputError unless there is a lesson of this name."""
    if name not in LESSONS:
        hint = did_you_mean(name, list(LESSONS))
        raise InputError(f"lesson: must be one of {', '.join(LESSONS)}; {name!r} came{hint}")


def write_lesson(name: str, folder: Path) -> Path:
    """Run what a lesson shows and write its page NAME.html, replaced in one move.

    Raises
    ------
    InputError : no lesson of this name
    OutputError : the folder cannot be made or written

    >>> write_lesson("displacement", Path("lessons"))
    PosixPath('lessons/displacement.html')
    """
    check_lesson(name)
    from crankmbs.lessons.page import page  # matplotlib and jinja2 only when they are used

    lesson = import_module(f"crankmbs.lessons.{name}").lesson()
    number = list(LESSONS).index(name) + 1
    text = page(lesson, name=name, title=LESSONS[name], number=number, count=len(LESSONS))
    target = folder / f"{name}.html"
    text_in_one_move(target, text)
    return target
