"""The command ``flywheel``: the inertia that gives a fluctuation of speed, beside the lecture's."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import typer

from crankmbs.cli.folder import writable, wrote_into
from crankmbs.cli.loads import loads_table
from crankmbs.cli.progress import progress
from crankmbs.cli.text import table
from crankmbs.design.flywheel import Flywheel, fluctuations, flywheel
from crankmbs.digits import digits, error_digits
from crankmbs.errors import InputError, shown
from crankmbs.export import copy_scene, export
from crankmbs.measures import Estimate, measure
from crankmbs.scene.loads import Constant
from crankmbs.scene.read import load_scene, scene_path
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM
from crankmbs.storage.files import together

__all__ = ["size_flywheel"]

_POINTS, _BEYOND = 13, 2.0  # of the curve drawn, and how far it goes beyond both inertias
_NOTHING = 1e-9  # of W: a load that balances is none
_SHARE = re.compile(r"\s*(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)\s*(%?)\s*")


def size_flywheel(
    name: str, wanted: str, write: Path | None, *, out: Path | None, figures: bool
) -> bool:
    """Size the flywheel of a scene, print it, draw it and write the scene with it; return whether
    it is in reach.

    Parameters
    ----------
    wanted : coefficient of fluctuation, as "1 %" or "0.01"
    write : file of the scene with the inertia; out : folder of the figure, None: results/NAME

    Raises
    ------
    CrankmbsError : bad scene, fluctuation, folder or file
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
    folder = writable(Path("results", path.stem) if out is None else out) if figures else None
    with progress("sizing"):
        found = flywheel(scene, number)
    said = [_report(path.stem, scene, found)]
    if found.status == 0:
        with progress("loads"):
            said += ["", loads, ""] if (loads := _loads(scene, found)) else [""]
        if folder is not None:
            said.append(wrote_into(folder, [_drawn(scene, found, folder)]))
        if write is not None:
            said.append(f"wrote {', '.join(map(str, _written(path, scene, found, write)))}")
    typer.echo("\n".join(said))
    return found.status == 0


def _loads(scene: Scene, found: Flywheel) -> str:
    """Bearing loads with the scene's own inertia, if it has any, and with the one found."""
    own = scene.crank.moment_of_inertia
    (before,) = fluctuations(scene, [own]) if own > 0.0 else (None,)
    return loads_table("the settled cycle", before, measure(found.result), "with it")


def _drawn(scene: Scene, found: Flywheel, folder: Path) -> str:
    """Draw the fluctuation over inertias about the one found and the scene's; the file's name."""
    from crankmbs.figures import save_flywheel_figure  # matplotlib only here

    at, own = found.inertia.value, scene.crank.moment_of_inertia
    floor = scene.crank.mass * scene.crank.center_of_mass**2
    least, most = max(min(at, own or at) / _BEYOND, floor), max(at, own or at) * _BEYOND
    inertias = np.geomspace(least, most, _POINTS).tolist()
    with progress("figure"), together(folder) as part:
        curve = [
            (inertia, measures.fluctuation.value)
            for inertia, measures in zip(inertias, fluctuations(scene, inertias), strict=True)
            if measures is not None
        ]
        return save_flywheel_figure(found, curve, part).name


def _written(path: Path, scene: Scene, found: Flywheel, file: Path) -> tuple[Path, ...]:
    """The scene with the inertia, in its own text; one that is set free or balanced is written
    anew, with the load."""
    settled = found.result.scene
    further = settled.torque[len(scene.torque) :]
    added = sum(abs(load.torque) for load in further if isinstance(load, Constant))
    value = f"{digits(*found.inertia)} kg m^2"
    if scene.motion is None and added <= _NOTHING * found.work.value:
        remark = f"the speed fluctuates by {100.0 * found.fluctuation.value:.4g} %"
        return copy_scene(path, file, {"inertia": value}, remark)
    return export(settled, "toml", file)


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
