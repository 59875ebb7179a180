"""What must be true of what the lessons draw and say: closed forms, other ways of computing them,
and identities, by lesson; each takes a figure's answer and says whether it holds.
"""

import math
import re
from functools import cache

import mpmath
import numpy as np
from lesson_readings import column, gear, of_first, said, same, x, y
from lesson_shown import SIZE, made
from scipy.optimize import brentq, minimize_scalar

from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.mechanics.train import crank_train

RPM = math.pi / 30.0
_NEAR = 0.02  # rad: a minimum so near to bottom dead centre is taken to lie there


def swing(phi, ratio, h=1e-4):
    """Acceleration of a central piston over r omega^2, by differences of its place."""
    place = [1.0 - np.cos(p) + (1.0 - np.sqrt(1.0 - (ratio * np.sin(p)) ** 2)) / ratio
             for p in (phi - h, phi, phi + h)]  # fmt: skip
    return (place[0] - 2.0 * place[1] + place[2]) / h**2


@cache
def least(ratio):
    """Where that is least, up to bottom dead centre [deg]: where the third derivative of the place
    is zero."""

    def place(p):
        return 1 - mpmath.cos(p) + (1 - mpmath.sqrt(1 - (ratio * mpmath.sin(p)) ** 2)) / ratio

    def third(p):
        return float(mpmath.diff(place, p, 3))

    if third(math.pi - _NEAR) < 0.0:
        return 180.0
    return math.degrees(brentq(third, 0.5 * math.pi, math.pi - _NEAR, xtol=1e-7))


def displacement(half, series):
    r, l, ratio = gear(half)
    lead = 1e3 * (l - math.sqrt(l * l - r * r))
    phi = column(half, "crank_angle")
    yield "half stroke", same(half["levels"][0][0], l)
    yield "lead", said(half, "lead", lead)
    yield "angle", said(half, "angle", math.degrees(math.acos(r / l / 2.0)))
    yield "piston", same(y(half, 0), 1e3 * of_first(half, "piston_displacement"))
    yield "endless rod", same(y(half, 1), 2e3 * r * np.sin(0.5 * phi) ** 2)
    pairs = 2.0 * np.sin(0.5 * phi) ** 2 + 0.5 * ratio * np.sin(phi) ** 2
    yield "two harmonics", same(y(series, 1), 1e3 * r * pairs)
    apart = series["shapes"][0]["differences"][0]["y"]
    yield "difference", same(apart, y(series, 0) - y(series, 1))
    yield "short", said(series, "short", 1e3 * (lead - 1e3 * r * ratio / 2.0))


def acceleration(motion, valley, fork):
    r, _, ratio = gear(motion)
    phi, omega = column(motion, "crank_angle"), column(motion, "crank_speed")
    yield "velocity", same(y(motion, 0), of_first(motion, "piston_velocity") / (r * omega))
    pair = np.sin(phi) + ratio * np.sin(phi) * np.cos(phi)
    yield "velocity, two harmonics", same(y(motion, 1), pair)
    own = of_first(motion, "piston_acceleration") / (r * omega**2)
    yield "acceleration", same(y(motion, 0, 1), own)
    pair = np.cos(phi) + ratio * (2.0 * np.cos(phi) ** 2 - 1.0)
    yield "acceleration, two harmonics", same(y(motion, 1, 1), pair)
    _, _, ratio = gear(valley)
    at = np.radians(x(valley, 0))
    bottom = swing(np.pi, ratio)
    yield "valley", bool(np.all(np.abs(y(valley, 0) - swing(at, ratio) + bottom) < 1e-5))
    pair = np.cos(at) + ratio * (2.0 * np.cos(at) ** 2 - 1.0) - (ratio - 1.0)
    yield "valley, two harmonics", same(y(valley, 1), pair)
    yield "says ratio", said(valley, "ratio", ratio)
    lowest = minimize_scalar(lambda p: swing(p, ratio), bounds=(1.6, 3.1), method="bounded").x
    yield "least", said(valley, "least", least(ratio))
    both = [float(each) for each in re.findall(r"[\d.]+", valley["says"]["least"])]
    yield "both", abs(sum(both) - 360.0) < 1e-9
    yield "dots", abs(x(valley, 2)[0] - math.degrees(lowest)) < 0.1
    yield "other dot", same(x(valley, 3), 360.0 - x(valley, 2))
    yield "fork", bool(np.all(np.abs(y(fork, 0) - [least(q) for q in x(fork, 0)]) < 1.2))
    truncated = [180.0 if q <= 0.25 else math.degrees(math.acos(-0.25 / q)) for q in x(fork, 1)]
    yield "fork, truncated", same(y(fork, 1), truncated)
    yield "fork, other branch", same(y(fork, 2), 360.0 - y(fork, 0))
    yield "fork, its truncated", same(y(fork, 3), 360.0 - y(fork, 1))
    yield "limit", said(fork, "limit", 0.26376)  # (sqrt(21) - 3) / 6
    yield "ratio", said(fork, "ratio", gear(fork)[2])


def forces(along, side, worth):
    scene = along["scene"]
    rod, center = scene["rod"], scene["rod"]["center_of_mass"] / scene["rod"]["length"]
    mass = scene["piston"]["mass"] + rod["mass"] * center
    inertia = -1e-3 * mass * of_first(along, "piston_acceleration")
    gas = 1e-3 * of_first(along, "gas_force")
    yield "sum", same(y(along, 0), gas + inertia)
    yield "gas", same(y(along, 1), gas)
    yield "inertia", same(y(along, 2), inertia)
    yield "says gas", said(along, "gas", gas.max())
    yield "says inertia", said(along, "inertia", inertia[gas.argmax()])
    rod = side["scene"]["rod"]
    lumped = rod["mass"] * rod["center_of_mass"] * (rod["length"] - rod["center_of_mass"])
    yield "share", same(rod["inertia"], side["values"]["share"] * lumped)
    lecture, own = y(side, 1), 1e-3 * of_first(side, "side_force")
    angle = column(side, "crank_angle")
    said_by = at_even_speed(made("forces").scene, angle, side["mean"])
    yield "two masses", same(lecture, 1e-3 * said_by["side thrust"][:, 0])
    yield "rigid", same(y(side, 0), own)
    yield "off", said(side, "off", 1e3 * np.abs(lecture - own).max())
    most = 0.4e-3 * lumped * hardest_swing(side["scene"]) * side["mean"] ** 2
    yield "room below", same(side["shapes"][0]["holdsBelow"], [-most, most], 1e-6)
    shape = worth["shapes"][0]
    parts = [np.abs(each["y"]).max() for each in shape["differences"]]
    peak = np.abs(shape["curves"][0]["y"]).max()
    yield "masses", said(worth, "masses", 100.0 * parts[0] / peak)
    yield "series", said(worth, "series", 100.0 * parts[1] / peak)


def hardest_swing(scene):
    """What a rod swings hardest at an even speed, of its square, at the wall [1/m]: a moment of the
    rod's inertia is taken by forces across the piston pin, at the crank pin's lever along X."""
    r, l, e = scene["crank"]["radius"], scene["rod"]["length"], scene["piston"]["offset"]
    h = 1e-4
    found = []
    for phi in (0.5 * math.pi, 1.5 * math.pi):
        beta = [math.asin((r * math.sin(p) - e) / l) for p in (phi - h, phi, phi + h)]
        found.append(abs(beta[0] - 2.0 * beta[1] + beta[2]) / h**2 / (l * math.cos(beta[1])))
    return max(found)


def at_even_speed(scene, angle, mean):
    even = np.full(angle.shape, mean)
    formulas = LECTURES["untruncated lecture"]
    return lectured(formulas, crank_train(scene), angle, even, np.zeros_like(even))


def fluctuation(swing, fall, cost):
    yield "speed", same(y(swing, 0), column(swing, "crank_speed") / RPM)
    yield "mean", same(y(swing, 1), np.full(len(swing["samples"]), swing["mean"] / RPM))
    yield "delta", said(swing, "delta", 100.0 * swing["fluctuation"])
    yield "says mean", said(swing, "mean", swing["mean"] / RPM)
    inertias, about = x(fall, 1), fall["textbook"]
    squares = (inertias + about["moving"]) * fall["mean"] ** 2
    yield "textbook", same(y(fall, 1), 100.0 * about["work"] / squares)
    near = np.abs(np.log(y(fall, 0) / y(fall, 1)))[inertias > inertias[len(inertias) // 2]]
    yield "simulated", bool(np.all(near < 0.05))  # the heavier, the nearer
    wider = np.diff(np.log(inertias))
    yield "flywheels", same(wider, np.full(len(wider), wider.mean()), 1e-6)
    yield "fall's delta", said(fall, "delta", 100.0 * fall["fluctuation"])
    angle = column(cost, "crank_angle")
    even = at_even_speed(made("fluctuation").scene, angle, cost["mean"])["piston acceleration"]
    yield "constant speed", same(y(cost, 1), even[:, 0])
    own = of_first(cost, "piston_acceleration")
    yield "as it swings", same(y(cost, 0), own)  # the lecture's is exact at the own speed
    share = 100.0 * np.abs(own - even[:, 0]).max() / np.abs(own).max()
    yield "share", said(cost, "share", share)


def order_of(values, angles, order):
    """Cosine and sine of an order, by least squares."""
    table = [f(n * angles) for n in range(1, 9) for f in (np.cos, np.sin)]
    found = np.linalg.lstsq(np.stack([np.ones_like(angles), *table], -1), values, rcond=None)[0]
    return found[2 * order - 1 : 2 * order + 1]


def row(couple):
    """The crank from the side: throws and pistons where they are, arrows as the pistons' forces, in
    thousandths of a metre; the arrows' sum is the force on the frame, their moment the couple."""
    scene, at = couple["scene"], couple["at"]
    svg, *parts = couple["drawing"]
    r, mass = 1e3 * scene["crank"]["radius"], scene["piston"]["mass"]
    levers = 1e3 * np.array(scene["levers"])
    phi = at["crank_angle"] + np.array([each["phase"] for each in scene["cylinders"]])
    pins = np.array([each["piston_position"] for each in at["cylinders"]])
    by = {kind: [each for each in parts if each.get("class") == kind] for kind in KINDS}
    throws, bars = (by[kind] for kind in ("throw", "bar"))
    for lines in (throws, bars):
        across = [[float(each[key]) for key in ("x1", "x2")] for each in lines]
        yield "across", same(across, np.stack([levers, levers], axis=1))
    ends = [[float(each[key]) for key in ("y1", "y2")] for each in throws]
    yield "throws", same(ends, np.stack([0.0 * phi, -r * np.cos(phi)], axis=1))
    ends = [[float(each[key]) for key in ("y1", "y2")] for each in bars]
    yield "rods", same(ends, np.stack([-r * np.cos(phi), -1e3 * pins], axis=1))
    wide = 2e3 * math.sqrt(scene["piston"]["area"] / math.pi)
    boxes = [[float(each[key]) for key in ("x", "width", "y", "height")] for each in by["body"]]
    left, width, top, height = np.array(boxes).T
    yield "middles", same(left + 0.5 * width, levers)
    yield "beside", bool(np.all(width < 0.9 * wide) and np.all(width > 0.7 * wide))
    yield "pins inside", bool(np.all(top < -1e3 * pins) and np.all(top + height > -1e3 * pins))
    lengths = np.array([length(each["d"]) for each in by["push"]])
    force = mass * np.array([each["piston_acceleration"] for each in at["cylinders"]])
    per = 1.3 * r / (mass * 1e-3 * r * at["crank_speed"] ** 2)  # m r omega^2 is 1.3 throws
    yield "arrows", same(lengths, per * force)
    yield "force on the frame", same(lengths.sum() / per, at["frame_force_x"], 1e-6 * len(force))
    moment = lengths @ levers / per * 1e-3
    yield (
        "couple of the arrows",
        abs(moment - at["rocking_moment_y"]) < 1e-9 * per * abs(force).sum(),
    )
    above = [tip(each["d"]) for each in by["push"]]
    yield "arrows on the crowns", same(np.maximum(*np.array(above).T), top)
    (letters,) = (each for each in parts if each["name"] == "text")
    number = letters["text"].removeprefix("couple ").removesuffix(" N m").replace("\u2212", "-")
    yield "couple in words", abs(float(number) - at["rocking_moment_y"]) <= 0.51
    left, top, width, height = map(float, svg["viewBox"].split())
    yield (
        "all in it",
        bool(
            left < levers.min() - 0.4 * wide
            and left + width > levers.max() + 0.4 * wide
            and top < min(np.min(above), -1e3 * pins.max())
            and top + height > float(letters["y"])
        ),
    )
    scale = min(SIZE["width"] / width, SIZE["height"] / height)
    yield "letters", same(float(letters["font-size"]) * scale, SIZE["type"])


KINDS = ("throw", "bar", "body", "push")


def tip(path):
    """Where an upright arrow begins and ends, downwards."""
    if not path:
        return 0.0, 0.0
    begin = float(re.match(r"M\S+ (\S+?)V", path)[1])
    return begin, float(re.search(r"L\S+ (\S+?)Z", path)[1])


def length(path):
    """Of an upright arrow, upwards."""
    begin, end = tip(path)
    return begin - end


def balance(shake, couple, torque, twin):
    own = made("balance").scene
    mass = own.piston.mass + own.rod.mass * own.rod.center_of_mass / own.rod.length
    yield "mass to and fro", same(shake["scene"]["piston"]["mass"], mass)
    yield "rod", shake["scene"]["rod"]["mass"] == 0.0
    r, _, ratio = gear(shake)
    unit = 1e-3 * mass * r * shake["mean"] ** 2
    phases = np.array([each["phase"] for each in shake["scene"]["cylinders"]])
    theta = column(shake, "crank_angle")[:, None] + phases
    yield (
        "first order",
        same(y(shake, 1), -unit * np.cos(theta).sum(axis=1) + 0.0, 1e-9)
        or (np.abs(y(shake, 1)).max() < 1e-12 * unit),
    )
    yield "second order", same(y(shake, 2), -unit * ratio * np.cos(2.0 * theta).sum(axis=1))
    frame, angles = 1e-3 * column(shake, "frame_force_x"), np.array(shake["angles"])
    yield "simulated", same(y(shake, 0), -frame)
    for order, name in ((1, "first"), (2, "second")):
        size = math.hypot(*order_of(frame, angles, order))
        yield f"says {name}", said(shake, name, size) if size > 1e-9 else said(shake, name, 0.0)
    yield "sticks", abs(y(shake, 0, 1).max() - math.hypot(*order_of(frame, angles, 2))) < 1e-6
    levers = np.array(couple["scene"]["levers"])
    spacing = np.diff(levers)
    yield "levers", same(levers, -levers[::-1]) and bool(np.all(spacing > 0.0))
    yield "spacing", same(spacing, np.full(len(spacing), made("balance").more["spacing"]))
    yield from row(couple)
    moment = column(couple, "rocking_moment_y")
    yield "couple's words", "3 cylinders sum to nothing" in couple["says"]["words"]
    yield "couple", said(couple, "most", np.abs(moment).max())
    sums = np.array([sum(c["crank_torque"] for c in v["cylinders"]) for v in torque["samples"]])
    yield "torque", same(y(torque, 0), sums)
    yield "mean torque", bool(np.all(np.abs(y(torque, 1) - sums[1:].mean()) < 1e-9 * sums.max()))
    yield "orders", torque["says"]["orders"] == "2, 4, 6"
    cylinders, bank = twin["scene"]["cylinders"], math.radians(twin["values"]["bank"])
    yield "bank", same(cylinders[1]["bank"] - cylinders[0]["bank"], bank)
    yield "one pin", same([each["phase"] + each["bank"] for each in cylinders], [0.0, 0.0], 1e-9)
    crank = twin["scene"]["crank"]
    yield "weight", same(crank["mass"] * crank["center_of_mass"],
                         -0.01 * twin["values"]["weight"] * mass * crank["radius"])  # fmt: skip
    across, up = (1e-3 * column(twin, f"frame_force_{axis}") for axis in "yx")
    yield "force", same(x(twin, 0), across) and same(y(twin, 0), up)
    angles = np.array(twin["angles"])
    waves = np.stack([np.cos(angles), np.sin(angles)])
    parts = [order_of(values, angles, 1) for values in (across, up)]
    yield "first order, across", same(x(twin, 1), parts[0] @ waves, 1e-6)
    yield "first order, up", same(y(twin, 1), parts[1] @ waves, 1e-6)
    yield "says first", said(twin, "first", max(math.hypot(*part) for part in parts))


def omega(moment, energy, speed):
    def power(v):
        return sum(c["gas_force"] * c["piston_velocity"] for c in v["cylinders"])

    gas = np.array([power(v) / v["crank_speed"] for v in moment["samples"]])
    load = -column(moment, "external_torque")
    yield "gas", same(y(moment, 0), gas)
    yield "load", same(y(moment, 1), load)
    slope = np.gradient(column(moment, "kinetic_energy"), column(moment, "crank_angle"))
    yield "balance", np.median(np.abs(slope - (gas - load))) < 0.01 * gas.max()
    yield "says load", said(moment, "load", load[1:].mean())
    yield "says most", said(moment, "most", gas.max())
    fast, angles = column(moment, "crank_speed"), np.array(moment["angles"])
    feels = 2.0 * column(moment, "kinetic_energy") / fast**2  # inertia of all that moves
    alpha = column(moment, "crank_acceleration")
    moving = feels - moment["scene"]["crank"]["inertia"]
    taken = 0.5 * np.gradient(feels, angles) * fast**2 + moving * alpha
    yield "taken", np.median(np.abs(y(moment, 2) - load - taken)) < 0.01 * taken.max()
    yield "faster", bool(np.all(((y(moment, 0) > y(moment, 2)) == (alpha > 0.0))[1:-1]))
    shown = fast / RPM, np.full(len(fast), moment["mean"] / RPM)
    yield "crank speed", all(same(y(moment, k, 1), each) for k, each in enumerate(shown))
    yield "says mean", said(moment, "mean", moment["mean"] / RPM)
    share, follows = 100.0 * np.mean(alpha[gas > load] > 0.0), "follows the gas"
    yield "share", said(moment, "share", share)
    yield "verdict", (follows in moment["says"]["verdict"]) == (share > 50.0)
    kinetic = column(energy, "kinetic_energy")
    yield "energy", same(y(energy, 0), kinetic)
    yield "its mean", same(y(energy, 1), np.full(len(kinetic), kinetic[1:].mean()))
    yield "swing", said(energy, "swing", np.ptp(kinetic))
    yield "stored", said(energy, "stored", kinetic[1:].mean())
    kinetic, fast = column(speed, "kinetic_energy"), column(speed, "crank_speed")
    inertia = 2.0 * kinetic / fast**2
    yield "as if constant", same(y(speed, 1), np.sqrt(2.0 * kinetic / inertia[1:].mean()) / RPM)
    yield "least", said(speed, "least", inertia.min())
    yield "most", said(speed, "most", inertia.max())
    yield "delta", said(speed, "delta", 100.0 * speed["fluctuation"])


def polar(bearing, pin, turning):
    size = np.hypot(*(column(bearing, f"main_bearing_force_{axis}") for axis in "xy"))
    yield "size", same(y(bearing, 0, 1), 1e-3 * size)
    yield "peak", said(bearing, "peak", 1e-3 * size.max())
    at = np.abs(np.degrees(bearing["angles"]) % 10.0 - 5.0) > 5.0 - 1e-6
    for k, figure in ((1, bearing), (1, pin), (2, turning)):
        found = np.array([x(figure, k), y(figure, k)])
        right = same(found[:, ::3], [x(figure, 0)[at], y(figure, 0)[at]])
        yield "dots", right and bool(np.all(np.isnan(found[:, 2::3])))
    yield "angle", said(bearing, "angle", math.degrees(bearing["angles"][size.argmax()]))
    force = of_first(pin, "crank_pin_force_x") + 1j * of_first(pin, "crank_pin_force_y")
    yield "pin's peak", said(pin, "peak", 1e-3 * np.abs(force).max())
    yield "pin's angle", said(pin, "angle", math.degrees(pin["angles"][np.abs(force).argmax()]))
    force = of_first(turning, "crank_pin_force_x") + 1j * of_first(turning, "crank_pin_force_y")
    felt = -force * np.exp(-1j * column(turning, "crank_angle"))  # of the rod on the pin
    yield "outwards", same(y(turning, 0), 1e-3 * felt.real)
    yield "across", same(x(turning, 0), 1e-3 * felt.imag)
    hole = math.radians(float(turning["says"]["hole"].rstrip("°").replace("\u2212", "-")))
    around = np.radians(np.arange(-180.0, 180.0, 2.0))
    off = np.cos(np.angle(-felt)[:, None] - around)  # a force presses where it comes from
    pressed = np.where(off >= 0.5, np.abs(felt)[:, None] * off, 0.0).sum(axis=0)
    best = around[pressed.argmin()]
    yield "hole", abs(hole - best) < math.radians(0.6)
    far = 0.8e-3 * np.abs(felt).max()
    ray = [far * np.sin(best), far * np.cos(best)]
    yield "ray", same([x(turning, 1)[1], y(turning, 1)[1]], ray)


def trust(step, order, stated):
    span = math.degrees(step["angles"][-1] - step["angles"][0])
    count = round(span / step["values"]["size"])
    yield "count", said(step, "count", count)
    exact, drawn = y(step, 0), y(step, 1)
    yield "exact", same(exact, column(step, "crank_speed") / RPM)
    apart = step["shapes"][0]["differences"][0]["y"]
    yield "difference", same(apart, drawn - exact)
    at = (len(drawn) - 1) // count
    bends = np.abs(np.diff(drawn[:-1].reshape(count, at), 2))
    yield "broken line", bool(np.all(bends < 1e-9 * exact.max()))
    nodes = np.abs(np.array(apart)[::at])
    yield "off", said(step, "off", nodes.max())
    digits = y(order, 1)  # Heun, as the figure begins
    counts = np.round(10.0 ** x(order, 1)).astype(int)
    here = digits[counts.tolist().index(round(span / order["values"]["size"]))]
    yield "digits", said(order, "digits", here)
    yield "as the step has it", abs(here + math.log10(nodes.max() * RPM / order["mean"])) < 1e-3
    for k, slope in enumerate((1.0, 2.0, 4.0)):
        long = counts >= (576 if slope == 1.0 else 144)
        rise = np.polyfit(np.log10(counts[long]), y(order, k)[long], 1)[0]
        yield f"order {slope:g}", abs(rise - slope) < 0.35
    twice = digits[counts.tolist().index(2 * round(span / order["values"]["size"]))]
    yield "times", said(order, "times", 10.0 ** (twice - here))
    truth, told = y(stated, 0), y(stated, 1)
    far = counts >= 1152  # where the last two orders agree
    yield "stated near true", bool(np.all(np.abs(truth - told)[far] < 0.05))
    at = counts.tolist().index(round(span / stated["values"]["size"]))
    yield "ratio", said(stated, "ratio", 10.0 ** (truth[at] - told[at]))


GUARDS = {
    "displacement": displacement,
    "acceleration": acceleration,
    "forces": forces,
    "fluctuation": fluctuation,
    "balance": balance,
    "omega": omega,
    "polar": polar,
    "trust": trust,
}
"""By lesson: its figures' answers, by their names -> (guard, whether it holds), one by one."""


def wrong(name, figures):
    """The guards of a lesson that do not hold."""
    return [guard for guard, holds in GUARDS[name](**figures) if not holds]
