"""Polytropes: Brauer's construction on a simulated diagram, and S1's expansion from its torque."""

from __future__ import annotations

import math

import numpy as np

from crankmbs import lecture
from validation import reference
from validation.case import Case
from validation.judge import Outcome
from validation.plots import Array
from validation.runs import run

__all__ = ["brauer", "expansion"]


def brauer(case: Case) -> Outcome:
    """Brauer's points from the beginning of compression and from the peak, against the simulated
    pressure at the same volume: between samples straight in the logarithms, as a polytrope is."""
    result, theirs = run(case.ours()), case.theirs()
    assert theirs.gas is not None
    cycle = theirs.gas.indicator
    assert cycle is not None
    assert theirs.gas.ambient is not None
    data, ratio = result.data, cycle.compression_ratio
    travel = data["piston_displacement"].values[:, 0]
    volume = 1.0 + (ratio - 1.0) * travel / np.max(travel)
    pressure = data["gas_pressure"].values[:, 0] + theirs.gas.ambient
    turned = np.degrees(data["crank_angle"].values)
    alpha = math.radians(float(case.parameters["volume_angle_deg"]))
    strokes = [
        (180.0, -1, ratio, cycle.intake_pressure, cycle.n_compression),
        (360.0, 1, 1.0, cycle.peak_pressure, cycle.n_expansion),
    ]
    worst, count, angles = 0.0, 0, []
    for begin, sense, first, start, exponent in strokes:
        own = (turned > begin + 1e-6) & (turned < begin + 180.0 - 1e-6)
        steps = sense * np.arange(1, int(math.log(ratio) / math.log1p(math.tan(alpha))))
        at, points = lecture.brauer_points(
            steps,
            volume_angle=alpha,
            exponent=exponent,
            reference_volume=first,
            reference_pressure=start,
        )
        simulated = _between(np.asarray(at), volume[own], pressure[own])
        worst = max(worst, float(np.max(np.abs(np.asarray(points) / simulated - 1.0))))
        count += len(steps)
        beta = float(lecture.brauer_angle(volume_angle=alpha, exponent=exponent))
        angles.append(math.degrees(beta))
    tabulated = [float(degrees) for degrees in case.parameters["beta_deg"]]
    of_angle = max(abs(a - b) for a, b in zip(angles, tabulated, strict=True)) / 0.0005
    return Outcome(
        max(worst / 1e-8, of_angle),
        f"{count} points, worst {worst:.1e}; beta_1 {angles[0]:.3f}, beta_2 {angles[1]:.3f} deg",
    )


def expansion(case: Case) -> Outcome:
    """The pressures that S1's torques imply after the peak, and the polytrope of its exponent."""
    radius, area = case.number("crank_radius"), case.number("piston_area")
    ratio, exponent = case.number("compression_ratio"), case.number("n_expansion")
    rod = {
        "crank_radius": radius,
        "rod_length": radius / case.number("rod_ratio"),
        "offset": case.number("relative_offset") * radius,
    }
    clearance = lecture.clearance_volume(swept_volume=2.0 * radius * area, compression_ratio=ratio)
    rows = [
        row
        for row in reference.rows("s1_table6_pressure")
        if 390 <= int(row["crank_angle_deg"]) <= 540
    ]
    angle: Array = np.radians([float(row["crank_angle_deg"]) for row in rows])
    volume = np.asarray(
        lecture.cylinder_volume_series(angle, piston_area=area, clearance_volume=clearance, **rod)
    )
    implied = np.array([float(row["p_best_kgf_cm2"]) for row in rows])
    ours = np.asarray(
        lecture.polytropic_pressure(
            volume,
            reference_volume=float(volume[0]),
            reference_pressure=float(implied[0]),
            exponent=exponent,
        )
    )
    tabulated = np.array([float(row["p_polytropic_kgf_cm2"]) for row in rows])
    fit = -float(np.polyfit(np.log(volume), np.log(implied), 1)[0])
    lines = [
        f"| {row['crank_angle_deg']} | {p:.3f} | {q:.3f} | {100.0 * (p / q - 1.0):+.0f} % |"
        for row, p, q in zip(rows, implied, ours, strict=True)
    ]
    return Outcome(
        float(np.max(np.abs(ours / tabulated - 1.0))),
        f"from the pressure at 390 deg; the implied pressures are no polytrope at all, the best "
        f"fit has n = {fit:.3f}",
        table=(
            "| crank angle [deg] | implied by Table 6 | polytrope | implied over it |",
            "|---|---|---|---|",
            *lines,
        ),
    )


def _between(at: Array, volume: Array, pressure: Array) -> Array:
    order = np.argsort(volume)
    logs = np.interp(np.log(at), np.log(volume[order]), np.log(pressure[order]))
    return np.asarray(np.exp(logs))
