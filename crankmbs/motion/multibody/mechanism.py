"""The mechanism of a scene, as a textbook lists it, and the same in exudyn, line by line.

Planar, in the engine's frame: X along the reference cylinder, Y is X turned by +90 degrees. The
order of bodies is that of the coordinates: x, y of the centre of mass [m] and the angle [rad], but
for point masses. That of hinges, then guides, is that of the multipliers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface

from crankmbs.mechanics.axes import closed_loops
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = [
    "Body",
    "Guide",
    "Hinge",
    "Mechanism",
    "add_body",
    "build",
    "closed",
    "marker",
    "mechanism_of",
]

exu: Any = exudyn  # its stubs are narrower than what it takes
eii: Any = itemInterface


class Body(NamedTuple):
    """Mass [kg] and moment of inertia about its centre of mass [kg m^2]; None: a point mass."""

    name: str
    mass: float
    inertia: float | None


class Hinge(NamedTuple):
    """Joins points of two bodies, x and y [m] in the axes of each; its force is on the second."""

    name: str
    bodies: tuple[str, str]
    points: tuple[tuple[float, float], tuple[float, float]]


class Guide(NamedTuple):
    """Keeps the distance [m] of a body from the crank axis along a normal."""

    name: str
    body: str
    normal: tuple[float, float]
    offset: float


class Mechanism(NamedTuple):
    """gravity [m/s^2]; bodies: the crank, then for each cylinder a rod and a piston."""

    gravity: tuple[float, float]
    bodies: tuple[Body, ...]
    hinges: tuple[Hinge, ...]
    guides: tuple[Guide, ...]


def mechanism_of(scene: Scene) -> Mechanism:
    """One crank that carries all throws; per cylinder a rod, a piston and the cylinder's wall.

    >>> [body.name for body in mechanism_of(load_scene("propeller")).bodies]
    ['crank', 'rod 1', 'piston 1']
    """
    crank, centre = scene.crank, scene.crank.center_of_mass
    inertia = max(crank.moment_of_inertia - crank.mass * centre**2, 0.0)
    bodies = [Body("crank", crank.mass, inertia)]
    hinges = [Hinge("main bearing", ("ground", "crank"), ((0.0, 0.0), (-centre, 0.0)))]
    guides = []
    for k, cylinder in enumerate(scene.cylinders, start=1):
        radius, rod, piston = scene.running_gear[k - 1]
        turn, a = cylinder.phase + cylinder.bank, rod.center_of_mass
        throw = radius * math.cos(turn) - centre, radius * math.sin(turn)
        big_end, small_end = (-a, 0.0), (rod.length - a, 0.0)
        bodies.append(Body(f"rod {k}", rod.mass, rod.moment_of_inertia))
        bodies.append(Body(f"piston {k}", piston.mass, None))
        hinges.append(Hinge(f"crank pin {k}", ("crank", f"rod {k}"), (throw, big_end)))
        points = small_end, (0.0, 0.0)
        hinges.append(Hinge(f"piston pin {k}", (f"rod {k}", f"piston {k}"), points))
        normal = -math.sin(cylinder.bank), math.cos(cylinder.bank)
        guides.append(Guide(f"wall {k}", f"piston {k}", normal, piston.offset))
    g, pull = scene.gravity, (0.0, 0.0)
    if g is not None:
        pull = g.acceleration * math.cos(g.angle), g.acceleration * math.sin(g.angle)
    return Mechanism(pull, tuple(bodies), tuple(hinges), tuple(guides))


def marker(system: Any, body: int, place: tuple[float, float] = (0.0, 0.0)) -> int:
    """A marker of exudyn on a body, at a place [m] in its axes."""
    item = eii.MarkerBodyPosition(bodyNumber=body, localPosition=[*place, 0.0])
    return int(system.AddMarker(item))


def add_body(system: Any, body: Body, gravity: tuple[float, float]) -> int:
    """Add a body with its weight and its node, which have the same number."""
    if body.inertia is None:
        node = system.AddNode(eii.NodePoint2D())
        item = eii.ObjectMassPoint2D(nodeNumber=node, mass=body.mass)
    else:
        node = system.AddNode(eii.NodeRigidBody2D())
        item = eii.ObjectRigidBody2D(nodeNumber=node, mass=body.mass, inertia=body.inertia)
    number = system.AddObject(item)
    centre = system.AddMarker(eii.MarkerBodyMass(bodyNumber=number))
    system.AddLoad(eii.Gravity(markerNumber=centre, loadVector=[*gravity, 0.0]))
    return int(number)


def build(
    mechanism: Mechanism,
    push: Callable[[int, float], list[float]] | None,
    torque: Callable[[float], float] | None,
) -> tuple[Any, Any]:
    """exudyn's container and system of a mechanism.

    push : force [N] on a piston, x, y and z, by its number and the solver's time [s]
    torque [N m] : on the crank, by the time; of both, None where there is none
    """
    container = exu.SystemContainer()
    system = container.AddSystem()
    system.AddNode(eii.NodePointGround())
    numbers = {"ground": int(system.AddObject(eii.ObjectGround()))}
    for body in mechanism.bodies:
        numbers[body.name] = add_body(system, body, mechanism.gravity)
    for hinge in mechanism.hinges:
        pairs = zip(hinge.bodies, hinge.points, strict=True)
        ends = [marker(system, numbers[name], point) for name, point in pairs]
        system.AddObject(eii.RevoluteJoint2D(markerNumbers=ends))
    for k, guide in enumerate(mechanism.guides):
        ends = [
            system.AddMarker(eii.MarkerNodeCoordinates(nodeNumber=numbers[name]))
            for name in ("ground", guide.body)
        ]
        wall = {"scalingMarker1": np.array([guide.normal]), "offset": [guide.offset]}
        system.AddObject(eii.CoordinateVectorConstraint(markerNumbers=ends, **wall))
        if push is not None:
            force = eii.LoadForceVector(
                markerNumber=marker(system, numbers[guide.body]),
                loadVectorUserFunction=lambda _, time, load, k=k: push(k, time),
            )
            system.AddLoad(force)
    if torque is not None:
        crank = eii.MarkerNodeCoordinate(nodeNumber=numbers["crank"], coordinate=2)
        turn = eii.LoadCoordinate(
            markerNumber=system.AddMarker(crank),
            loadUserFunction=lambda _, time, load: torque(time),
        )
        system.AddLoad(turn)
    return container, system


def closed(scene: Scene, theta: Array) -> Array:
    """Coordinates of all bodies on the closed loop at crank angles [rad], shape (m, q): the right
    one of the two ways in which a rod closes it."""
    centre, loop = scene.crank.center_of_mass * np.exp(1j * theta), closed_loops(scene, theta)
    columns = [centre.real, centre.imag, theta]
    for k, (cylinder, gear) in enumerate(zip(scene.cylinders, scene.running_gear, strict=True)):
        axis, a = np.exp(1j * cylinder.bank), gear.rod.center_of_mass
        throw = gear.radius * (loop.cos_phi[k] + 1j * loop.sin_phi[k])
        middle = axis * (throw + a * (loop.cos_beta[k] - 1j * loop.sin_beta[k]))
        pin = axis * (loop.x[k] + 1j * gear.piston.offset)
        columns += [middle.real, middle.imag, cylinder.bank - loop.beta[k], pin.real, pin.imag]
    return np.stack(columns, axis=-1)
