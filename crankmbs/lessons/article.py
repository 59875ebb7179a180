"""A lesson as one HTML file that computes in the browser and loads nothing from anywhere."""

from __future__ import annotations

import base64
import dataclasses
import re
from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup

from crankmbs.errors import InputError
from crankmbs.lessons.markup import formula, prose
from crankmbs.lessons.pieces import TITLES, Lesson
from crankmbs.lessons.runs import named
from crankmbs.page import FOLDER, encoded, filled, given_of, joined, refusals
from crankmbs.page.knobs import knobs_of
from crankmbs.scene.scene import Scene

__all__ = ["article", "index"]

_HERE = Path(__file__).parent
_NUMBER = re.compile(r'<data id="(\w+)" value="[^"]*" data-error="([^"]*)">([^<]*)</data>')


def article(lesson: Lesson, name: str, titles: dict[str, str], *, linked: bool) -> str:
    """The page of a lesson.

    titles : of all lessons by their names, in their order; linked : whether the others and their
    index lie beside it

    Raises
    ------
    InputError : a scene that the browser cannot run, with the reasons
    """
    reasons = refusals(lesson.scene)
    if reasons:
        raise InputError(f"the lesson cannot show this scene. {'. '.join(reasons)}")
    script = f"{joined(f'lesson_{name}')}.start();"
    gas = lesson.scene.gas
    given = {
        **given_of(lesson.scene),
        "knobs": [dataclasses.asdict(knob) for knob in knobs_of(lesson.scene)],
        "compression": gas.indicator.compression_ratio if gas and gas.indicator else None,
        "figures": [section.figure.data for section in lesson.sections],
        **lesson.more,
        "questions": [question.data for question in lesson.questions],
    }
    names = list(titles)
    at = names.index(name)
    return _rendered(
        "article.html",
        script,
        lesson=lesson,
        name=name,
        title=titles[name],
        number=at + 1,
        count=len(names),
        linked=linked,
        before=_neighbour(titles, at - 1),
        after=_neighbour(titles, at + 1),
        errors=[match for text in lesson.texts for match in _NUMBER.findall(text)],
        sources=[full for _, full in TITLES.values()],
        given=Markup(encoded(given)),
    )


def index(titles: dict[str, str], ideas: dict[str, str], scene: Scene | None) -> str:
    """The page that lists the lessons. ideas : of each in a sentence; scene : which all are about,
    or None."""
    about = "" if scene is None else named(scene)
    return _rendered("index.html", "", titles=titles, ideas=ideas, scene=about)


def _neighbour(titles: dict[str, str], at: int) -> tuple[str, str] | None:
    return list(titles.items())[at] if 0 <= at < len(titles) else None


def _rendered(template: str, script: str, **words: Any) -> str:
    words |= {"prose": prose, "formula": formula}
    return filled(_HERE / template, script, _style(), fonts=True, **words)


@cache
def _style() -> str:
    """The page's style, what a lesson looks like besides, and the font of formulas."""
    font = base64.b64encode((_HERE / "font" / "stix_two_math.woff").read_bytes()).decode()
    face = (
        '@font-face { font-family: "Lesson Math"; font-display: block; '
        f'src: url("data:font/woff;base64,{font}") format("woff"); }}\n'
    )
    styles = (FOLDER.parent / "page.css", _HERE / "article.css")
    return face + "".join(path.read_text(encoding="utf-8") for path in styles)
