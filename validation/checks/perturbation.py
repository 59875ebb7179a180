"""The first-order perturbation of the crank's speed, a formula given from Python, against the
settled motion, from a heavy flywheel to a light one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from scipy.interpolate import CubicSpline

from crankmbs.compare import Comparison, compare
from crankmbs.figures.style import STYLE, line_of, panels
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene
from validation.adapter import machine_of
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.affine_period import Periodic
from validation.runs import run

__all__ = ["crank_speed", "fluctuation", "flywheels"]


def crank_speed(
    theta: Array,
    generalized_force: Array,
    reduced_slope: Array,
    crank_inertia: float,
    start_omega: float,
) -> Array:
    """omega(theta) = Omega (1 + (W - mean of W) / (J Omega^2)), to first order in 1/J.

    W is the work of gas, weights and rods at the constant speed Omega, beyond what the load takes,
    J the flywheel's inertia alone.
    """
    torque = generalized_force - reduced_slope * start_omega**2 / 2
    work = CubicSpline(theta, torque).antiderivative()(theta)
    work -= work[-1] * (theta - theta[0]) / (theta[-1] - theta[0])
    swing = (work - work[:-1].mean()) / (crank_inertia * start_omega**2)
    return np.asarray(start_omega * (1.0 + swing))


def fluctuation(
    theta: Array,
    generalized_force: Array,
    reduced_slope: Array,
    crank_inertia: float,
    start_omega: float,
) -> float:
    """(max - min) / Omega of `crank_speed`."""
    speed = crank_speed(theta, generalized_force, reduced_slope, crank_inertia, start_omega)
    return float(np.ptp(speed)) / start_omega


def flywheels(case: Case) -> Outcome:
    """How far the formula's fluctuation is off, in percent of the settled one, with each inertia:
    ours less that of the oracle's periodic speed and of its own work at constant speed."""
    inertias = [float(value) for value in case.parameters["inertias"]]
    exact = dict(zip(inertias, _exact(case.theirs(), inertias), strict=True))
    ours = {inertia: _compared(_with(case.ours(), inertia)) for inertia in inertias}
    apart = {each: abs(ours[each].numbers[0].percent - exact[each]) for each in inertias}
    worst = max(apart, key=lambda inertia: apart[inertia])
    rows = [
        f"| {inertia:g} | {found.numbers[0].value:.6g} | {found.numbers[0].simulated.value:.6g} "
        f"| {found.numbers[0].percent:.3g} % | {apart[inertia]:.1e} |"
        for inertia, found in ours.items()
    ]
    heading = (
        "| flywheel [kg m^2] | first order | settled | off by | from the oracle's |",
        "|---" * 5 + "|",
    )
    said = ", ".join(f"{found.numbers[0].percent:.2g} %" for found in ours.values())
    named = ", ".join(f"{inertia:g}" for inertia in inertias)
    return Outcome(
        apart[worst],
        f"off by {said} with {named} kg m^2; worst with {worst:g}",
        (*heading, *rows),
        {case.name: _figure(ours)},
    )


def _compared(scene: Scene) -> Comparison:
    formulas = {"fluctuation, first order": fluctuation, "crank speed, first order": crank_speed}
    return compare(run(scene), formulas)


def _with(scene: Scene, inertia: float) -> Scene:
    return replace(scene, crank=replace(scene.crank, inertia=inertia))


def _exact(scene: Scene, inertias: list[float]) -> list[float]:
    """The same percentages by the oracle alone."""
    assert scene.start is not None
    first, speed = scene.start.angle, scene.start.speed
    edges = first + np.linspace(0.0, scene.settled_period, 2 * 720 + 1)  # samples, and between
    periodic = Periodic(machine_of(scene), edges)
    work = float(np.ptp(periodic.work(speed)[::2]))
    found = []
    for inertia in inertias:
        omega = periodic.speed(inertia)
        omega[-1] = omega[0]
        path = CubicSpline(edges, omega, bc_type="periodic")
        turns = path(path.derivative().roots(extrapolate=False))
        slowness = CubicSpline(edges, 1.0 / omega, bc_type="periodic")
        mean = (edges[-1] - edges[0]) / float(slowness.integrate(edges[0], edges[-1]))
        settled = float(np.ptp(turns)) / mean
        found.append(100.0 * (work / (inertia * speed**2) / settled - 1.0))
    return found


@rc_context(STYLE)
def _figure(found: dict[float, Comparison]) -> Figure:
    """The speed by run and formula with all but the heaviest and the lightest flywheel, and how far
    the fluctuation is off with each."""
    figure, (speeds, errors) = panels(1, 2, 13.0, 5.2, width_ratios=(1.5, 1.0))
    for k, (inertia, each) in enumerate(list(found.items())[1:-1]):
        row = each.row("crank speed", "crank speed, first order")
        degrees, colour = np.degrees(each.excerpt.theta), line_of(k)["color"]
        speeds.plot(
            degrees, each.simulated["crank speed"], color=colour, label=f"{inertia:g} kg m$^2$"
        )
        speeds.plot(degrees, row.values, color=colour, linestyle=(0, (4, 2)))
    speeds.plot([], [], color="black", label="settled motion")
    speeds.plot([], [], color="black", linestyle=(0, (4, 2)), label="first order")
    speeds.set_xlim(0.0, 360.0)
    speeds.set_xticks(range(0, 361, 90))
    speeds.set_xlabel("crank angle [deg]")
    speeds.set_ylabel("crank speed [rad/s]")
    percents = [each.numbers[0].percent for each in found.values()]
    errors.loglog(list(found), percents, color="black", marker="o")
    for inertia, percent in zip(found, percents, strict=True):
        errors.annotate(f"{percent:.2g} %", (inertia, percent), (6, 4), textcoords="offset points")
    errors.set_xlabel("inertia of crank and flywheel [kg m$^2$]")
    errors.set_ylabel("error of the fluctuation [%]")
    errors.margins(0.22)
    figure.legend(loc="outside upper center", ncols=5)
    return figure
