"""A crank train as MuJoCo's bodies: the crank on a hinge, the rods on hinges of the crank, the
pistons on slides.

The pin at the end of each rod is held on its piston exactly, by multipliers:

    [M  -J'] [qacc  ]   [applied - bias]
    [J   0 ] [lambda] = [-dJ/dt qvel   ]

with M, bias, J and dJ/dt of MuJoCo, J the Jacobian of the rod's end less that of the piston's pin.
The multipliers are the forces in the piston pins; those in crank pins and main bearing are what
MuJoCo finds between the bodies under them.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from validation.oracles.machine import Machine

__all__ = ["Bodies", "Turned"]

Floats = NDArray[np.float64]

_CLOSED = 1e-15  # of the largest throw and rod: corrections so small end Newton's method
_CORRECTIONS = 12
_NEAR = 0.2  # rad: from so near the last state leads to the next
_LEAST = 1e-14  # kg, kg m2: MuJoCo's compiler takes no body without mass and inertia
_ALMOST_NONE = 1e-30  # kg, kg m2: what a body without has instead
_MODEL = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="{gx!r} {gy!r} 0"><flag contact="disable" constraint="disable"/></option>
  <worldbody>
    <body name="crank">
      <joint type="hinge" axis="0 0 1"/>
      <inertial pos="{center!r} 0 0" mass="{mass!r}" diaginertia="{inertia} {inertia} {inertia}"/>
{rods}    </body>
{pistons}  </worldbody>
</mujoco>
"""
_ROD = """      <body name="rod {k}" pos="{x!r} {y!r} 0">
        <joint type="hinge" axis="0 0 1"/>
        <inertial pos="{center!r} 0 0" mass="{mass!r}" diaginertia="{inertia} {inertia} {inertia}"/>
        <site name="end {k}" pos="{length!r} 0 0"/>
      </body>
"""
_PISTON = """    <body name="piston {k}" pos="{x!r} {y!r} 0">
      <joint type="slide" axis="{along!r} {across!r} 0"/>
      <inertial pos="0 0 0" mass="{mass!r}" diaginertia="1 1 1"/>
      <site name="pin {k}"/>
    </body>
"""


class Turned(NamedTuple):
    """What MuJoCo's bodies do at a crank angle and speed.

    alpha [rad/s2]; main_bearing [N] on the crank, engine's X and Y, shape (2,)

    Of each cylinder, in its own X and Y, shape (n,): position of the pin [m], away from the crank,
    with velocity [m/s] and acceleration [m/s2]; rod_acceleration [rad/s2], counter-clockwise;
    crank_pin on the rod and piston_pin on the piston [N], shape (n, 2); side [N], wall on piston.
    """

    alpha: float
    main_bearing: Floats
    position: Floats
    velocity: Floats
    acceleration: Floats
    rod_acceleration: Floats
    crank_pin: Floats
    piston_pin: Floats
    side: Floats


class Bodies:
    """MuJoCo's model of a machine, and the state that it stands in."""

    def __init__(self, machine: Machine) -> None:
        import mujoco

        self.engine: Any = mujoco
        self.model: Any = mujoco.MjModel.from_xml_string(_xml(machine))
        self.data: Any = mujoco.MjData(self.model)
        n = self.count = len(machine.cylinders)
        self.banks = np.array([float(bank) for _, bank in machine.cylinders])
        self.bodies = [
            [self.model.body(f"{part} {k}").id for part in ("rod", "piston")] for k in range(n)
        ]
        self.sites = [
            [self.model.site(f"{place} {k}").id for place in ("end", "pin")] for k in range(n)
        ]
        each = [machine.of(k) for k in range(n)]
        for pair, m in zip(self.bodies, each, strict=True):
            masses = [(m.rod_mass, m.rod_inertia), (m.piston_mass, 1.0)]
            for body, (mass, inertia) in zip(pair, masses, strict=True):
                self.model.body_mass[body] = max(float(mass), _ALMOST_NONE)
                self.model.body_inertia[body] = max(float(inertia), _ALMOST_NONE)
        self.reach = np.array([float(m.crank_radius) + float(m.rod_length) for m in each])
        self.rates = np.eye(1 + 2 * n)[0]  # of all coordinates, per crank angle
        self.jacobian = np.zeros((2 * n, 1 + 2 * n))
        self.last = math.inf  # the crank angle of the state

    def velocities(self, theta: float) -> Floats:
        """Of the pistons away from the crank, per crank angle [m], shape (n,)."""
        self._close(theta)
        rates: Floats = self.rates[1 + self.count :]
        return rates

    def alpha(self, theta: float, omega: float, forces: list[float], torque: float) -> float:
        """The crank's acceleration [rad/s2] under forces on the pistons towards the crank [N] and a
        torque on the crank [N m]."""
        return float(self._solve(theta, omega, forces, torque)[0])

    def turned(self, theta: float, omega: float, forces: list[float], torque: float) -> Turned:
        """The same with all motions and forces."""
        n, data = self.count, self.data
        found = self._solve(theta, omega, forces, torque)
        data.qacc[:] = found[: 1 + 2 * n]
        on_rods = found[1 + 2 * n :].reshape(n, 2)
        data.xfrc_applied[:] = 0.0
        for pair, sites, force in zip(self.bodies, self.sites, on_rods, strict=True):
            for body, site, sign in zip(pair, sites, (1.0, -1.0), strict=True):
                arm = data.site_xpos[site] - data.xipos[body]
                moment = arm[0] * force[1] - arm[1] * force[0]
                data.xfrc_applied[body, [0, 1, 5]] = sign * np.append(force, moment)
        self.engine.mj_rnePostConstraint(self.model, data)
        between = data.cfrc_int[:, 3:5]
        rods, pistons = np.array(self.bodies).T
        return Turned(
            alpha=float(found[0]),
            main_bearing=between[1].copy(),
            position=data.qpos[1 + n :].copy(),
            velocity=data.qvel[1 + n :].copy(),
            acceleration=found[1 + n : 1 + 2 * n],
            rod_acceleration=found[0] + found[1 : 1 + n],
            crank_pin=self._own(between[rods]),
            piston_pin=self._own(-on_rods),
            side=self._own(between[pistons])[:, 1],
        )

    def _solve(self, theta: float, omega: float, forces: list[float], torque: float) -> Floats:
        """Accelerations of all coordinates and multipliers."""
        model, data, engine, n = self.model, self.data, self.engine, self.count
        self._close(theta)
        data.qvel[:] = self.rates * omega
        engine.mj_forward(model, data)
        size = 1 + 2 * n
        matrix, right = np.zeros((size + 2 * n, size + 2 * n)), np.zeros(size + 2 * n)
        for k, unit in enumerate(np.eye(size)):
            engine.mj_mulM(model, data, matrix[k, :size], unit)
        drift, rate = np.zeros(2 * n), np.zeros((3, size))
        for k, (bodies, sites) in enumerate(zip(self.bodies, self.sites, strict=True)):
            for body, site, sign in zip(bodies, sites, (1.0, -1.0), strict=True):
                engine.mj_jacDot(model, data, rate, None, data.site_xpos[site], body)
                drift[2 * k : 2 * k + 2] += sign * (rate[:2] @ data.qvel)
        matrix[:size, size:], matrix[size:, :size] = -self.jacobian.T, self.jacobian
        right[:size] -= data.qfrc_bias
        right[0] += torque
        right[1 + n : size] -= forces
        right[size:] = -drift
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)

    def _close(self, theta: float) -> None:
        """Rods and pistons at a crank angle, and their rates, by Newton's method on MuJoCo's sites
        and their Jacobians."""
        if theta == self.last:
            return
        data, n = self.data, self.count
        far = not abs(theta - self.last) < _NEAR
        data.qpos[:] = data.qpos + (0.0 if far else theta - self.last) * self.rates
        data.qpos[0] = theta
        if far:  # every rod along its cylinder
            data.qpos[1 : 1 + n] = self.banks - theta
            data.qpos[1 + n :] = self.reach
        for _ in range(_CORRECTIONS):
            self.engine.mj_kinematics(self.model, data)
            self.engine.mj_comPos(self.model, data)
            self.jacobian = self._jacobian()
            ends, pins = data.site_xpos[self.sites].transpose(1, 0, 2)[..., :2]
            right = np.stack([(ends - pins).ravel(), self.jacobian[:, 0]], axis=1)
            correction, rates = np.linalg.solve(self.jacobian[:, 1:], right).T
            if np.abs(correction[n:]).max() < _CLOSED * self.reach.max():
                break
            data.qpos[1:] -= correction
        self.rates[1:] = -rates
        self.last = theta

    def _jacobian(self) -> Floats:
        """Of the rods' ends less the pistons' pins, shape (2 n, 1 + 2 n)."""
        n = self.count
        found, one = np.zeros((2 * n, 1 + 2 * n)), np.zeros((3, 1 + 2 * n))
        for k, sites in enumerate(self.sites):
            for site, sign in zip(sites, (1.0, -1.0), strict=True):
                self.engine.mj_jacSite(self.model, self.data, one, None, site)
                found[2 * k : 2 * k + 2] += sign * one[:2]
        return found

    def _own(self, vectors: Floats) -> Floats:
        """From the engine's X and Y to each cylinder's, shape (n, 2)."""
        c, s = np.cos(self.banks), np.sin(self.banks)
        x, y = vectors.T
        return np.stack([c * x + s * y, c * y - s * x], axis=1)


def _xml(machine: Machine) -> str:
    center, mass = float(machine.crank_center_of_mass), float(machine.crank_mass)
    rods, pistons = "", ""
    for k, (phase, bank) in enumerate(machine.cylinders):
        own, throw = machine.of(k), float(phase) + float(bank)
        radius, offset = float(own.crank_radius), float(own.offset)
        c, s = math.cos(bank), math.sin(bank)
        rods += _ROD.format(
            k=k,
            x=radius * math.cos(throw),
            y=radius * math.sin(throw),
            center=float(own.rod_center_of_mass),
            mass=max(float(own.rod_mass), _LEAST),
            inertia=repr(max(float(own.rod_inertia), _LEAST)),
            length=float(own.rod_length),
        )
        pistons += _PISTON.format(
            k=k,
            x=-offset * s,
            y=offset * c,
            along=c,
            across=s,
            mass=max(float(own.piston_mass), _LEAST),
        )
    gx, gy = (float(one) for one in machine.gravity)
    central = max(float(machine.crank_inertia) - mass * center**2, _LEAST)
    return _MODEL.format(
        gx=gx,
        gy=gy,
        center=center,
        mass=max(mass, _LEAST),
        inertia=repr(central),
        rods=rods,
        pistons=pistons,
    )
