"""What the manual shows of the project is made from it while it is built: tables of keys, commands
and names within the pages, figures that are not there, the lessons, a page that computes, and the
source."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from hard import hard_page
from keys import keys_page
from names import commands_page, python_page, variables_page

import crankmbs
from crankmbs.lessons import write_lessons
from crankmbs.page import page_of
from crankmbs.storage.files import text_in_one_move

if TYPE_CHECKING:
    from sphinx.application import Sphinx

__all__ = ["PARTS", "setup", "with_part"]

PARTS = {
    "reference/keys.md": keys_page,
    "reference/commands.md": commands_page,
    "reference/result.md": variables_page,
    "reference/python.md": python_page,
    "validation/hard.md": hard_page,
}
"""Pages of which a part is made, and what makes it; it stands in the page, to be read without a
build, between two comments."""
_PART = re.compile(r"(<!-- made -->\n\n).*?(\n<!-- to here -->\n)", re.DOTALL)
_VALIDATION = ("REPORT", "MEASURED", "CLAIMS", "ERRATA", "MUTANTS", "BIBLIOGRAPHY")
_ANCHOR = re.compile(r'^(#+ )<a id="([^"]+)"></a>', re.MULTILINE)
_FIGURES: dict[str, tuple[str, dict[str, object], str]] = {  # scene, changes, kind of the figure
    "speed": ("yi_diesel_free", {"run__until": "4 cycles"}, "speed"),
    "polar": ("yi_diesel", {"run__until": "1 cycle"}, "polar"),
    "cycles": ("misfire", {"run__until": "8 cycles"}, "cycles"),
    "bearings": (
        "yi_diesel_free",
        {
            "run__until": "settled",
            "layout__spacing": "100 mm",
            "bearings": crankmbs.Bearings(),
        },
        "bearings",
    ),
}


def with_part(page: str, part: str) -> str:
    r"""A page with a part of it made anew.

    >>> with_part("a\n<!-- made -->\n\nb\n\n<!-- to here -->\n", "c\n")
    'a\n<!-- made -->\n\nc\n\n<!-- to here -->\n'
    """
    return _PART.sub(lambda at: f"{at[1]}{part.strip()}\n{at[2]}", page)


def _make(app: Sphinx) -> None:
    docs = Path(app.srcdir)
    made = docs / "_made"
    for name, part in PARTS.items():
        page = (docs / name).read_text(encoding="utf-8")
        if with_part(page, part()) != page:
            (docs / name).write_text(with_part(page, part()), encoding="utf-8")
    for name in _VALIDATION:
        page = (made.parents[1] / "validation" / f"{name}.md").read_text(encoding="utf-8")
        (made / f"{name}.md").write_text(_linked(page), encoding="utf-8")
    mpl.use("agg")
    for name, (scene, changes, kind) in _FIGURES.items():
        file = docs / "figures" / f"{name}.png"
        if not file.exists():
            result = crankmbs.simulate(crankmbs.load_scene(scene).with_(**changes))
            result.plot(kind).savefig(file, dpi=110)
    write_lessons(made / "pages" / "lessons")
    demo = page_of(crankmbs.load_scene("yi_diesel_free"), "yi_diesel_free")
    text_in_one_move(made / "pages" / "demo.html", demo)
    archive = ["git", "archive", "--prefix=crankmbs/", "-o", made / "crankmbs.tar.gz", "HEAD"]
    subprocess.run(archive, cwd=made.parents[1], check=True)


def _linked(text: str) -> str:
    """A page of validation whose anchors, figures and headings are where Sphinx looks for them."""
    text = _ANCHOR.sub(r"(\2)=\n\1", text).replace("](figures/", "](../../validation/figures/")
    return text.replace("\n### ", "\n## ") if "\n## " not in text else text


def setup(app: Sphinx) -> dict[str, Any]:
    """Make all of it before Sphinx reads a page; the folder, before Sphinx looks whether it is
    there."""
    (Path(app.srcdir) / "_made" / "pages").mkdir(parents=True, exist_ok=True)
    app.connect("builder-inited", _make)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
