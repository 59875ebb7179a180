"""The rigid bodies of a scene, their joints and their sensors, as exudyn wants them.

One crank on a revolute joint; per cylinder a rod, a piston as a point mass, two revolute joints
and a constraint that keeps the piston on the cylinder axis. Only this file and the next, the
model, import exudyn.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface

from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Assembly"]

exu: Any = exudyn  # its stubs are narrower than what it takes
items: Any = itemInterface


class Assembly:
    """Adds the parts of a scene to a system, in the order of the coordinates of a `Start`.

    sensors : exudyn's sensor numbers by what they record, body by body or joint by joint
    """

    def __init__(self, system: Any, scene: Scene, reference: Array) -> None:
        self.sensors: dict[str, list[Any]] = {}
        self._system, self._scene = system, scene
        self._ground = system.AddObject(items.ObjectGround())
        self._still = system.AddNode(items.NodePointGround())
        self._crank, self._pistons = self._bodies(reference)

    def drive(self, angle: Callable[[float], float]) -> None:
        """Prescribe the crank's rotation from the reference [rad] over the solver's time [s]."""
        markers = [self._coordinate(self._still, 0), self._coordinate(self._crank, 2)]
        constraint = items.CoordinateConstraint(
            markerNumbers=markers, offsetUserFunction=lambda _, time, item, offset: angle(time)
        )
        self._observe_force("drive", self._system.AddObject(constraint))

    def load(self, torque: Callable[[float], float]) -> None:
        """Put a torque [N m] over the solver's time [s] on the crank."""
        self._force(self._crank, 2, torque)

    def push(self, cylinder: int, force: Callable[[], float]) -> None:
        """Push a piston towards the crank with a force [N]."""
        bank = self._scene.cylinders[cylinder].bank
        for coordinate, share in enumerate((-math.cos(bank), -math.sin(bank))):
            if abs(share) > 1e-15:
                self._force(self._pistons[cylinder], coordinate, _share(share, force))

    def _bodies(self, reference: Array) -> tuple[Any, list[Any]]:
        crank, rod = self._scene.crank, self._scene.rod
        centre, a = crank.center_of_mass, rod.center_of_mass
        own = max(crank.moment_of_inertia - crank.mass * centre**2, 0.0)
        crank_node, body = self._rigid(reference[:3], crank.mass, own)
        self._revolute("bearing", (self._ground, 0.0), (body, -centre))
        pistons = []
        for k, cylinder in enumerate(self._scene.cylinders):
            at = 3 + 5 * k
            throw = crank.radius * np.exp(1j * (cylinder.phase + cylinder.bank)) - centre
            _, bar = self._rigid(reference[at : at + 3], rod.mass, rod.moment_of_inertia)
            node, mass = self._point(reference[at + 3 : at + 5], self._scene.piston.mass)
            self._revolute("crank_pin", (body, throw), (bar, -a))
            self._revolute("piston_pin", (bar, rod.length - a), (mass, 0.0))
            self._guide(node, cylinder.bank)
            pistons.append(node)
        return crank_node, pistons

    def _rigid(self, reference: Array, mass: float, inertia: float) -> tuple[Any, Any]:
        node = self._system.AddNode(items.NodeRigidBody2D(referenceCoordinates=reference))
        body = items.ObjectRigidBody2D(nodeNumber=node, mass=mass, inertia=inertia)
        return node, self._observed(node, body)

    def _point(self, reference: Array, mass: float) -> tuple[Any, Any]:
        node = self._system.AddNode(items.NodePoint2D(referenceCoordinates=reference))
        return node, self._observed(node, items.ObjectMassPoint2D(nodeNumber=node, mass=mass))

    def _observed(self, node: Any, item: Any) -> Any:
        """Add a body with its sensors and its weight."""
        body = self._system.AddObject(item)
        kinds = exu.OutputVariableType
        for name, kind in (
            ("position", kinds.Coordinates),
            ("velocity", kinds.Coordinates_t),
            ("acceleration", kinds.Coordinates_tt),
        ):
            self._observe(name, items.SensorNode(nodeNumber=node, outputVariableType=kind))
        gravity = self._scene.gravity
        if gravity is not None:
            g = gravity.acceleration * np.exp(1j * gravity.angle)
            marker = self._system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
            self._system.AddLoad(items.Gravity(markerNumber=marker, loadVector=[g.real, g.imag, 0]))
        return body

    def _observe_force(self, name: str, joint: Any) -> None:
        force = exu.OutputVariableType.Force
        self._observe(name, items.SensorObject(objectNumber=joint, outputVariableType=force))

    def _observe(self, name: str, sensor: Any) -> None:
        sensor.storeInternal, sensor.writeToFile = True, False
        self.sensors.setdefault(name, []).append(self._system.AddSensor(sensor))

    def _revolute(self, name: str, *ends: tuple[Any, complex]) -> None:
        markers = [
            self._system.AddMarker(
                items.MarkerBodyPosition(bodyNumber=body, localPosition=[z.real, z.imag, 0.0])
            )
            for body, z in ends
        ]
        joint = self._system.AddObject(items.RevoluteJoint2D(markerNumbers=markers))
        self._observe_force(name, joint)

    def _guide(self, piston: Any, bank: float) -> None:
        """Keep a piston at the offset from the axis of its cylinder."""
        markers = [
            self._system.AddMarker(items.MarkerNodeCoordinates(nodeNumber=node))
            for node in (self._still, piston)
        ]
        constraint = items.CoordinateVectorConstraint(
            markerNumbers=markers,
            scalingMarker1=np.array([[-math.sin(bank), math.cos(bank)]]),
            offset=[self._scene.piston.offset],
        )
        self._observe_force("side", self._system.AddObject(constraint))

    def _force(self, node: Any, coordinate: int, force: Callable[[float], float]) -> None:
        load = items.LoadCoordinate(
            markerNumber=self._coordinate(node, coordinate),
            loadUserFunction=lambda _, time, value: force(time),
        )
        self._system.AddLoad(load)

    def _coordinate(self, node: Any, coordinate: int) -> Any:
        marker = items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate)
        return self._system.AddMarker(marker)


def _share(share: float, force: Callable[[], float]) -> Callable[[float], float]:
    return lambda time: share * force()
