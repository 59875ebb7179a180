"""The lesson pages: well-formed, complete in themselves, with formulas; and the commands."""

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

from crankmbs import lecture
from crankmbs.cli import app
from crankmbs.errors import InputError, OutputError
from crankmbs.lessons import LESSONS, write_lesson
from crankmbs.lessons.markup import formula, prose
from crankmbs.lessons.parts import Formula, Number

MATHML = "{http://www.w3.org/1998/Math/MathML}"
SVG = "{http://www.w3.org/2000/svg}"
LOADS = {"src", "href", "data", "srcset", "poster", "action", "{http://www.w3.org/1999/xlink}href"}


@pytest.fixture(scope="module", params=LESSONS)
def page(request, tmp_path_factory):
    """Each lesson's page as text."""
    folder = tmp_path_factory.mktemp("lessons")
    file = write_lesson(request.param, folder)
    assert [path.name for path in folder.iterdir()] == [f"{request.param}.html"]
    return file.read_text(encoding="utf-8")


def test_page_is_complete_in_itself(page):
    doctype, text = page.split("\n", 1)
    assert doctype == "<!DOCTYPE html>"
    root = ElementTree.fromstring(text)  # well-formed, or this raises
    for element in root.iter():
        assert element.tag.rsplit("}", 1)[-1] not in {"link", "iframe", "object", "embed", "base"}
        for name, value in element.attrib.items():
            assert name not in LOADS or value.startswith("#"), (element.tag, name, value)
    assert "@import" not in text
    assert all(target.startswith("#") for target in re.findall(r"url\(['\"]?(.)", text))
    assert not re.search(r"\b(fetch|XMLHttpRequest|import)\b *\(", text)


def test_ids_are_unique_and_every_reference_is_met(page):
    root = ElementTree.fromstring(page.split("\n", 1)[1])
    ids = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(ids) == len(set(ids))
    used = re.findall(r'(?:xlink:href="|url\()#([^")]+)', page)
    assert used
    assert set(used) <= set(ids)


def test_page_has_formulas_figures_questions_and_sources(page):
    root = ElementTree.fromstring(page.split("\n", 1)[1])
    formulas = [e for e in root.iter("div") if e.get("class") == "formula"]
    assert len(formulas) >= 3
    for each in formulas:
        assert each.find(f"{MATHML}math") is not None
        assert "Source: " in "".join(each.itertext())
    for figure in root.iter("figure"):
        frames = [e for e in figure.iter("div") if e.get("class") == "frame"]
        assert frames
        assert all(frame.find(f"{SVG}svg") is not None for frame in frames)
        assert sum(frame.get("hidden") is None for frame in frames) == 1
        assert "".join(figure.find("figcaption").itertext()).strip()
    assert 2 <= len(list(root.iter("figure"))) <= 3
    assert 2 <= len(list(root.iter("details"))) <= 3
    assert all(d.find("summary") is not None and not d.get("open") for d in root.iter("details"))
    assert "$" not in "".join(root.itertext())


def test_slider_has_a_mark_for_each_frame(page):
    root = ElementTree.fromstring(page.split("\n", 1)[1])
    moved = [f for f in root.iter("figure") if f.find(".//input") is not None]
    assert moved
    for figure in moved:
        (slider,) = figure.iter("input")
        marks = slider.get("data-marks").split("|")
        frames = [e for e in figure.iter("div") if e.get("class") == "frame"]
        assert len(set(marks)) == len(marks) == len(frames) == int(slider.get("max")) + 1
        first = int(slider.get("value"))
        assert frames[first].get("hidden") is None
        assert figure.find(".//output").text == marks[first]


def test_a_number_shows_its_digits_unit_and_error():
    shown = str(Number("force", 1234.5678, "N", 2.1e-9))
    assert "1235\u00a0N</data>" in shown
    assert "± 2.1·10⁻⁹\u00a0N" in shown
    assert 'value="1234.5678"' in shown
    assert "±" not in str(Number("force", 1234.5678, "N"))
    assert ">−2.500°<" in str(Number("angle", -2.5, "°"))


def test_a_formula_says_how_exact_it_is_in_the_lectures_words():
    about = Formula("N", lecture.side_thrust_series).about
    assert about == "Approximate, order 3 in λ: off by -F λ³ (sin φ - k)³ / 2. Source: S1 Eq. 25."


def test_tex_becomes_mathml_and_functions_keep_their_distance():
    tree = ElementTree.fromstring(str(formula(r"\frac{\cos^2\varphi}{\sin\beta}")))
    power = tree.find(f".//{MATHML}msup")
    assert [child.tag for child in power] == [f"{MATHML}mi", f"{MATHML}mn"]
    assert len(list(tree.iter(f"{MATHML}mspace"))) == 2
    assert prose("half of $r$ is").startswith("half of <math ")


def test_commands_write_a_page_and_list_them_all(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["lesson", "displacement", "-o", "pages"])
    assert result.exit_code == 0, result.output
    assert "wrote pages/displacement.html" in result.stdout
    assert Path("pages/displacement.html").is_file()
    listed = CliRunner().invoke(app, ["lessons"]).stdout
    assert [line.split()[1] for line in listed.splitlines()] == list(LESSONS)


def test_an_unknown_lesson_is_refused_with_the_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r'must be one of .*; .*; did you mean "forces"'):
        write_lesson("force", tmp_path)
    result = CliRunner().invoke(app, ["lesson", "gears", "-o", "pages"])
    assert result.exit_code == 2
    assert all(name in result.stderr for name in LESSONS)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_a_file_is_refused_before_the_lesson_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("pages").write_text("")
    result = CliRunner().invoke(app, ["lesson", "balance", "-o", "pages"])
    assert result.exit_code == 2
    assert "choose another folder" in result.stderr
    with pytest.raises(OutputError):
        write_lesson("displacement", Path("pages"))
