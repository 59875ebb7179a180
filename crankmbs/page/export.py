"""A scene as the modules in JavaScript take it: numbers in SI units, arrays as base64 doubles.

Loads go as their parts, so that a new one needs no new JavaScript; pressures as their polynomials,
and besides as what these were made of, for when a knob changes the geometry.
"""

from __future__ import annotations

import base64
import json
import math
from typing import Any

import numpy as np

from crankmbs.mechanics.speed import speed_pieces
from crankmbs.mechanics.speed_over_angle import AngleLaw
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import gauss
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.page.gas import exported_gas
from crankmbs.scene.drives import Motion, Oscillation, SpeedFile
from crankmbs.scene.force import PistonForce
from crankmbs.scene.forces import TravelTable
from crankmbs.scene.fuel import Fuel, Misfire
from crankmbs.scene.parts import Piston, Rod, RunningGear
from crankmbs.scene.scene import Scene
from crankmbs.scene.speed_rows import over_angle, repeats
from crankmbs.scene.torque import Torque

__all__ = ["encoded", "exported", "machine", "rules"]

_STAGES = range(3, 10)  # of the Gauss rules that the passes take, and those that check them
_FRICTION = ("ring_force", "ring_pressure", "viscous")
_WINDOW = ("after", "until", "from_speed", "until_speed")


def exported(scene: Scene) -> dict[str, Any]:
    """What the engine of the page needs of a scene; arrays are still NumPy's (`encoded`).

    >>> exported(load_scene("propeller"))["crank"]["radius"]
    0.046
    """
    train = crank_train(scene)
    return {
        **machine(scene),
        "gas": exported_gas(scene, train),
        "loads": [_load(load) for load in scene.torque],
        "force": [_force(force) for force in scene.force],
        "fuel": None if scene.fuel is None else _fuel(scene.fuel),
        "period": scene.period,
        "periods": [scene.settled_period, scene.load_period, scene.period],
        "grid_period": _grid_period(scene, train),
        "start": None if scene.start is None else _fields(scene.start, "angle", "speed"),
        "motion": None if scene.motion is None else _motion(scene.motion),
        "run": _run(scene),
    }


def rules() -> dict[int, dict[str, Array]]:
    """The Gauss rules by their number of stages.

    >>> sorted(rules()[3])
    ['matrix', 'nodes', 'to_legendre', 'weights']
    """
    return {
        s: {
            "nodes": rule.nodes,
            "weights": rule.weights,
            "matrix": rule.matrix.ravel(),
            "to_legendre": rule.to_legendre.ravel(),
        }
        for s in _STAGES
        for rule in [gauss(s)]
    }


def encoded(value: object) -> str:
    """JSON that may stand inside a script: arrays as base64 doubles, no ``<``, no NaN; an array
    that comes again, as the number of the different ones before its first.

    >>> encoded([np.array([1.0]), np.array([1.0])])
    '[{"f64":"AAAAAAAA8D8="},{"again":0}]'
    """
    seen: dict[bytes, int] = {}

    def array(value: object) -> dict[str, str | int]:
        assert isinstance(value, np.ndarray)
        data = value.astype("<f8").tobytes()
        if data in seen:
            return {"again": seen[data]}
        seen[data] = len(seen)
        return {"f64": base64.b64encode(data).decode("ascii")}

    text = json.dumps(value, default=array, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def machine(scene: Scene) -> dict[str, Any]:
    """Crank, rods, pistons and cylinders as the modules in JavaScript take them, in SI units.

    >>> machine(load_scene("run_up"))["rod"]["length"]
    0.153333333333
    """
    crank, gravity, friction = scene.crank, scene.gravity, scene.friction
    return {
        "crank": {
            "inertia": crank.moment_of_inertia,
            **_fields(crank, "radius", "mass", "center_of_mass"),
        },
        "rod": _rod(scene.rod),
        "piston": _piston(scene.piston),
        "gravity": None if gravity is None else _fields(gravity, "acceleration", "angle"),
        "friction": None if friction is None else _fields(friction, *_FRICTION),
        "cylinders": [
            {**_fields(cylinder, "phase", "bank"), "own": _gear(gear) if scene.unlike else None}
            for cylinder, gear in zip(scene.cylinders, scene.running_gear, strict=True)
        ],
        "levers": None if scene.levers is None else list(scene.levers),
        "throws": _throws(scene),
    }


def _throws(scene: Scene) -> dict[str, Any] | None:
    """Of the crank's own mass, which throws with bearings share: its mean place along the crank
    [m], and what unbalances that are not alike rock beside it, [kg m2] at crank angle 0."""
    throws = scene.throws
    if throws is None or scene.levers is None:
        return None
    levers, unbalances = np.array(throws.levers), np.array(throws.unbalances)
    beside = complex(levers @ (unbalances - unbalances.mean()))
    return {"lever": float(levers.mean()), "couple": [beside.real, beside.imag]}


def _gear(gear: RunningGear) -> dict[str, Any]:
    return {"radius": gear.radius, "rod": _rod(gear.rod), "piston": _piston(gear.piston)}


def _rod(rod: Rod) -> dict[str, Any]:
    return {"inertia": rod.moment_of_inertia, **_fields(rod, "length", "mass", "center_of_mass")}


def _piston(piston: Piston) -> dict[str, Any]:
    return {"area": piston.gas_area, **_fields(piston, "mass", "offset", "crank_end_share")}


def _fields(part: object, *names: str) -> dict[str, Any]:
    return {name: getattr(part, name) for name in names}


def _load(load: Torque) -> dict[str, Any]:
    over_time, over_speed, over_angle, _ = load.parts
    return {
        "over_time": None if over_time is None else _pieces(over_time),
        "over_speed": None if over_speed is None else _pieces(over_speed),
        "over_angle": None if over_angle is None else _cycle(over_angle),
        **_fields(load, *_WINDOW),
    }


def _force(force: PistonForce) -> dict[str, Any]:
    law = force.law
    return {
        "forward": None if law.forward is None else _lines(law.forward),
        "back": _lines(law.back) if law.back is not None and law.switches else None,
        "over_angle": None if law.over_angle is None else _cycle(law.over_angle),
        "rows": list(force.file.x) if isinstance(force, TravelTable) else None,
        **_fields(force, "cylinder"),
        **_fields(law, "viscous"),
    }


def _lines(function: Piecewise) -> dict[str, Any]:
    return {**_pieces(function), "jumps": list(function.jumps)}


def _pieces(function: Piecewise) -> dict[str, Array]:
    knots, pieces = function.arrays
    return {"knots": knots, "pieces": pieces.ravel()}


def _cycle(cycle: Cycle) -> dict[str, Array]:
    return {"knots": cycle.knots, "coefficients": cycle.coefficients.ravel()}


def _fuel(fuel: Fuel) -> dict[str, Any]:
    misfires = [_misfire(each) for each in fuel.misfire or ()]
    return {"misfire": misfires, **_fields(fuel, *_WINDOW)}


def _misfire(misfire: Misfire) -> dict[str, Any]:
    first, last, every = misfire.bounds
    return {"cylinder": misfire.cylinder, "first": first, "last": last, "every": every}


def _grid_period(scene: Scene, train: CrankTrain) -> float:
    """Over which the cells repeat [rad]: what settles does so over a multiple of all periods."""
    return scene.settled_period if scene.settles else train.period


def _motion(motion: Motion) -> dict[str, Any]:
    speed = motion.speed
    if isinstance(speed, Oscillation):
        swing = _fields(speed, "mean", "amplitude", "order", "phase")
        return {"kind": "oscillation", "angle": motion.angle, **swing}
    if isinstance(speed, SpeedFile) and speed.kind == "angle_table":
        return _over_angle(motion.angle, speed)
    pieces = speed_pieces(speed)
    cubics = np.zeros((4, pieces.c.shape[1]))
    cubics[4 - len(pieces.c) :] = pieces.c
    return {
        "kind": "polynomial",
        "angle": motion.angle,
        "knots": pieces.x,
        "coefficients": cubics.ravel(),
    }


def _over_angle(start: float, speed: SpeedFile) -> dict[str, Any]:
    knots, coefficients = over_angle(speed.file, speed.interpolation)
    law = AngleLaw(knots, coefficients, start, repeats=repeats(speed.file))
    return {
        "kind": "over_angle",
        "angle": start,
        "repeats": repeats(speed.file),
        "knots": knots,
        "coefficients": coefficients.ravel(),
        "nodes": law.rule.nodes,
        "weights": law.rule.weights,
        **law.panels._asdict(),
    }


def _run(scene: Scene) -> dict[str, Any]:
    until, in_time = scene.end
    every, over_time = math.radians(1.0), False
    if scene.run.every is not None:
        every, over_time = scene.run.every.resolve(scene.period)
    return {
        "until": until,
        "in_time": in_time,
        "settled": scene.settles,
        "every": every,
        "every_in_time": over_time,
    }
