"""A lesson as one HTML file that loads nothing from anywhere."""

from __future__ import annotations

from crankmbs.lessons.markup import formula, prose, svg
from crankmbs.lessons.parts import Lesson

__all__ = ["page"]


def page(lesson: Lesson, *, name: str, title: str, number: int, count: int) -> str:
    """The page of a lesson, which is ``number`` of ``count``; well-formed as XML too."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("crankmbs.lessons", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(prose=prose, formula=formula, svg=svg)
    return environment.get_template("page.html").render(
        lesson=lesson, name=name, title=title, number=number, count=count
    )
