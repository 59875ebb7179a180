"""REPORT.md, two pages: kinds of evidence, the worst figure of each, prediction or consistency."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path

from validation import bibliography
from validation.case import Case
from validation.claims import claims_page
from validation.kinds import KINDS, Kind, kind_of
from validation.results import Row

__all__ = ["CLAIMS", "REPORT", "write_pages"]

_HERE = Path(__file__).parent
REPORT, CLAIMS = _HERE / "REPORT.md", _HERE / "CLAIMS.md"
_INTRODUCTION = """\
# Validation

Written by `python -m validation`. A claim says what is held against what, in which norm, how close
and why so close; a shift of one of its parameters has to turn it red. All of them: as data in
`validation/results.csv`, in words and figures in [CLAIMS.md](CLAIMS.md)."""
_KINDS = """\
## Kinds of evidence

| held against | what this shares with crankmbs | claims | hold | worst over tolerance |
|---|---|---|---|---|"""
_WORST = """\
## Worst figures

Of the claims of one kind that one module checks, the one that comes closest to its tolerance.

| claim | of | norm | measured | tolerance |
|---|---|---|---|---|"""
_STANDING = """\
## Prediction and consistency

A published number is predicted where every parameter is printed in its source. [S1] prints neither
radius, rod ratio, bore nor reciprocating mass: they were identified from its own cells, and a claim
about the cells that they were identified from shows consistency, no more. Parameters, cells and
standard errors are in [CLAIMS.md](CLAIMS.md); misprints in [ERRATA.md](ERRATA.md)."""

_MACHINE = """\
## Held against a machine

[MEASURED.md](MEASURED.md) holds a free run under measured pressures against the speed that the
machine's wheel showed: identified on some cycles at full load, predicted for its other cycles, half
load and no load, with what it leaves and why."""
_MUTANTS = """\
## Every law guarded

A claim can be trusted if it can fail. `python -m validation.mutants` breaks the source, one law at
a time: terms dropped, signs flipped, units, phases and orders mixed up; then a test or a claim has
to turn red. [MUTANTS.md](MUTANTS.md) has every one, with what turned red."""
_FIRST_CLAUSE = re.compile(r"[,;:] (?![^\[]*\])")  # of a norm; units stand in brackets


def write_pages(
    cases: Sequence[Case], rows: Mapping[str, Row], folder: Path = REPORT.parent
) -> Path:
    """Write REPORT.md and CLAIMS.md of claims that all have their row; returns the report."""
    (folder / CLAIMS.name).write_text(claims_page(cases, rows), encoding="utf-8")
    lines = [_INTRODUCTION, "", *_head(cases, rows), "", *_kinds(cases, rows), ""]
    lines += [*_worst(cases, rows), "", *_standings(cases), "", *_MACHINE.splitlines(), ""]
    lines += [*_MUTANTS.splitlines(), ""]
    report = folder / REPORT.name
    report.write_text("\n".join([*lines, *bibliography.links(["S1"])]) + "\n", encoding="utf-8")
    return report


def _head(cases: Sequence[Case], rows: Mapping[str, Row]) -> list[str]:
    """When, at which commits and with what the claims were judged, and how many hold."""
    own = [rows[case.name] for case in cases]
    red = [row for row in own if not row.green]
    days = sorted({row.date for row in own})
    return [
        f"**{len(own) - len(red)} of {len(own)} claims hold.**",
        *(f"- **{row.verdict}**: {_link(row)}" for row in red),
        "",
        f"- run: {' to '.join(dict.fromkeys((days[0], days[-1])))}, {_times(own)} min",
        *(f"- commit {commit}: {count} claims" for commit, count in _counted(own, "commit")),
        *(f"- with {with_}: {count} claims" for with_, count in _counted(own, "environment")),
    ]


def _times(rows: Sequence[Row]) -> str:
    return f"{sum(row.seconds for row in rows) / 60.0:.0f}"


def _counted(rows: Sequence[Row], field: str) -> list[tuple[str, int]]:
    values = sorted(getattr(row, field) for row in rows)
    return [(value, len(list(same))) for value, same in groupby(values)]


def _kinds(cases: Sequence[Case], rows: Mapping[str, Row]) -> list[str]:
    lines = _KINDS.splitlines()
    for kind in KINDS:
        if own := _of_kind(kind, cases, rows):
            hold, worst = sum(row.green for row in own), max(row.share for row in own)
            cells = (kind.title, kind.shares, str(len(own)), str(hold), f"{worst:.2g}")
            lines.append(f"| {' | '.join(cells)} |")
    return lines


def _of_kind(kind: Kind, cases: Sequence[Case], rows: Mapping[str, Row]) -> list[Row]:
    return [rows[case.name] for case in cases if kind_of(case) is kind]


def _worst(cases: Sequence[Case], rows: Mapping[str, Row]) -> list[str]:
    """Of every kind and module of checks the claim with the largest share of its tolerance."""
    lines = _WORST.splitlines()
    for kind in KINDS:
        own = sorted((case for case in cases if kind_of(case) is kind), key=_module)
        if own:
            lines.append(f"| **{kind.title}** | | | | |")
        for _, same in groupby(own, key=_module):
            group = list(same)
            worst = max(group, key=lambda case: rows[case.name].share)
            row, norm = rows[worst.name], _FIRST_CLAUSE.split(worst.norm)[0]
            numbers = f"{row.measured:.2g} | {row.tolerance:.2g}"
            lines.append(f"| {_link(row)} | {len(group)} | {norm} | {numbers} |")
    return lines


def _module(case: Case) -> str:
    return case.check.partition(".")[0]


def _standings(cases: Sequence[Case]) -> list[str]:
    lines = [_STANDING, ""]
    for word in ("prediction", "consistency"):
        names = [case.name for case in cases if word in case.standing]
        lines.append(f"- {word}: {', '.join(f'[{name}](CLAIMS.md#{name})' for name in names)}")
    return lines


def _link(row: Row) -> str:
    return f"[{row.claim}](CLAIMS.md#{row.name})"
