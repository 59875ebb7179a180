"""A plain exudyn script as a user writes it: bodies, joints, loads, sensors, solve."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface

from crankmbs.numerics.arrays import Array
from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.trace import Trace
from validation.speed.gas import gas_function
from validation.speed.job import Cylinder, Job

__all__ = ["exudyn_contenders"]

exu: Any = exudyn  # its stubs are narrower than what it takes
eii: Any = itemInterface
_KIND = exu.OutputVariableType
_STEPS_PER_TURN = (250.0, 500.0, 1000.0, 2000.0, 4000.0)


def exudyn_contenders(job: Job, reference: Trace) -> tuple[Contender, ...]:
    """The script with the settings it starts from, and with the best ones for this mechanism."""
    return tuple(
        Contender(
            name=f"exudyn script, {title}",
            knob="steps/rev",
            settings=_STEPS_PER_TURN,
            run=partial(_run, job, best),
            reference=reference,
        )
        for title, best in (("defaults", False), ("best settings", True))
    )


def _run(job: Job, best: bool, steps_per_turn: float) -> Answer:
    intervals = len(job.times) - 1
    steps = math.ceil(steps_per_turn * job.turns / intervals) * intervals
    container = exu.SystemContainer()
    mbs: Any = container.AddSystem()
    crank_node, crank, bearing = _add_crank(mbs, job)
    joints, guides = [bearing], []
    for cylinder in job.cylinders:
        crank_pin, piston_pin, guide = _add_cylinder(mbs, job, cylinder, crank_node, crank)
        joints += [crank_pin, piston_pin]
        guides.append(guide)

    stored = {"storeInternal": True, "writeToFile": False}
    sensors = [
        mbs.AddSensor(eii.SensorNode(nodeNumber=crank_node, outputVariableType=kind, **stored))
        for kind in (_KIND.Coordinates, _KIND.Coordinates_t)
    ]
    sensors += [
        mbs.AddSensor(eii.SensorObject(objectNumber=one, outputVariableType=_KIND.Force, **stored))
        for one in (*joints, *guides)
    ]
    mbs.Assemble()

    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime = job.end
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = job.end / intervals
    if best:
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.timeIntegration.adaptiveStep = False
        settings.timeIntegration.newton.useModifiedNewton = False
        settings.timeIntegration.newton.relativeTolerance = 1e-10
        settings.timeIntegration.newton.absoluteTolerance = 1e-12
        settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    before, exu.config.printToConsole = exu.config.printToConsole, False
    try:
        complete = mbs.SolveDynamic(settings)
    finally:
        exu.config.printToConsole = before
    if not complete:
        raise RuntimeError("its solver did not reach the end")

    tables = [mbs.GetSensorStoredData(sensor) for sensor in sensors]
    mbs.Reset()
    if not np.allclose(tables[0][:, 0], job.times, rtol=0.0, atol=1e-9 * job.end):
        raise RuntimeError("its sensors did not record the times asked for")
    return Answer(_trace(job, [table[:, 1:] for table in tables]), steps)


def _add_crank(mbs: Any, job: Job) -> tuple[int, int, int]:
    """The crank on its bearing under its loads: its node, its body and the joint."""
    throw, c = np.exp(1j * job.theta), job.crank_center
    node = mbs.AddNode(
        eii.NodeRigidBody2D(
            referenceCoordinates=[c * throw.real, c * throw.imag, job.theta],
            initialVelocities=[-c * throw.imag * job.omega, c * throw.real * job.omega, job.omega],
        )
    )
    central = job.crank_inertia - job.crank_mass * c**2
    crank = mbs.AddObject(
        eii.ObjectRigidBody2D(nodeNumber=node, mass=job.crank_mass, inertia=central)
    )
    _add_weight(mbs, job, crank)
    ground = mbs.AddObject(eii.ObjectGround())
    bearing = _add_joint(mbs, _marker(mbs, ground, 0.0), _marker(mbs, crank, -c))
    if job.has_torque:

        def torque(mbs: Any, t: float, load: list[float]) -> list[float]:
            omega = mbs.GetNodeOutput(node, _KIND.Coordinates_t)[2]
            return [0.0, 0.0, job.constant - (job.viscous + job.quadratic * abs(omega)) * omega]

        shaft = mbs.AddMarker(eii.MarkerNodeRigid(nodeNumber=node))
        mbs.AddLoad(eii.LoadTorqueVector(markerNumber=shaft, loadVectorUserFunction=torque))
    return node, crank, bearing


def _add_cylinder(
    mbs: Any, job: Job, cylinder: Cylinder, crank_node: int, crank: int
) -> tuple[int, int, int]:
    """A rod and a piston in its guide under weight and gas: crank pin, piston pin and guide."""
    (rod_at, rod_v), (piston_at, piston_v) = _placed(job, cylinder)
    node = mbs.AddNode(eii.NodeRigidBody2D(referenceCoordinates=rod_at, initialVelocities=rod_v))
    rod = mbs.AddObject(
        eii.ObjectRigidBody2D(nodeNumber=node, mass=job.rod_mass, inertia=job.rod_inertia)
    )
    node = mbs.AddNode(eii.NodePoint2D(referenceCoordinates=piston_at, initialVelocities=piston_v))
    piston = mbs.AddObject(eii.ObjectMassPoint2D(nodeNumber=node, mass=job.piston_mass))
    for body in (rod, piston):
        _add_weight(mbs, job, body)

    turn = cylinder.phase + cylinder.bank
    throw = job.radius * math.cos(turn) - job.crank_center, job.radius * math.sin(turn)
    crank_pin = _add_joint(mbs, _marker(mbs, crank, *throw), _marker(mbs, rod, -job.rod_center))
    pushed = _marker(mbs, piston, 0.0)
    small_end = _marker(mbs, rod, job.rod_length - job.rod_center)
    piston_pin = _add_joint(mbs, small_end, pushed)
    fixed = mbs.AddNode(eii.NodePointGround())
    axis = math.cos(cylinder.bank), math.sin(cylinder.bank)
    guide = mbs.AddObject(
        eii.CoordinateVectorConstraint(
            markerNumbers=[
                mbs.AddMarker(eii.MarkerNodeCoordinates(nodeNumber=each)) for each in (fixed, node)
            ],
            scalingMarker1=np.array([[-axis[1], axis[0]]]),
            offset=[job.offset],
        )
    )
    if job.has_gas:
        gas, begin = gas_function(cylinder), job.theta + cylinder.phase

        def push(mbs: Any, t: float, load: list[float]) -> list[float]:
            force = -gas(begin + mbs.GetNodeOutput(crank_node, _KIND.Coordinates)[2])
            return [force * axis[0], force * axis[1], 0.0]

        mbs.AddLoad(eii.LoadForceVector(markerNumber=pushed, loadVectorUserFunction=push))
    return crank_pin, piston_pin, guide


def _marker(mbs: Any, body: int, x: float, y: float = 0.0) -> int:
    return int(mbs.AddMarker(eii.MarkerBodyPosition(bodyNumber=body, localPosition=[x, y, 0])))


def _add_joint(mbs: Any, *markers: int) -> int:
    return int(mbs.AddObject(eii.RevoluteJoint2D(markerNumbers=list(markers))))


def _add_weight(mbs: Any, job: Job, body: int) -> None:
    marker = mbs.AddMarker(eii.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(eii.LoadMassProportional(markerNumber=marker, loadVector=[*job.gravity, 0]))


def _placed(job: Job, cylinder: Cylinder) -> tuple[tuple[list[float], list[float]], ...]:
    """Where rod and piston are at the start, and how fast they move."""
    phi, axis = job.theta + cylinder.phase, np.exp(1j * cylinder.bank)
    throw = job.radius * np.exp(1j * phi)
    beta = math.asin((throw.imag - job.offset) / job.rod_length)
    rate = -throw.real * job.omega / (job.rod_length * math.cos(beta))  # of the rod's angle
    along = np.exp(-1j * beta)
    found = []
    for length in (job.rod_center, job.rod_length):
        place = axis * (throw + length * along)
        speed = 1j * axis * (throw * job.omega + length * along * rate)
        found.append(([place.real, place.imag], [speed.real, speed.imag]))
    (rod_at, rod_v), piston = found
    return (([*rod_at, cylinder.bank - beta], [*rod_v, rate]), piston)


def _trace(job: Job, tables: list[Array]) -> Trace:
    """What the sensors recorded, each cylinder's forces in its axes."""
    turned, omega, main, *rest = tables
    n = len(job.cylinders)
    axes = np.exp(-1j * np.array([cylinder.bank for cylinder in job.cylinders]))
    pins = -np.stack([each[:, 0] + 1j * each[:, 1] for each in rest[: 2 * n]], axis=1)
    pins = pins.reshape(len(pins), n, 2) * axes[:, None]
    crank_pin, piston_pin = (
        np.stack([each.real, each.imag], axis=-1) for each in (pins[..., 0], pins[..., 1])
    )
    forces = {
        "main bearing": -main[:, :2],
        "crank pin": crank_pin,
        "piston pin": piston_pin,
        "side force": -np.stack([each[:, :1] for each in rest[2 * n :]], axis=1),
    }
    return Trace(job.times, job.theta + turned[:, 2], omega[:, 2], forces)
