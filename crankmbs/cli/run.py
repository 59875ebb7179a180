"""The command ``run``: a scene in, files and a report out."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import typer

from crankmbs.choose import choose
from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.progress import progress
from crankmbs.cli.report import comparison, report
from crankmbs.compare.confirm import Difference, differences, followed
from crankmbs.errors import InputError
from crankmbs.measures import measure
from crankmbs.result import Result
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.storage.files import together

__all__ = ["override", "run_scene"]

_LENGTH = ("until", "every")  # the options that a scene may refuse though [run] takes them


def run_scene(
    name: str,
    options: Mapping[str, Any],
    *,
    out: Path | None,
    figures: bool,
    confirm: bool,
    cost_cap: float,
) -> bool:
    """Run a scene, write its results, print its report; return whether it reached its end.

    Parameters
    ----------
    options : those of [run] that the command line overrides
    out : folder of the results; None: results/NAME
    confirm : run the multibody model too, print and draw the difference
    cost_cap : as `simulate` takes it [s]

    Raises
    ------
    CrankmbsError : bad scene, option or folder; before anything runs
    """
    path = scene_path(name)
    scene = override(load_scene(path), options)
    choice = choose(scene, scene.run.formulation)
    if confirm and choice.formulation == "multibody":
        raise InputError(
            "--confirm compares a run with multibody, and this run is multibody itself; "
            "leave out --confirm or choose another formulation"
        )
    folder = writable(Path("results", path.stem) if out is None else out)

    result = _simulate(scene, cost_cap, rtol=options.get("rtol"))
    said = [report(path.stem, result, measure(result))]
    complete, rows = result.status == 0, None
    if confirm:
        check = _simulate(followed(result), cost_cap, formulation="multibody")
        complete, rows = complete and check.status == 0, differences(result, check)
        said.append(comparison(result, check, rows))
    written = _save(result, rows, folder, figures=figures)
    typer.echo("\n".join([*said, "", wrote(folder, written)]))  # a screen may fail: files first
    return complete


def _save(
    result: Result, rows: tuple[Difference, ...] | None, folder: Path, *, figures: bool
) -> list[str]:
    """Write data and figures, which appear together; return their names."""
    written = ["result.nc", "motion.csv"]
    with together(folder) as part:
        result.save(part)
        if figures:
            from crankmbs.figures import save_differences, save_figures  # matplotlib only here

            with progress("figures"):
                written += [file.name for file in save_figures(result, part)]
                if rows is not None:
                    written.append(save_differences(result, rows, part).name)
    return written


def override(scene: Scene, options: Mapping[str, Any]) -> Scene:
    """The scene with options of [run] replaced; an error names the option."""
    try:
        run = dataclasses.replace(scene.run, **options)
    except InputError as error:
        raise InputError(f"--{error}") from None  # it begins with the name
    try:
        return dataclasses.replace(scene, run=run)
    except InputError as error:
        given = " ".join(f"--{name} {options[name]}" for name in _LENGTH if name in options)
        raise InputError(f"{given}: {error}") from None


def _simulate(
    scene: Scene, cost_cap: float, *, formulation: str | None = None, rtol: float | None = None
) -> Result:
    with progress(formulation or "running"):
        return simulate(scene, formulation=formulation, rtol=rtol, cost_cap=cost_cap)
