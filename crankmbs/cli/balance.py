"""The command ``balance``: counterweights for a scene, and what remains."""

from __future__ import annotations

from pathlib import Path

import typer

from crankmbs.cli.folder import writable, wrote
from crankmbs.cli.progress import progress
from crankmbs.cli.text import table
from crankmbs.design import Balance, Remaining, balance
from crankmbs.digits import digits, error_digits
from crankmbs.errors import InputError
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.storage.files import together

__all__ = ["balance_scene"]


def balance_scene(
    name: str, share: str, *, out: Path | None, figures: bool, cost_cap: float
) -> bool:
    """Balance a scene, write table and figure; return whether its run reached its end.

    Raises
    ------
    CrankmbsError : bad scene, share or folder; a run without a whole cycle
    """
    path, part_of = scene_path(name), _share(share)
    scene = load_scene(path)
    folder = writable(Path("results", path.stem) if out is None else out)
    with progress("balancing"):
        found = balance(scene, part_of, cost_cap=cost_cap)
    written = ["balance.csv"]
    with together(folder) as part:
        (part / "balance.csv").write_text(_csv(found), encoding="utf-8")
        if figures:
            from crankmbs.figures import save_balance_figure  # matplotlib only here

            written.append(save_balance_figure(found, part).name)
    typer.echo("\n".join([_report(path.stem, found), "", wrote(folder, written)]))
    return found.result.status == 0


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
            table(["over the last cycle", "order", "before", "error", "after", "error"], rows),
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
