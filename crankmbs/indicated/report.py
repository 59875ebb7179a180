"""The findings of a measured file in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from crankmbs.indicated.dead_centre import LATE_PEAK, DeadCentre
from crankmbs.indicated.findings import CylinderPressure, Level
from crankmbs.indicated.shape import Shape
from crankmbs.scene.units import BAR

__all__ = ["sentences_of"]

_LATE = -0.5  # degrees: a fired cycle that peaks before this burns too early, or is out of phase
_EARLY = -3.0  # degrees: no loss of heat brings a motored peak so far
_EPSILON = 1e-9  # of the range: less is the rounding of digits, no noise
_MOVED = 0.01  # of the range: how far a cycle may miss the next one's beginning


def sentences_of(
    cylinder: CylinderPressure, shape: Shape | None, level: Level, doubted: str
) -> Iterator[str]:
    """The sentences of one cylinder.

    doubted : what the compression speaks against, so that it has no dead centre; else nothing
    """
    name = f"cylinder {cylinder.number}"
    yield _size(cylinder, name, doubted)
    if len(cylinder.pressure) > 1:
        yield _scatter(cylinder, name)
    yield _noise(cylinder, name)
    yield from _dead_centre(cylinder, name, shape, level, doubted)
    yield from _suspicions(cylinder, name, level.absolute)
    if cylinder.moved is not None:
        peak, angle, imep = cylinder.moved
        work = "" if math.isnan(imep) else f" and the imep by {imep / BAR:+.2g} bar"
        yield (
            f"{name}: smoothing moves the peak of the mean cycle by {peak / BAR:+.3g} bar and "
            f"{angle:+.2g} degrees{work}"
        )


def _size(cylinder: CylinderPressure, name: str, doubted: str) -> str:
    mean = cylinder.mean
    at = cylinder.angle[np.argmax(mean)]
    burns = {True: "fired", False: "motored", None: "fired or motored (not clear which)"}
    work = ""
    if cylinder.imep is not None:
        work = f"; imep {np.mean(cylinder.imep) / BAR:.4g} bar"
    centre = cylinder.dead_centre
    if centre is not None and cylinder.imep_within is not None and _stands(centre, doubted):
        low, high = (imep / BAR for imep in cylinder.imep_within)
        work += "" if centre.low <= 0.0 <= centre.high else " with the file's dead centre"
        work += f", from {low:.4g} to {high:.4g} bar with the dead centre where it may lie"
    side = "after" if at >= 0.0 else "before"
    named = "" if cylinder.name == name else f"{cylinder.name}, "
    return (
        f"{name}: {named}{burns[cylinder.fired]}; the mean cycle ranges "
        f"from {np.min(mean) / BAR:.4g} to {np.max(mean) / BAR:.5g} bar and peaks {abs(at):.4g} "
        f"degrees {side} the firing dead centre, which is {cylinder.firing:g} degrees of the file"
        f"{work}"
    )


def _scatter(cylinder: CylinderPressure, name: str) -> str:
    peaks = cylinder.peaks
    text = (
        f"{name}: over {len(peaks)} cycles the peak scatters by {np.std(peaks, ddof=1) / BAR:.3g} "
        f"bar (standard deviation)"
    )
    if cylinder.imep is not None:
        share = np.std(cylinder.imep, ddof=1) / abs(np.mean(cylinder.imep))
        text += f", the imep by {100.0 * share:.3g} %"
    lowered = f"{cylinder.lowered / BAR:.3g} bar below the mean of the peaks"
    return f"{text}; the mean cycle's peak is {lowered}"


def _noise(cylinder: CylinderPressure, name: str) -> str:
    text = f"{name}: no noise"
    if cylinder.noise > _EPSILON * np.ptp(cylinder.mean):
        text = f"{name}: noise of {cylinder.noise / BAR:.2g} bar a sample (standard deviation)"
    return f"{text}; a cycle ends {cylinder.closure / BAR:.2g} bar off the beginning of the next"


def _stands(centre: DeadCentre, doubted: str) -> bool:
    """Whether a dead centre has a basis: a motored peak, or an undoubted compression."""
    return centre.motored or not doubted


def _dead_centre(
    cylinder: CylinderPressure, name: str, shape: Shape | None, level: Level, doubted: str
) -> Iterator[str]:
    centre = cylinder.dead_centre
    if centre is None:
        yield f"{name}: the dead centre is not checked: {_unchecked(cylinder, shape, level)}"
        return
    if not _stands(centre, doubted):
        yield (
            f"{name}: the dead centre is not checked: its compression would show it "
            f"{centre.middle:+.2f} +- {centre.half:.2f} degrees from the file's{_first(doubted)}"
        )
        return
    angle = cylinder.firing + centre.middle
    basis = f"{name}: {'fired, ' if cylinder.fired else ''}from its compression"
    trusted = ""
    if not centre.motored and shape is not None and shape.ratio is not None:
        trusted = f", if the compression ratio of {shape.ratio:g} and the reference are right"
    place = (
        f"the true dead centre lies {centre.middle:+.2f} +- {centre.half:.2f} degrees from the "
        "file's"
    )
    if centre.motored:
        basis = (
            f"{name}: the motored peak lies at {centre.peak:.3f} degrees, the middle of the chord "
            f"at 70 % {centre.skew:+.2f} degrees from it"
        )
        place += (
            ", for a loss angle from 0.2 to 1.2 degrees, which loss_angle narrows"
            if centre.loss_angle is None
            else f", with the loss angle of {centre.loss_angle:g} degrees as given"
        )
    if centre.low <= 0.0 <= centre.high:
        yield f"{basis}; {place}: the file's may be right"
        return
    yield (
        f"warning: {basis}; {place}; the file's is kept, "
        f'firing_tdc="{angle:.2f} deg" takes the one found{trusted}'
    )


def _first(doubted: str) -> str:
    """What to check where a compression speaks against a reference, or a stroke."""
    if doubted != "the reference":
        return f"; check {doubted} first"
    return (
        ", if the reference is right; check the dead centre first, by a motored record, and then "
        "the reference"
    )


def _unchecked(cylinder: CylinderPressure, shape: Shape | None, level: Level) -> str:
    """Why a dead centre is not checked, and what it is worth."""
    costs = ""
    if cylinder.imep_a_degree is not None:
        costs = f"; one degree later changes the imep by {cylinder.imep_a_degree / BAR:+.2g} bar"
    if level.pegged and level.absolute and shape is not None and shape.ratio is not None:
        return (
            "the polytrope that gives the pressures their level fits a wrong dead centre as well, "
            "with another level; a motored record, or a reference that does not rest on the "
            f"compression, shows it{costs}"
        )
    needs = "a reference that makes its pressures absolute"
    if shape is None or shape.ratio is None:
        needs = "stroke, rod length and compression_ratio"
    return f"in a fired cycle the compression shows it, which takes {needs}{costs}"


def _suspicions(cylinder: CylinderPressure, name: str, referenced: bool) -> Iterator[str]:
    mean, imep = cylinder.mean, cylinder.imep
    at = float(cylinder.angle[np.argmax(mean)])
    if at < (_LATE if cylinder.fired else _EARLY):
        yield (
            f"warning: {name}: its peak lies {-at:.3g} degrees before the dead centre: "
            "check the dead centre, and the sign of the angle"
        )
    if cylinder.fired is None and at > LATE_PEAK:
        yield (
            f"warning: {name}: it peaks {at:.3g} degrees after the file's dead centre, as "
            "symmetric as a motored cycle: it burns little, or it is motored and its dead centre "
            "lies behind that peak; loss_angle takes it as motored"
        )
    if imep is not None and cylinder.fired is not None:
        work = float(np.mean(imep))
        if cylinder.fired != (work > 0.0):
            sense = (
                "fired, and the gas takes work from"
                if cylinder.fired
                else ("motored, and the gas gives work to")
            )
            yield (
                f"warning: {name}: {sense} the piston, imep {work / BAR:.3g} bar: check the dead "
                "centre, and the sign of the angle"
            )
    below = int(np.sum(np.min(cylinder.pressure, axis=1) < 0.0))
    if referenced and below:
        cycle, row = np.unravel_index(np.argmin(cylinder.pressure), cylinder.pressure.shape)
        low, deg = cylinder.pressure[cycle, row], cylinder.angle[row]
        yield (
            f"warning: {name}: an absolute pressure falls to {low / BAR:.3g} bar, {deg:.4g} "
            f"degrees from the dead centre in cycle {cycle + 1}, below zero in {below} of "
            f"{len(cylinder.pressure)} cycles: check the reference, and the signal for spikes"
        )
    if abs(cylinder.closure) > _MOVED * np.ptp(mean) + 5.0 * cylinder.noise:
        yield (
            f"warning: {name}: a cycle ends {cylinder.closure / BAR:.2g} bar off the beginning of "
            "the next, over 1 % of its range: the signal drifts, or rows are missing"
        )
