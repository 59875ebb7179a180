"""Numbers far outside what machines have: said, not refused, for a machine may be unusual.

Each rule is one function of the scene that gives its sentences; its limits stand above it with
their reason. They are wide: what they catch is a unit or a sign, not a bold design.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from crankmbs.measures.plausible_signs import backwards, drives_on, pushes_on
from crankmbs.measures.plausible_tables import gaps, scatter
from crankmbs.measures.room import bores_overlap, shells_overlap
from crankmbs.mechanics.pressure import PeriodicPressure, pressures_of
from crankmbs.scene.gas import CONSTANT, Gas
from crankmbs.scene.levels import unlikely_peak
from crankmbs.scene.parts import RunningGear
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.scene.units import BAR

__all__ = ["warnings"]

_STEEL = 7850.0  # kg/m3


class _Sized(NamedTuple):
    """What moves in a cylinder; its piston's diameter [m], without area three times the stroke, as
    the slide of a press may be wide; whether gas presses on it."""

    gear: RunningGear
    diameter: float
    gas: bool


def warnings(scene: Scene) -> tuple[str, ...]:
    """One sentence for each number that no machine is likely to have.

    >>> warnings(load_scene("propeller"))
    ()
    """
    common = RunningGear(scene.crank.radius, scene.rod, scene.piston)
    sentences = []
    for number, gear in enumerate(scene.running_gear, start=1):
        area = gear.piston.gas_area
        wide = 3.0 * gear.stroke if area is None else _diameter(area)
        sized = _Sized(gear, wide, scene.gas is not None)
        prefix = "" if gear == common else f"cylinder[{number}]: "
        sentences += [f"{prefix}{sentence}" for rule in _OF_GEAR for sentence in rule(sized)]
    sentences += [sentence for rule in _OF_SCENE for sentence in rule(scene)]
    return tuple(dict.fromkeys(sentences))


def _diameter(area: float) -> float:
    return math.sqrt(4.0 * area / math.pi)


# The longest strokes are those of ships' two-stroke engines, 3.5 m; model engines have 5 mm.
_STROKES = 1e-3, 5.0


def _stroke(machine: _Sized) -> Iterator[str]:
    least, most = _STROKES
    if not least <= machine.gear.stroke <= most:
        yield (
            f"crank.radius: a stroke of {machine.gear.stroke:.4g} m is outside {least:g} to "
            f"{most:g} m, where machines lie; a bare number is in metres"
        )


# Bore over stroke: 0.27 in ships' two-stroke engines, less in high-pressure plungers; 2.5 in the
# racing engines of 18,000 rpm.
_BORE_OVER_STROKE = 0.15, 3.5


def _bore(machine: _Sized) -> Iterator[str]:
    if machine.gear.stroke < _STROKES[0]:  # that is said already
        return
    ratio = machine.diameter / machine.gear.stroke
    least, most = _BORE_OVER_STROKE
    if not least <= ratio <= most:
        name = "bore" if machine.gear.piston.area is None else "area"
        yield (
            f"piston.{name}: a piston {machine.diameter * 1e3:.4g} mm wide with a stroke of "
            f"{machine.gear.stroke * 1e3:.4g} mm has a bore {ratio:.3g} times the stroke; machines "
            f"have {least:g} to {most:g} times; check its unit"
        )


# Solid steel as wide as the piston: a rod as long as it is, a piston (with piston rod and
# crosshead) five diameters high. Rods and trunk pistons weigh a quarter of that and less.
_DIAMETERS = 5.0


def _masses(machine: _Sized) -> Iterator[str]:
    (_, rod, piston), d, _ = machine
    column = _STEEL * math.pi / 4.0 * d**2
    for name, mass, height in (
        ("rod", rod.mass, rod.length),
        ("piston", piston.mass, _DIAMETERS * d),
    ):
        if mass > column * height:
            yield (
                f"{name}.mass: {mass:.4g} kg is more than solid steel {d * 1e3:.4g} mm wide and "
                f"{height * 1e3:.4g} mm long, {column * height:.3g} kg; a bare number is in kg"
            )


def _fold(machine: _Sized) -> Iterator[str]:
    """A crank that turns as far as the rod folds onto it, and no farther."""
    radius, length, offset = machine.gear.shape
    if length - radius - abs(offset) <= 1e-12 * length:
        angle = 90 if offset <= 0.0 else 270
        yield (
            f"rod.length: a rod as long as crank.radius + |piston.offset|, {length * 1e3:.6g} mm, "
            f"folds onto the crank at a cycle angle of {angle} degrees, where the motion is not "
            "determined: a run ends there"
        )


# Rods are 3 to 5 crank radii long, in steam engines up to 8, in presses of a short stroke some 30.
_ROD_OVER_RADIUS = 50.0


def _rod_length(machine: _Sized) -> Iterator[str]:
    radius, length, _ = machine.gear.shape
    if machine.gear.stroke >= _STROKES[0] and length > _ROD_OVER_RADIUS * radius:
        yield (
            f"rod.length: a rod of {length:.4g} m is {length / radius:.4g} times as long as the "
            f"crank's radius, and machines have up to {_ROD_OVER_RADIUS:g}; a bare number is in "
            "metres"
        )


# A disc of aluminium as wide as the bore and a fiftieth of that high; a bar of it as long as the
# rod and a fiftieth of that wide. Pistons and rods weigh ten times that and more.
_ALUMINIUM = 2700.0  # kg/m3
_THIN = 0.02


def _light_masses(machine: _Sized) -> Iterator[str]:
    if any(True for rule in (_stroke, _bore, _rod_length) for _ in rule(machine)):
        return  # what is wrong is a length
    (_, rod, piston), d, _ = machine
    disc = math.inf if piston.gas_area is None else _ALUMINIUM * piston.gas_area * _THIN * d
    bar = _ALUMINIUM * rod.length * (_THIN * rod.length) ** 2
    if 0.0 < piston.mass < disc < math.inf:
        yield (
            f"piston.mass: {1e3 * piston.mass:.4g} g is less than a disc of aluminium "
            f"{d * 1e3:.4g} mm wide and {_THIN * d * 1e3:.3g} mm high, {1e3 * disc:.3g} g; check "
            "its unit"
        )
    if 0.0 < rod.mass < bar:
        yield (
            f"rod.mass: {1e3 * rod.mass:.4g} g is less than a bar of aluminium "
            f"{rod.length * 1e3:.4g} mm long and {_THIN * rod.length * 1e3:.3g} mm wide, "
            f"{1e3 * bar:.3g} g; check its unit"
        )


# Radius of gyration over length: 0.29 for a uniform bar, at most 0.5 for two masses at the pins.
_GYRATION = 0.7


def _rod(machine: _Sized) -> Iterator[str]:
    rod = machine.gear.rod
    if rod.mass == 0.0:
        return
    if not 0.0 <= rod.center_of_mass <= rod.length:
        yield (
            f"rod.center_of_mass: {rod.center_of_mass * 1e3:.4g} mm from the crank pin is not "
            f"between the pins, 0 to {rod.length * 1e3:.4g} mm; check its unit"
        )
    gyration = math.sqrt(max(rod.moment_of_inertia, 0.0) / rod.mass)
    if gyration > _GYRATION * rod.length:
        yield (
            f"rod.inertia: {rod.moment_of_inertia:.4g} kg m^2 about the centre of mass is that of "
            f"the whole mass {gyration * 1e3:.4g} mm away from it, and the rod is "
            f"{rod.length * 1e3:.4g} mm long; check its unit"
        )


# Engines are offset by a twentieth of the crank's radius at the pin, by a half at most where their
# cylinders stand beside the crankshaft; mechanisms without gas, such as quick returns, by any.
_OFFSET_OVER_RADIUS = 1.0


def _offset(machine: _Sized) -> Iterator[str]:
    radius, _, offset = machine.gear.shape
    if machine.gas and abs(offset) > _OFFSET_OVER_RADIUS * radius:
        yield (
            f"piston.offset: {offset * 1e3:.4g} mm is {abs(offset) / radius:.3g} times the crank's "
            f"radius, with which a stroke of {2e3 * radius:.4g} mm becomes one of "
            f"{machine.gear.stroke * 1e3:.4g} mm; engines have up to half the radius; check its "
            "unit"
        )


# A solid disc of steel six strokes (bores, where they are larger) in diameter and two wide. The
# flywheels of stationary engines and compressors have a tenth of its inertia and less; presses,
# which have no gas, have theirs behind a gear.
_DISC = 6.0, 2.0


def _inertia(scene: Scene) -> Iterator[str]:
    inertia, gears = scene.crank.inertia, scene.running_gear
    areas = [each.piston.gas_area for each in gears]
    size = max(*(2.0 * each.radius for each in gears), *(_diameter(each or 0.0) for each in areas))
    if scene.gas is None or inertia is None or not _STROKES[0] <= size <= _STROKES[1]:
        return
    diameter, width = (times * size for times in _DISC)
    disc = _STEEL * math.pi / 32.0 * diameter**4 * width
    if inertia > disc:
        yield (
            f"crank.inertia: {inertia:.4g} kg m^2 is more than that of a solid steel disc "
            f"{diameter * 1e3:.4g} mm in diameter and {width * 1e3:.4g} mm wide, {disc:.3g} kg "
            "m^2; flywheels of engines have a tenth of that and less; check its unit"
        )


# Main journals of ships' engines have a diameter of 1 m; plain bearings are 0.2 to 2 times as wide
# as their diameter.
_DIAMETER = 1e-3, 2.0
_WIDTH = 0.05, 5.0


def _shells(scene: Scene) -> Iterator[str]:
    bearings = scene.bearings
    if bearings is None:
        return
    for name, shell in (("crank_pin", bearings.crank_pin), ("main_journal", bearings.main_journal)):
        if shell is None:
            continue
        if not _DIAMETER[0] <= shell.diameter <= _DIAMETER[1]:
            yield (
                f"bearings.{name}: a diameter of {shell.diameter:.4g} m is outside "
                f"{_DIAMETER[0]:g} to {_DIAMETER[1]:g} m, where bearings lie; a bare number is in "
                "metres"
            )
        ratio = shell.width / shell.diameter
        if not _WIDTH[0] <= ratio <= _WIDTH[1]:
            yield (
                f"bearings.{name}: a width of {shell.width:.4g} m is {ratio:.3g} times the "
                f"diameter, {shell.diameter:.4g} m; bearings have {_WIDTH[0]:g} to "
                f"{_WIDTH[1]:g} times; check its unit"
            )


# 0.3 bar is the air on Mount Everest; refrigerating compressors have crankcases of up to 35 bar.
_AMBIENT = 0.2 * BAR, 50.0 * BAR
# Vacuum pumps with pistons come to 10 mbar. Above stand pressures of plungers.
_CYLINDER = 0.01 * BAR, 4000.0 * BAR


def _pressures(scene: Scene) -> Iterator[str]:
    """Each pressure that is one number; that of a gauge pressure may be 0, and have either sign."""
    gas = scene.gas
    if gas is None:
        return
    numbers = [("ambient", gas.ambient, _AMBIENT, "crankcases")]
    if gas.indicator is not None:
        for key in ("intake_pressure", "exhaust_pressure"):
            number = getattr(gas.indicator, key)
            numbers.append((f"indicator.{key}", number, _CYLINDER, "pressures of cylinders"))
    for key in ("pressure", "motored", "crank_end"):
        source = getattr(gas, key)
        for each in source if isinstance(source, tuple) else (source,):
            number = each.y[0] if isinstance(each, Table) and each.source == CONSTANT else each
            if isinstance(number, float):
                numbers.append((key, number, _CYLINDER, "pressures of cylinders"))
    for key, number, (least, most), whose in numbers:
        if number is None or (number == 0.0 and not gas.absolute):
            continue
        if not least <= abs(number) <= most:
            yield (
                f"gas.{key}: {number / BAR:.3g} bar is outside {least / BAR:g} to {most / BAR:g} "
                f"bar, where {whose} lie; a bare number is in Pa"
            )


# Engines peak 5 to 20 degrees behind the firing dead centre, late diesels 30; a compressor delivers
# up to it: what counts is the nearest angle with all but 2 % of the peak.
_FAR = math.radians(45.0)
_NEARLY = 0.98


def _peak(scene: Scene) -> Iterator[str]:
    gas, pressures = scene.gas, list(dict.fromkeys(pressures_of(scene) or ()))
    if gas is None or isinstance(gas.pressure, float):
        return
    for number, pressure in enumerate(pressures, start=1):
        whose = "gas" if len(pressures) == 1 else f"gas, cylinder {number}"
        for said in _peak_of(gas, pressure):
            yield f"{whose}: {said}"


def _peak_of(gas: Gas, pressure: PeriodicPressure) -> Iterator[str]:
    angle, peak = pressure.peak
    yield from unlikely_peak(peak, gas.stroke)
    fired = gas.period / 2.0 if gas.stroke == 4 else 0.0
    around = np.add.outer(
        np.arange(fired, pressure.period, gas.period), np.linspace(-_FAR, _FAR, 361)
    )
    if peak > 0.0 and np.max(pressure(around)) < _NEARLY * peak:
        zero = ', and zero = "firing_tdc" where they count from there' if gas.stroke == 4 else ""
        yield (
            f"the pressure peaks at a cycle angle of {math.degrees(angle):.4g} degrees, far "
            f"from the firing dead centre at {math.degrees(fired):g}; check the table's angles"
            f"{zero}"
        )


_Rules = tuple[Callable[..., Iterator[str]], ...]
_OF_GEAR: _Rules = (_stroke, _bore, _masses, _light_masses, _rod_length, _offset, _fold, _rod)
_OF_SCENE: _Rules = (
    *(_inertia, _shells, bores_overlap, shells_overlap),
    *(_pressures, gaps, scatter, _peak, backwards, drives_on, pushes_on),
)
