"""The blocks of the manual's pages, and how each is run."""

import doctest
import re
import shlex
from pathlib import Path
from typing import NamedTuple

from command_line import crankmbs_

DOCS = Path(__file__).parent.parent / "docs"
CI = DOCS.parent / ".ci" / "run"
_FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"# (at the end of )?(\S+\.\w+)$", re.MULTILINE)
_EXIT = re.compile(r"# exits with (\d)$")
_FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


class Block(NamedTuple):
    """A fenced block, its language and its text."""

    language: str
    text: str


def pages():
    """The pages that somebody wrote, by their places in the folder."""
    written = [p.relative_to(DOCS) for p in sorted(DOCS.rglob("*.md"))]
    return [page for page in written if page.parts[0] not in ("_build", "_made")]


def blocks(text):
    """All blocks of a page but those of directives, in their order."""
    return [Block(*found) for found in _FENCE.findall(text)]


class Reader:
    """Does in the present folder what a page tells its reader to do, block after block."""

    def __init__(self, capsys):
        self._capsys = capsys
        self._names = {"__name__": "__main__"}
        self._said = ""

    def follow(self, block):
        """Run a block, write its file, or hold it against what the block before printed."""
        getattr(self, f"_{block.language}")(block.text)

    def _python(self, text):
        exec(compile(text, "block", "exec"), self._names)
        self._said = self._capsys.readouterr().out

    def _sh(self, text):
        self._said = "".join(map(self._command, text.replace("\\\n", " ").splitlines()))

    def _command(self, line):
        words = shlex.split(line, comments=True)
        if words[0] != "crankmbs":
            assert line in CI.read_text(encoding="utf-8"), f"nothing runs: {line}"
            return ""
        result = crankmbs_(*words[1:])
        status = _EXIT.search(line)
        assert result.exit_code == (int(status[1]) if status else 0), result.output
        return result.output

    def _text(self, text):
        seen = doctest.OutputChecker().check_output(text, self._said, _FLAGS)
        assert seen, f"the page shows\n{text}\nand what came is\n{self._said}"

    def _toml(self, text):
        appended, name = _FILE.match(text).groups()
        with Path(name).open("a" if appended else "w", encoding="utf-8") as file:
            file.write(f"\n{text}" if appended else text)

    _csv = _py = _toml
