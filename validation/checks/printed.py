"""Numbers that books, test sets and other programs print, by the method by which they got them."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from crankmbs import lecture
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.scene.loads import Constant
from crankmbs.scene.scene import Scene
from validation import reference
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.ode45 import Vector, ode45
from validation.runs import run

__all__ = ["departure", "elongated_rod", "integration", "largest_speed", "piston_forces"]


def largest_speed(case: Case) -> Outcome:
    """Khurmi 15.3: where the truncated acceleration is zero, and the truncated speed there."""
    scene = case.ours()
    given = {**_geometry(scene), "omega": _speed(scene)}

    def acceleration(degrees: float) -> float:
        return float(lecture.piston_acceleration_series(np.radians(degrees), **given))

    degrees = float(brentq(acceleration, 60.0, 90.0, xtol=1e-10))
    fastest = lecture.piston_velocity_series(np.radians(round(degrees)), **given)
    return _against(
        case, {"crank_angle_of_largest_speed": degrees, "largest_piston_speed": float(fastest)}
    )


def piston_forces(case: Case) -> Outcome:
    """Khurmi 15.7: forces from the truncated acceleration, through the rod at its exact angle.

    By hand with the angular speed and the gas force that are printed, and the torque from the
    tangential force as it is printed.
    """
    scene, degrees = case.ours(), case.number("crank_angle")
    geometry, by_hand = _geometry(scene), "angular_speed" in case.parameters
    angle = np.radians(degrees)
    omega = case.number("angular_speed") if by_hand else _speed(scene)
    inertia = lecture.inertia_force_series(
        angle, reciprocating_mass=scene.piston.mass, omega=omega, **geometry
    )
    gas = case.number("gas_force") if by_hand else _gas_force(scene, angle)
    net = lecture.net_force(gas_force=gas, inertia_force=inertia)
    thrust = lecture.rod_force(angle, net_force=net, **geometry)
    across = float(lecture.tangential_force(angle, rod_force=thrust, **geometry)) / 1e3
    arm = scene.crank.radius
    ours = {
        "side_thrust": float(lecture.side_thrust(angle, net_force=net, **geometry)) / 1e3,
        "rod_thrust": float(thrust) / 1e3,
        "tangential_force": across,
        "crank_torque": (round(across, 2) if by_hand else across) * arm,
    }
    if by_hand:
        del ours["side_thrust"]  # the key prints the gas force in its place
    return _against(case, ours)


def elongated_rod(case: Case) -> Outcome:
    """The IVP test set's elastic rod, rigid at the length that it prints for t = 0.1 s.

    Its equations hold the derivative of the loop closure at zero; by how much its initial values
    miss the loop closure itself therefore stays.
    """
    scene = case.ours()
    longer = float(
        reference.one_row("printed", machine="ivp_crank", quantity="elongation")["printed"]
    )
    angle, radius = 150.0 * 0.1, scene.crank.radius
    rod = {"crank_radius": radius, "rod_length": scene.rod.length + longer}
    beta = float(lecture.rod_angle(angle, **rod))
    fits = radius + scene.rod.length + case.number("initial_elongation")
    missed = case.number("initial_position") - fits
    position = radius * math.cos(angle) + rod["rod_length"] * math.cos(beta) + missed
    return _against(case, {"rod_angle": -beta, "piston_position": position})


def integration(case: Case) -> Outcome:
    """exudyn's reference: crank angle and speed by ode45 at the tolerance that the file names.

    As many rows as the file has besides: every step of ours is one of its.
    """
    scene, rtol = case.ours(), case.number("rtol")
    (load,) = scene.torque
    assert isinstance(load, Constant)
    torque = load.torque

    def slope(_: float, state: Vector) -> Vector:
        inertia, inertia_1, _ = (
            float(value) for value in reduce(CrankTrain(scene, None), state[0])
        )
        return np.array([state[1], (torque - 0.5 * inertia_1 * state[1] ** 2) / inertia])

    start = scene.start
    assert start is not None
    first = np.array([start.angle, start.speed])
    times, states = ode45(slope, first, case.number("end"), rtol, case.number("atol"))
    ours = {"crank_angle": float(states[-1][0]), "crank_speed": float(states[-1][1])}
    found = _against(case, ours)
    rows = 4 * (len(times) - 1) + 1  # ode45 writes three more states into every step
    missed = abs(rows - case.number("rows"))
    return Outcome(max(found.error, missed), f"{found.detail}; in {rows} rows, as the file has")


def departure(case: Case) -> Outcome:
    """A printed end state whose method is not to be had: how far it lies from the run.

    The error is that of this distance, relative to printed minus computed here.
    """
    data = run(case.ours(), case.word("formulation")).data
    worst, parts = 0.0, []
    for row in _rows(case):
        printed, value = float(row["printed"]), float(data[row["quantity"]].values[-1])
        stated = printed - float(row["computed_here"])
        worst = max(worst, abs((printed - value) / stated - 1.0))
        parts.append(
            f"{row['quantity']}: {row['printed']} {row['unit']} printed, {printed - value:+.6e} "
            f"from the run, {abs(printed / value - 1.0):.1e} of it"
        )
    return Outcome(worst, "; ".join(parts))


def _rows(case: Case) -> list[dict[str, str]]:
    return [row for row in reference.rows("printed") if row["machine"] == case.word("machine")]


def _against(case: Case, ours: dict[str, float]) -> Outcome:
    """The worst difference in halves of the last printed digit; beside it from the exact answer."""
    worst, parts = 0.0, []
    for name, value in ours.items():
        row = reference.one_row("printed", machine=case.word("machine"), quantity=name)
        off = abs(value - float(row["printed"])) / (0.5 * float(row["last_digit"]))
        worst = off if math.isnan(off) else max(worst, off)
        parts.append(
            f"{name} {value:.12g} {row['unit']} by the source's method (printed {row['printed']}; "
            f"off the exact answer by {row['why']})"
        )
    return Outcome(worst, "; ".join(parts))


def _geometry(scene: Scene) -> dict[str, float]:
    return {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}


def _speed(scene: Scene) -> float:
    assert scene.motion is not None
    assert isinstance(scene.motion.speed, float)
    return scene.motion.speed


def _gas_force(scene: Scene, angle: float) -> float:
    pressures, area = pressures_of(scene), scene.piston.gas_area
    assert pressures is not None
    pressure = pressures[0]
    assert area is not None
    force = lecture.gas_force(
        gas_pressure=float(pressure(angle)), ambient_pressure=0.0, piston_area=area
    )
    return float(force)
