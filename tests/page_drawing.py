"""What must be true of the mechanism and the arrows that the page draws."""

import math

import numpy as np
from page_cases import CASES, POSES, frame, named, of_cylinder, same, truth


def drawing_holds(said, scene, data, k):
    """Pins, piston, notch and ring where the mechanism has them in millimetres with X upwards and Y
    to the left, arrows as long as their bar says, the disc's inertia by its rim."""
    cylinder, gear = scene.cylinders[k], scene.running_gear[k]
    most = max(map(abs, said["leads"]))
    position = of_cylinder(data["piston_position"].values, k)
    for body, poses in enumerate(said["poses"]):
        for n, pose in zip(POSES, poses, strict=True):
            theta, lead = said["angles"][n], said["leads"][n]
            throw = frame(cylinder.bank + cylinder.phase + theta, gear.radius, 0.0)
            pin = frame(cylinder.bank, position[n], gear.piston.offset)
            ok = (
                at(pose["pin"], throw)
                and leads(pose["rod"], pin, throw)
                and same(numbers(pose["piston"]["transform"]), [0.0, -1e3 * position[n]])
                and turns(pose["web"], theta + cylinder.phase + cylinder.bank)
                and turns(pose["mark"], theta)
                and ring_holds(pose, theta, lead, most)
                and arrows_hold(pose, said["forces"][body][n], largest(said["forces"][body]))
            )
            if not ok:
                return False
    return own_inertia(scene, said["rim"])


def own_inertia(scene, found):
    """A scene without a flywheel of its own, or one that is turned, has a rim accordingly."""
    names = {id(case): case for case in CASES.values()}
    for case in names.values():
        if truth_is(case, scene):
            own = named(case[0]).crank.moment_of_inertia
            return own == 0.0 or same(found, scene.crank.moment_of_inertia / own, near=1e-6)
    return False


def truth_is(case, scene):
    return any(CASES[name] is case and truth(name)[0] is scene for name in CASES)


def at(circle, place):
    return same([float(circle["cx"]), float(circle["cy"])], [-1e3 * place.imag, -1e3 * place.real])


def leads(rod, small, big):
    """A rod's group stands at its small end and turns what points down in it to its big end."""
    place, turn = rod["transform"].split(") ")
    x, y = numbers(place)
    (degrees,) = numbers(turn)
    at_small = same([x, y], [-1e3 * small.imag, -1e3 * small.real])
    lean = np.angle(-(big - small))  # counter-clockwise, as X points up
    return at_small and abs(np.exp(-1j * math.radians(degrees)) - np.exp(1j * lean)) < 1e-9


def numbers(text):
    return [float(each) for each in text.partition("(")[2].rstrip(")").split()]


def turns(element, angle):
    """Counter-clockwise, as the screen has it."""
    (degrees,) = numbers(element["transform"])
    return abs(np.exp(-1j * math.radians(degrees)) - np.exp(1j * angle)) < 1e-9


def ring_holds(pose, theta, lead, most):
    """The ring is behind the crank by the lead times what is said, at most 14 degrees."""
    words = pose["says"]
    if words == "the crank turns evenly":
        return most <= 1e-9 and pose["ring"] is None
    times = float(words.partition("(drawn ")[2].removesuffix("×)") or 1.0)
    degrees, where = words.removeprefix("crank ").split("° ")
    ahead = "ahead" if lead > 0.0 else "behind"
    return (
        times * most <= math.radians(14.0) * (1.0 + 1e-9)
        and turns(pose["ring"], theta - times * lead)
        and abs(float(degrees) - abs(math.degrees(lead))) < 0.051
        and where.startswith(ahead)
        and pose["lead"]["class"] == f"lead {ahead}"
    )


def largest(samples):
    """Of the forces on a body over the cycle [N]."""
    return max(abs(complex(*each["force"])) for arrows in samples for each in arrows)


def arrows_hold(pose, forces, most):
    """Their lengths are to the scale's bar as the roots of their forces to that of what it says,
    and all are there that are above a hundredth of the largest, with a line to their names, which
    stand beside the drawing in rows of their own."""
    path, text = pose["bar"]
    newtons, unit, *_ = text["text"].split()
    size = float(newtons) * (1e3 if unit == "kN" else 1.0)
    bar = float(path["d"].partition("h")[2].partition("v")[0])
    by_name = {each["name"]: complex(*each["force"]) for each in forces}
    shown = {name: force for name, force in by_name.items() if abs(force) >= 0.01 * most}
    if len(pose["arrows"]) != len(shown):
        return False
    for arrow, force in zip(pose["arrows"], shown.values(), strict=True):
        points = [complex(*map(float, each.split())) for each in arrow["d"][1:-1].split("L")]
        drawn = points[3] - 0.5 * (points[0] + points[-1])
        long = bar * math.sqrt(abs(force) / size)
        if abs(drawn - long * complex(-force.imag, -force.real) / abs(force)) > 0.3:
            return False
    rows = {side: [float(each["y"]) for each in pose["names"] if each["text-anchor"] == side]
            for side in ("start", "end")}  # fmt: skip
    letters = float(text["font-size"])
    apart = all(np.all(np.diff(each) >= 1.2 * letters) for each in rows.values())
    return apart and {each["text"] for each in pose["names"]} == set(shown)
