"""The command ``balance``: counterweights for a scene, and what remains."""

from __future__ import annotations

import cmath
import textwrap
from itertools import combinations
from typing import TYPE_CHECKING, Annotated

from typer import Exit, Option, echo

from crankmbs.cli.folder import results_folder, wrote
from crankmbs.cli.loads import loads_table
from crankmbs.cli.options import (
    CostCap,
    NoFigures,
    OutBesideScene,
    SceneName,
    WrittenScene,
    named_scene,
)
from crankmbs.cli.progress import progress
from crankmbs.cli.text import cells, heading, table
from crankmbs.digits import digits
from crankmbs.errors import InputError
from crankmbs.scene.units import share_of
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.design import Balance
    from crankmbs.scene.scene import Scene

__all__ = ["balance"]

_ERRORS = ["before", "num. error", "after", "num. error"]
_ALIKE = 1e-9  # of the largest counterweight, and rad: so near are two that are alike
_CANCEL = (
    "the counterweights of all throws cancel on the crank as a whole, so that the scene stays as\n"
    "it is; with [bearings] and places along the crank they are written as throw_unbalance"
)


def balance(
    scene: SceneName,
    share: Annotated[str, Option(help="Share of the reciprocating mass that is balanced.")] = "50%",
    cost_cap: CostCap = 10.0,
    write: WrittenScene = None,
    out: OutBesideScene = None,
    no_figures: NoFigures = False,
) -> None:
    """Find counterweights; show what is left of first and second order, before and after."""
    from crankmbs.design import balance as balanced
    from crankmbs.export import copy_scene

    path, machine = named_scene(scene)
    part_of = _share(share)
    folder = results_folder(path, out)
    with progress("balancing"):
        weights = balanced(machine, part_of, cost_cap=cost_cap)
        report = _report(path.stem, weights)
        try:
            pasted = None if write is None else _pasted(machine, weights)
        except InputError:  # before anything is written; what was found is shown all the same
            echo(report)
            raise
        lines = [report, "", *_crank(machine, weights, cost_cap)]
    written = ["balance.csv"]
    with together(folder) as part:
        (part / "balance.csv").write_text(_csv(weights), encoding="utf-8")
        if not no_figures:
            from crankmbs.figures import save_balance_figure  # matplotlib only here

            written.append(save_balance_figure(weights, part).name)
    lines += ["", wrote(folder, written)]
    if write is not None and pasted is not None:
        remark = f"with counterweights for {100.0 * weights.share:g} % of the reciprocating mass"
        files = copy_scene(path, write, pasted, remark)
        lines.append(f"wrote {', '.join(map(str, files))}")
    echo("\n".join(lines))
    if weights.result.status != 0:
        raise Exit(3)


def _pasted(scene: Scene, weights: Balance) -> dict[str, str | tuple[str, ...]]:
    """What crank and throws are with the counterweights, as `Scene.with_` names it; the inertia
    where it would be too small for them."""
    crank, throws = weights.crank, weights.throw_unbalance
    values: dict[str, str | tuple[str, ...]] = {}
    if crank["center_of_mass"] or scene.crank.center_of_mass:
        values["crank__mass"] = f"{crank['mass']:.7g} kg"
        values["crank__center_of_mass"] = f"{crank['center_of_mass'] * 1e3:.7g} mm"
    least = crank["mass"] * crank["center_of_mass"] ** 2
    if scene.crank.inertia is not None and scene.crank.inertia < least:
        values["crank__inertia"] = f"{digits(scene.crank.inertia + least)} kg m^2"
    if throws is not None:
        values["bearings__throw_unbalance"] = tuple(f"{1e3 * u:.9g} kg mm" for u in throws)
    return values


def _crank(scene: Scene, weights: Balance, cost_cap: float) -> list[str]:
    """Crank and throws to paste into the scene, and the bearing loads of a run with them."""
    from crankmbs.measures import measure
    from crankmbs.simulate import simulate

    try:
        values = _pasted(scene, weights)
    except InputError as error:
        return [textwrap.fill(str(error), 100)]
    if not values:
        return [_CANCEL]
    after = simulate(scene.with_(**values), cost_cap=cost_cap)
    lines, before = [loads_table(measure(weights.result), measure(after), "after")], ""
    for name, value in values.items():
        part, _, key = name.partition("__")
        lines += [] if part == before else ["", f"[{part}]"]
        several = ", ".join(f'"{each}"' for each in value)
        lines.append(f'{key} = "{value}"' if isinstance(value, str) else f"{key} = [{several}]")
        before = part
    return lines


def _share(text: str) -> float:
    """A share such as "50%" or 0.5."""
    value = share_of(text)
    if not 0.0 <= value <= 1.0:
        raise InputError(f'--share: must be from 0% to 100%, such as "50%"; {text!r} came')
    return value


def _report(name: str, weights: Balance) -> str:
    from crankmbs.measures.span import measured_span

    rows = [
        [
            f"{force.quantity}, {force.direction} [{force.units}]",
            f"{force.order:g}",
            *cells(force.before),
            *cells(force.after),
        ]
        for force in weights.remaining
    ]
    rocks = any("rocking" in force.quantity for force in weights.remaining)
    about = "; rocking about the middle of the crank" if rocks else ""
    return "\n".join(
        [
            heading(name, weights.result.scene.title),
            "",
            "counterweight, mass times radius, for the rotating mass and "
            f"{100.0 * weights.share:g} % of the reciprocating mass:",
            *(f"  {where:41}  {digits(moment)} kg m" for where, moment in _throws(weights)),
            *(f"  {whose:41}  {digits(abs(moment))} kg m" for whose, moment in _present(weights)),
            "",
            table([f"over the {measured_span(weights.result).kind}", "order", *_ERRORS], rows),
            f"moving parts on the frame, engine's X and Y{about}",
        ]
    )


def _present(weights: Balance) -> list[tuple[str, float]]:
    """What the crank itself adds, as it is [kg m]; a counterweight that it has counts."""
    bearings = weights.result.scene.bearings
    if bearings is not None and bearings.throw_unbalance is not None:
        present = bearings.throw_unbalance
        if len(set(present)) == 1:
            return [
                (f"{_less(present[0])} {'every' if len(present) > 1 else 'the'} throw", present[0])
            ]
        return [(f"{_less(each)} throw {k}", each) for k, each in enumerate(present, start=1)]
    if weights.of_crank < 0.0:
        return [("less the counterweight that the crank has", weights.of_crank)]
    return [("opposite the crank's own centre of mass", weights.of_crank)]


def _less(unbalance: float) -> str:
    return "less the counterweight of" if unbalance < 0.0 else "and for the unbalance of"


def _throws(weights: Balance) -> list[tuple[str, float]]:
    """Where counterweights stand, and how much each is [kg m]."""
    from crankmbs.scene.bearings import throw_numbers

    scene, moments = weights.result.scene, weights.per_throw
    numbers = throw_numbers(scene)
    if len(moments) == 1:
        rows = [("opposite the throw", moments[0])]
    elif max(moments) - min(moments) <= _ALIKE * max(moments):
        rows = [("opposite every throw", moments[0])]
    elif scene.cylinders[0].throw is None:
        rows = [
            (f"opposite the throw of cylinder {k}", moments[throw])
            for k, throw in enumerate(numbers, start=1)
        ]
    else:
        rows = [(f"opposite throw {k}", each) for k, each in enumerate(moments, start=1)]
    return rows + [
        (
            f"where cylinders {i + 1} and {j + 1} share a pin",
            moments[numbers[i]] + moments[numbers[j]],
        )
        for i, j in _may_share(scene)
    ]


def _may_share(scene: Scene) -> list[tuple[int, int]]:
    """Cylinders, counted from 0, of two banks whose throws stand at one angle, where neither their
    `throw` nor journals between them say whether their rods are on one pin."""
    cylinders = scene.cylinders
    if scene.throws is not None or cylinders[0].throw is not None:
        return []
    turns = [cmath.exp(1j * (c.phase + c.bank)) for c in cylinders]
    return [
        (i, j)
        for i, j in combinations(range(len(cylinders)), 2)
        if abs(turns[i] - turns[j]) <= _ALIKE and cylinders[i].bank != cylinders[j].bank
    ]


def _csv(weights: Balance) -> str:
    head = "quantity,direction,order,units,before,before_error,after,after_error"
    lines = [head]
    for force in weights.remaining:
        words = f"{force.quantity},{force.direction},{force.order:g},{force.units}"
        numbers = (f"{number:.12g}" for number in (*force.before, *force.after))
        lines.append(",".join([words, *numbers]))
    return "\n".join(lines) + "\n"
