"""The machine of a scene as it was understood, in words, and how it would be solved."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.choose import Choice
from crankmbs.measures.plausible import warnings
from crankmbs.mechanics.geometry import dead_centres
from crankmbs.mechanics.pressure import PeriodicPressure, crank_ends_of, pressures_of, remarks
from crankmbs.mechanics.speed import speed_remarks
from crankmbs.mechanics.windows import Phase, first_phases
from crankmbs.report.rows import cycle_remark
from crankmbs.scene.cycles import cycles_in
from crankmbs.scene.drives import Oscillation, Ramp, SpeedFile
from crankmbs.scene.gas import AnyPressure, Gas, tables_of
from crankmbs.scene.parts import RunningGear
from crankmbs.scene.run import SETTLED, Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.speed_rows import repeats
from crankmbs.scene.tables import CylinderTable
from crankmbs.scene.torque import Torque
from crankmbs.scene.units import BAR, RPM

__all__ = ["describe", "journal_remarks", "machine_rows"]


def describe(path: str, scene: Scene, choice: Choice) -> str:
    """The scene in a few lines."""
    rows = [
        ("scene", path),
        *machine_rows(scene),
        ("formulation", choice.formulation),
        *(("", reason) for reason in choice.reasons),
        *(("warning", text) for text in warnings(scene)),
    ]
    return "\n".join(f"{name:<12} {text}" for name, text in rows)


def machine_rows(scene: Scene) -> list[tuple[str, str]]:
    """What each part of a scene is, by its name; a part in several rows is named once.

    >>> [name for name, _ in machine_rows(load_scene("coasting"))][2:5]
    ['crank', 'rod', 'piston']
    """
    heads, ends = pressures_of(scene) or (), crank_ends_of(scene) or ()
    common = RunningGear(scene.crank.radius, scene.rod, scene.piston)
    at_head = "in the head end" if ends else "across the piston"
    rows = [
        ("title", scene.title),
        ("source", scene.source),
        ("crank", _crank(scene)),
        ("rod", _rod(common)),
        ("piston", _piston(common)),
        ("dead centres", _dead_centres(common, several=len(scene.cylinders) > 1)),
        *_unlike(scene, common),
        ("cylinders", _cylinders(scene)),
        ("gas", _gas(scene)),
        *([("cycle", remark)] if (remark := cycle_remark(scene)) else []),
        *(("pressure", text) for text in _pressures(scene, heads, at_head)),
        *(("", text) for text in _pressures(scene, ends, "in the crank end")),
        *(("", remark) for remark in remarks(scene)),
        ("fuel", _fuel(scene)),
        ("gravity", _gravity(scene)),
        ("friction", _friction(scene)),
        ("bearings", _shells(scene)),
        *(("", text) for text in journal_remarks(scene)),
        ("motion", _motion(scene)),
        *(("", text) for text in speed_remarks(scene)),
        *((f"torque[{k}]", _load(scene, load)) for k, load in enumerate(scene.torque, start=1)),
        *(
            (
                f"force[{k}]",
                f"on {f'piston {each.cylinder}' if each.cylinder else 'each piston'}, "
                f"{each.introduced}: {each.words}{each.window_words}",
            )
            for k, each in enumerate(scene.force, start=1)
        ),
        ("run", _run(scene)),
    ]
    return [(name, text) for name, text in rows if text]


def _crank(scene: Scene) -> str:
    crank = scene.crank
    left_out = ", left out" if crank.inertia is None else ""
    return (
        f"radius {crank.radius * 1e3:.6g} mm, {_body(crank.mass, crank.center_of_mass)}, "
        f"inertia {crank.moment_of_inertia:.6g} kg m^2 about its axis{left_out}"
    )


def _unlike(scene: Scene, common: RunningGear) -> list[tuple[str, str]]:
    """The throw, rod and piston of each cylinder that differs."""
    return [
        row
        for number, gear in enumerate(scene.running_gear, start=1)
        if gear != common
        for row in (
            (f"cylinder[{number}]", f"radius {gear.radius * 1e3:.6g} mm; rod: {_rod(gear)}"),
            ("", f"piston: {_piston(gear)}"),
            ("", f"dead centres: {_dead_centres(gear, several=False)}"),
        )
    ]


def _rod(gear: RunningGear) -> str:
    rod, ratio = gear.rod, gear.radius / gear.rod.length
    lumped = ", two masses" if rod.inertia == "two-mass" else ""
    return (
        f"length {rod.length * 1e3:.6g} mm, ratio {ratio:.6g}, "
        f"{_body(rod.mass, rod.center_of_mass)}, inertia {rod.moment_of_inertia:.6g} kg m^2 about "
        f"its centre of mass{lumped}"
    )


def _body(mass: float, center_of_mass: float) -> str:
    place = f", centre of mass at {center_of_mass * 1e3:.6g} mm" if mass else ""
    return f"mass {mass:.6g} kg{place}"


def _piston(gear: RunningGear) -> str:
    piston, area = gear.piston, gear.piston.gas_area
    bore = ""
    if area is not None:
        across = math.sqrt(4.0 * area / math.pi)
        bore = f", bore {across * 1e3:.6g} mm, area {area * 1e4:.6g} cm^2"
    offset = f", offset {piston.offset * 1e3:.6g} mm" if piston.offset else ""
    rod = f", piston rod {piston.rod_diameter * 1e3:.6g} mm" if piston.rod_diameter else ""
    return f"mass {piston.mass:.6g} kg{bore}{offset}{rod}"


def _dead_centres(gear: RunningGear, *, several: bool) -> str:
    top, bottom = np.degrees(dead_centres(*gear.shape))
    text = f"cycle angles {top:.6g} and {bottom:.6g} deg, stroke {gear.stroke * 1e3:.6g} mm"
    area = gear.piston.gas_area
    if area is not None:
        text += f", displaces {gear.stroke * area * 1e6:.6g} cm^3{' each' * several}"
    elif gear.piston.offset:
        out = (bottom - top) % 360.0
        ratio = max(out, 360.0 - out) / min(out, 360.0 - out)
        text += f", quick-return ratio {ratio:.6g}: {out:.6g} deg from the first to the second"
    return text


def _cylinders(scene: Scene) -> str:
    fired = scene.gas is not None and scene.gas.stroke == 4
    each = [
        f"{number}: phase {math.degrees(c.phase):.6g} deg"
        + (f", bank {math.degrees(c.bank):.6g} deg" if c.bank else "")
        + f", throw at {math.degrees(c.phase + c.bank) % 360.0:.6g} deg"
        + (f", fires at {(360.0 - math.degrees(c.phase)) % 720.0:.6g} deg" if fired else "")
        for number, c in enumerate(scene.cylinders, start=1)
    ]
    return "; ".join(each)


def _gas(scene: Scene) -> str:
    gas = scene.gas
    if gas is None:
        return "none"
    if gas.indicator is not None:
        origin = f"indicator diagram, compression ratio {gas.indicator.compression_ratio:.6g}"
    else:
        assert gas.pressure is not None
        origin = _origin(gas, gas.pressure)
    if gas.crank_end is not None:
        origin += f"; crank end: {_origin(gas, gas.crank_end)}"
    return f"{gas.stroke}-stroke, {'double-acting, ' * scene.double_acting}{origin}"


def _origin(gas: Gas, source: AnyPressure) -> str:
    """What a pressure is made of."""
    if isinstance(source, float):
        return f"constant pressure of {source / BAR:.6g} bar"
    return f"{_tables(gas, source)}, {gas.interpolation}"


def _tables(gas: Gas, source: AnyPressure) -> str:
    tables = tables_of(source)
    if isinstance(source, CylinderTable):
        over = "its own cycle angle" if gas.aligned else "that of cylinder 1"
        text = f"{len(source.x)} rows of {source.source}, {len(source.y)} columns, each over {over}"
    else:
        text = " and ".join(f"{len(table.x)} rows of {table.source}" for table in tables)
    cycles = max(cycles_in(table, gas.period) for table in tables)
    if cycles == 1:
        return text
    return f"{text}, {'the mean' if gas.cycles == 'mean' else 'a sequence'} of {cycles} cycles"


def _pressures(scene: Scene, pressures: tuple[PeriodicPressure, ...], ending: str) -> list[str]:
    """Each pressure once, of several with the cylinders that have it."""
    of: dict[PeriodicPressure, list[int]] = {}
    for number, pressure in enumerate(pressures, start=1):
        of.setdefault(pressure, []).append(number)
    return [
        ("" if len(of) == 1 else f"cylinder {', '.join(map(str, numbers))}: ")
        + _pressure(scene, pressure, ending)
        for pressure, numbers in of.items()
    ]


def _pressure(scene: Scene, pressure: PeriodicPressure, ending: str) -> str:
    assert scene.gas is not None
    ambient = scene.gas.ambient
    kind = "gauge" if ambient is None else f"absolute, ambient {ambient / BAR:.6g} bar subtracted"
    angle, peak = pressure.peak
    return (
        f"{kind}; at most {peak / BAR:.6g} bar {ending}, at a cycle angle of "
        f"{math.degrees(angle):.6g} deg"
    )


def _gravity(scene: Scene) -> str:
    gravity = scene.gravity
    if gravity is None:
        return "none"
    return (
        f"{gravity.acceleration:.6g} m/s^2, pulling at {math.degrees(gravity.angle):.6g} deg from X"
    )


def _fuel(scene: Scene) -> str:
    fuel = scene.fuel
    if fuel is None:
        return ""
    parts = [
        f"cylinder {misfire.cylinder} misfires in cycles {misfire.cycles}"
        for misfire in fuel.misfire or ()
    ]
    if fuel.scatter:
        parts.append(f"scatter {100.0 * fuel.scatter:.6g} %, seed {fuel.seed}")
    if fuel.governor is not None:
        parts.append(f"governor at {fuel.governor.speed / RPM:.6g} rpm")
    times = {"from": fuel.after or None, "until": fuel.until}
    speeds = {"from": fuel.from_speed, "until": fuel.until_speed}
    parts += [f"{word} {time:.6g} s" for word, time in times.items() if time is not None]
    parts += [f"{word} {v / RPM:.6g} rpm" for word, v in speeds.items() if v is not None]
    return "; ".join(parts) or "every firing whole"


def _friction(scene: Scene) -> str:
    friction = scene.friction
    if friction is None:
        return ""
    parts = [
        f"{friction.ring_force:.6g} N" * (friction.ring_force > 0.0),
        f"{100.0 * friction.ring_pressure:.6g} % of |gas force|" * (friction.ring_pressure > 0.0),
        f"{friction.viscous:.6g} N s/m times the velocity" * (friction.viscous > 0.0),
    ]
    return f"{' and '.join(part for part in parts if part) or 'none'}, against each sliding piston"


def _shells(scene: Scene) -> str:
    bearings, throws = scene.bearings, scene.throws
    if bearings is None:
        return ""
    shells = {"crank pin": bearings.crank_pin, "main journal": bearings.main_journal}
    parts = [
        f"{name} {shell.diameter * 1e3:.6g} x {shell.width * 1e3:.6g} mm"
        for name, shell in shells.items()
        if shell is not None
    ]
    if throws is not None:
        count = len(throws.unbalances)
        parts.append(f"{count} throw{'s' if count > 1 else ''} in {count + 1} main journals")
    return ", ".join(parts)


def journal_remarks(scene: Scene) -> list[str]:
    """What the loads of the main journals rest on.

    >>> journal_remarks(load_scene("propeller"))
    []
    """
    throws = scene.throws
    if throws is None or scene.bearings is None:
        return []
    remarks = [
        "a main journal's load is the usual statically determinate split, an approximation: each "
        "throw rests on the two journals beside it"
    ]
    if scene.bearings.throw_unbalance is None and scene.crank.mass and len(throws.unbalances) > 1:
        remarks.append("the crank's unbalance and weight are shared equally by its throws")
    return remarks


def _motion(scene: Scene) -> str:
    if scene.motion is not None:
        speed, begin = _speed(scene.motion.speed), math.degrees(scene.motion.angle)
        return f"prescribed, {speed}, from {begin:.6g} deg"
    assert scene.start is not None
    speed, begin = _rpm(scene.start.speed), math.degrees(scene.start.angle)
    sense = _sense(scene.start.speed)
    loads = "" if scene.torque or scene.force else ", no load"
    return f"free, from {speed} at {begin:.6g} deg{sense}{loads}"


def _speed(speed: float | Oscillation | Ramp | SpeedFile) -> str:
    match speed:
        case Oscillation():
            swing = f"{_rpm(speed.mean)} on average over the angle, +-{_rpm(speed.amplitude)}"
            return f"{swing}, {speed.order:.6g} times a turn{_sense(speed.mean)}"
        case Ramp():
            return f"from {_rpm(speed.start)} to {_rpm(speed.to)} in {speed.over:.6g} s, then held"
        case SpeedFile(file=table):
            least, most = _rpm(min(table.y)), _rpm(max(table.y))
            over_time = speed.kind == "time_table"
            over = " over time" if over_time else " over the crank angle"
            turned = f", again every {math.degrees(table.x[-1] - table.x[0]):.6g} deg"
            again = "" if over_time or not repeats(table) else turned
            rows = f"{len(table.x)} rows of {table.source}, {speed.interpolation}"
            return f"{least} to {most}{over} in {rows}{again}"
        case _:
            return f"{_rpm(speed)}{_sense(speed)}"


def _rpm(speed: float) -> str:
    return f"{speed / RPM:.6g} rpm"


def _sense(speed: float) -> str:
    if speed == 0.0:
        return ""
    return ", counter-clockwise (+theta)" if speed > 0.0 else ", clockwise (-theta)"


def _load(scene: Scene, load: Torque) -> str:
    assert scene.start is not None
    text = f"{load.introduced}, {load.words}{load.window_words}"
    speed = scene.start.speed
    if any(phase is not Phase.ACTING for phase in first_phases((load,), speed)):
        return f"{text}; none at the start"
    torque = float(load(0.0, scene.start.angle, speed))
    if torque * speed == 0.0:
        return text
    return f"{text}; {torque:+.6g} N m at the start, {'drives' if torque * speed > 0 else 'brakes'}"


def _run(scene: Scene) -> str:
    run = scene.run
    every = "the last cycle only" if run.every is None else f"every {_extent(run.every)}"
    until = run.until if run.until == SETTLED else _extent(run.until)
    return f"until {until}, {every}, rtol {run.rtol:g}"


def _extent(extent: Extent) -> str:
    if extent.unit == "rad":
        return f"{math.degrees(extent.value):.6g} deg"
    many = extent.unit == "cycle" and extent.value != 1.0
    return f"{extent.value:.6g} {extent.unit}{'s' if many else ''}"
