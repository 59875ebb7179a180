"""Every quantity of a run at one crank angle, with its error and the lectures' name for it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.compare.bodies import bodies_of
from crankmbs.compare.quantities import QUANTITIES, cycle_angles, observed, variable_of
from crankmbs.errors import InputError, shown
from crankmbs.measures.interpolate import read_with_errors
from crankmbs.measures.span import last_span, passes_over
from crankmbs.mechanics.variables import COORDINATES, EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import quantity

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["AtAngle", "Reading", "angle_of", "at_angle"]

_ROUNDING = 1e-9  # rad
_FARTHEST = 1e6  # rad: the next number after it is 1e-10 rad away


@dataclass(frozen=True)
class Reading:
    """One number: value and error estimate [units]; cylinder : its number, None of the engine;
    symbol : what the lectures call it, empty where they have no name."""

    quantity: str
    symbol: str
    units: str
    cylinder: int | None
    value: float
    error: float

    @property
    def words(self) -> str:
        """The quantity in plain words."""
        return self.quantity.replace("_", " ")


@dataclass(frozen=True)
class AtAngle:
    """A run at one crank angle [rad], unwrapped, and the time [s] at which the crank passes it."""

    scene: Scene = field(repr=False)
    crank_angle: float
    time: float
    readings: tuple[Reading, ...]

    def to_dataframe(self) -> pd.DataFrame:
        """The readings as a pandas table in the units of its index: rpm, bar, mm, deg, N, N m.
        ``attrs["remarks"]`` says which body each force acts on, and how F_v, F_oj, F_T, F_R and M_k
        go together: M_k = F_T r - m r^2 alpha, with the rod's mass m at the crank pin.

        >>> state = simulate(load_scene("yi_diesel")).at("60 deg")
        >>> state.to_dataframe().loc["crank speed [rpm]", "value"].round(6).item()
        3200.0
        """
        from crankmbs.report.readings import readings_frame

        return readings_frame(self)

    def _repr_html_(self) -> str:
        from crankmbs.report.html import at_html

        return at_html(self)


def at_angle(result: Result, angle: float | str) -> AtAngle:
    """Every quantity of a run where the last whole cycle passes a crank angle.

    Values are read from the motion as solved, also between the samples. The lectures' F_v, N,
    F_oj, F_T, F_R and M_k follow as in `crankmbs.compare.quantities.observed`, with the lectures'
    signs; the error of each sums those of the variables it follows from.

    Parameters
    ----------
    angle : "60 deg", text with its unit; a bare number is in rad, as all numbers in Python are;
        modulo the engine's period

    Raises
    ------
    InputError : no angle; no whole cycle in the run; a reversal, which passes the angle twice

    >>> state = at_angle(simulate(load_scene("yi_diesel")), "60 deg")
    >>> print(round(math.degrees(state.crank_angle)))
    60
    """
    modulo_period = angle_of(angle)
    window = last_span(result)
    if window.kind != "last cycle":
        raise InputError(
            "a crank angle is looked up in the last whole cycle, and this run ends with none: it "
            "is shorter, or the crank rests or turns back in it; look in motion.csv"
        )
    crank_angle = _in_last_cycle(result, modulo_period)
    passes = passes_over(result, window)
    values, errors = read_with_errors(result, passes, np.array([crank_angle]), in_time=False)
    readings = *_variables(values, errors), *_lecture_forces(result.scene, values, errors)
    return AtAngle(result.scene, crank_angle, float(values["time"][0]), readings)


def angle_of(text: float | str) -> float:
    """A crank angle [rad] from a number, or from text with its unit.

    Raises
    ------
    InputError : it is no angle, or so large that its place in a cycle is rounded away

    >>> round(angle_of("60 deg"), 3)
    1.047
    """
    if isinstance(text, bool) or not isinstance(text, (str, Real)):
        raise InputError(
            'a crank angle is one number [rad], or text with its unit, such as "60 deg"; '
            f"{shown(text)} came; of several, ask for one after the other"
        )
    angle = quantity(text, "angle") if isinstance(text, str) else float(text)
    if not abs(angle) <= _FARTHEST:
        raise InputError(
            f"the crank angle must be within {_FARTHEST:g} rad, or its place in a cycle is rounded "
            f"away; {text!r} came"
        )
    return angle


def _in_last_cycle(result: Result, angle: float) -> float:
    """The crank angle in the last cycle that equals this one modulo the period; the cycle's end
    belongs to it, its beginning does not."""
    period = result.scene.period
    end = float(result.data["crank_angle"].values[-1])
    sense = math.copysign(1.0, last_span(result).angle)
    until_end = sense * (end - angle) % period
    if period - until_end <= _ROUNDING:
        until_end = 0.0
    return end - sense * until_end


def _variables(values: dict[str, Array], errors: dict[str, float]) -> Iterator[Reading]:
    """Every variable at the one point."""
    for name, at_point in values.items():
        if name in COORDINATES:
            continue
        units, _, of = EVERY[name]
        words = name.replace("_", " ")
        symbol = QUANTITIES[words].symbol if words in QUANTITIES else ""
        for k, value in enumerate(np.atleast_1d(at_point[0]), start=1):
            label = f"{name} {k}" if of in ("journal", "pin") else name
            cylinder = k if of == "cylinder" else None
            yield Reading(label, symbol, units, cylinder, float(value), errors[name])


def _lecture_forces(
    scene: Scene, values: dict[str, Array], errors: dict[str, float]
) -> Iterator[Reading]:
    """The lectures' forces and torque at the one point."""
    motion = values["crank_speed"], values["crank_acceleration"]
    bodies, phi = bodies_of(scene), cycle_angles(scene, values["crank_angle"])
    lectured = observed(bodies, values, phi, *motion)
    # a force through the rod is the crank pin's less that of a mass which turns with it
    mass_radius = float(np.max(np.abs(bodies.masses.crank_pin * bodies.crank_radius)))
    speed_error = 2.0 * abs(float(motion[0][0])) * errors["crank_speed"]
    inertia_error = mass_radius * (speed_error + errors["crank_acceleration"])
    through_rod = errors["crank_pin_force_x"] + errors["crank_pin_force_y"] + inertia_error
    for name, (units, symbol, _) in QUANTITIES.items():
        if not symbol or name.replace(" ", "_") in values:
            continue
        plain = symbol.replace("{", "").replace("}", "")
        error = errors.get(variable_of(name), through_rod)
        for k, value in enumerate(lectured[name][0], start=1):
            yield Reading(name, plain, units, k, float(value), error)
