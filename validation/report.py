"""REPORT.md: one row a claim, the hard cases in one table, then cell by cell and the figures."""

from collections.abc import Sequence
from pathlib import Path

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


def write_report(verdicts: Sequence[Verdict], folder: Path = REPORT.parent) -> Path:
    """Write REPORT.md and figures/*.png into a folder; returns the report's path."""
    green = sum(verdict.green for verdict in verdicts)
    lines = [_INTRODUCTION, f"{green} of {len(verdicts)} claims hold.", ""]
    lines += ["| claim | scene | measured | tolerance | verdict |", "|---|---|---|---|---|"]
    lines += [_row(verdict) for verdict in verdicts]
    lines += _hard_cases(verdicts)
    lines += section()
    for verdict in verdicts:
        lines += ["", *_section(verdict)]
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
    lines = ["", "## Hard cases", "", "Right within twice the stated error, or stopped and why."]
    return [*lines, "", *tables[0][:2], *(row for table in tables for row in table[2:])]


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
        f"- turns red with: {case.mutant.parameter} times {case.mutant.factor:.10g}",
    ]
    if outcome.table and not _is_hard(verdict):
        lines += ["", *outcome.table]
    for name in outcome.figures:
        lines += ["", f"![{case.claim}](figures/{name}.png)"]
    return lines
