"""Dead centres and stroke with offset, the two inertia forces, and where the acceleration is least:
the lectures' formulas against the simulated motion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from crankmbs import lecture
from crankmbs.measures import orders
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from validation.case import Case
from validation.checks.curves import lecture_geometry
from validation.judge import Outcome
from validation.plots import Array
from validation.runs import run

__all__ = ["acceleration_minimum", "dead_centres", "inertia_force_orders"]

_TERMS = 60


def dead_centres(case: Case) -> Outcome:
    """Angles [rad] and travel (over r) at which the simulated piston turns, between samples by
    splines; the datum l + r lies above the upper one by the difference to its position."""
    result, theirs = run(case.ours()), lecture_geometry(run(case.theirs()))
    angle = result.data["crank_angle"].values
    travel, velocity, position = (
        CubicSpline(angle, result.data[f"piston_{name}"].values[:, 0])
        for name in ("displacement", "velocity", "position")
    )
    turns = velocity.roots(extrapolate=False)
    top, bottom = (float(turns[np.argmin(np.abs(turns - at))]) for at in (2.0 * math.pi, math.pi))
    radius, length = theirs["crank_radius"], theirs["rod_length"]
    pairs = {
        "top": (top - 2.0 * math.pi, lecture.top_dead_centre(**theirs)),
        "bottom": (bottom, lecture.bottom_dead_centre(**theirs)),
        "stroke": (float(travel(bottom) - travel(top)) / radius, lecture.stroke(**theirs) / radius),
        "datum": (
            (radius + length - float(position(top))) / radius,
            lecture.datum_shift(**theirs) / radius,
        ),
    }
    apart = {name: abs(ours - float(formula)) for name, (ours, formula) in pairs.items()}
    worst = max(apart, key=lambda name: apart[name])
    return Outcome(
        apart[worst],
        f"top {math.degrees(pairs['top'][0]):.4f} deg, bottom {math.degrees(bottom):.4f} deg, "
        f"stroke {pairs['stroke'][0]:.6f} r where S1 has 0, 180 deg and 2 r; the worst is {worst}",
    )


def inertia_force_orders(case: Case) -> Outcome:
    """First and second order of m_1 times the simulated acceleration, in units of m_1 r w^2.

    Without offset the first order is the lectures' exactly. Of the second they have lambda, the
    first term of lambda + lambda^3 / 4 + 15 lambda^5 / 128 + ...: theirs is scaled to the whole
    sum, from the binomial series of the rod's root.
    """
    result, scene = run(case.ours()), case.theirs()
    shares = lecture.two_mass_rod(
        rod_mass=scene.rod.mass,
        rod_length=scene.rod.length,
        center_of_mass=scene.rod.center_of_mass,
    )
    omega = float(run(scene).data["crank_speed"].values[0])
    angle: Array = np.linspace(0.0, 2.0 * math.pi, 73)
    given = {
        "reciprocating_mass": scene.piston.mass + float(shares.piston_pin),
        "crank_radius": scene.crank.radius,
        "rod_length": scene.rod.length,
        "omega": omega,
    }
    ratio = scene.crank.radius / scene.rod.length
    whole = _second_order(ratio)
    pairs = [
        (1.0, np.asarray(lecture.first_order_inertia_force(angle, **given))),
        (2.0, np.asarray(lecture.second_order_inertia_force(angle, **given)) * whole / ratio),
    ]
    unit = given["reciprocating_mass"] * scene.crank.radius * omega**2
    found = orders(result, "piston_acceleration", highest=2.0)
    worst = 0.0
    for order, force in pairs:
        at = found.order == order
        wave = found.amplitude[at, 0] * np.cos(order * angle + found.phase[at, 0])
        simulated = -given["reciprocating_mass"] * wave
        worst = max(worst, float(np.max(np.abs(force - simulated))) / unit)
    return Outcome(
        worst,
        f"the lectures' second order is {100.0 * (1.0 - ratio / whole):.3f} % too small at rod "
        f"ratio {ratio:.4f}, their first order exact",
    )


def acceleration_minimum(case: Case) -> Outcome:
    """Two numbers: the second derivative of the simulated acceleration at bottom dead centre, over
    r w^2, at the limit of the rod ratio, where it is zero; and the angle [rad] of the least
    acceleration of a rod beyond the limit."""
    limit, beyond = lecture.ACCELERATION_MINIMUM_LIMIT, case.number("rod_ratio")
    shift = beyond / float(case.parameters["rod_ratio"])
    curve = _acceleration(case.theirs(), limit * shift)
    flat = float(curve(math.pi, 2))
    least = _acceleration(case.theirs(), beyond).derivative().roots(extrapolate=False)
    # from pi the acceleration falls to its minimum on either side
    ours = float(np.max(least[least < math.pi - 1e-3]))
    formula = float(lecture.acceleration_minimum_angle(rod_ratio=beyond / shift))
    apart = {"curvature at the limit": abs(flat), "angle of the minimum": abs(ours - formula)}
    worst = max(apart, key=lambda name: apart[name])
    return Outcome(
        apart[worst],
        f"curvature {flat:.1e} at rod ratio {limit:.6f}; minimum at {math.degrees(ours):.4f} deg "
        f"for {beyond:g}, at {math.degrees(_truncated(beyond)):.4f} deg by the truncated series; "
        f"the worst is {worst}",
    )


def _truncated(rod_ratio: float) -> float:
    return float(lecture.acceleration_minimum_angle_series(rod_ratio=rod_ratio))


def _acceleration(scene: Scene, rod_ratio: float) -> CubicSpline:
    """Simulated acceleration over r w^2, over the crank angle of the first revolution."""
    length = scene.crank.radius / rod_ratio
    result: Result = run(replace(scene, rod=replace(scene.rod, length=length)))
    data = result.data
    unit = scene.crank.radius * float(data["crank_speed"].values[0]) ** 2
    return CubicSpline(data["crank_angle"].values, data["piston_acceleration"].values[:, 0] / unit)


def _second_order(ratio: float) -> float:
    """Amplitude of cos(2 phi) in s'' / r: of sin(phi)^(2 j) it is -2 C(2 j, j - 1) / 4^j, and of
    the second derivative 4 times that."""
    total, binomial = 0.0, 1.0
    for j in range(1, _TERMS):
        binomial *= (1.5 - j) / j  # of 1/2 over j
        total += binomial * (-(ratio**2)) ** j * 2.0 * math.comb(2 * j, j - 1) / 4.0**j
    return -4.0 * total / ratio
