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

__all__ = ["PARTS", "as_built", "setup", "with_part"]

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
_SIDES = re.compile(
    r"(?:<!-- in a checkout -->\n(?:(?!<!--).)*)?<!-- in the built manual\n(.*?)-->\n", re.DOTALL
)
_LESSON = re.compile(r"^- \*\*(\w+)\*\*: (.*)\n", re.MULTILINE)
_FRAME = r"""
<details>
<summary><b>\1</b>: \2</summary>
<p><a href="lessons/\1.html">on a page of its own</a></p>
<iframe class="live" src="lessons/\1.html" title="lesson \1" loading="lazy"></iframe>
</details>
"""
_VALIDATION = ("REPORT", "MEASURED", "CLAIMS", "ERRATA", "MUTANTS", "BIBLIOGRAPHY")
_TO_VALIDATION = re.compile(rf"\]\(\.\./((?:\.\./)?validation/(?:{'|'.join(_VALIDATION)})\.md)")
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


def as_built(name: str, page: str) -> str:
    r"""A page with what the build alone can show, in place of what a checkout's reader sees there:
    where its comments say so, and lessons in frames.

    >>> as_built("a", "<!-- in a checkout -->\nno\n<!-- in the built manual\nyes\n-->\nand on\n")
    'yes\nand on\n'
    """
    page = _SIDES.sub(r"\1", page)
    return _LESSON.sub(_FRAME, page) if name == "lessons" else page


def _make(app: Sphinx) -> None:
    docs = Path(app.srcdir)
    made = docs / "_made"
    for name, part in PARTS.items():
        page = (docs / name).read_text(encoding="utf-8")
        if with_part(page, part()) != page:
            (docs / name).write_text(with_part(page, part()), encoding="utf-8")
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


def _read(app: Sphinx, name: str, source: list[str]) -> None:
    """A page as it is built. Six of the folder validation are pages of the manual, and links lead
    there."""
    folder, _, page = name.rpartition("/")
    if folder == "validation" and page in _VALIDATION:
        file = Path(app.srcdir).parent / f"{name}.md"
        app.env.note_dependency(file)
        source[0] = _linked(file.read_text(encoding="utf-8"))
    source[0] = _TO_VALIDATION.sub(r"](\1", as_built(name, source[0]))


def _linked(text: str) -> str:
    """A page of validation whose anchors, figures and headings are where Sphinx looks for them."""
    text = _ANCHOR.sub(r"(\2)=\n\1", text).replace("](figures/", "](../../validation/figures/")
    return text.replace("\n### ", "\n## ") if "\n## " not in text else text


def setup(app: Sphinx) -> dict[str, Any]:
    """Make all of it before Sphinx reads a page; the folder, before Sphinx looks whether it is
    there."""
    (Path(app.srcdir) / "_made" / "pages").mkdir(parents=True, exist_ok=True)
    app.connect("builder-inited", _make)
    app.connect("source-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
