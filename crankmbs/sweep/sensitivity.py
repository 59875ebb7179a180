"""How much a measure changes with a number of a scene: a derivative with its error."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crankmbs.errors import InputError
from crankmbs.measures import Estimate
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.knobs import Interval, number_at
from crankmbs.sweep.pressure_table import step_from_zero
from crankmbs.sweep.reading import Reading, free_reading_of
from crankmbs.sweep.solve import Asked

__all__ = ["Sensitivity", "sensitivity"]

_STEP = 2e-3  # of the number: the error of a difference is small, and so is rounding over the step


@dataclass(frozen=True)
class Sensitivity:
    """How a measure changes.

    knob, units, value : what is changed, in SI units, and the number that the scene has
    measure, reached : what changes, and its value there
    derivative : in the measure's unit over the knob's; NaN where a case beside has none
    """

    knob: str
    units: str
    value: float
    measure: Reading
    reached: Estimate
    derivative: Estimate

    @property
    def elasticity(self) -> float:
        """Percent by which the measure changes for one percent of the number; NaN where the number
        or the measure is 0."""
        return self.derivative.value * (self.value or math.nan) / (self.reached.value or math.nan)


def sensitivity(scene: Scene, name: str, measure: str) -> Sensitivity:
    """The derivative of a measure with respect to a number of a scene.

    Central differences D(h) and D(2 h) give (4 D(h) - D(2 h)) / 3; h is 0.2 % of the number, of a
    pressure table's shift 0.1 degree, of its offset 0.2 % of the largest pressure. The error is the
    step's, |that - D(h)|; the measure's error over h; and where a peak bends, so that slopes on
    both sides do not come nearer as h does, half their difference.

    Parameters
    ----------
    name : any number of the scene that is not 0, or "rod_ratio", "gas.shift", "gas.scale",
        "gas.offset"
    measure : "fluctuation", "peak crank pin force", "side thrust by Grega"

    Raises
    ------
    InputError : no scene, no such number or measure, or a number that is 0

    >>> scene = load_scene("propeller").with_(run__until="settled", crank__inertia=0.3)
    >>> print(f"{sensitivity(scene, 'crank.inertia', 'fluctuation').elasticity:.3f}")
    -0.993
    """
    check_scene(scene)
    knob = number_at(scene, name)
    value = float(knob.values[0])
    reading = free_reading_of(scene, measure, [knob.name])
    step = step_from_zero(scene, knob.name) or _STEP * abs(value)
    if step == 0.0:
        raise InputError(f"{name}: is 0 in this scene, and steps are a share of it; give it a size")
    ends = value - 2.0 * step, value + 2.0 * step
    asked = Asked(scene, (Interval(knob.name, knob.units, *ends),), (reading,))
    cases = [asked.at(share)[0] for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    far_low, low, middle, high, far_high = (case.value for case in cases)
    near, far = (high - low) / (2.0 * step), (far_high - far_low) / (4.0 * step)
    derivative = (4.0 * near - far) / 3.0
    bend, far_bend = (high - 2.0 * middle + low) / step, (far_high - 2.0 * middle + far_low) / step
    bent = abs(2.0 * bend - 0.5 * far_bend)  # 0 of a parabola, else the jump of the slope
    numerical = max(case.error for case in cases) / step
    error = abs(derivative - near) + 0.5 * bent + 2.0 * numerical
    return Sensitivity(
        knob=knob.name,
        units=knob.units,
        value=value,
        measure=reading,
        reached=cases[2],
        derivative=Estimate(float(derivative), float(np.nan_to_num(error, nan=np.inf))),
    )
