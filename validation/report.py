"""REPORT.md: one row a claim, the hard cases in one table, then cell by cell and the figures."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from validation import bibliography, s1
from validation.about import about
from validation.case import Case
from validation.judge import Verdict
from validation.mutants.page import section

__all__ = ["REPORT", "write_report"]

REPORT = Path(__file__).parent / "REPORT.md"
_INTRODUCTION = """\
# Validation

Written by `python -m validation`. A claim is one file in `cases/`: what is claimed, in which norm,
how close, why so close, and a parameter whose shift must turn it red (the tests shift it). The
oracles in `oracles/` share no code with crankmbs. References, each with its source, are in
`reference/`.
"""
_HARD = """\
Right: the true error is at most twice the stated one, and that at most 1e-3 of a variable's peak.
For rounding 1e-12 of the largest peak with the same unit is allowed besides; what is right by that
alone is named.
Right, but only to x %: more is stated. No answer: more than the peak is. Error unknown: no number
is. Or stopped, and why."""


def write_report(verdicts: Sequence[Verdict], folder: Path = REPORT.parent) -> Path:
    """Write REPORT.md and figures/*.png into a folder; returns the report's path."""
    green = sum(verdict.green for verdict in verdicts)
    lines = [_INTRODUCTION, *about(), "", f"{green} of {len(verdicts)} claims hold.", ""]
    lines += ["| claim | scene | measured | tolerance | verdict |", "|---|---|---|---|---|"]
    lines += [_row(verdict) for verdict in verdicts]
    lines += _hard_cases(verdicts)
    lines += s1.section([verdict.case for verdict in verdicts])
    lines += section()
    for verdict in verdicts:
        lines += ["", *_section(verdict)]
    lines += ["", *bibliography.links()]
    (folder / "figures").mkdir(exist_ok=True)
    for verdict in verdicts:
        for name, figure in verdict.outcome.figures.items():
            figure.savefig(folder / "figures" / f"{name}.png", dpi=90, metadata={"Software": None})
    report = folder / REPORT.name
    report.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return report


def _row(verdict: Verdict) -> str:
    case = verdict.case
    cells = [
        f"[{case.claim}](#{case.name})",
        case.scene.replace("_", " ") or "-",
        f"{verdict.outcome.error:.2g}",
        f"{case.tolerance:.2g}",
        verdict.word if verdict.green else f"**{verdict.word}**",
    ]
    return f"| {' | '.join(cells)} |"


def _hard_cases(verdicts: Sequence[Verdict]) -> list[str]:
    """One table of what every formulation makes of the hard cases."""
    tables = [v.outcome.table for v in verdicts if _is_hard(v) and v.outcome.table]
    if not tables:
        return []
    return [
        "",
        "## Hard cases",
        "",
        _HARD,
        "",
        *tables[0][:2],
        *(row for table in tables for row in table[2:]),
    ]


def _is_hard(verdict: Verdict) -> bool:
    return verdict.case.check.startswith("hard.")


def _section(verdict: Verdict) -> list[str]:
    case, outcome = verdict.case, verdict.outcome
    lines = [
        f'## <a id="{case.name}"></a>{case.claim}',
        "",
        f"- quantity: {case.quantity}",
        f"- norm: {case.norm}",
        f"- measured {outcome.error:.3g}, tolerance {case.tolerance:.3g}: {case.reason}",
        f"- {outcome.detail}",
        f"- source: {case.source}",
        *([f"- shows {case.standing}"] if case.standing else []),
        *_setup(case),
        f"- turns red with: {_mutant(case)}",
    ]
    if outcome.table and not _is_hard(verdict):
        lines += ["", *outcome.table]
    for name in outcome.figures:
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
