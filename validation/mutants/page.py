"""`validation/MUTANTS.md`: the score, every mutant with what turned red, and the survivors."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from validation.mutants.plan import Mutant
from validation.mutants.results import NO_END, PAGE, Row, score

__all__ = ["summary", "write_page"]


def write_page(mutants: list[Mutant], rows: dict[str, Row], path: Path = PAGE) -> Path:
    """Write the page from mutants that all have their row; returns where it is."""
    lines = ["# Every law guarded", "", *summary(mutants, rows), ""]
    lines += ["## What is left", "", *_left(mutants, rows), ""]
    for file, own in groupby(mutants, key=lambda mutant: mutant.file):
        lines += [f"## {file}", "", *_table(list(own), rows), ""]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def summary(mutants: list[Mutant], rows: dict[str, Row]) -> list[str]:
    """What was done and what came of it, in a few lines of Markdown."""
    dead, counted = score(mutants, rows)
    equivalent = sum(bool(mutant.equivalent) for mutant in mutants)
    dates = sorted({row.date for row in rows.values()})
    commits = {row.commit for row in rows.values()}
    killed = [row for row in rows.values() if row.verdict == "killed"]
    by_test = sum(row.by.startswith("tests/") for row in killed)
    endless = sum(row.verdict == NO_END for row in rows.values())
    return [
        "A claim can be trusted if it can fail. Here the source is broken, one law at a time: "
        "terms dropped, signs flipped, units, phases and orders mixed up; then tests and claims "
        "run, and one of them has to turn red.",
        "",
        f"**{dead} of {counted} mutants turn a test or a claim red: {100.0 * dead / counted:.1f} "
        f"%.** {equivalent} more change no number and are not counted; they are listed with "
        "the reason.",
        "",
        f"- run: {' to '.join(dict.fromkeys((dates[0], dates[-1])))}, on {len(commits)} "
        "commits; `validation/mutants/results.csv` has that of each",
        f"- a test turned red first for {by_test}, a claim for {len(killed) - by_test}; for "
        f"{endless} the guards did not come to their end in the time they have",
        "- command: `python -m validation.mutants`; the mutants are the TOML files in "
        "`validation/mutants`",
        "",
        "| what is broken | mutants | red | change no number |",
        "|---|---|---|---|",
        *_rooms(mutants, rows),
    ]


def _rooms(mutants: list[Mutant], rows: dict[str, Row]) -> Iterator[str]:
    for room, group in groupby(mutants, key=lambda mutant: mutant.room):
        own = list(group)
        dead, counted = score(own, rows)
        yield f"| {room} | {len(own)} | {dead} of {counted} | {len(own) - counted} |"


def _left(mutants: list[Mutant], rows: dict[str, Row]) -> list[str]:
    survivors = [m for m in mutants if not rows[m.name].dead and not m.equivalent]
    equivalent = [m for m in mutants if m.equivalent]
    lines = [f"- **{m.name}** survives: {m.law}" for m in survivors] or ["Nothing survives."]
    if equivalent:
        lines += ["", "Equivalent:", ""]
        lines += [f"- {m.name} ({m.law}): {m.equivalent}" for m in equivalent]
    return lines


def _table(mutants: list[Mutant], rows: dict[str, Row]) -> Iterator[str]:
    yield "| mutant | law it breaks | source | instead | red |"
    yield "|---|---|---|---|---|"
    for mutant in mutants:
        row = rows[mutant.name]
        red = row.by if row.verdict == "killed" else f"{row.verdict} {row.by}".strip()
        cells = (mutant.name, mutant.law, _code(mutant.find), _code(mutant.replace), red)
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _code(text: str) -> str:
    one_line = " ".join(text.split())
    return f"`{one_line}`" if one_line else "(nothing)"
