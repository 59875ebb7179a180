"""Mutants of the page's engine, of page_mutants.toml: module -> what is replaced by what, and the
task of `page_guards.tasks` that shows it."""

import tomllib
from pathlib import Path

_TABLE = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
MUTANTS = {
    module: [(one["find"], one["replace"], one["by"]) for one in mutants]
    for module, mutants in tomllib.loads(_TABLE).items()
}
