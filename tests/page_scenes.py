"""Scenes that tests of the page share: shortened, settled, altered, fuelled."""

import math
from dataclasses import replace

from crankmbs import InputError, load_scene, shipped_scenes
from crankmbs.scene.fuel import Fuel, Misfire
from crankmbs.scene.gas import Polytrope
from crankmbs.scene.run import Extent

SETTLING = ("propeller", "v_twin", "yi_diesel_free")
FILMS = ("run_up", "run_down", "torque_driven")  # replayed, as `test_page_film` holds
SHOWN = tuple(name for name in shipped_scenes() if name not in FILMS)


def shortened(scene, cycles=3.0):
    """A run that shows all of it in a fraction of the time."""
    until = Extent(value=cycles, unit="cycle")
    return replace(scene, run=replace(scene.run, until=until))


def sampled(scene, degrees):
    every = Extent(value=math.radians(degrees), unit="rad")
    return replace(scene, run=replace(scene.run, every=every))


def settled(name):
    scene = load_scene(name)
    return replace(scene, run=replace(scene.run, until="settled"))


def altered(scene, length=1.0, offset=0.0, radius=1.0):
    crank = replace(scene.crank, radius=scene.crank.radius * radius)
    piston = replace(scene.piston, offset=scene.piston.offset + offset)
    rod = replace(scene.rod, length=scene.rod.length * length)
    return replace(scene, crank=crank, rod=rod, piston=piston)


def fuelled(name, **gas):
    scene = load_scene(name)
    return replace(scene, gas=replace(scene.gas, **gas), fuel=Fuel(misfire=(MISFIRE,)))


MISFIRE = Misfire(cylinder=1, cycles="every 3")
POLYTROPE = Polytrope(polytrope=1.32, closes=math.radians(-20.0), compression_ratio=18.0)


def refused(makes, *arguments):
    """The sentence in which something is refused, if it is."""
    try:
        makes(*arguments)
    except InputError as error:
        return str(error)
    return ""
