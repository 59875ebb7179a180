"""With the two-mass rod, constant speed and no gravity the lectures' exact formulas are exact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crankmbs import lecture
from crankmbs.lecture.accumulated_torque import accumulated_torque
from crankmbs.result import Result
from validation.case import Case
from validation.checks.curves import lecture_geometry
from validation.judge import Outcome
from validation.plots import Array, Panel, overlay
from validation.runs import run

__all__ = ["forces", "torque_of_all_cylinders", "torque_of_one_cylinder"]


def lecture_forces(result: Result, acceleration: float | Array | None = None) -> dict[str, Array]:
    """S0's forces for every cylinder, shape (n, cylinders), named as the run's variables.

    acceleration : the piston's, shape (n, cylinders); None takes the exact formula
    """
    scene, data = result.scene, result.data
    geometry, omega = lecture_geometry(result), float(data["crank_speed"].values[0])
    phases = np.array([cylinder.phase for cylinder in scene.cylinders])
    angle = data["crank_angle"].values[:, None] + phases
    if acceleration is None:
        acceleration = lecture.piston_acceleration(angle, omega=omega, **geometry)
    shares = lecture.two_mass_rod(
        rod_mass=scene.rod.mass,
        rod_length=scene.rod.length,
        center_of_mass=scene.rod.center_of_mass,
    )
    inertia = lecture.inertia_force(
        reciprocating_mass=scene.piston.mass + shares.piston_pin, piston_acceleration=acceleration
    )
    net = lecture.net_force(gas_force=data["gas_force"].values, inertia_force=inertia)
    along = lecture.rod_force(angle, net_force=net, **geometry)
    tangential = lecture.tangential_force(angle, rod_force=along, **geometry)
    datum = lecture.datum_shift(**geometry)
    found = {
        "piston_displacement": lecture.piston_displacement(angle, **geometry) - datum,
        "piston_velocity": lecture.piston_velocity(angle, omega=omega, **geometry),
        "piston_acceleration": acceleration,
        "net_force": net,
        "side_force": lecture.side_thrust(angle, net_force=net, **geometry),
        "rod_force": along,
        "tangential_force": tangential,
        "radial_force": lecture.radial_force(angle, rod_force=along, **geometry),
        "crank_torque": lecture.crank_torque(
            tangential_force=tangential, crank_radius=geometry["crank_radius"]
        ),
    }
    return {name: np.asarray(values) for name, values in found.items()}


def forces(case: Case) -> Outcome:
    """Every quantity of the lectures against the run's joint forces."""
    result = run(case.ours())
    errors = {}
    for name, values in lecture_forces(run(case.theirs())).items():
        simulated = _simulated(result, name)
        errors[name] = float(np.max(np.abs(values - simulated)) / np.max(np.abs(simulated)))
    worst = max(errors, key=lambda name: errors[name])
    return Outcome(errors[worst], f"{len(errors)} quantities; the worst is {worst}")


def torque_of_one_cylinder(case: Case) -> Outcome:
    """S0's M_k of cylinder 1."""
    return _torque(case, "S0: torque of one cylinder", lambda torque: torque[:, 0])


def torque_of_all_cylinders(case: Case) -> Outcome:
    """The sum of S0's M_k; at constant speed it is what the drive has to take off the crank."""
    return _torque(
        case,
        "S0: torque of all cylinders",
        lambda torque: accumulated_torque(torque).journals[:, -1],
    )


def _torque(case: Case, title: str, pick: Callable[[Array], Array]) -> Outcome:
    result, original = run(case.ours(), "multibody"), run(case.theirs(), "kinetostatic")
    geometry, omega = lecture_geometry(original), float(original.data["crank_speed"].values[0])
    phases = np.array([cylinder.phase for cylinder in original.scene.cylinders])
    angle = original.data["crank_angle"].values
    truncated = lecture.piston_acceleration_series(angle[:, None] + phases, omega=omega, **geometry)
    exact = pick(lecture_forces(original)["crank_torque"])
    series = pick(lecture_forces(original, truncated)["crank_torque"])
    simulated = pick(result.data["crank_torque"].values)
    peak = float(np.max(np.abs(simulated)))
    error = float(np.max(np.abs(exact - simulated))) / peak
    of_series = float(np.max(np.abs(series - simulated))) / peak
    panel = Panel("torque [N m]", simulated, series)
    figure = overlay(np.degrees(angle), [panel], title, ("lecture, truncated", "multibody run"))
    return Outcome(
        error,
        f"{error * peak:.1e} N m with the exact acceleration; with S0's truncated one "
        f"{of_series * peak:.3g} N m, {100 * of_series:.2f} % of the peak of {peak:.2f} N m",
        figures={case.name: figure},
    )


def _simulated(result: Result, name: str) -> Array:
    """A lecture quantity from the run's joint forces, without any formula of the lectures.

    The crank pin carries the rod's force and the centrifugal force of the rod's turning mass m_or.
    """
    data, scene = result.data, result.scene
    if name in data:
        values: Array = data[name].values
        return values
    phases = np.array([cylinder.phase for cylinder in scene.cylinders])
    phi = data["crank_angle"].values[:, None] + phases
    turning = scene.rod.mass * (1.0 - scene.rod.center_of_mass / scene.rod.length)
    centrifugal = turning * scene.crank.radius * data["crank_speed"].values[:, None] ** 2
    x = data["crank_pin_force_x"].values + centrifugal * np.cos(phi)
    y = data["crank_pin_force_y"].values + centrifugal * np.sin(phi)
    from_pin: Array = {
        "net_force": x,
        "rod_force": np.copysign(np.hypot(x, y), x),
        "tangential_force": x * np.sin(phi) - y * np.cos(phi),
        "radial_force": x * np.cos(phi) + y * np.sin(phi),
    }[name]
    return from_pin
