"""The lesson pages: complete in themselves, with formulas and sources; and the commands."""

import base64
import hashlib
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import make_math_font
import pytest
from typer.testing import CliRunner

from crankmbs import lecture, load_scene
from crankmbs.cli import app
from crankmbs.errors import InputError, OutputError
from crankmbs.lessons import LESSONS, write_lesson, write_lessons
from crankmbs.lessons.markup import formula, prose
from crankmbs.lessons.pieces import Formula, Number

pytestmark = pytest.mark.slow

MATHML = "{http://www.w3.org/1998/Math/MathML}"
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)> $x$"


@pytest.fixture(scope="module", params=LESSONS)
def page(request, tmp_path_factory):
    """Each lesson's page as text."""
    folder = tmp_path_factory.mktemp("lessons")
    file = write_lesson(request.param, folder)
    assert [path.name for path in folder.iterdir()] == [f"{request.param}.html"]
    return file.read_text(encoding="utf-8")


def test_a_page_is_small_and_complete_in_itself(page):
    assert len(page.encode()) < 500e3
    assert page.startswith("<!DOCTYPE html>")
    assert not re.search(r"<(link|iframe|object|embed|base|img)\b", page)
    body = page[page.index("<body") : page.index("<script")]
    assert all(link.startswith("#") for link in re.findall(r'href="([^"]*)"', body))
    assert 'src="' not in body


def test_the_policy_has_the_hash_of_the_only_script(page):
    script = re.search(r"<script>(.*?)</script>", page, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    policy = policy.replace("&#39;", "'")
    assert f"script-src 'sha256-{digest}'" in policy
    assert policy.startswith("default-src 'none'")


def test_formulas_say_how_exact_they_are_and_sources_are_titles(page):
    formulas = re.findall(r'<div class="formula">(.*?)</div>', page, re.DOTALL)
    assert all("<math" in each for each in formulas)
    assert all(re.search(r"<p>(Exact|Approximate|Euler)", each) for each in formulas)
    body = page[page.index("<body") : page.index("<script")]
    words = re.sub(r"<[^>]*>", " ", body)
    assert not re.search(r"\bS[012]\b|_series|_force\b|\$", words)
    assert "Automobile Design" in words


def test_figures_say_nothing_that_is_not_filled_in_and_ids_are_unique(page):
    body = page[page.index("<body") : page.index("<script")]
    ids = re.findall(r'\bid="([^"]+)"', body)
    assert len(ids) == len(set(ids))
    figures = re.findall(r'<figure id="(\w+)"', body)
    assert len(figures) >= 2
    said = re.findall(r'data-say="(\w+)\.\w+"', body)
    assert set(said) <= set(figures)
    assert 3 <= len(re.findall(r'class="question"', body)) <= 4


def test_an_error_that_is_only_rounding_is_not_shown():
    shown = str(Number("force", 1234.5678, "N", 2.1e-9))
    assert "1235\u00a0N</data>" in shown
    assert "data-error" not in shown
    assert 'value="1234.5678"' in shown
    assert 'data-error="0.11\u00a0N"' in str(Number("force", 1234.5678, "N", 0.103))
    assert ">\u22122.500°<" in str(Number("angle", -2.5, "°"))


def test_a_formula_says_how_exact_it_is_in_the_lectures_words():
    made = Formula("N", lecture.side_thrust_series)
    assert made.about == "Approximate, order 3 in λ: off by -F λ³ (sin φ - k)³ / 2."
    assert made.sources == "Yi, Win, Htay, Eq. 25"


def test_tex_becomes_mathml_and_functions_keep_their_distance():
    tree = ElementTree.fromstring(str(formula(r"\frac{\cos^2\varphi}{\sin\beta}")))
    power = tree.find(f".//{MATHML}msup")
    assert [child.tag for child in power] == [f"{MATHML}mi", f"{MATHML}mn"]
    assert len(list(tree.iter(f"{MATHML}mspace"))) == 2
    assert prose("half of $r$ is").startswith("half of <math ")


def test_the_font_of_formulas_can_be_made_again():
    source = make_math_font.source()
    if source is None:
        pytest.skip("ziamath, which has the font, is not installed")
    assert make_math_font.TARGET.read_bytes() == make_math_font.made(source)
    licence = (make_math_font.TARGET.parent / "OFL.txt").read_text(encoding="utf-8")
    assert "SIL OPEN FONT LICENSE Version 1.1" in licence


def test_a_hostile_title_stays_text(tmp_path):
    scene = replace(load_scene("propeller"), title=HOSTILE, source=HOSTILE)
    page = write_lesson("displacement", tmp_path, scene).read_text(encoding="utf-8")
    assert page.count("<script") == 2
    assert "<img" not in page
    assert "&lt;img src=x onerror=alert(2)&gt; $x$" in page


def test_every_lesson_can_be_about_another_scene_and_leads_to_the_others(tmp_path):
    assert write_lessons(tmp_path, load_scene("v_twin")) == tmp_path / "index.html"
    index = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert re.findall(r'<li><a href="(\w+)\.html">', index) == list(LESSONS)
    for name in LESSONS:
        page = (tmp_path / f"{name}.html").read_text(encoding="utf-8")
        assert "60 degree V-twin" in page
        assert 'href="index.html"' in page
        for other in re.findall(r'rel="\w+" href="([^"]*)"', page):
            assert (tmp_path / other).is_file()


@pytest.mark.parametrize(
    ("name", "scene", "said"),
    [
        ("forces", "coasting", "gas: the lesson forces is about a machine with"),
        ("omega", "compressor", "needs a gas that drives the crank"),
        ("polar", "torque_driven", "gas|speed: a lesson needs"),
        ("fluctuation", "friction", "crank.inertia: the lesson fluctuation lets the crank run"),
    ],
)
def test_a_scene_that_a_lesson_cannot_be_about_is_refused_in_a_sentence(
    tmp_path, name, scene, said
):
    with pytest.raises(InputError, match=said):
        write_lesson(name, tmp_path, load_scene(scene))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.always
def test_commands_write_a_page_and_list_them_all(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["lesson", "displacement", "-o", "pages"])
    assert result.exit_code == 0, result.output
    assert "wrote pages/displacement.html" in result.stdout
    assert Path("pages/displacement.html").is_file()
    listed = CliRunner().invoke(app, ["lessons"]).stdout
    assert [line.split()[1] for line in listed.splitlines()] == list(LESSONS)


def test_the_command_takes_a_scene_and_without_a_name_writes_all(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["lesson", "--scene", "propeller"])
    assert result.exit_code == 0, result.output
    assert "wrote lessons/index.html" in result.stdout
    assert {path.stem for path in Path("lessons").iterdir()} == {*LESSONS, "index"}
    assert "benchmark B" in Path("lessons/polar.html").read_text(encoding="utf-8")
    result = CliRunner().invoke(app, ["lesson", "polar", "--scene", "none.toml"])
    assert result.exit_code == 2


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
