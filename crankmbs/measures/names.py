"""The measures of a run by name: what each is called, its unit, and its values."""

from __future__ import annotations

from typing import NamedTuple

from crankmbs.measures.estimate import Estimate
from crankmbs.measures.joints import kinds_of, shell_area
from crankmbs.measures.peaks import SPEEDS, quantities_of, torque_of_rods
from crankmbs.measures.summary import Measures
from crankmbs.scene.scene import Scene

__all__ = ["Angles", "Named", "angles_of", "names_of", "signless", "values_of"]

_OVER_ANGLE = "mean_speed", "piston_speed", "crank_torque", "external_torque"

Angles = tuple[float, float | None]
"""Crank angle and, of what belongs to a cylinder, cycle angle of a peak [rad]."""


class Named(NamedTuple):
    """units : SI; words : for people; of : "cylinder", "journal" or "pin", if each of them has
    one."""

    units: str
    words: str
    of: str = ""


def names_of(scene: Scene) -> dict[str, Named]:
    """The measures that a run of a scene can have, by name, in the order in which they are shown.

    >>> names_of(load_scene("propeller"))["crank_pin_peak"]
    Named(units='N', words='largest crank pin force', of='cylinder')
    """
    gas, rubs, double = scene.gas is not None, scene.friction is not None, scene.double_acting
    every = ", all cylinders" if len(scene.cylinders) > 1 else ""
    imep, works = "indicated mean effective pressure", gas or rubs or scene.force
    single = {
        "mean_speed": Named("rad/s", "mean speed"),
        "piston_speed": Named("m/s", "mean piston speed", "cylinder"),
        "fluctuation": Named("1", "coefficient of fluctuation, (max - min)/mean"),
        "speed_gain": Named("rad/s", "drift of the speed"),
        "crank_torque": Named("N m", f"mean {torque_of_rods(scene)}"),
        "external_torque": Named("N m", "mean load torque (drive, where positive)"),
        "indicated_power": Named("W", "indicated power") if gas else None,
        "friction_power": Named("W", "friction power of the pistons") if rubs else None,
        "force_power": Named("W", "power of the forces on the pistons") if scene.force else None,
        "indicated_power_head_end": Named("W", "indicated power, head end") if double else None,
        "indicated_power_crank_end": Named("W", "indicated power, crank end") if double else None,
        "brake_power": Named("W", "brake power (drive power, where negative)") if works else None,
        "kinetic_power": Named("W", "power into kinetic energy") if works else None,
        "mechanical_efficiency": Named("1", "mechanical efficiency") if gas and rubs else None,
        "imep": Named("Pa", f"{imep}{', head end' if double else ''}", "cylinder") if gas else None,
        "imep_crank_end": Named("Pa", f"{imep}, crank end", "cylinder") if double else None,
        "indicated_work": Named("J", f"indicated work per cycle{every}") if gas else None,
    }
    names = {name: about for name, about in single.items() if about is not None}
    kinds = kinds_of(scene)
    for kind in kinds:
        key, of = kind.key, kind.of
        force = signless(f"{kind.joint.removesuffix(' force')} force")
        names[f"{key}_peak"] = Named("N", f"largest {force}", of)
        names[f"{key}_mean"] = Named("N", f"mean {force}", of)
        if shell_area(scene, kind.joint) is not None:
            load = f"specific load, {kind.joint}"
            names[f"{key}_specific_peak"] = Named("N/m^2", f"largest {load}", of)
            names[f"{key}_specific_mean"] = Named("N/m^2", f"mean {load}", of)
    for quantity in (*quantities_of(scene)[kinds[-1].rows.stop :], *SPEEDS):
        of = "cylinder" if quantity.number else ""
        names[_key(quantity.name)] = Named(quantity.units, signless(quantity.name), of)
    return names


def signless(name: str) -> str:
    """What a force with a sign is called where its magnitude is meant.

    >>> signless("side force"), signless("crank pin force")
    ('|side force|', 'crank pin force')
    """
    return f"|{name}|" if name in ("side force", "applied force") else name


def values_of(measures: Measures) -> dict[str, tuple[Estimate, ...]]:
    """The measures that a run has, by the names of `names_of` and in their order; of each cylinder,
    journal or pin where they are many. Where the crank turns back it has none that are means over
    the angle turned.

    >>> values_of(simulate(load_scene("propeller")).measures())["crank_pin_peak"][0].value > 2e4
    True
    """
    values: dict[str, tuple[Estimate, ...]] = {}
    names, none = names_of(measures.scene), _OVER_ANGLE if measures.turns_back else ()
    for name in names:
        value = getattr(measures, name, None)
        if value is not None and name not in none:
            values[name] = value if names[name].of else (value,)
    for force in measures.joints:
        key = force.joint.replace(" ", "_")
        for part in ("peak", "mean", "specific_peak", "specific_mean"):
            estimate = getattr(force, part)
            if estimate is not None:
                values[f"{key}_{part}"] = (*values.get(f"{key}_{part}", ()), estimate)
    for peak in measures.peaks:
        values[_key(peak.name)] = (*values.get(_key(peak.name), ()), peak.value)
    return {name: values[name] for name in names if name in values}


def angles_of(measures: Measures) -> dict[str, tuple[Angles, ...]]:
    """Where those of `values_of` are that are peaks.

    >>> angles_of(simulate(load_scene("propeller")).measures())["gauge_pressure"][0][1] > 6.28
    True
    """
    angles: dict[str, tuple[Angles, ...]] = {}
    places = [
        (f"{force.joint.replace(' ', '_')}_peak", force.crank_angle, force.cycle_angle)
        for force in measures.joints
    ]
    places += [(_key(peak.name), peak.crank_angle, peak.cycle_angle) for peak in measures.peaks]
    for key, crank, cycle in places:
        angles[key] = (*angles.get(key, ()), (crank, cycle))
    return angles


def _key(peak: str) -> str:
    """The name of a measure by that of a peak: of torques the same with gas and without."""
    name, _, word = peak.rpartition(", ")
    if word in ("max", "min"):
        return f"{'external_' * name.endswith('drive')}torque_{word}"
    return "_".join(peak.replace(",", "").split())
