"""The command ``validate``: a run against closed form and lectures, and the error budget."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.progress import progress
from crankmbs.cli.run import override
from crankmbs.cli.text import table
from crankmbs.compare import (
    CAUSES,
    CLOSED_FORM,
    QUANTITIES,
    Budget,
    Comparison,
    Excerpt,
    LeftOut,
    budget,
    check_cylinder,
    compare,
    percent,
    save_budget,
    save_budget_peaks,
    save_comparison,
)
from crankmbs.digits import digits
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.units import RPM
from crankmbs.simulate import simulate
from crankmbs.storage.files import together

__all__ = ["validate_scene"]

_ADDED = (
    "The peaks of the causes lie at different angles and do not add; at each angle the causes do:\n"
    "budget.csv has them all, budget_peaks.csv this table."
)


def validate_scene(
    name: str,
    options: Mapping[str, Any],
    *,
    formulation: str,
    cost_cap: float,
    cylinder: int,
    out: Path | None,
    figures: bool,
) -> bool:
    """Run a scene, print and write how far formulas are from it; return whether it reached its end.

    Parameters
    ----------
    options : those of [run] that the command line overrides; rtol among them is also asked of
        "multibody", which else is content with 1e-5
    out : folder of the results; None: results/NAME

    Raises
    ------
    CrankmbsError : bad scene, option or folder; before anything runs
    """
    path = scene_path(name)
    scene = override(load_scene(path), options)
    check_cylinder(scene, cylinder)
    folder = writable(Path("results", path.stem) if out is None else out)
    with progress(formulation):
        result = simulate(
            scene, formulation=formulation, rtol=options.get("rtol"), cost_cap=cost_cap
        )
    comparison, split = compare(result, cylinder), budget(result, cylinder)
    with together(folder) as part:  # before anything is printed: a screen may fail
        written = [save(split, part) for save in (save_budget, save_budget_peaks)]
        written.append(save_comparison(comparison, part))
        if figures:
            from crankmbs.figures import save_validation  # matplotlib only when it is used

            with progress("figures"):
                written += save_validation(comparison, split, part)
    typer.echo(f"{_first(comparison, split)}\n\n{result}\n\n{_about(comparison.excerpt)}\n")
    typer.echo(f"{_causes(split)}\n\n{_ADDED}\n\n{_words(split)}\n")
    for reference in comparison.references:
        typer.echo(f"{_against(comparison, reference)}\n")
    for line in _left_out((*comparison.left_out, *split.left_out)):
        typer.echo(line)
    typer.echo(f"\n{wrote(folder, [file.name for file in written])}")
    return result.status == 0


def _about(excerpt: Excerpt) -> str:
    count = len(excerpt.result.scene.cylinders)
    rpm = excerpt.mean_speed / RPM
    inside = excerpt.result.data.sizes["time"] - excerpt.window.inside
    folded = len(excerpt.samples) < inside
    return (
        f"over the {excerpt.window.kind}"
        f"{' but for where the rod folds onto the crank' if folded else ''}, "
        f"cylinder {excerpt.cylinder} of {count}, mean speed {digits(rpm)} rpm\n"
        "angles: cycle angle of the cylinder, for the main bearing the crank angle\n"
        "peak: the largest magnitude in the run\n"
        "lectures: S0 is Grega's, S1 that of Yi, Win and Htay; the budget splits the error of S1"
    )


def _first(comparison: Comparison, split: Budget) -> str:
    """What matters most: the lecture's largest error, and how far to believe the run."""
    lines = []
    if split.splits:
        lines.append(f"the lecture is most wrong about the {split.ranked[0].sentence()}")
    shares = [
        (percent(row.size.largest, row.peak), row.quantity)
        for row in comparison.rows
        if row.reference == CLOSED_FORM and row.peak > 0.0
    ]
    if comparison.excerpt.result.formulation != "multibody":
        lines.append("the run takes its forces from the closed form; multibody has its own")
    elif shares:
        share, quantity = max(shares)
        lines.append(f"the run itself is within {_share(share)} % of the closed form ({quantity})")
    return "\n".join(lines)


def _against(comparison: Comparison, reference: str) -> str:
    headings = [f"against: {reference}", "peak", "max", "% of peak", "at [deg]", "rms", "% of peak"]
    rows = [
        [
            f"{row.quantity} [{QUANTITIES[row.quantity].units}]",
            digits(row.peak),
            digits(row.size.largest, most=4),
            _share(percent(row.size.largest, row.peak)),
            f"{math.degrees(row.size.angle):.1f}",
            digits(row.size.rms, most=4),
            _share(percent(row.size.rms, row.peak)),
        ]
        for row in comparison.rows
        if row.reference == reference
    ]
    return table(headings, rows)


def _causes(split: Budget) -> str:
    """Every cause's peak in percent of the quantity's in the run."""
    rubs = split.excerpt.result.scene.friction is not None
    named = [name for name in (*CAUSES, "total") if rubs or name != "friction"]
    headings = ["error budget, peaks in %", *named]
    rows = []
    for row in split.splits:
        shares = {cause.name: row.share(cause) for cause in (*row.causes, row.total)}
        rows.append([row.quantity, *(_share(shares.get(name, math.nan)) for name in named)])
    return table(headings, rows)


def _words(split: Budget) -> str:
    return "\n".join(row.sentence() for row in split.ranked)


def _left_out(entries: Sequence[LeftOut]) -> list[str]:
    """One line for each reason, naming its quantities."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for entry in dict.fromkeys(entries):
        grouped.setdefault((entry.what, entry.reason), []).append(entry.quantity)
    return [
        f"left out{f' of {what!r}' if what else ''}: {', '.join(quantities)}: {reason}"
        for (what, reason), quantities in grouped.items()
    ]


def _share(percentage: float) -> str:
    return digits(percentage, most=3)
