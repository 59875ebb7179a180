"""The command ``validate``: how far formulas are off a run, and why."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Exit, Option, echo

from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.options import CostCap, NoFigures, Rtol, SceneName, Until
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.compare import Budget, Comparison
    from crankmbs.scene.scene import Scene

__all__ = ["validate"]

_FURTHER = "--verbose prints every reference and cause, --out DIR writes tables and figures"


def validate(
    scene: SceneName,
    formulation: Annotated[
        str | None,
        Option(help="Which run is compared; default multibody, where it serves the scene."),
    ] = None,
    rtol: Rtol = None,
    until: Until = None,
    cost_cap: CostCap = 10.0,
    cylinder: Annotated[int, Option(help="Number of the cylinder compared.")] = 1,
    formula: Annotated[
        list[str] | None,
        Option(
            metavar="FILE:NAME",
            help="A function of your own to compare, mine.py:torque_series; may be given often.",
        ),
    ] = None,
    causes: Annotated[
        str | None,
        Option(help='Order of the causes, "series, constant speed, solver"; the rest last.'),
    ] = None,
    verbose: Annotated[
        bool, Option("--verbose", help="Print every reference and every cause.")
    ] = False,
    out: Annotated[
        Path | None,
        Option("-o", "--out", metavar="DIR", help="Write tables and figures into this folder."),
    ] = None,
    no_figures: NoFigures = False,
) -> None:
    """Show how far lecture formulas and your own are off a run, and why."""
    from crankmbs.cli.formulas import named_formulas
    from crankmbs.cli.run import override
    from crankmbs.cli.validate_report import validation_report
    from crankmbs.compare import budget, check_comparable, compare
    from crankmbs.scene.read import load_scene
    from crankmbs.simulate import simulate

    loaded = override(load_scene(scene), rtol=rtol, until=until)
    check_comparable(loaded, cylinder)
    chain = _chain(causes, loaded)
    formulas = named_formulas(formula or ())
    folder = None if out is None else writable(out)
    chosen = formulation or _independent(loaded)
    with progress(chosen):  # rtol is also asked of multibody, which else is content with 1e-5
        result = simulate(loaded, formulation=chosen, rtol=rtol, cost_cap=cost_cap)
    comparison = compare(result, formulas, cylinder=cylinder)
    split = budget(result, formulas, cylinder=cylinder, chain=chain)
    report = validation_report(comparison, split, verbose=verbose)
    files = folder and _save(comparison, split, folder, figures=not no_figures)
    echo(f"{report}\n\n{files or _FURTHER}")  # a screen may fail: files first
    if result.status != 0:
        raise Exit(3)


def _chain(causes: str | None, scene: Scene) -> list[str] | None:
    """The names of --causes, checked before anything runs."""
    from crankmbs.compare import checked_chain

    chain = None if causes is None else [name.strip() for name in causes.split(",")]
    try:
        checked_chain(chain, scene)
    except InputError as error:
        raise InputError(str(error).replace("chain: ", "--causes: ", 1)) from None
    return chain


def _independent(scene: Scene) -> str:
    """The formulation with joint forces of its own, where it serves the scene."""
    from crankmbs.motion.formulations import serving

    names = [formulation.name for formulation in serving(scene)]
    return "multibody" if "multibody" in names else names[0]


def _save(comparison: Comparison, split: Budget, folder: Path, *, figures: bool) -> str:
    """Write tables and figures, which appear together; return what was written."""
    from crankmbs.compare import save_budget, save_budget_peaks, save_comparison, save_numbers

    with together(folder) as part:
        written = [save(split, part) for save in (save_budget, save_budget_peaks)]
        written.append(save_comparison(comparison, part))
        if comparison.numbers:
            written.append(save_numbers(comparison, part))
        if figures:
            from crankmbs.figures import save_validation  # matplotlib only when it is used

            with progress("figures"):
                written += save_validation(comparison, split, part)
    return wrote(folder, [file.name for file in written])
