"""The scene that the page's knobs give, in Python: what the page's own is held against."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, Literal

from crankmbs.design import freed
from crankmbs.mechanics.carried import carried_over
from crankmbs.page.knobs import AS_GIVEN, FIRING_ORDERS, knobs_of
from crankmbs.scene.drives import Motion, Oscillation
from crankmbs.scene.gas import AnyPressure, Gas, Polytrope
from crankmbs.scene.parts import Layout
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import RPM

Values = Mapping[str, float | str]


def turned(scene: Scene, values: Values) -> Scene:
    """The scene with its knobs at other values; what stays at its value stays to the last bit.

    With another rod ratio the rod keeps its mass, the place of its centre of mass and its shape;
    with another mass its shape. Other loads than constant ones are the same torque at the new
    speed, per cylinder.

    Parameters
    ----------
    values : knob -> its value, in the knob's unit; besides, "rod" -> "rigid" or "two-mass",
        "cylinders" -> "given" or a key of `FIRING_ORDERS`, "speed_is" -> "free" or "prescribed";
        what is missing stays

    Raises
    ------
    InputError : a scene that cannot be
    """
    new = {k.name: float(values.get(k.name, k.value)) for k in knobs_of(scene)}
    changed = {k.name for k in knobs_of(scene) if new[k.name] != k.value}
    parts: dict[str, Any] = {}
    if changed & {"rod_ratio", "rod_mass"} or "rod" in values:
        parts["rod"] = _rod(scene, new, changed, str(values.get("rod", "")))
    if "offset" in changed:
        parts["piston"] = dataclasses.replace(scene.piston, offset=new["offset"] * 1e-3)
    if changed & {"flywheel", "counterweight"}:
        inertia = new["flywheel"] if "flywheel" in changed else scene.crank.inertia
        center = new.get("counterweight", 1e3 * scene.crank.center_of_mass) * 1e-3
        parts["crank"] = dataclasses.replace(scene.crank, inertia=inertia, center_of_mass=center)
    faster = 1.0
    if "speed" in changed:
        faster = new["speed"] * RPM / _speed(scene)
        parts |= _sped(scene, new["speed"] * RPM, faster)
    cylinders = str(values.get("cylinders", AS_GIVEN))
    share = new.get("load", 100.0) / 100.0
    if cylinders != AS_GIVEN:
        order = FIRING_ORDERS[cylinders]
        parts["layout"] = Layout(firing_order=order)
        share *= len(order) / len(scene.cylinders)
    if share != 1.0 or faster != 1.0:
        parts["torque"] = tuple(load.scaled(share, faster) for load in scene.torque)
    if scene.gas is not None and "pressure" in changed:
        parts["gas"] = _pressed(scene.gas, new["pressure"] / 100.0)
    if values.get("speed_is") == "prescribed":
        start = parts.get("start", scene.start)
        parts |= {"start": None, "torque": (), "run": _one_cycle(scene)}
        parts["motion"] = Motion(speed=start.speed, angle=start.angle)
    found = carried_over(dataclasses.replace(scene, **parts), scene) if parts else scene
    return freed(found) if found.motion and values.get("speed_is") == "free" else found


def _one_cycle(scene: Scene) -> Any:
    return dataclasses.replace(scene.run, until=Extent(value=1.0, unit="cycle"))


def _rod(scene: Scene, new: dict[str, float], changed: set[str], kind: str) -> Any:
    rod = scene.rod
    length = scene.crank.radius / new["rod_ratio"] if "rod_ratio" in changed else rod.length
    mass, stretch = new["rod_mass"], length / rod.length
    inertia: float | Literal["two-mass"] = "two-mass"
    if kind != "two-mass" and not (kind == "" and rod.inertia == "two-mass"):
        if rod.inertia == "two-mass" or (rod.mass == 0.0 and mass > 0.0):
            inertia = mass * length**2 / 12.0  # the scene knows none: a uniform bar's
        else:
            heavier = mass / rod.mass if rod.mass > 0.0 else 1.0
            inertia = float(rod.inertia) * heavier * stretch**2
    return dataclasses.replace(
        rod,
        length=length,
        mass=mass,
        center_of_mass=rod.center_of_mass * stretch,
        inertia=inertia,
    )


def _sped(scene: Scene, speed: float, faster: float) -> dict[str, Any]:
    if scene.start is not None:
        return {"start": dataclasses.replace(scene.start, speed=speed)}
    assert scene.motion is not None
    swing = scene.motion.speed
    if not isinstance(swing, Oscillation):
        return {"motion": dataclasses.replace(scene.motion, speed=speed)}
    swing = dataclasses.replace(swing, mean=speed, amplitude=swing.amplitude * abs(faster))
    return {"motion": dataclasses.replace(scene.motion, speed=swing)}


def _pressed(gas: Gas, factor: float) -> Gas:
    """The pressures of the table or of the diagram times the factor; ambient stays."""
    if gas.crank_end is not None:
        gas = dataclasses.replace(gas, crank_end=_pressed_more(gas.crank_end, factor))
    if gas.pressure is not None:
        closing = None if gas.closing is None else factor * gas.closing
        pressed = _pressed_more(gas.pressure, factor)
        motored = gas.motored
        if motored is not None and not isinstance(motored, Polytrope):
            motored = _pressed_more(motored, factor)
        return dataclasses.replace(gas, pressure=pressed, closing=closing, motored=motored)
    assert gas.indicator is not None
    names = ("intake_pressure", "exhaust_pressure", "peak_pressure")
    old = {name: getattr(gas.indicator, name) for name in names}
    new = {name: p * factor for name, p in old.items() if p is not None}
    return dataclasses.replace(gas, indicator=dataclasses.replace(gas.indicator, **new))


def _pressed_more(pressure: AnyPressure, factor: float) -> AnyPressure:
    if isinstance(pressure, float):
        return factor * pressure
    if isinstance(pressure, Table):
        return pressure.scaled(factor)
    if isinstance(pressure, CylinderTable):
        more = tuple(table.scaled(factor).y for table in pressure.tables)
        return CylinderTable(pressure.x, more, pressure.source)
    return tuple(table.scaled(factor) for table in pressure)


def _speed(scene: Scene) -> float:
    """The speed [rad/s] that the knob turns; 0 where there is none to turn."""
    if scene.start is not None:
        return scene.start.speed
    assert scene.motion is not None
    speed = scene.motion.speed
    if isinstance(speed, Oscillation):
        return speed.mean
    return speed if isinstance(speed, float) else 0.0
