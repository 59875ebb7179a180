"""Summary measures of a run over its last cycle, each with its error."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crankmbs.measures.estimate import ROUNDING, Estimate, Number, Numbers, estimates
from crankmbs.measures.joints import JointForce, joints_of, shell_area
from crankmbs.measures.nodes import nodes_of
from crankmbs.measures.peaks import SPEEDS, Peak, peak_numbers, peaks_from, quantities_of
from crankmbs.measures.span import CYCLES, Span, measured_span, passes_over
from crankmbs.mechanics.axes import areas
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.motion.motion import Motion
from crankmbs.motion.states import samples_in
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "Measures",
    "Works",
    "efficiency",
    "fluctuation",
    "largest",
    "mean_speed",
    "measure",
    "powers",
    "works_of",
]

_DRIFT, _OF_SWING = 0.01, 0.25  # what may change from a cycle to the next and be called periodic
_RESTS = 1e-6  # of the highest speed: a root of the energy is known to half the digits near zero


@dataclass(frozen=True, kw_only=True)
class Measures:
    """What a run amounts to over its window. Means of forces are over time.

    mean_speed [rad/s]; fluctuation : (max - min) / |mean speed|
    speed_gain [rad/s] : drift, the speed at the end less that at the beginning; 0 once a motion is
        periodic
    crank_torque [N m] : moment of all rods on the crank, external_torque [N m] : from outside;
        both means are work per angle turned, so that torque times mean speed is power
    indicated_power [W] : work of the gas on all pistons per time; None without gas
    imep [Pa] : work of the gas in a cycle, the mean of several, over the displaced volume, per
        cylinder; of double-acting ones that of the head end; None without gas or without a whole
        cycle
    indicated_work [J] : work of the gas on all pistons in a cycle, the mean of several; None
        without gas or without a whole cycle
    imep_crank_end [Pa] : the same of the crank end, over its volume, stroke times the piston's
        area less the rod's; None where cylinders are single-acting
    indicated_power_head_end, indicated_power_crank_end [W] : the parts of the indicated power; None
        where cylinders are single-acting
    friction_power [W] : what the friction of all pistons takes per time; None without friction
    mechanical_efficiency : where the gas drives, the share of the indicated power that friction
        leaves; where it is driven, indicated power over that with the friction's; None without
        friction or gas
    kinetic_power [W] : gain of kinetic energy per time, 0 once a motion is periodic
    force_power [W] : what the forces from outside on all pistons give per time, negative where they
        take; None without
    peaks : of torques, applied forces and pressures, as `crankmbs.measures.peaks.quantities_of`
        lists them, then highest and lowest speed
    energy_closure : max |energy residual| / peak kinetic energy over the whole run
    """

    window: Span
    scene: Scene = field(repr=False)
    mean_speed: Estimate
    fluctuation: Estimate
    speed_gain: Estimate
    joints: tuple[JointForce, ...]
    crank_torque: Estimate
    external_torque: Estimate
    kinetic_power: Estimate | None = None
    indicated_power: Estimate | None = None
    imep: tuple[Estimate, ...] | None = None
    imep_crank_end: tuple[Estimate, ...] | None = None
    indicated_work: Estimate | None = None
    indicated_power_head_end: Estimate | None = None
    indicated_power_crank_end: Estimate | None = None
    friction_power: Estimate | None = None
    mechanical_efficiency: Estimate | None = None
    force_power: Estimate | None = None
    peaks: tuple[Peak, ...]
    energy_closure: float

    @property
    def steady(self) -> bool:
        """Whether the motion over the window is periodic enough to stand for the cycles after it:
        the crank neither rests nor turns back, and its speed drifts by no more than 1 % of its mean
        and a quarter of its swing."""
        mean = abs(self.mean_speed.value)
        most = min(_DRIFT * mean, _OF_SWING * self.fluctuation.value * mean)
        drift = abs(self.speed_gain.value) - self.speed_gain.error
        return self.moves_on and drift <= most

    @property
    def moves_on(self) -> bool:
        """Whether the crank neither rests nor turns back in the window, nor at its ends."""
        highest, lowest = (peak.value.value for peak in self.peaks[-2:])
        slow, fast = sorted(map(abs, (highest, lowest)))
        return highest * lowest > 0.0 and slow > _RESTS * fast

    @property
    def turns_back(self) -> bool:
        """Whether the crank turns both ways in the window: what is taken over the angle turned,
        mean speeds and mean torques, then means nothing."""
        highest, lowest = (peak.value.value for peak in self.peaks[-2:])
        least, most = sorted((highest, -lowest))
        return least > _RESTS * most

    @property
    def piston_speed(self) -> tuple[Estimate, ...]:
        """Mean piston speed of each cylinder [m/s]: twice its stroke a revolution."""
        speed, error = self.mean_speed
        per_radian = [gear.stroke / math.pi for gear in self.scene.running_gear]
        return tuple(Estimate(abs(speed) * stroke, error * stroke) for stroke in per_radian)

    @property
    def power(self) -> Estimate:
        """Of drive and loads together [W], negative where these take more: mean torque from outside
        times mean speed."""
        (torque, of_torque), (speed, of_speed) = self.external_torque, self.mean_speed
        error = abs(torque) * of_speed + abs(speed) * of_torque
        return Estimate(torque * speed, error)

    @property
    def brake_power(self) -> Estimate:
        """What the loads take less what drives give [W]."""
        return Estimate(-self.power.value, self.power.error)

    def to_dataframe(self) -> pd.DataFrame:
        """The measures as a pandas table in the units of its index, rpm, kW, bar, N, N m: value and
        error, and of peaks where they are [deg]. A sweep takes the measures by these names.
        ``attrs["window"]`` says over what they are: "last cycle" or another kind of
        `crankmbs.measures.Span`. Where the motion is not periodic, fluctuation and mechanical
        efficiency mean nothing and are left out. The mean side force is that of its magnitude.

        >>> table = simulate(load_scene("yi_diesel")).measures().to_dataframe()
        >>> table.loc["mean speed [rpm]", "value"].round(6).item()
        3200.0
        """
        from crankmbs.report.readings import measures_frame

        return measures_frame(self)

    def _repr_html_(self) -> str:
        from crankmbs.report.html import measures_html

        return measures_html(self)


def measure(result: Result) -> Measures:
    """Sum up a run over its last whole cycle (or revolution, or the run); where cycles differ and
    come again together, as a sequence does, over their last whole period.

    Every number is read from the motion as it was solved (`crankmbs.measures.nodes`). Its error is
    what the same number of the motion that checks it differs by, and the rounding of what it is
    summed from; infinite where nothing checks it.

    >>> measure(simulate(load_scene("propeller"))).window.kind
    'last cycle'
    """
    window, scene = measured_span(result), result.scene
    passes = passes_over(result, window)
    numbers = estimates(passes, partial(_numbers, scene, window))
    joints, quantities = joints_of(scene), quantities_of(scene)
    places = {name: numbers.pop(name) for name in ("peaks", "times", "angles")}
    peaks, means = peaks_from(places, (*quantities, *SPEEDS), scene), numbers.pop("means")
    forces = tuple(
        JointForce(
            joint=joint.joint,
            cylinder=joint.cylinder,
            peak=peak.value,
            mean=mean,
            crank_angle=peak.crank_angle,
            cycle_angle=peak.cycle_angle,
            number=joint.number,
            area=shell_area(scene, joint.joint),
        )
        for joint, peak, mean in zip(joints, peaks[: len(joints)], means, strict=True)
    )
    named: dict[str, Any] = {
        name: values if name.startswith("imep") else values[0] for name, values in numbers.items()
    }
    closure, others = _energy_closure(result), peaks[len(joints) :]
    summed: dict[str, Any] = {"joints": forces, "peaks": others, "energy_closure": closure}
    return Measures(window=window, scene=scene, **summed, **named)


def mean_speed(result: Result, window: Span) -> Estimate:
    """Mean speed over a window [rad/s]: the angle turned over the time it took."""
    passes = passes_over(result, window)
    return estimates(passes, lambda motion: {"mean": _mean_speed(motion, window)})["mean"][0]


def fluctuation(result: Result, window: Span) -> Estimate:
    """Coefficient of fluctuation over a window [1]: (max - min) / |mean speed|; NaN at rest."""

    def numbers(motion: Motion) -> Numbers:
        speeds = peak_numbers(SPEEDS, motion)["peaks"].value
        return {"fluctuation": _fluctuation(speeds, _mean_speed(motion, window))}

    return estimates(passes_over(result, window), numbers)["fluctuation"][0]


def largest(result: Result, quantity: Callable[[Mapping[str, Array]], Array]) -> Estimate:
    """The largest value of a quantity over all that is kept of a run.

    quantity : from the variables of the result by name, shape (p,) or (p, cylinders), to (p,)

    >>> value, error = largest(simulate(load_scene("turning_moment")), lambda v: v["crank_speed"])
    """

    def numbers(motion: Motion) -> Numbers:
        tops = nodes_of(motion).tops(lambda variables: quantity(variables)[None])
        return {"largest": Number(tops.value, tops.sizes)}

    return estimates(result.passes, numbers)["largest"][0]


def efficiency(indicated: Estimate | None, rubbed: Estimate | None) -> Estimate | None:
    """Of indicated power I and friction's R, or their works: (I - R) / I of an engine, I / (I - R)
    of what is driven, with the errors of both; None without either.

    >>> efficiency(Estimate(4.0, 0.0), Estimate(1.0, 0.1)).value
    0.75
    """
    if indicated is None or rubbed is None or abs(indicated.value) <= indicated.error:
        return None
    of_gas, left = indicated.value, indicated.value - rubbed.value
    value, whole = (left / of_gas, of_gas) if of_gas > 0.0 else (of_gas / left, left)
    apart = abs(rubbed.value) * indicated.error + abs(of_gas) * rubbed.error
    return Estimate(value, apart / whole**2)


def _numbers(scene: Scene, window: Span, motion: Motion) -> Numbers:
    """Everything that is measured of one motion."""
    nodes, mean = nodes_of(motion), _mean_speed(motion, window)
    duration, turned, joints = motion.end - motion.begin, motion.turned, joints_of(scene)
    variables, speed = nodes.variables, nodes.variables["crank_speed"]
    numbers = peak_numbers((*quantities_of(scene), *SPEEDS), motion)
    peaks, sizes = (part[: len(joints)] for part in numbers["peaks"])
    late = 1.0 + (motion.end / duration if duration else 0.0)  # units of rounding of the duration
    means = peaks  # of one state
    if duration:
        means = nodes.magnitude(np.array([joint.force(variables) for joint in joints])) / duration
    numbers |= {
        "mean_speed": mean,
        "fluctuation": _fluctuation(numbers["peaks"].value[-2:], mean),
        "speed_gain": _speed_gain(motion, np.abs(speed).max(keepdims=True)),
        "means": Number(means, late * sizes),
    }
    torques = {
        "crank_torque": variables["crank_torque"].sum(axis=1),
        "external_torque": variables["external_torque"],
    }
    for name, torque in torques.items():
        if turned and duration:
            work = Number(nodes.integral(torque * speed), nodes.integral(np.abs(torque * speed)))
            numbers[name] = work.over(turned)
        else:
            numbers[name] = Number(torque[-1:], np.abs(torque[-1:]))
    if duration:
        energy = variables["kinetic_energy"].max(keepdims=True)
        numbers["kinetic_power"] = _energy_gain(scene, motion, energy).over(duration)
        works = works_of(scene, variables, nodes.integral, late)
        cycles = abs(window.angle) / scene.period if window.kind in CYCLES else 0.0
        numbers |= powers(scene, works, cycles, duration)
    return numbers


class Works(NamedTuple):
    """Works on the pistons, shape (cylinders,) [J]: of the gas, of friction, of forces from
    outside, and of the gas of double-acting cylinders in the head end and in the crank end."""

    gas: Number
    rubbed: Number
    applied: Number
    ends: tuple[Number, Number] | None = None


def works_of(
    scene: Scene,
    variables: Mapping[str, Array],
    integral: Callable[[Array], Array],
    late: float = 1.0,
) -> Works:
    """The works by the variables at points of shape (p,) and what integrates over the motion there;
    late : units of rounding of what it integrates over."""
    velocity = variables["piston_velocity"]

    def work(name: str, factor: Array | float = 1.0) -> Number:
        power = factor * variables[name] * velocity if name in variables else 0.0 * velocity
        return Number(integral(power), late * integral(np.abs(power)))

    ends = None
    if scene.double_acting:
        head, crank = areas(scene)
        ends = work("gas_pressure", head), work("crank_end_pressure", -crank)
    return Works(work("gas_force"), work("friction_force"), work("applied_force"), ends)


def powers(scene: Scene, works: Works, cycles: float, duration: float | Array) -> Numbers:
    """Powers, mean effective pressures and efficiency by the works on the pistons over so many
    cycles, 0 where they are not whole ones, in a duration [s]."""
    numbers, (of_gas, rubbed, applied, ends) = {}, works
    if scene.gas is not None:
        numbers["indicated_power"] = of_gas.summed.over(duration)
        head, crank = ends or (of_gas, None)
        if crank is not None:
            numbers["indicated_power_head_end"] = head.summed.over(duration)
            numbers["indicated_power_crank_end"] = crank.summed.over(duration)
        if cycles:
            numbers["indicated_work"] = of_gas.summed.over(cycles)
            strokes = cycles * np.array([gear.stroke for gear in scene.running_gear])
            on_head, on_crank = areas(scene)
            numbers["imep"] = head.over(on_head * strokes)
            if crank is not None:
                numbers["imep_crank_end"] = crank.over(on_crank * strokes)
    if scene.friction is not None:
        numbers["friction_power"] = rubbed.summed.over(-duration)
        gained, lost = (
            Estimate(float(work.summed.value[0]), 0.0) for work in (of_gas, rubbed.over(-1.0))
        )
        share = efficiency(gained if scene.gas is not None else None, lost)
        if share is not None:
            value = np.array([share.value])
            numbers["mechanical_efficiency"] = Number(value, np.ones(1) + np.abs(value))
    if scene.force:
        numbers["force_power"] = applied.summed.over(duration)
    return numbers


def _mean_speed(motion: Motion, window: Span) -> Number:
    duration = motion.end - motion.begin
    if duration <= 0.0:
        speed = motion.cells[-1].speed[-1:, -1]
        return Number(speed, np.abs(speed))
    turned = motion.turned if window.kind == "whole run" else window.angle
    mean = np.array([turned / duration])
    return Number(mean, np.abs(mean) * (1.0 + motion.end / duration))


def _fluctuation(extremes: Array, mean: Number) -> Number:
    """From the largest and the largest negative speed; what is but rounding is none."""
    size = np.abs(mean.value)
    if size[0] == 0.0:
        return Number(np.full(1, math.nan), np.full(1, math.nan))
    share, largest = extremes.sum() / size, np.abs(extremes).max() / size
    return Number(np.where(np.abs(share) > ROUNDING * largest, share, 0.0), largest)


def _speed_gain(motion: Motion, largest: Array) -> Number:
    begin, end = (speed for _, speed in _ends(motion))
    return Number(end - begin, largest)


def _energy_gain(scene: Scene, motion: Motion, largest: Array) -> Number:
    before, after = (0.5 * inertia_alone(scene, at) * speed**2 for at, speed in _ends(motion))
    return Number(after - before, largest)


def _ends(motion: Motion) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Angle and speed at the beginning of a motion and at its end, shape (1,) each."""
    first, last = motion.cells[0], motion.cells[-1]
    begin = samples_in(first, motion.train, np.zeros(1, np.intp), np.zeros(1))
    return (begin.theta, begin.omega), (last.angle[-1:, -1], last.speed[-1:, -1])


def _energy_closure(result: Result) -> float:
    peak = float(np.max(result.sampled("kinetic_energy")))
    worst = float(np.max(np.abs(result.sampled("energy_residual"))))
    return worst / peak if peak > 0.0 else 0.0
