"""The manual, whose build runs its blocks: its tables are complete, what it names is there."""

import os
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter
from typer.main import get_command

import crankmbs
from crankmbs.cli import app
from crankmbs.compare import WORDS
from crankmbs.lessons import LESSONS
from crankmbs.mechanics.variables import EVERY
from crankmbs.scene.examples import example_of
from crankmbs.scene.schema import dimension_of
from crankmbs.scene.shipped import shipped_scenes
from crankmbs.scene.unit_table import PREFIXES, UNITS

sys.path.insert(0, str(Path(__file__).parent.parent / "docs" / "_ext"))
import docstrings
import hard
import keys
import made
import names
from blocks import DOCS, WIDTH, Reader, blocks, pages, printed

pytestmark = pytest.mark.slow

PAGES = {str(page): (DOCS / page).read_text(encoding="utf-8") for page in pages()}


def test_what_a_page_shows_can_be_wrong(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    reader = Reader()
    code, shown = blocks("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n")
    reader.follow(code)
    with pytest.raises(ValueError, match="what came is\n2"):
        reader.follow(shown)
    with pytest.raises(ValueError, match="does not name it"):
        reader.follow(blocks("```toml\nradius = 1\n```\n")[0])


def test_a_page_shows_what_was_printed_where_it_has_room():
    came = "speed  12 rpm\n" + "x\n" * 3 + "wrote a: " + "b, " * WIDTH + "c\n"
    shown = "speed ... rpm\n...\nwrote a: ...c\n"
    assert printed(shown, came) == "speed  12 rpm\n...\nwrote a: ...c\n"
    assert printed(shown.replace("speed", "mean"), came) is None
    assert printed("speed 12 rpm\n", came) is None


@pytest.mark.parametrize("page", PAGES)
def test_no_code_overflows_its_page(page):
    for block in blocks(PAGES[page]):
        if block.language != "text":  # which is wrapped
            assert max(map(len, block.text.splitlines())) <= WIDTH


@pytest.mark.parametrize("page", PAGES)
def test_an_option_that_is_named_is_there(page):
    theirs = {"--no-project", "--quick", "--long", "--only"}  # of uv, and of python -m validation
    group = get_command(app)
    ours = {name for command in group.commands.values() for p in command.params for name in p.opts}
    named = re.findall(r"(?<![-|\w])(--[a-z][a-z-]*)", PAGES[page])
    assert set(named) <= ours | theirs


def test_every_table_and_key_of_a_shipped_scene_has_its_row():
    rows: dict[str, set[str]] = {}
    for path, part in keys.sections():
        rows.setdefault(path, set()).update(key.name for key in keys.keys_of(part))
    for file in shipped_scenes().values():
        scene = tomllib.loads(file.read_text(encoding="utf-8"))
        for name, value in scene.items():
            if name == "cylinder":
                keys_there = rows["[layout] cylinders"] | {"pressure", "motored", "crank_end"}
                assert set().union(*value) <= keys_there
            elif isinstance(value, list):
                assert set().union(*value) <= rows["[[torque]]"]
            elif isinstance(value, dict):
                assert value.keys() <= rows[f"[{name}]"]
                for inner, table in value.items():
                    for one in table if isinstance(table, list) else [table]:
                        if isinstance(one, dict):
                            assert one.keys() <= rows[f"[{name}] {inner}"]


def key_of(part, name):
    return next(key for key in keys.keys_of(part) if key.name == name)


def test_a_key_has_its_unit_default_and_rule():
    assert key_of(crankmbs.Crank, "radius")[1:4] == (('"46 mm"',), "needed", ("above 0",))
    assert key_of(crankmbs.Gravity, "angle").default == "180 deg"
    assert key_of(crankmbs.Polytrope, "closes").rules == ("at least -180 deg", "at most 0")
    assert key_of(crankmbs.Rod, "inertia").values == ('"5.8e-3 kg m^2"', '`"two-mass"`')
    assert key_of(crankmbs.Ramp, "from").values == ('"800 rpm"',)
    assert key_of(crankmbs.Gas, "pressure").values[1:] == ("file name", "list of either")
    assert key_of(crankmbs.Run, "every").values[-1] == '`"none"`'
    assert key_of(crankmbs.TimeTable, "file").rules == ("columns `time_s` and `torque_Nm`",)
    assert "kind" not in {key.name for key in keys.keys_of(crankmbs.SpeedFile)}


def test_an_example_is_of_its_key():
    """Each is a value that its key takes, and no two lengths of a machine are one."""
    lengths = []
    for _, part in keys.sections():
        for name, field in part.__pydantic_fields__.items():
            dimension, key = dimension_of(part, name), field.validation_alias or name
            if dimension is None:
                continue
            value = tomllib.loads(f"value = {example_of(part, key)}")["value"]
            adapter = TypeAdapter(field.rebuild_annotation())
            taken = adapter.validate_python(value, context={"folder": "."})
            if dimension == "length" and part in (crankmbs.Crank, crankmbs.Rod, crankmbs.Piston):
                lengths.append(taken)
    assert len(set(lengths)) == len(lengths) == 7


def test_every_command_variable_and_public_name_has_its_place():
    commands = set(re.findall(r"^## `crankmbs (\S+)`$", names.commands_page(), re.MULTILINE))
    assert commands == set(get_command(app).commands)
    assert re.findall(r"^\| `(\w+)`", names.variables_page(), re.MULTILINE) == list(EVERY)
    shown = set(re.findall(r"^\.\. auto\w+:: crankmbs\.(\w+)$", names.python_page(), re.MULTILINE))
    assert shown == set(crankmbs.__all__) - {"figures", "lecture"}


@pytest.mark.parametrize("page", made.PARTS)
def test_what_is_made_of_a_page_stands_in_it(page):
    """Build the manual to write it anew."""
    assert "<!-- made -->" in PAGES[page]
    assert made.with_part(PAGES[page], made.PARTS[page]()) == PAGES[page]


def test_what_the_build_adds_to_a_page_is_made():
    added = []
    for page, text in PAGES.items():
        built = made.as_built(page.removesuffix(".md"), text)
        assert "<!-- in " not in built
        added += [
            os.path.normpath(Path(page).parent / target)
            for target in re.findall(r'(?:href|src)="([^"]+)"', built)
            if ":" not in target
        ]
    lessons = [f"lessons/{name}.html" for name in LESSONS for _ in ("linked", "framed")]
    assert sorted(added) == sorted([*lessons, "lessons/index.html", "demo.html", "demo.html"])


def test_a_figure_that_is_made_stands_in_the_folder():
    figures = {file.stem for file in (DOCS / "figures").glob("*.png")}
    assert figures == {*made._FIGURES, "crank_pin"}


def test_a_part_shows_the_types_of_its_fields():
    signature, _ = docstrings._typed(None, "class", "crankmbs.Crank", crankmbs.Crank)
    assert signature.startswith("(*, radius: float, inertia: float | None = None")


def test_every_hard_case_has_its_reason_and_a_row_with_both_errors():
    cases = {file.stem for file in (DOCS.parent / "validation" / "cases").glob("hard_*.toml")}
    assert {f"hard_{name}" for name in hard.WHY} == cases
    rows = [re.split(r"(?<!\\)\|", line[1:-1]) for line in hard.hard_page().splitlines()[2:]]
    assert {len(row) for row in rows} == {6}
    for case, _, _, outcome, true, stated in (map(str.strip, row) for row in rows):
        assert outcome.startswith(("right", "stops: ", "refused: ")), case
        assert bool(true) == bool(stated) == (not outcome.startswith("refused"))


def test_the_manual_names_every_unit_and_prefix():
    text = PAGES["reference/scene.md"]
    said = text[text.index("- **Units.**") : text.index("- **Cylinders.**")]
    symbols = set(re.findall(r"`([^`]+)`", said))
    assert symbols >= {*UNITS, *PREFIXES} - {"\N{GREEK SMALL LETTER MU}"}


OWN = PAGES["howto/own_formula.md"]


def test_the_perturbation_is_off_by_what_is_printed():
    own: dict[str, Any] = {}
    (file,) = [text for language, text in blocks(OWN) if language == "py"]
    exec(file, own)
    (shares,) = re.findall(r"it is off by ([\d., and]+) % of the fluctuation", OWN)
    (inertias,) = re.findall(r"the\s+flywheel\s+goes from ([\d., overandto]+) kg m\^2", OWN)
    pairs = zip(re.findall(r"[\d.]+", shares), re.findall(r"[\d.]+", inertias), strict=True)
    for share, inertia in pairs:
        scene = crankmbs.load_scene("yi_diesel_free").with_(
            run__until="settled", crank__inertia=inertia + " kg m^2"
        )
        result = crankmbs.simulate(scene)
        (row,) = crankmbs.compare(result, {"mine": own["fluctuation_first_order"]}).numbers
        assert f"{row.percent:.2g}" == share


def test_every_word_of_a_formula_is_listed_with_its_unit():
    (listed,) = re.findall(r"- \*\*The words\*\*, in SI units: (.*?\[1\])\.", OWN, re.DOTALL)
    found = {
        name: unit
        for names, unit in re.findall(r"((?:`\w+`,?\s+)+)\[([^]]+)\]", listed)
        for name in re.findall(r"`(\w+)`", names)
    }
    assert found == {name: word.units for name, word in WORDS.items()}


def test_a_docstring_becomes_lists_formulas_and_sentences():
    lines = [
        "Least |x| of `f_`.",
        "",
        "    y = x_1",
        "",
        "Parameters",
        "----------",
        "x : shape (n,) [m]",
        "    or one",
    ]
    assert docstrings.restructured(lines) == [
        *("Least \\|x\\| of ``f_``.", ""),
        *("::", "", "    y = x_1", ""),
        *(".. rubric:: Parameters", "", "", "* **x**: shape (n,) [m]", "  or one", ""),
    ]
