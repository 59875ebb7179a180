"""The command ``balance``: counterweights for a scene, and what remains."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from pathlib import Path

import typer

from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.loads import loads_table
from crankmbs.cli.progress import progress
from crankmbs.cli.text import table
from crankmbs.design import Balance, Remaining, balance
from crankmbs.digits import digits, error_digits
from crankmbs.errors import InputError
from crankmbs.export import copy_scene
from crankmbs.measures import measure
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.storage.files import together

__all__ = ["Wanted", "balance_scene"]

_ERRORS = ["before", "num. error", "after", "num. error"]


@dataclass(frozen=True)
class Wanted:
    """What is asked of a balance.

    share : of the reciprocating mass, as "50%" or 0.5
    write : file of the scene with the counterweights; out : folder, None: results/NAME
    cost_cap : as `simulate` takes it [s]
    """

    share: str
    write: Path | None
    out: Path | None
    figures: bool
    cost_cap: float


def balance_scene(name: str, wanted: Wanted) -> bool:
    """Balance a scene, write table, figure and scene; return whether its run reached its end.

    Raises
    ------
    CrankmbsError : bad scene, share, folder or file; a run without a whole cycle
    """
    path, part_of = scene_path(name), _share(wanted.share)
    scene = load_scene(path)
    folder = writable(Path("results", path.stem) if wanted.out is None else wanted.out)
    with progress("balancing"):
        found = balance(scene, part_of, cost_cap=wanted.cost_cap)
        said = [_report(path.stem, found), "", *_crank(scene, found, wanted.cost_cap)]
    written = ["balance.csv"]
    with together(folder) as part:
        (part / "balance.csv").write_text(_csv(found), encoding="utf-8")
        if wanted.figures:
            from crankmbs.figures import save_balance_figure  # matplotlib only here

            written.append(save_balance_figure(found, part).name)
    said += ["", wrote(folder, written)]
    if wanted.write is not None:
        remark = f"with counterweights for {100.0 * found.share:g} % of the reciprocating mass"
        files = copy_scene(path, wanted.write, _pasted(scene, found), remark)
        said.append(f"wrote {', '.join(map(str, files))}")
    typer.echo("\n".join(said))
    return found.result.status == 0


def _pasted(scene: Scene, found: Balance) -> dict[str, str]:
    """What [crank] is with the counterweights; its inertia where it would be too small for them."""
    crank = found.crank
    values = {
        "mass": f"{crank['mass']:.7g} kg",
        "center_of_mass": f"{crank['center_of_mass'] * 1e3:.7g} mm",
    }
    least = crank["mass"] * crank["center_of_mass"] ** 2
    if scene.crank.inertia is not None and scene.crank.inertia < least:
        values["inertia"] = f"{digits(scene.crank.inertia + least)} kg m^2"
    return values


def _crank(scene: Scene, found: Balance, cost_cap: float) -> list[str]:
    """The crank to paste into the scene, and the bearing loads of a run with it."""
    try:
        values = _pasted(scene, found)
    except InputError as error:
        return [textwrap.fill(str(error), 100)]
    if found.crank["center_of_mass"] == scene.crank.center_of_mass == 0.0:
        return ["the counterweights of all throws cancel on the crank as a whole: [crank] stays"]
    after = simulate(
        scene.with_(**{f"crank__{key}": value for key, value in values.items()}), cost_cap=cost_cap
    )
    return [
        loads_table("the last cycle", measure(found.result), measure(after), "after"),
        "",
        "[crank]",
        *(f'{key} = "{value}"' for key, value in values.items()),
    ]


def _share(text: str) -> float:
    """A share such as "50%" or 0.5."""
    number = text.strip()
    percent = number.endswith("%")
    try:
        value = float(number.removesuffix("%")) * (0.01 if percent else 1.0)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= 1.0:
        raise InputError(f'--share: must be from 0% to 100%, such as "50%"; {text!r} came')
    return value


def _report(name: str, found: Balance) -> str:
    title = found.result.scene.title
    rows = [
        [
            f"{one.quantity}, {one.direction} [{one.units}]",
            f"{one.order:g}",
            *(digits(*one.before), error_digits(one.before.error)),
            *(digits(*one.after), error_digits(one.after.error)),
        ]
        for one in found.remaining
    ]
    return "\n".join(
        [
            f"{name}: {title}" if title else name,
            "",
            "counterweight, mass times radius, for the rotating mass and "
            f"{100.0 * found.share:g} % of the reciprocating mass:",
            f"  opposite every throw                      {digits(found.per_throw)} kg m",
            f"  opposite the crank's own centre of mass   {digits(found.of_crank)} kg m",
            "",
            table(["over the last cycle", "order", *_ERRORS], rows),
            "moving parts on the frame, engine's X and Y; rocking about the middle of the crank",
        ]
    )


def _csv(found: Balance) -> str:
    head = "quantity,direction,order,units,before,before_error,after,after_error"
    return "\n".join([head, *map(_line, found.remaining)]) + "\n"


def _line(one: Remaining) -> str:
    numbers = (*one.before, *one.after)
    words = f"{one.quantity},{one.direction},{one.order:g},{one.units}"
    return ",".join([words, *(f"{number:.12g}" for number in numbers)])
