"""The command ``run``: a scene in, files and a report out."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.options import CostCap, NoFigures, Out, Rtol, SceneName, Until
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.compare.confirm import Confirmation
    from crankmbs.measures import EngineOrders
    from crankmbs.result import Result
    from crankmbs.scene.scene import Scene

__all__ = ["override", "run"]

_LENGTH = ("until", "every")  # the options that a scene may refuse though [run] takes them


def run(
    scene: SceneName,
    formulation: Annotated[
        str | None,
        typer.Option(help="auto, kinetostatic, crank_angle, minimal or multibody."),
    ] = None,
    rtol: Rtol = None,
    until: Until = None,
    every: Annotated[
        str | None, typer.Option(help='Output spacing: "1 deg", "0.1 ms" or "none".')
    ] = None,
    out: Out = None,
    no_figures: NoFigures = False,
    confirm: Annotated[
        bool,
        typer.Option("--confirm", help="Let exudyn's rigid bodies run the last cycle too."),
    ] = False,
    orders: Annotated[
        bool, typer.Option("--orders", help="Show the orders of torque and frame force.")
    ] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(help='Every quantity at a crank angle, "60 deg"; may be given often.'),
    ] = None,
    cost_cap: CostCap = 10.0,
) -> None:
    """Run a scene: print its measures, write data and figures."""
    from crankmbs.choose import choose, chosen
    from crankmbs.cli.report import report
    from crankmbs.measures import measure
    from crankmbs.scene.read import load_scene, scene_path
    from crankmbs.simulate import simulate

    path = scene_path(scene)
    options = {"formulation": formulation, "rtol": rtol, "until": until, "every": every}
    machine = override(load_scene(path), options)
    choice = choose(machine, machine.run.formulation)
    angles = [_angle(text) for text in at or ()]
    if confirm and choice.formulation == "multibody":
        raise InputError(
            "--confirm compares a run with multibody, and this run is multibody itself; "
            "leave out --confirm or choose another formulation"
        )
    folder = writable(Path("results", path.stem) if out is None else out)

    with progress(chosen(choice).cost(machine) or "running"):
        result = simulate(machine, rtol=rtol, cost_cap=cost_cap)
    said, made = [report(path.stem, result, measure(result))], _Made(result)
    said += _further(made, angles, confirm=confirm, orders=orders)
    written = _save(made, folder, figures=not no_figures)
    typer.echo("\n".join([*said, "", wrote(folder, written)]))  # a screen may fail: files first
    if result.status != 0:
        raise typer.Exit(3)


@dataclass
class _Made:
    """What a run gave, to be written."""

    result: Result
    confirmation: Confirmation | None = None
    orders: EngineOrders | None = None


def _further(made: _Made, angles: list[float], *, confirm: bool, orders: bool) -> list[str]:
    """What is said beside the report; what is to be written of it is put into ``made``."""
    said, result = [], made.result
    if confirm:
        from crankmbs.cli.report import comparison
        from crankmbs.compare.confirm import confirm as confirmed

        with progress("exudyn"):
            made.confirmation = confirmed(result)
        said.append(comparison(result, made.confirmation))
    if orders:
        from crankmbs.cli.orders import orders_report
        from crankmbs.measures import engine_orders

        made.orders = engine_orders(result)
        said.append(orders_report(made.orders))
    if angles:
        from crankmbs.cli.orders import reading_report
        from crankmbs.compare import at_angle

        period = result.scene.period
        said += [reading_report(at_angle(result, angle), period) for angle in angles]
    return said


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
        differences = made.confirmation.period
        files.append(figures.save_differences(made.result, differences, folder))
    return [file.name for file in files]


def _angle(text: str) -> float:
    """A crank angle of the option --at [rad]."""
    from crankmbs.compare.at import angle_of

    try:
        return angle_of(text)
    except InputError as error:
        raise InputError(f"--at: {error}") from None


def override(scene: Scene, options: Mapping[str, Any]) -> Scene:
    """The scene with options of [run] replaced where they are not None; an error names them."""
    options = {name: value for name, value in options.items() if value is not None}
    try:
        run = dataclasses.replace(scene.run, **options)
    except InputError as error:
        raise InputError(f"--{error}") from None  # it begins with the name
    try:
        return dataclasses.replace(scene, run=run)
    except InputError as error:
        given = " ".join(f"--{name} {options[name]}" for name in _LENGTH if name in options)
        raise InputError(f"{given}: {error}") from None
