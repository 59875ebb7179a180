"""Every Markdown page leads to what a checkout has: files that git tracks, headings in them."""

import re

import pytest
from links import ROOT, TRACKED, dead, seen

PAGES = [name for name in TRACKED if name.endswith(".md")]


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_points_at_is_there(page):
    assert dead(page, (ROOT / page).read_text(encoding="utf-8")) == []


def test_a_link_can_be_dead():
    text = "![a](docs/no.png) [b](docs/_made/x) [c](#no) [d](README.md#license) [e](docs)"
    assert dead("README.md", text) == ["docs/no.png", "docs/_made/x", "#no", "docs"]
    assert dead("README.md", '<iframe src="demo.html"></iframe> `[a](b)`') == ["demo.html"]


@pytest.mark.parametrize("page", PAGES)
def test_what_only_a_build_can_show_stands_in_a_comment(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    assert "```{include}" not in text
    assert re.findall(r"\{download\}|_made/|<iframe", seen(text)) == []
