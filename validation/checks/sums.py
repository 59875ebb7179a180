"""What a run amounts to, against closed forms: fluctuation, orders, work of an ideal cycle."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.measures import measure, orders
from crankmbs.scene.drives import Oscillation
from crankmbs.scene.scene import Scene
from validation.case import Case
from validation.judge import Outcome
from validation.runs import run

__all__ = ["fluctuation", "ideal_cycle", "speed_orders", "stroke_orders"]


def fluctuation(case: Case) -> Outcome:
    """A speed m + a cos(n theta): over time its mean is sqrt(m^2 - a^2), as
    2 pi / int d(theta) / omega; its largest and smallest values are 2 a apart."""
    found, law = measure(run(case.ours())), _law(case.theirs())
    mean = math.sqrt(law.mean**2 - law.amplitude**2)
    pairs = {
        "mean speed": (found.mean_speed.value, mean),
        "fluctuation": (found.fluctuation.value, 2.0 * law.amplitude / mean),
    }
    return _worst(pairs, f"the mean over the angle is {law.mean:.9g}")


def speed_orders(case: Case) -> Outcome:
    """Of such a speed over the angle: one order, of amplitude a; the worst of all others over a."""
    law = _law(case.theirs())
    found = orders(run(case.ours()), "crank_speed", highest=6.0)
    wave = found.amplitude * np.exp(1j * found.phase)
    expected = np.where(found.order == law.order, law.amplitude * np.exp(1j * law.phase), 0.0)
    apart = np.append(np.abs(wave - expected), abs(found.mean - law.mean)) / law.amplitude
    return Outcome(
        float(np.max(apart)), f"{len(found.order)} orders and the mean, in units of the amplitude"
    )


def stroke_orders(case: Case) -> Outcome:
    """Without offset l cos(beta) has even orders alone: the first order of every piston's
    displacement is -r cos(cycle angle), exactly."""
    found = orders(run(case.ours()), "piston_displacement", highest=1.0)
    first = found.order == 1.0
    wave = (found.amplitude * np.exp(1j * found.phase))[first]
    radius = case.theirs().crank.radius
    apart = np.abs(wave + radius) / radius
    return Outcome(float(np.max(apart)), f"{apart.size} cylinders")


def ideal_cycle(case: Case) -> Outcome:
    """imep, power and mean torque of an indicator diagram at constant speed, by the work of its
    polytropes, p V (rho^(n-1) - 1) / (n - 1), over the true swept volume."""
    found, theirs = measure(run(case.ours())), case.theirs()
    assert found.imep is not None
    assert found.indicated_power is not None
    assert theirs.motion is not None
    omega = theirs.motion.speed
    assert isinstance(omega, float)
    imep, swept = _imep(theirs), _swept_volume(theirs)
    power = len(theirs.cylinders) * imep * swept * omega / theirs.period
    pairs = {f"imep of cylinder {k}": (one.value, imep) for k, one in enumerate(found.imep, 1)}
    pairs["indicated power"] = found.indicated_power.value, power
    pairs["torque of the drive"] = found.external_torque.value, -power / omega
    return _worst(pairs, f"imep {imep / 1e5:.6f} bar, {power / 1e3:.6f} kW")


def _imep(scene: Scene) -> float:
    """Work over swept volume, both in units of the clearance volume and the ambient's zero."""
    assert scene.gas is not None
    cycle = scene.gas.indicator
    assert cycle is not None
    assert cycle.exhaust_pressure is not None
    ratio, rho = cycle.compression_ratio, cycle.pre_expansion
    less, more = cycle.n_compression - 1.0, cycle.n_expansion - 1.0
    spent = cycle.intake_pressure * ratio * (ratio**less - 1.0) / less
    spread = cycle.peak_pressure * rho * (1.0 - (rho / ratio) ** more) / more
    held = cycle.peak_pressure * (rho - 1.0)
    exchanged = (cycle.intake_pressure - cycle.exhaust_pressure) * (ratio - 1.0)
    return float((held + spread - spent + exchanged) / (ratio - 1.0))


def _swept_volume(scene: Scene) -> float:
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    area = scene.piston.gas_area
    assert area is not None
    return area * (math.sqrt((l + r) ** 2 - e**2) - math.sqrt((l - r) ** 2 - e**2))


def _law(scene: Scene) -> Oscillation:
    assert scene.motion is not None
    law = scene.motion.speed
    assert isinstance(law, Oscillation)
    return law


def _worst(pairs: dict[str, tuple[float, float]], detail: str) -> Outcome:
    """The largest relative difference of ours from the closed form."""
    apart = {name: abs(ours / closed - 1.0) for name, (ours, closed) in pairs.items()}
    worst = max(apart, key=lambda name: apart[name])
    if not all(math.isfinite(one) for one in apart.values()):
        raise ValueError("no number came")
    return Outcome(apart[worst], f"{len(pairs)} numbers, the worst is {worst}; {detail}")
