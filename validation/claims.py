"""CLAIMS.md: every claim with what it is held against, what was measured, and what turns it red."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from validation import bibliography, s1
from validation.case import Case
from validation.kinds import kind_of
from validation.results import Row

__all__ = ["claims_page"]

_INTRODUCTION = """\
# Claims

Written by `python -m validation` from `cases/`, `results.csv` and `details.json`; two pages of it
are [REPORT.md](REPORT.md). A claim is one file in `cases/`: what is claimed, in which norm, how
close, why so close, and a parameter whose shift must turn it red (the tests shift it). Oracles are
in `oracles/`, references, each with its source, in `reference/`.
"""
_HARD = """\
Right: the true error is at most twice the stated one, and that at most 1e-3 of a variable's peak.
For rounding 1e-12 of the largest peak with the same unit is allowed besides; what is right by that
alone is named.
Right, but only to x %: more is stated. No answer: more than the peak is. Error unknown: no number
is. Or stopped, and why."""


def claims_page(cases: Sequence[Case], rows: Mapping[str, Row]) -> str:
    """The page of claims that all have their row."""
    lines = [_INTRODUCTION, *_hard_cases(cases, rows), *s1.section()]
    for case in cases:
        lines += ["", *_section(case, rows[case.name])]
    return "\n".join([*lines, "", *bibliography.links()]) + "\n"


def _hard_cases(cases: Sequence[Case], rows: Mapping[str, Row]) -> list[str]:
    """One table of what every formulation makes of the hard cases."""
    tables = [rows[case.name].table for case in cases if _is_hard(case)]
    tables = [table for table in tables if table]
    if not tables:
        return []
    of_all = [row for table in tables for row in table[2:]]
    return ["## Hard cases", "", _HARD, "", *tables[0][:2], *of_all]


def _is_hard(case: Case) -> bool:
    return case.check.startswith("hard.")


def _section(case: Case, row: Row) -> list[str]:
    lines = [
        f'## <a id="{case.name}"></a>{case.claim}',
        "",
        f"- evidence: {kind_of(case).title[0].lower()}{kind_of(case).title[1:]}",
        f"- quantity: {case.quantity}",
        f"- norm: {case.norm}",
        f"- measured {row.measured:.3g}, tolerance {row.tolerance:.3g}: {case.reason}",
        f"- {row.detail}",
        f"- source: {case.source}",
        *([f"- shows {case.standing}"] if case.standing else []),
        *_setup(case),
        f"- turns red with: {_mutant(case)}",
        f"- {row.verdict}: {row.date}, commit {row.commit}",
    ]
    if row.table and not _is_hard(case):
        lines += ["", *row.table]
    for name in row.figures:
        lines += ["", f"![{case.claim}](figures/{name}.png)"]
    return lines


def _setup(case: Case) -> list[str]:
    """What is run: the scene, what is changed in it, and the parameters of the check."""
    lines = []
    if case.scene:
        drive = "" if case.drive == "as shipped" else f", {case.drive} speed"
        length = "" if case.until is None else f", {case.until:g} cycles"
        change = f"; changed: {_listed(case.change)}" if case.change else ""
        lines.append(f"- scene: `{case.scene}`{drive}{length}{change}")
    if case.parameters:
        lines.append(f"- parameters: {_listed(case.parameters)}")
    return lines


def _mutant(case: Case) -> str:
    """The parameter, the factor in all its digits, and by how much it shifts the value."""
    mutant, value = case.mutant, case.mutated_value()
    part = mutant.factor - 1.0
    slight = f" (1 + {part:.3g})" if 0.0 < part < 0.1 else ""
    return (
        f"`{mutant.parameter}` times {mutant.factor!r}{slight}, "
        f"which shifts {value:.6g} by {value * part:+.3g}"
    )


def _listed(values: Mapping[str, Any]) -> str:
    return ", ".join(f"`{name} = {_toml(value)}`" for name, value in values.items())


def _toml(value: Any) -> str:
    """A value as a case file has it."""
    match value:
        case bool():
            return str(value).lower()
        case str():
            return f'"{value}"'
        case list():
            return f"[{', '.join(map(_toml, value))}]"
        case dict():
            pairs = (f"{name} = {_toml(part)}" for name, part in value.items())
            return f"{{ {', '.join(pairs)} }}"
    return repr(value)
