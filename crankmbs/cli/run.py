"""The command ``run``: a scene in, files and a report out."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Exit, Option, echo

from crankmbs.cli.folder import results_folder, wrote
from crankmbs.cli.options import CostCap, NoFigures, Out, Rtol, SceneName, Until, named_scene
from crankmbs.cli.progress import progress
from crankmbs.errors import InputError, at_place
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
        str | None, Option(help="auto, kinetostatic, crank_angle, minimal or multibody.")
    ] = None,
    rtol: Rtol = None,
    until: Until = None,
    every: Annotated[
        str | None, Option(help='Output spacing: "1 deg", "0.1 ms" or "none".')
    ] = None,
    out: Out = None,
    no_figures: NoFigures = False,
    confirm: Annotated[
        bool, Option("--confirm", help="Let exudyn's rigid bodies run the last cycle too.")
    ] = False,
    orders: Annotated[
        bool, Option("--orders", help="Show the orders of torque and frame force.")
    ] = False,
    at: Annotated[
        list[str] | None,
        Option(help='Every quantity at a crank angle, "60 deg"; may be given often.'),
    ] = None,
    cost_cap: CostCap = 10.0,
) -> None:
    """Run a scene: print its measures, write data and figures."""
    from crankmbs.choose import choose, chosen
    from crankmbs.cli.report import report
    from crankmbs.compare.at import angle_of
    from crankmbs.measures import measure
    from crankmbs.simulate import simulate

    path, machine = named_scene(scene)
    options = {"formulation": formulation, "rtol": rtol, "until": until, "every": every}
    machine = override(machine, **options)
    choice = choose(machine, machine.run.formulation)
    with at_place("--at"):
        angles = [angle_of(text) for text in at or ()]
    if confirm and choice.formulation == "multibody":
        raise InputError(
            "--confirm compares a run with multibody, and this run is multibody itself; "
            "leave out --confirm or choose another formulation"
        )
    folder = results_folder(path, out)
    with progress(chosen(choice).cost(machine) or "running"):
        result = simulate(machine, rtol=rtol, cost_cap=cost_cap)
    parts, outcome = [report(path.stem, result, measure(result))], _Outcome(result)
    parts += _further(outcome, angles, confirm=confirm, orders=orders)
    written = _save(outcome, folder, figures=not no_figures)
    echo("\n".join([*parts, "", wrote(folder, written)]))  # a screen may fail: files first
    if result.status != 0:
        raise Exit(3)


@dataclass
class _Outcome:
    """What there is to write of a run."""

    result: Result
    confirmation: Confirmation | None = None
    orders: EngineOrders | None = None


def _further(outcome: _Outcome, angles: list[float], *, confirm: bool, orders: bool) -> list[str]:
    """Reports of the further options; the outcome takes what is to be written of them."""
    parts, result = [], outcome.result
    if confirm:
        from crankmbs.cli.report import comparison
        from crankmbs.compare.confirm import confirm as confirmed

        with progress("exudyn"):
            outcome.confirmation = confirmed(result)
        parts.append(comparison(result, outcome.confirmation))
    if orders:
        from crankmbs.cli.orders import orders_report
        from crankmbs.measures import engine_orders

        outcome.orders = engine_orders(result)
        parts.append(orders_report(outcome.orders))
    if angles:
        from crankmbs.cli.orders import reading_report
        from crankmbs.compare import at_angle

        parts += [reading_report(at_angle(result, angle)) for angle in angles]
    return parts


def _save(outcome: _Outcome, folder: Path, *, figures: bool) -> list[str]:
    """Write data and figures, which appear together; return their names."""
    written = ["result.nc", "motion.csv"]
    with together(folder) as part:
        outcome.result.save(part)
        tables = ("events.csv", "cycles.csv")
        written += [name for name in tables if (part / name).exists()]
        if outcome.orders is not None:
            from crankmbs.cli.orders import save_orders

            written.append(save_orders(outcome.orders, part).name)
        if figures:
            with progress("figures"):
                written += _draw(outcome, part)
    return written


def _draw(outcome: _Outcome, folder: Path) -> list[str]:
    from crankmbs import figures  # matplotlib only here

    files = figures.save_figures(outcome.result, folder)
    if outcome.orders is not None:
        files.append(figures.save_orders_figure(outcome.result, outcome.orders, folder))
    if outcome.confirmation is not None and outcome.confirmation.period:
        differences = outcome.confirmation.period
        files.append(figures.save_differences(outcome.result, differences, folder))
    return [file.name for file in files]


def override(scene: Scene, **options: Any) -> Scene:
    """The scene with values of [run] replaced by options that are not None; errors name these."""
    options = {name: value for name, value in options.items() if value is not None}
    try:
        run = dataclasses.replace(scene.run, **options)
    except InputError as error:
        raise InputError(f"--{error}") from None  # it begins with the name
    try:
        return dataclasses.replace(scene, run=run)
    except InputError as error:
        named = " ".join(f"--{name} {options[name]}" for name in _LENGTH if name in options)
        raise InputError(f"{named}: {error}") from None
