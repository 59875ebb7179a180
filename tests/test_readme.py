"""README is one screen: its two lines run in CI, what it names is there."""

import re
from pathlib import Path

import pytest
from typer.main import get_command

from crankmbs.cli import app
from crankmbs.scene.shipped import shipped_scenes

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
CHANGES = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
OPTION = re.compile(r"(?<![-|\w])(--[a-z][a-z-]*)")
LINES = re.findall(r"^```sh\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def test_it_is_one_screen():
    assert len(README.splitlines()) < 60


@pytest.mark.parametrize("line", LINES)
def test_a_line_is_run_in_ci(line):
    assert f"grep -m1 -F '{line.strip()}' README.md" in (ROOT / ".ci" / "run").read_text()


def test_its_lines_are_the_two():
    assert len(LINES) == 2
    (name,) = re.findall(r"crankmbs run (\w+)", README)
    assert name in shipped_scenes()


@pytest.mark.parametrize("option", sorted(set(OPTION.findall(README + CHANGES))))
def test_an_option_that_is_named_is_there(option):
    theirs = {"--quick", "--long"}  # of python -m validation
    group = get_command(app)
    ours = {name for command in group.commands.values() for p in command.params for name in p.opts}
    assert option in ours | theirs
