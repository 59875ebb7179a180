"""The blocks of the manual's pages, and how each is run: ``python`` and ``sh`` are done; ``toml``,
``csv`` and ``py`` are written to the file that their first line names; ``text`` is what the block
before prints, with ... where it is shortened."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from typer.testing import CliRunner

from crankmbs.cli import app

if TYPE_CHECKING:
    from sphinx.application import Sphinx

__all__ = ["DOCS", "WIDTH", "Block", "Reader", "blocks", "pages", "printed", "setup"]

DOCS = Path(__file__).parents[1]
WIDTH = 88  # characters of a line that the page shows without scrolling
_CI = DOCS.parent / ".ci" / "run"
_FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"# (at the end of )?(\S+\.\w+)$", re.MULTILINE)
_EXIT = re.compile(r"# exits with (\d)$")


class Block(NamedTuple):
    """A fenced block, its language and its text."""

    language: str
    text: str


def pages() -> list[Path]:
    """The pages that somebody wrote, by their places in the folder."""
    written = [page.relative_to(DOCS) for page in sorted(DOCS.rglob("*.md"))]
    return [page for page in written if page.parts[0] not in ("_build", "_made")]


def blocks(text: str) -> list[Block]:
    """All blocks of a page but those of directives, in their order."""
    return [Block(*found) for found in _FENCE.findall(text)]


def printed(shown: str, came: str) -> str | None:
    r"""What was printed, shortened where the page does so; None if the page shows something else.

    A line ... stands for any lines, and ... within a line for any part of it, which is filled in
    where the whole line fits the page. Numbers of blanks do not matter.

    >>> printed("a 1\n...\nb ... 3\n", "a  1\nx\ny\nb 2 3\n")
    'a  1\n...\nb 2 3\n'
    """
    lines = shown.splitlines()
    skipped = [line.strip() == "..." for line in lines]
    parts = [
        r"((?:.*\n)*?)" if skip else f"({_line(line)})\n"
        for line, skip in zip(lines, skipped, strict=True)
    ]
    found = re.fullmatch("".join(parts), came if came.endswith("\n") else f"{came}\n")
    if found is None:
        return None
    rows = zip(lines, skipped, found.groups(), strict=True)
    kept = [line if skip or len(text) > WIDTH else text.rstrip() for line, skip, text in rows]
    return "".join(f"{line}\n" for line in kept)


def _line(line: str) -> str:
    words = [re.escape(word).replace(r"\.\.\.", ".*") for word in line.split()]
    return rf"[ ]*{'[ ]+'.join(words)}[ ]*".replace(".*[ ]+", ".*[ ]*").replace("[ ]+.*", "[ ]*.*")


class Reader:
    """Does in the present folder what a page tells its reader to do, block after block."""

    def __init__(self) -> None:
        self._names: dict[str, Any] = {"__name__": "__main__"}
        self._said = ""

    def follow(self, block: Block) -> str:
        """Run a block, write its file, or hold it against what the block before printed; its text
        as the page shows it.

        Raises
        ------
        ValueError : a command that fails, or another text
        """
        match block.language:
            case "python":
                with contextlib.redirect_stdout(io.StringIO()) as said:
                    exec(compile(block.text, "block", "exec"), self._names)
                self._said = said.getvalue()
            case "sh":
                lines = block.text.replace("\\\n", " ").splitlines()
                self._said = "".join(map(_command, lines))
            case "text":
                made = printed(block.text, self._said)
                if made is None:
                    raise ValueError(
                        f"the page shows\n{block.text}\nand what came is\n{self._said}"
                    )
                return made
            case _:
                _write(block.text)
        return block.text


def _write(text: str) -> None:
    """Write a file, or to the end of it."""
    found = _FILE.match(text)
    if found is None:
        raise ValueError(f"the first line of this file does not name it:\n{text}")
    appended, name = found.groups()
    with Path(name).open("a" if appended else "w", encoding="utf-8") as file:
        file.write(f"\n{text}" if appended else text)


def _command(line: str) -> str:
    words = shlex.split(line, comments=True)
    if words[0] != "crankmbs":
        if line not in _CI.read_text(encoding="utf-8"):
            raise ValueError(f"nothing runs: {line}")
        return ""
    result = CliRunner().invoke(app, words[1:])
    status = _EXIT.search(line)
    if result.exit_code != (int(status[1]) if status else 0):
        raise ValueError(result.output)
    return result.output


@contextlib.contextmanager
def _elsewhere() -> Iterator[None]:
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield


def _made(app: Sphinx, name: str, source: list[str]) -> None:
    """Follow a page, and put what its blocks print in place of what it says that they print."""
    if not blocks(source[0]):
        return
    reader = Reader()
    with _elsewhere():
        source[0] = _FENCE.sub(
            lambda found: f"```{found[1]}\n{reader.follow(Block(found[1], found[2]))}```", source[0]
        )


def setup(app: Sphinx) -> dict[str, Any]:
    """Run the pages as Sphinx reads them, one after the other: each changes the folder."""
    app.connect("source-read", _made)
    return {"parallel_read_safe": False}
