"""MuJoCo: crank and rod on hinges, the piston on a slide, the loop closed by a constraint."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.trace import Trace
from validation.speed.gas import gas_function
from validation.speed.job import Job

__all__ = ["mujoco_contenders"]

_STEPS_PER_TURN = (250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0)

# The constraint as hard as it pays here: its time constant is a 400th of a revolution, but at least
# two steps, and its impedance the largest that MuJoCo takes. A harder one errs more.
_HARDNESS = 400.0
_MODEL = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="{step!r}" gravity="{gx!r} {gy!r} 0" integrator="RK4" tolerance="1e-14">
    <flag contact="disable"/>
  </option>
  <worldbody>
    <body name="crank">
      <joint type="hinge" axis="0 0 1"/>
      <inertial pos="{c!r} 0 0" mass="{crank!r}" diaginertia="{central!r} {central!r} {central!r}"/>
      <body name="rod" pos="{r!r} 0 0">
        <joint type="hinge" axis="0 0 1"/>
        <inertial pos="{a!r} 0 0" mass="{rod!r}" diaginertia="{turn!r} {turn!r} {turn!r}"/>
        <site name="rod_end" pos="{l!r} 0 0"/>
      </body>
    </body>
    <body name="piston" pos="0 {e!r} 0">
      <joint type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="{piston!r}" diaginertia="1 1 1"/>
      <site name="pin"/>
    </body>
  </worldbody>
  <equality>
    <connect site1="rod_end" site2="pin" solref="{slack!r} 1" solimp="0.9999 0.9999 0.001"/>
  </equality>
</mujoco>
"""


def mujoco_contenders(job: Job, reference: Trace) -> tuple[Contender, ...]:
    """RK4 with the hardest constraint."""
    import mujoco  # noqa: F401  its absence is to be known before anything runs

    gas = gas_function(job.alone)
    return (
        Contender(
            name="MuJoCo, RK4",
            knob="steps/rev",
            settings=_STEPS_PER_TURN,
            run=partial(_run, job, gas),
            reference=reference,
        ),
    )


def _run(job: Job, gas: Callable[[float], float], steps_per_turn: float) -> Answer:
    import mujoco

    intervals = len(job.times) - 1
    per_sample = math.ceil(steps_per_turn * job.turns / intervals)
    step = job.end / (per_sample * intervals)
    model: Any = mujoco.MjModel.from_xml_string(_xml(job, step))
    data: Any = mujoco.MjData(model)
    _start(job, data)

    def push(model: Any, data: Any) -> None:
        theta, omega = data.qpos[0], data.qvel[0]
        data.qfrc_applied[0] = job.constant - (job.viscous + job.quadratic * abs(omega)) * omega
        data.qfrc_applied[2] = -gas(theta)

    crank, rod, piston = 1, 2, 3  # the world is body 0
    rows = []
    mujoco.set_mjcb_control(push if job.has_gas or job.has_torque else None)
    try:
        for _ in job.times:
            mujoco.mj_forward(model, data)
            mujoco.mj_rnePostConstraint(model, data)
            force = data.cfrc_int[:, 3:5]
            side = force[piston, 1]
            pin = job.piston_mass * (data.qacc[2] - job.gravity[0]) - data.qfrc_applied[2]
            rows.append(
                [
                    *(data.qpos[0], data.qvel[0], *force[crank], *force[rod]),
                    *(pin, -side - job.piston_mass * job.gravity[1], side),
                ]
            )
            mujoco.mj_step(model, data, nstep=per_sample)
    finally:
        mujoco.set_mjcb_control(None)
    table = np.array(rows)
    forces = {
        "main bearing": table[:, 2:4],
        "crank pin": table[:, 4:6],
        "piston pin": table[:, 6:8],
        "side force": table[:, 8:9],
    }
    evaluations = 4 * per_sample * intervals
    return Answer(Trace(job.times, table[:, 0], table[:, 1], forces), evaluations)


def _xml(job: Job, step: float) -> str:
    gx, gy = job.gravity
    return _MODEL.format(
        step=step,
        slack=max(2.0 * step, job.end / job.turns / _HARDNESS),
        gx=gx,
        gy=gy,
        c=job.crank_center,
        crank=job.crank_mass,
        central=job.crank_inertia - job.crank_mass * job.crank_center**2,
        r=job.radius,
        a=job.rod_center,
        rod=job.rod_mass,
        turn=job.rod_inertia,
        l=job.rod_length,
        e=job.offset,
        piston=job.piston_mass,
    )


def _start(job: Job, data: Any) -> None:
    r, l = job.radius, job.rod_length
    sine, cosine = math.sin(job.theta), math.cos(job.theta)
    beta = math.asin((r * sine - job.offset) / l)
    turning = r * cosine * job.omega / (l * math.cos(beta))
    data.qpos[:] = job.theta, -beta - job.theta, r * cosine + l * math.cos(beta)
    data.qvel[:] = (
        job.omega,
        -turning - job.omega,
        -r * sine * job.omega - l * math.sin(beta) * turning,
    )
