"""Which tests and claims turn a mutant of the Python red, as they were measured."""

import csv
from pathlib import Path

import pytest

RESULTS = Path(__file__).parent.parent / "validation" / "mutants" / "results.csv"
COLLECTED = pytest.StashKey[set[str]]()  # all tests that are there, also those left out
LONGEST = 45  # s, of a guard in which its mutant turned red


def killed():
    """The rows of the mutants that a test or a claim turned red."""
    with RESULTS.open(encoding="utf-8", newline="") as lines:
        return [row for row in csv.DictReader(lines) if row["verdict"] == "killed"]


def quick_guards():
    """The tests and claims that kill a mutant of the Python, but those that take long."""
    return {row["by"] for row in killed() if int(row["seconds"]) <= LONGEST}
