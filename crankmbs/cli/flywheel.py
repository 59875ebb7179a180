"""The command ``flywheel``: the inertia that gives a fluctuation of speed, beside the lecture's."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Exit, Option, echo

from crankmbs.cli.folder import results_folder, wrote_into
from crankmbs.cli.loads import loads_table
from crankmbs.cli.options import NoFigures, OutBesideScene, SceneName, WrittenScene, named_scene
from crankmbs.cli.progress import progress
from crankmbs.cli.text import heading, table
from crankmbs.digits import digits, error_digits
from crankmbs.errors import InputError, shown
from crankmbs.scene.units import DEGREE, RPM, share_of
from crankmbs.storage.files import together

if TYPE_CHECKING:
    from crankmbs.design.flywheel import Flywheel
    from crankmbs.measures import Measures
    from crankmbs.scene.scene import Scene

__all__ = ["flywheel"]

_POINTS, _BEYOND = 13, 2.0  # of the curve drawn, and how far it goes beyond both inertias
_NOTHING = 1e-9  # of W: a load that balances is none
_LARGE = 0.2  # of the mean speed: as a bare number rather a percentage without its sign


def flywheel(
    scene: SceneName,
    fluctuation: Annotated[
        str, Option(help='Wanted (max - min)/mean of the speed, as "1 %" or 0.01.')
    ] = "1 %",
    write: WrittenScene = None,
    out: OutBesideScene = None,
    no_figures: NoFigures = False,
) -> None:
    """Find the crank inertia that gives a fluctuation of speed on the settled cycle."""
    from crankmbs.design.flywheel import flywheel as sized
    from crankmbs.measures import measure

    number = share_of(fluctuation)
    if not 0.0 < number < 2.0:
        raise InputError(
            "--fluctuation: must be a share of the mean speed above 0 and below 200 %, such as "
            f'"1 %" or 0.01; {shown(fluctuation)} came'
        )
    if "%" not in fluctuation and number >= _LARGE:
        raise InputError(
            f"--fluctuation: {number:g} without a unit is {100.0 * number:g} % of the mean speed; "
            f'write "{number:g} %", or "{100.0 * number:g} %" if that is meant'
        )
    path, machine = named_scene(scene)
    folder = None if no_figures else results_folder(path, out)
    with progress("sizing"):
        wheel = sized(machine, number)
    with progress("before"):
        before = _before(machine) if wheel.status == 0 else None
    lines = [_report(path.stem, machine, wheel, before)]
    if wheel.status == 0:
        with progress("loads"):
            loads = loads_table(before, measure(wheel.result), "with it")
        lines += ["", loads, ""] if loads else [""]
        if folder is not None:
            lines.append(wrote_into(folder, [_drawn(machine, wheel, folder)]))
        if write is not None:
            lines.append(f"wrote {', '.join(map(str, _written(path, machine, wheel, write)))}")
    echo("\n".join(lines))
    if wheel.status != 0:
        raise Exit(3)


def _before(scene: Scene) -> Measures | None:
    """Measures of the settled cycle with the scene's inertia; None where it has none or does not
    settle with it."""
    from crankmbs.design.flywheel import fluctuations

    inertia = scene.crank.moment_of_inertia
    return fluctuations(scene, [inertia])[0] if inertia > 0.0 else None


def _drawn(scene: Scene, wheel: Flywheel, folder: Path) -> str:
    """Draw the fluctuation over inertias about the wheel's and the scene's; the file's name."""
    import numpy as np

    from crankmbs.design.flywheel import fluctuations
    from crankmbs.figures import save_flywheel_figure  # matplotlib only here

    at, before = wheel.inertia.value, scene.crank.moment_of_inertia
    floor = scene.crank.mass * scene.crank.center_of_mass**2
    least, most = max(min(at, before or at) / _BEYOND, floor), max(at, before or at) * _BEYOND
    inertias = np.geomspace(least, most, _POINTS).tolist()
    with progress("figure"), together(folder) as part:
        curve = [
            (inertia, measures.fluctuation.value)
            for inertia, measures in zip(inertias, fluctuations(scene, inertias), strict=True)
            if measures is not None
        ]
        return save_flywheel_figure(wheel, curve, part).name


def _written(path: Path, scene: Scene, wheel: Flywheel, file: Path) -> tuple[Path, ...]:
    """The scene with the inertia, in its own text; set free or balanced also with its start and the
    load."""
    from crankmbs.export import copy_scene

    settled = wheel.result.scene
    assert settled.start is not None
    torque = _balance(scene, wheel)
    inertia = {"crank__inertia": f"{digits(*wheel.inertia)} kg m^2"}
    remark = f"the speed fluctuates by {100.0 * wheel.fluctuation.value:.4g} %"
    if scene.motion is None and not torque:
        return copy_scene(path, file, inertia, remark)
    start = {
        "angle": f"{settled.start.angle / DEGREE:.9g} deg",
        "speed": f"{settled.start.speed / RPM:.9g} rpm",
    }
    load = f"{torque:.9g} N m" if torque else None
    return copy_scene(path, file, inertia, remark, start=start, torque=load)


def _report(name: str, scene: Scene, wheel: Flywheel, before: Measures | None) -> str:
    from crankmbs.measures.span import measured_span

    lines = [
        f"{heading(name, scene.title)}\n",
        f"{'flywheel':<12} {wheel.message}",
        f"{'load':<12} {_load(scene, wheel)}",
    ]
    if wheel.status != 0:
        return "\n".join(lines)
    moving = []
    if wheel.moving > _NOTHING * wheel.lecture.value:
        moving = [
            _row("less rods and pistons, their mean [kg m^2]", (wheel.moving, 0.0)),
            _row("crank and flywheel by the formula [kg m^2]", wheel.lecture_crank),
        ]
    present = []
    if before is not None:
        inertia = f"{scene.crank.moment_of_inertia:.6g} kg m^2"
        present = [_row(f"the same with the scene's {inertia} [1]", before.fluctuation)]
    rows = [
        _row("inertia of crank and flywheel [kg m^2]", wheel.inertia),
        _row("of which beyond the scene's [kg m^2]", (wheel.added, wheel.inertia.error)),
        _row("coefficient of fluctuation, (max - min)/mean [1]", wheel.fluctuation),
        *present,
        _row("mean speed [rpm]", wheel.mean_speed, 1.0 / RPM),
        _row("W, excess of work at that constant speed [J]", wheel.work),
        _row("the formula's inertia, W / (fluctuation omega^2) [kg m^2]", wheel.lecture),
        *moving,
        _row("the formula is off by [%]", wheel.lecture_error, 100.0, most=3),
    ]
    headings = [f"over the {measured_span(wheel.result).kind}", "value, to 6 digits", "num. error"]
    return "\n".join([*lines, "", table(headings, rows)])


def _load(scene: Scene, wheel: Flywheel) -> str:
    balance = _balance(scene, wheel)
    what = f"a constant {digits(balance)} N m, which balances gas, gravity and friction"
    if not scene.torque:
        return f"none in the scene; {what}"
    return f"the scene's, with {what}" if balance else "the scene's"


def _balance(scene: Scene, wheel: Flywheel) -> float:
    """The constant torque [N m] that was added to the scene's loads; 0 where it is nothing."""
    from crankmbs.scene.loads import Constant

    further = wheel.result.scene.torque[len(scene.torque) :]
    torque = math.fsum(load.torque for load in further if isinstance(load, Constant))
    return torque if abs(torque) > _NOTHING * wheel.work.value else 0.0


def _row(name: str, estimate: tuple[float, float], scale: float = 1.0, most: int = 6) -> list[str]:
    value, error = (scale * part for part in estimate)
    return [name, digits(value, error, most), error_digits(error)]
