"""What ``check`` prints: the machine as it was understood, and how it would be solved."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.choose import Choice
from crankmbs.geometry import close_loop, dead_centres
from crankmbs.pressure import remarks
from crankmbs.scene import Extent, Scene

__all__ = ["describe"]


def describe(path: str, scene: Scene, choice: Choice) -> str:
    """The scene in a few lines."""
    rows = [
        ("scene", path),
        ("title", scene.title),
        ("source", scene.source),
        ("crank", _crank(scene)),
        ("dead centres", _dead_centres(scene)),
        ("cylinders", _cylinders(scene)),
        ("gas", _gas(scene)),
        *(("", remark) for remark in remarks(scene)),
        ("motion", _motion(scene)),
        ("run", _run(scene)),
        ("formulation", choice.formulation),
        *(("", reason) for reason in choice.reasons),
    ]
    return "\n".join(f"{name:<12} {text}" for name, text in rows if text)


def _crank(scene: Scene) -> str:
    r, l = scene.crank.radius, scene.rod.length
    offset = scene.piston.offset
    text = f"radius {r * 1e3:.6g} mm, rod {l * 1e3:.6g} mm, ratio {r / l:.6g}"
    return f"{text}, offset {offset * 1e3:.6g} mm" if offset else text


def _dead_centres(scene: Scene) -> str:
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    angles = dead_centres(r, l, e)
    top, bottom = close_loop(angles, r, l, e).x
    at = " and ".join(f"{angle:.6g}" for angle in np.degrees(angles))
    text = f"cycle angles {at} deg, stroke {float(top - bottom) * 1e3:.6g} mm"
    area = scene.piston.gas_area
    if area is not None:
        text += f", displaced {float(top - bottom) * area * 1e6:.6g} cm^3 a cylinder"
    return text


def _cylinders(scene: Scene) -> str:
    fired = scene.gas is not None and scene.gas.stroke == 4
    each = [
        f"phase {math.degrees(c.phase):.6g} deg"
        + (f", bank {math.degrees(c.bank):.6g} deg" if c.bank else "")
        + f", throw at {math.degrees(c.phase + c.bank) % 360.0:.6g} deg"
        + (f", fires at {(360.0 - math.degrees(c.phase)) % 720.0:.6g} deg" if fired else "")
        for c in scene.cylinders
    ]
    return f"{len(each)}: " + "; ".join(each)


def _gas(scene: Scene) -> str:
    gas = scene.gas
    if gas is None:
        return "none"
    if gas.indicator is not None:
        origin = f"indicator diagram, compression ratio {gas.indicator.compression_ratio:.6g}"
    else:
        assert gas.pressure is not None
        origin = f"{len(gas.pressure.x)} rows of {gas.pressure.source}, {gas.interpolation}"
    return f"{gas.stroke}-stroke, {origin}"


def _motion(scene: Scene) -> str:
    if scene.start is None:
        return "prescribed speed"
    speed, angle = scene.start.speed * 30.0 / math.pi, math.degrees(scene.start.angle)
    kinds = ", ".join(load.kind.replace("_", " ") for load in scene.torque) or "none"
    return f"free, from {speed:.6g} rpm at {angle:.6g} deg; torques: {kinds}"


def _run(scene: Scene) -> str:
    run = scene.run
    every = "the last cycle only" if run.every is None else f"every {_extent(run.every)}"
    return f"until {_extent(run.until)}, {every}, rtol {run.rtol:g}"


def _extent(extent: Extent) -> str:
    if extent.unit == "rad":
        return f"{math.degrees(extent.value):.6g} deg"
    return f"{extent.value:.6g} {extent.unit}{'s' if extent.unit == 'cycle' else ''}"
