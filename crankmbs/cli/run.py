"""The command ``run``: a scene in, files and a report out."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from crankmbs.choose import choose, chosen
from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.progress import progress
from crankmbs.cli.report import comparison, report
from crankmbs.errors import InputError
from crankmbs.measures import EngineOrders, engine_orders, measure
from crankmbs.result import Result
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.compare.confirm import Confirmation

__all__ = ["Wanted", "override", "run_scene"]


@dataclass(frozen=True)
class Wanted:
    """What a run shall show beside its measures.

    confirm : let exudyn integrate the last period too, print and draw the difference
    orders : print, write and draw the orders of torque and frame force
    at : crank angles with their unit, at which every quantity is printed
    """

    figures: bool = True
    confirm: bool = False
    orders: bool = False
    at: tuple[str, ...] = ()


_LENGTH = ("until", "every")  # the options that a scene may refuse though [run] takes them


def run_scene(
    name: str,
    options: Mapping[str, Any],
    *,
    out: Path | None,
    wanted: Wanted,
    cost_cap: float,
) -> bool:
    """Run a scene, write its results, print its report; return whether it reached its end.

    Parameters
    ----------
    options : those of [run] that the command line overrides
    out : folder of the results; None: results/NAME
    cost_cap : as `simulate` takes it [s]

    Raises
    ------
    CrankmbsError : bad scene, option or folder; before anything runs
    """
    path = scene_path(name)
    scene = override(load_scene(path), options)
    choice = choose(scene, scene.run.formulation)
    angles = [_angle(text) for text in wanted.at]
    if wanted.confirm and choice.formulation == "multibody":
        raise InputError(
            "--confirm compares a run with multibody, and this run is multibody itself; "
            "leave out --confirm or choose another formulation"
        )
    folder = writable(Path("results", path.stem) if out is None else out)

    with progress(chosen(choice).cost(scene) or "running"):
        result = simulate(scene, rtol=options.get("rtol"), cost_cap=cost_cap)
    said = [report(path.stem, result, measure(result))]
    complete, made = result.status == 0, _Made(result)
    if wanted.confirm:
        from crankmbs.compare.confirm import confirm

        with progress("exudyn"):
            made.confirmation = confirm(result)
        said.append(comparison(result, made.confirmation))
    if wanted.orders:
        from crankmbs.cli.orders import orders_report

        made.orders = engine_orders(result)
        said.append(orders_report(made.orders))
    if angles:
        from crankmbs.cli.orders import reading_report
        from crankmbs.compare import at_angle

        said += [reading_report(at_angle(result, angle), scene.period) for angle in angles]
    written = _save(made, folder, figures=wanted.figures)
    typer.echo("\n".join([*said, "", wrote(folder, written)]))  # a screen may fail: files first
    return complete


@dataclass
class _Made:
    """What a run gave, to be written."""

    result: Result
    confirmation: Confirmation | None = None
    orders: EngineOrders | None = None


def _save(made: _Made, folder: Path, *, figures: bool) -> list[str]:
    """Write data and figures, which appear together; return their names."""
    written = ["result.nc", "motion.csv"]
    with together(folder) as part:
        made.result.save(part)
        tables = ("events.csv", "cycles.csv")
        written += [name for name in tables if (part / name).exists()]
        if made.orders is not None:
            from crankmbs.cli.orders import save_orders

            written.append(save_orders(made.orders, part).name)
        if figures:
            with progress("figures"):
                written += _draw(made, part)
    return written


def _draw(made: _Made, folder: Path) -> list[str]:
    from crankmbs import figures  # matplotlib only here

    files = figures.save_figures(made.result, folder)
    if made.orders is not None:
        files.append(figures.save_orders_figure(made.result, made.orders, folder))
    if made.confirmation is not None and made.confirmation.period:
        found = made.confirmation.period
        files.append(figures.save_differences(made.result, found, folder))
    return [file.name for file in files]


def _angle(text: str) -> float:
    """A crank angle of the option --at [rad]."""
    from crankmbs.compare.at import angle_of

    try:
        return angle_of(text)
    except InputError as error:
        raise InputError(f"--at: {error}") from None


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
