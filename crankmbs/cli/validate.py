"""The command ``validate``: a run against closed form, lectures and one's own formulas, and the
error budget."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.options import CostCap, NoFigures, Out, Rtol, SceneName, Until
from crankmbs.cli.progress import progress
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.compare import Budget, Comparison

__all__ = ["validate"]


def validate(
    scene: SceneName,
    formulation: Annotated[
        str, typer.Option(help="Which run is compared; only multibody is independent.")
    ] = "multibody",
    rtol: Rtol = None,
    until: Until = None,
    cost_cap: CostCap = 10.0,
    cylinder: Annotated[int, typer.Option(help="Number of the cylinder compared.")] = 1,
    formula: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE:NAME",
            help="A function of your own to compare, mine.py:torque_series; may be given often.",
        ),
    ] = None,
    causes: Annotated[
        str | None,
        typer.Option(help='Order of the causes, "series, constant speed, solver"; the rest last.'),
    ] = None,
    out: Out = None,
    no_figures: NoFigures = False,
) -> None:
    """Compare a run with closed form, lectures and your formulas; split errors into causes."""
    from crankmbs.cli.formulas import named_formulas
    from crankmbs.cli.run import override
    from crankmbs.cli.validate_report import validation_report
    from crankmbs.compare import budget, check_cylinder, checked_chain, compare
    from crankmbs.scene.read import load_scene, scene_path
    from crankmbs.simulate import simulate

    path = scene_path(scene)
    given = {"rtol": rtol, "until": until}
    options = {name: value for name, value in given.items() if value is not None}
    loaded = override(load_scene(path), options)
    check_cylinder(loaded, cylinder)
    chain = None if causes is None else [name.strip() for name in causes.split(",")]
    checked_chain(chain, loaded)
    formulas = named_formulas(formula or ())
    folder = writable(Path("results", path.stem) if out is None else out)
    with progress(formulation):  # rtol is also asked of multibody, which else is content with 1e-5
        result = simulate(loaded, formulation=formulation, rtol=rtol, cost_cap=cost_cap)
    comparison = compare(result, formulas, cylinder=cylinder)
    split = budget(result, formulas, cylinder=cylinder, chain=chain)
    written = _written(comparison, split, folder, figures=not no_figures)
    typer.echo(validation_report(comparison, split))
    typer.echo(f"\n{wrote(folder, [file.name for file in written])}")
    if result.status != 0:
        raise typer.Exit(3)


def _written(comparison: Comparison, split: Budget, folder: Path, *, figures: bool) -> list[Path]:
    """The files, before anything is printed: a screen may fail."""
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
    return written
