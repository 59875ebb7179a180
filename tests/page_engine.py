"""The engine of the page without a browser, and what Python says of the same scenes."""

import math
from pathlib import Path

import numpy as np

from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.page import exported, joined
from crankmbs.page.export import encoded, rules

ANSWERS = Path(__file__).with_name("page_answers.js")
"""What the engine is asked by."""

_ASK = "((name, text) => answers[name](engine, answers.decoded(JSON.parse(text))))"


class Engine:
    """What the page's modules answer, asked by the name of the answer and its arguments.

    script : of the answers, where it is not that of the page
    """

    def __init__(self, v8, script=None):
        self.v8 = v8
        v8.eval(f"var answers = {script or joined(ANSWERS)};")
        v8.eval(f"var engine = answers.engineOf({encoded(rules())});")

    def ask(self, name, **arguments):
        return self.asked(name, encoded(arguments))

    def asked(self, name, text):
        return self.v8.call(_ASK, name, text)

    def answer(self, scene, angles):
        return self.ask("answer", scene=exported(scene), angles=np.asarray(angles))


def differences(result, variables):
    """By how much every variable is off at most, beyond the error that Python states, of its peak;
    of sums that may cancel and of what is nothing beside others of its unit, of the largest of
    that."""
    names = [str(n) for n in result.data.variables if n not in ("cylinder", "energy_residual")]
    expected = {name: result.data[name].values for name in names}
    assert variables.keys() == expected.keys()
    largest: dict[str, float] = {}
    for name in names:
        unit = EVERY[name].units
        largest[unit] = max(largest.get(unit, 0.0), peak(expected[name]))
    found = {}
    for name in names:
        own, most = peak(expected[name]), largest[EVERY[name].units]
        size = most if name in SUMS or own < 1e-10 * most else own
        shown = np.array(variables[name], dtype=float)
        apart = peak(shown - expected[name]) if np.isfinite(shown).all() else math.inf
        apart = max(apart - result.data[name].attrs["error_estimate"], 0.0)
        found[name] = apart / size if size > 0.0 else apart
    return found


def unlike(measures, found, size):
    """The measures of Python that those of the page are not: by more than 1e-9 of a size, and twice
    the error that Python states.

    size : of the measures by name
    """
    pairs = {
        name: (found[name], getattr(measures, name))
        for name in ("mean_speed", "fluctuation", "speed_gain", "external_torque")
    }
    if measures.indicated_power is not None:
        pairs["indicated_power"] = (found["indicated_power"], measures.indicated_power)
    for name in ("friction_power", "mechanical_efficiency"):
        if (one := getattr(measures, name)) is not None:
            pairs[name] = (found[name], one)
    for name in ("indicated_power_head_end", "indicated_power_crank_end"):
        if (one := getattr(measures, name)) is not None:
            pairs[name] = (found[name], one)
    for own, one in zip(found["joints"], measures.joints, strict=True):
        assert (own["joint"], own["cylinder"]) == (one.joint, one.cylinder)
        pairs[f"force {one.joint} {one.cylinder}"] = (own["peak"], one.peak)
    return {
        name: (abs(value - one.value), 1e-9 * size[name.split()[0]], one.error)
        for name, (value, one) in pairs.items()
        if not abs(value - one.value) <= 1e-9 * size[name.split()[0]] + 2.0 * one.error
    }


def sizes(result, measures):
    """What the measures are compared to: the peaks that they are made of."""
    rods = peak(result.data["crank_torque"].values) * result.data.sizes["cylinder"]
    torque = max(rods, peak(result.data["external_torque"].values))
    speed = abs(measures.mean_speed.value)
    return {
        "mean_speed": speed,
        "fluctuation": 1.0,
        "speed_gain": speed,
        "external_torque": torque,
        "indicated_power": torque * speed,
        "friction_power": torque * speed,
        "mechanical_efficiency": 1.0,
        "indicated_power_head_end": torque * speed,
        "indicated_power_crank_end": torque * speed,
        "force": max(one.peak.value for one in measures.joints),
    }
