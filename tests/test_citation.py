"""What is cited has an entry, and the program can be cited."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

from validation import bibliography, reference
from validation.case import load_cases

ROOT = Path(__file__).parent.parent
CFF = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def cited(text: str) -> set[str]:
    return set(re.findall(r"\[([\w-]+)\]", text))


@pytest.mark.parametrize("case", load_cases(), ids=lambda case: case.name)
def test_a_claim_names_its_sources_by_keys_of_the_bibliography(case):
    assert cited(case.source) <= set(bibliography.keys())


def test_a_printed_number_names_its_source_by_a_key():
    rows = reference.rows("printed")
    assert {row["source"] for row in rows} <= set(bibliography.keys())
    assert {row["lecture"] for row in reference.rows("errata")} == {"S0", "S1", "S2"}


NAMED = re.compile(r"(SAE|[A-Z][a-zà-ü]+),?(?: \d{6},|[^\n\d]{0,50}\d{1,2})? \(?((?:19|20)\d\d)\)")


@pytest.mark.parametrize("folder", ["crankmbs", "validation"])
def test_a_work_that_code_names_with_its_year_has_an_entry(folder):
    """As "Brüls (2007)", "(Saltelli 2010)", "(SAE 900170, 1990)", "Math. 6 (1980)"."""
    entries = bibliography.BIBLIOGRAPHY.read_text(encoding="utf-8").split("### ")
    named = set()
    for file in (ROOT / folder).rglob("*.py"):
        named |= set(NAMED.findall(file.read_text(encoding="utf-8")))
    assert named
    lacking = [one for one in named if not any(one[0] in e and one[1] in e for e in entries)]
    assert lacking == []


def test_no_key_stands_twice():
    assert len(bibliography.keys()) == len(set(bibliography.keys()))


def test_the_citation_is_of_this_version():
    assert CFF["cff-version"] == "1.2.0"
    assert CFF["title"] == PROJECT["name"]
    assert CFF["version"] == PROJECT["version"]
    assert CFF["license"] == PROJECT["license"]
    assert CFF["authors"] == PROJECT["authors"]
    assert CFF["type"] == "software"
    assert CFF["message"]
    assert CFF["abstract"]
