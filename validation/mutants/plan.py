"""The mutants: one law broken by one change of the source, as data.

A file of mutants is a list of source files; each names the guards that look at it, and its
mutants. The text to be replaced stands in the source exactly once, so that code can move and only
the line that names the file has to follow.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.inputs import short_hash

__all__ = ["FOLDER", "ROOT", "Guards", "Mutant", "load_mutants", "wide_guards"]

FOLDER = Path(__file__).parent
ROOT = FOLDER.parents[1]


@dataclass(frozen=True)
class Guards:
    """What may turn red, quickest first: test files or single tests, and claims by name."""

    tests: tuple[str, ...] = ()
    claims: tuple[str, ...] = ()

    def without(self, others: Guards) -> Guards:
        """These guards but for others."""
        return Guards(
            tuple(test for test in self.tests if test not in others.tests),
            tuple(claim for claim in self.claims if claim not in others.claims),
        )

    def only(self, guard: str) -> Guards:
        """The one that turned red, a claim or a single test of these."""
        return Guards(claims=(guard,)) if guard in self.claims else Guards(tests=(guard,))


@dataclass(frozen=True)
class Mutant:
    """One change of one source file.

    room : the file of mutants it stands in; file : source file from the root of the checkout
    law : what holds in the source and no longer in the mutant
    find, replace : the text as it is, exactly once in the file, and as the mutant has it
    equivalent : why no number can show it, of a mutant that is none
    """

    name: str
    room: str
    file: str
    law: str
    find: str
    replace: str
    guards: Guards
    equivalent: str = ""

    @property
    def digest(self) -> str:
        """Twelve hexadecimal digits of the file, the text in it and what stands there instead."""
        return short_hash((self.file, self.find, self.replace))

    def applied(self, source: str) -> str:
        """The mutated text of a source file.

        Raises
        ------
        ValueError : the text to be replaced is not there exactly once
        """
        count = source.count(self.find)
        if count != 1:
            raise ValueError(f"{self.name}: {self.find!r} stands {count} times in {self.file}")
        return source.replace(self.find, self.replace)


def load_mutants() -> list[Mutant]:
    """Every mutant, in the order of the files and in theirs."""
    return [mutant for path in sorted(FOLDER.glob("*.toml")) for mutant in _room(path)]


def wide_guards(mutants: list[Mutant], claims: list[str]) -> Guards:
    """For what survives its own guards: those of all others, and these claims."""
    tests = dict.fromkeys(test for mutant in mutants for test in mutant.guards.tests)
    return Guards(tuple(tests), tuple(claims))


def _room(path: Path) -> list[Mutant]:
    with path.open("rb") as file:
        raw = tomllib.load(file)
    return [mutant for source in raw["source"] for mutant in _source(path.stem, source)]


def _source(room: str, source: dict[str, Any]) -> list[Mutant]:
    guards = Guards(tuple(source["tests"]), tuple(source.get("claims", ())))
    return [
        Mutant(room=room, file=source["file"], guards=guards, **raw) for raw in source["mutant"]
    ]
