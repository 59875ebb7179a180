"""The command ``flywheel``: the inertia that gives a fluctuation of speed, beside the lecture's."""

from __future__ import annotations

import math
import re

import typer

from crankmbs.cli.progress import progress
from crankmbs.cli.text import table
from crankmbs.design.flywheel import Flywheel, flywheel
from crankmbs.digits import digits, error_digits
from crankmbs.errors import InputError, shown
from crankmbs.measures import Estimate
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

__all__ = ["size_flywheel"]

_SHARE = re.compile(r"\s*(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)\s*(%?)\s*")


def size_flywheel(name: str, wanted: str) -> bool:
    """Size the flywheel of a scene and print it; return whether it is in reach.

    Parameters
    ----------
    wanted : coefficient of fluctuation, as "1 %" or "0.01"

    Raises
    ------
    CrankmbsError : bad scene or fluctuation; before anything runs
    """
    match = _SHARE.fullmatch(wanted)
    number = float(match[1]) * (0.01 if match[2] else 1.0) if match else math.nan
    if not 0.0 < number < 2.0:
        raise InputError(
            "--fluctuation: must be a share of the mean speed above 0 and below 200 %, such as "
            f'"1 %" or 0.01; {shown(wanted)} came'
        )
    path = scene_path(name)
    scene = load_scene(path)
    with progress("sizing"):
        found = flywheel(scene, number)
    typer.echo(_report(path.stem, scene, found))
    return found.status == 0


def _report(name: str, scene: Scene, found: Flywheel) -> str:
    title = f"{name}: {scene.title}" if scene.title else name
    lines = [
        f"{title}\n",
        f"{'flywheel':<12} {found.message}",
        f"{'load':<12} {_load(scene, found)}",
    ]
    if found.status != 0:
        return "\n".join(lines)
    rows = [
        _row("inertia of crank and flywheel [kg m^2]", found.inertia),
        _row("of which beyond the scene's [kg m^2]", Estimate(found.added, found.inertia.error)),
        _row("coefficient of fluctuation, (max - min)/mean [1]", found.fluctuation),
        _row("mean speed [rpm]", Estimate(*(part / RPM for part in found.mean_speed))),
        _row("W, excess of work at that constant speed [J]", found.work),
        _row("inertia by W / (fluctuation omega^2) [kg m^2]", found.lecture),
        _row(
            "which is off by [%]", Estimate(*(100.0 * part for part in found.lecture_error)), most=3
        ),
    ]
    heading = ["over the settled cycle", "value, to 6 digits", "num. error"]
    return "\n".join([*lines, "", table(heading, rows)])


def _load(scene: Scene, found: Flywheel) -> str:
    if scene.torque:
        return "the scene's"
    balance = found.result.data["external_torque"].values[0]
    return f"none in the scene; a constant {digits(balance)} N m balances gas and gravity"


def _row(name: str, estimate: Estimate, most: int = 6) -> list[str]:
    return [name, digits(*estimate, most), error_digits(estimate.error)]
