"""Short lessons that compute in the browser: the lectures' formulas, the simulation, questions.

A lesson is a module here that says its words and answers, and its module in JavaScript,
`crankmbs/page/js/lesson_NAME.js`, that says what its figures show; `pieces` is what it is made of.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from crankmbs.errors import InputError
from crankmbs.scene.read import load_scene
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import did_you_mean
from crankmbs.storage.files import text_in_one_move

__all__ = ["LESSONS", "check_lesson", "write_lesson", "write_lessons"]

LESSONS = {
    "displacement": "Displacement and the Brix correction",
    "acceleration": "Velocity and acceleration",
    "forces": "Forces and side thrust",
    "omega": "Why the speed is not constant",
    "fluctuation": "Constant speed or not",
    "balance": "The engine with several cylinders",
    "polar": "Reading a bearing polar",
    "trust": "How far to trust a number",
}
"""The lessons in their order: name and title."""

_INDEX = "index.html"


def check_lesson(name: str) -> None:
    """Raise InputError unless there is a lesson of this name."""
    if name not in LESSONS:
        hint = did_you_mean(name, list(LESSONS))
        raise InputError(f"lesson: must be one of {', '.join(LESSONS)}; {name!r} came{hint}")


def write_lesson(name: str, folder: Path, scene: Scene | None = None) -> Path:
    """Run what a lesson needs and write its page NAME.html, replaced in one move.

    Parameters
    ----------
    scene : which the lesson is about; None: that which it has by itself

    Raises
    ------
    InputError : no lesson of this name, a scene that it cannot be about
    OutputError : the folder cannot be made or written

    >>> write_lesson("displacement", Path("lessons"))
    PosixPath('lessons/displacement.html')
    """
    check_lesson(name)
    target = folder / f"{name}.html"
    text_in_one_move(target, _page(name, scene, linked=(folder / _INDEX).exists()))
    return target


def write_lessons(folder: Path, scene: Scene | None = None) -> Path:
    """Write all lessons, and index.html that leads to them.

    Raises
    ------
    InputError : a scene that one of them cannot be about
    OutputError : the folder cannot be made or written

    >>> write_lessons(Path("lessons"))
    PosixPath('lessons/index.html')
    """
    from crankmbs.lessons.article import index

    pages = {name: _page(name, scene, linked=True) for name in LESSONS}
    for name, text in pages.items():
        text_in_one_move(folder / f"{name}.html", text)
    ideas = {name: import_module(f"crankmbs.lessons.{name}").IDEA for name in LESSONS}
    text_in_one_move(folder / _INDEX, index(LESSONS, ideas, scene))
    return folder / _INDEX


def _page(name: str, scene: Scene | None, *, linked: bool) -> str:
    from crankmbs.lessons.article import article  # jinja2 only when it is used

    module = import_module(f"crankmbs.lessons.{name}")
    made = module.lesson(load_scene(module.SCENE) if scene is None else scene)
    return article(made, name, LESSONS, linked=linked)
