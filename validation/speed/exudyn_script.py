"""A plain exudyn script as a user writes it: bodies, joints, loads, sensors, solve."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.trace import Trace
from validation.speed.gas import gas_function
from validation.speed.job import Job

__all__ = ["exudyn_contenders"]

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
    import exudyn as exu
    import exudyn.itemInterface as items

    eii: Any = items  # its stubs take no Python function for a load
    intervals = len(job.times) - 1
    steps = math.ceil(steps_per_turn * job.turns / intervals) * intervals
    gas = gas_function(job)

    # where everything stands, and how fast it moves, at the start
    r, l, a, c = job.radius, job.rod_length, job.rod_center, job.crank_center
    sine, cosine = math.sin(job.theta), math.cos(job.theta)
    beta = math.asin((r * sine - job.offset) / l)
    turning = r * cosine * job.omega / (l * math.cos(beta))
    sb, cb = math.sin(beta), math.cos(beta)
    u, v = -r * sine * job.omega, r * cosine * job.omega

    container = exu.SystemContainer()
    mbs: Any = container.AddSystem()
    ground = mbs.AddObject(eii.ObjectGround())
    crank_node = mbs.AddNode(
        eii.NodeRigidBody2D(
            referenceCoordinates=[c * cosine, c * sine, job.theta],
            initialVelocities=[-c * sine * job.omega, c * cosine * job.omega, job.omega],
        )
    )
    rod_node = mbs.AddNode(
        eii.NodeRigidBody2D(
            referenceCoordinates=[r * cosine + a * cb, r * sine - a * sb, -beta],
            initialVelocities=[u - a * sb * turning, v - a * cb * turning, -turning],
        )
    )
    piston_node = mbs.AddNode(
        eii.NodePoint2D(
            referenceCoordinates=[r * cosine + l * cb, job.offset],
            initialVelocities=[u - l * sb * turning, 0.0],
        )
    )
    central = job.crank_inertia - job.crank_mass * c**2
    crank = mbs.AddObject(
        eii.ObjectRigidBody2D(nodeNumber=crank_node, mass=job.crank_mass, inertia=central)
    )
    rod = mbs.AddObject(
        eii.ObjectRigidBody2D(nodeNumber=rod_node, mass=job.rod_mass, inertia=job.rod_inertia)
    )
    piston = mbs.AddObject(eii.ObjectMassPoint2D(nodeNumber=piston_node, mass=job.piston_mass))

    def at(body: int, x: float) -> int:
        return int(mbs.AddMarker(eii.MarkerBodyPosition(bodyNumber=body, localPosition=[x, 0, 0])))

    piston_marker = at(piston, 0.0)
    pairs = [
        (at(ground, 0.0), at(crank, -c)),
        (at(crank, r - c), at(rod, -a)),
        (at(rod, l - a), piston_marker),
    ]
    joints = [mbs.AddObject(eii.RevoluteJoint2D(markerNumbers=list(pair))) for pair in pairs]
    fixed = mbs.AddNode(eii.NodePointGround())
    zero, lateral = (
        mbs.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        for node, coordinate in ((fixed, 0), (piston_node, 1))
    )
    guide = mbs.AddObject(eii.ObjectConnectorCoordinate(markerNumbers=[zero, lateral]))

    for body in (crank, rod, piston):
        marker = mbs.AddMarker(eii.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(eii.LoadMassProportional(markerNumber=marker, loadVector=[*job.gravity, 0]))

    def gas_load(mbs: Any, t: float, load: list[float]) -> list[float]:
        turned = mbs.GetNodeOutput(crank_node, exu.OutputVariableType.Coordinates)[2]
        return [-gas(job.theta + turned), 0.0, 0.0]

    def torque_load(mbs: Any, t: float, load: list[float]) -> list[float]:
        omega = mbs.GetNodeOutput(crank_node, exu.OutputVariableType.Coordinates_t)[2]
        return [0.0, 0.0, job.constant - (job.viscous + job.quadratic * abs(omega)) * omega]

    if job.has_gas:
        mbs.AddLoad(
            eii.LoadForceVector(markerNumber=piston_marker, loadVectorUserFunction=gas_load)
        )
    if job.has_torque:
        shaft = mbs.AddMarker(eii.MarkerNodeRigid(nodeNumber=crank_node))
        mbs.AddLoad(eii.LoadTorqueVector(markerNumber=shaft, loadVectorUserFunction=torque_load))

    forces = [
        mbs.AddSensor(
            eii.SensorObject(
                objectNumber=joint,
                outputVariableType=exu.OutputVariableType.Force,
                storeInternal=True,
                writeToFile=False,
            )
        )
        for joint in (*joints, guide)
    ]
    states = [
        mbs.AddSensor(
            eii.SensorNode(
                nodeNumber=crank_node,
                outputVariableType=kind,
                storeInternal=True,
                writeToFile=False,
            )
        )
        for kind in (exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t)
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

    stored = [mbs.GetSensorStoredData(sensor) for sensor in (*states, *forces)]
    mbs.Reset()
    if not np.allclose(stored[0][:, 0], job.times, rtol=0.0, atol=1e-9 * job.end):
        raise RuntimeError("its sensors did not record the times asked for")
    turned, omega, *reactions = (table[:, 1:] for table in stored)
    main, crank_pin, piston_pin, side = (-values[:, :2] for values in reactions)
    names = ("main bearing", "crank pin", "piston pin", "side force")
    trace = Trace(
        job.times,
        job.theta + turned[:, 2],
        omega[:, 2],
        dict(zip(names, (main, crank_pin, piston_pin, side), strict=True)),
    )
    return Answer(trace, steps)
