"""What must be true of what the page says and shows as numbers and forces: Python's motion, the law
of Newton for every drawn body."""

import io
import math

import numpy as np
from page_cases import CASES, CURVES, POLARS, SAID, frame, of_cylinder, same, truth

from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import EVERY, SUMS


def wrong(name, said):
    """The names of the guards that what a case says does not hold."""
    scene, data = truth(name)
    about = (scene, data, CASES[name][2])
    guards = {
        "data": lambda: data_hold(said["data"], data),
        "cycle": lambda: cycle_holds(said, *about),
        "curves": lambda: curves_hold(said, *about),
        "polars": lambda: polars_hold(said, *about),
        "forces": lambda: forces_hold(said["forces"], *about),
        "words": lambda: words_hold(said, *about),
    }
    return [guard for guard, holds in guards.items() if not holds()]


def data_hold(text, data):
    """The columns handed out: every variable under its name and unit, of its peak, or where it may
    cancel of that of its unit."""
    names = text.splitlines()[0].split(",")
    rows = np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)
    columns = dict(zip(names, rows.T, strict=True))
    largest: dict[str, float] = {}
    variables = [v for v in data.variables if v not in ("cylinder", "energy_residual")]
    for variable in variables:
        unit = EVERY[variable].units
        largest[unit] = max(largest.get(unit, 0.0), np.abs(data[variable].values).max())
    start = columns["time [s]"][0]
    for variable in variables:
        values, unit = data[variable].values, EVERY[variable].units
        own = np.abs(values).max()
        size = largest[unit] if variable in SUMS or own < 1e-9 * largest[unit] else own
        for number, one in enumerate(np.atleast_2d(values.T), start=1):
            of = f" {number}" if values.ndim == 2 else ""
            found = columns.get(f"{variable}{of} [{unit}]")
            if variable == "time":
                found, one, size = columns["time [s]"] - start, one - one[0], one[-1] - one[0]
            if variable == "crank_angle":
                one = one - one[0] + columns["crank_angle [rad]"][0]
            if found is None or not same(found, one, size, 5e-9):
                return False
    return True


def cycle_holds(said, scene, data, _):
    """Mean, gain and fluctuation of the speed, and the crank's lead on a ring that turns evenly."""
    time, angle = data["time"].values, data["crank_angle"].values
    speed = data["crank_speed"].values
    mean = (angle[-1] - angle[0]) / (time[-1] - time[0])
    lead = angle - angle[0] - mean * (time - time[0])
    lead -= lead[1:].mean()
    middle = 0.5 * (said["angles"][77] + said["angles"][78])
    return (
        same(said["mean"], mean)
        and same(said["gain"], (speed[-1] - speed[0]) * 30.0 / math.pi, mean)
        and same(said["fluctuation"], np.ptp(speed) / mean, near=2e-3)
        and same(said["leads"], lead, 1.0)
        and same(said["lead"], 0.5 * (lead[77] + lead[78]), 1.0)
        and same(said["ahead"], 0.5 * (time[77] + time[78]) - time[0], near=1e-4)
        and same(said["angle"], middle, near=1e-5)
        and said["prescribed"] == (scene.motion is not None)
    )


def at_mean(scene, data):
    """What the lectures say at the mean speed, exact and truncated."""
    time, angle = data["time"].values, data["crank_angle"].values
    mean = np.full(angle.shape, (angle[-1] - angle[0]) / (time[-1] - time[0]))
    still = np.zeros_like(mean)
    train = crank_train(scene)
    return [
        lectured(LECTURES[each], train, angle, mean, still)
        for each in ("untruncated lecture", "S1 (motion and forces truncated)")
    ]


def curves_hold(said, scene, data, k):
    """Every curve in its unit, those of the lectures, and what one is less the next."""
    says = at_mean(scene, data)
    shape = scene.running_gear[k].shape
    datum = shape[0] + shape[1] - math.sqrt((shape[0] + shape[1]) ** 2 - shape[2] ** 2)
    for name, (variable, per, unit) in CURVES.items():
        if variable == "gas_pressure" and scene.gas is None:
            continue
        found = said["curves"][name]
        total = name == "turning moment"
        wanted = [of_cylinder(data[variable].values, k, total)]
        if name in SAID:
            less = datum if name == "piston displacement" else 0.0
            wanted += [of_cylinder(each[SAID[name]], k, total) - less for each in says]
        elif name == "crank speed":
            wanted.append(np.full(wanted[0].shape, said["mean"]))
        large = unit == "N" and max(np.abs(each).max() for each in wanted) >= 1e3
        factor = 1e-3 if large else per
        size = factor * max(np.abs(each).max() for each in wanted)
        size = max(size, factor * 1e-6 * np.abs(data["crank_pin_force_x"].values).max())
        if found["up"]["unit"] != ("kN" if large else unit) or found["up"]["text"] != name:
            return False
        if len(found["curves"]) != len(wanted):
            return False
        pairs = zip(found["curves"], wanted, strict=True)
        if not all(same(one["y"], factor * two, size, 1e-8) for one, two in pairs):
            return False
        if not all(same(each["x"], np.degrees(said["angles"])) for each in found["curves"]):
            return False
        if not same(found["now"], factor * wanted[0][100], size, 1e-8):
            return False
        for each, one, two in zip(found["differences"], wanted, wanted[1:], strict=False):
            if not same(each["y"], factor * (one - two), size, 2e-8):
                return False
        if len(found["differences"]) != (0 if name == "crank speed" else len(wanted) - 1):
            return False
    if scene.double_acting:
        below = 1e-5 * of_cylinder(data["crank_end_pressure"].values, k)
        if not same(said["curves"]["crank end pressure"]["curves"][0]["y"], below, near=1e-8):
            return False
    if scene.force:
        found = said["curves"]["applied force"]
        pushed = of_cylinder(data["applied_force"].values, k)
        per = 1e-3 if np.abs(pushed).max() >= 1e3 else 1.0
        if not same(found["curves"][0]["y"], per * pushed, near=1e-8):
            return False
    ahead = said["curves"]["crank ahead of the mean"]
    return ahead["up"]["unit"] == "°" and same(ahead["curves"][0]["y"], np.degrees(said["leads"]))


def polars_hold(said, scene, data, k):
    """Diagrams: pressure over the swept volume, and forces with X up and Y to the left."""
    says = at_mean(scene, data)[1]
    for name, variable in POLARS.items():
        found = said["curves"][name]
        wanted = [[of_cylinder(data[f"{variable}_{axis}"].values, k) for axis in "yx"]]
        if variable != "frame_force":
            key = variable.replace("_", " ")
            wanted.append([of_cylinder(says[f"{key} {axis}"], k) for axis in "yx"])
        per = 1e-3 if np.abs(wanted).max() >= 1e3 else 1.0
        units = {found[axis]["unit"] for axis in ("up", "right")}
        if not found["equal"] or units != {"kN" if per < 1.0 else "N"}:
            return False
        size = per * max(np.abs(wanted).max(), 1e-6 * np.abs(data["crank_pin_force_x"]).max())
        for curve, pair in zip(found["curves"], wanted, strict=True):
            if not same([curve["x"], curve["y"]], per * np.array(pair), size, 1e-8):
                return False
    found = said["curves"]["p-V diagram"]
    if scene.gas is None:
        return True
    volume = area(scene, k) * 1e6 * of_cylinder(data["piston_displacement"].values, k)
    loops = {"simulated": (volume, data["gas_pressure"])}
    if scene.double_acting:
        share = 1.0 - 0.25 * math.pi * scene.piston.rod_diameter**2 / area(scene, k)
        loops = {
            "head end": (volume, data["gas_pressure"]),
            "crank end": (share * volume, data["crank_end_pressure"]),
        }
    if [curve["name"] for curve in found["curves"]] != list(loops):
        return False
    shown = [found[axis]["unit"] for axis in ("right", "up")]
    return shown == ["cm³", "bar"] and all(
        same(curve["x"], x) and same(curve["y"], 1e-5 * of_cylinder(y.values, k), near=1e-8)
        for curve, (x, y) in zip(found["curves"], loops.values(), strict=True)
    )


def area(scene, k=0):
    """Of a piston's crown [m2]."""
    piston = scene.running_gear[k].piston
    return piston.area if piston.bore is None else 0.25 * math.pi * piston.bore**2


def forces_hold(forces, scene, data, k):
    """Newton: the arrows on a body and its weight give its acceleration; Euler: about its centre of
    mass those on the rod turn it."""
    (radius, rod, piston), crank = scene.running_gear[k], scene.crank
    cylinder = scene.cylinders[k]
    g = gravity_of(scene)
    one = {name: of_cylinder(data[name].values, k) for name in data.data_vars}
    phi = data["crank_angle"].values + cylinder.phase
    pins = [
        frame(cylinder.bank, one["piston_position"], piston.offset),
        frame(cylinder.bank, radius * np.cos(phi), radius * np.sin(phi)),
    ]
    share = rod.center_of_mass / rod.length
    turned_by = np.exp(1j * data["crank_angle"].values)
    omega, alpha = data["crank_speed"].values, data["crank_acceleration"].values
    lag = frame(cylinder.bank + cylinder.phase, radius, 0.0)
    of_pin = (1j * alpha - omega**2) * turned_by * lag
    of_piston = frame(cylinder.bank, -one["piston_acceleration"], 0.0)
    of_rod = (1.0 - share) * of_pin + share * of_piston
    of_crank = (1j * alpha - omega**2) * turned_by * crank.center_of_mass
    wanted = [(piston.mass, of_piston), (rod.mass, of_rod), (crank.mass, of_crank)]
    size = np.abs(data["crank_pin_force_x"].values).max()
    for arrows, (mass, accelerates) in zip(forces, wanted, strict=True):
        total = sum_of(arrows)
        needed = mass * (accelerates - g)
        if not same([total.real, total.imag], [needed.real, needed.imag], size, 1e-8):
            return False
    places = [[complex(*each["at"]) for each in arrows] for arrows in forces[1]]
    on_rod = np.array(places).T
    centre = pins[1] + share * (pins[0] - pins[1])
    if not all(
        same(np.abs(one - two), 0.0 * phi, 1.0) for one, two in zip(on_rod, pins, strict=True)
    ):
        return False
    parts = [[complex(*each["force"]) for each in arrows] for arrows in forces[1]]
    moment = sum(
        ((place - centre).conj() * force).imag
        for place, force in zip(on_rod, np.array(parts).T, strict=True)
    )
    inertia = (
        rod.mass * rod.center_of_mass * (rod.length - rod.center_of_mass)
        if rod.inertia == "two-mass"
        else rod.inertia
    )
    spin = -inertia * one["rod_angular_acceleration"]
    return same(np.abs(moment), np.abs(spin), size * rod.length, 1e-8) and named_rightly(
        forces, pins, scene
    )


def gravity_of(scene):
    if scene.gravity is None:
        return 0.0
    return scene.gravity.acceleration * np.exp(1j * scene.gravity.angle)


def sum_of(samples):
    return np.array([sum(complex(*each["force"]) for each in arrows) for arrows in samples])


def named_rightly(forces, pins, scene):
    """What acts where: gas and wall on the piston at its pin, rods on the crank at theirs."""
    on_piston, _, on_crank = (samples[0] for samples in forces)
    names = {"wall on piston", "rod on piston"} | ({"gas on piston"} if scene.gas else set())
    names |= {"friction on piston"} if scene.friction else set()
    names |= {"applied force"} if scene.force else set()
    n = len(scene.cylinders)
    rods = [f"rod {number} on crank" for number in range(1, n + 1)] if n > 1 else ["rod on crank"]
    return (
        {each["name"] for each in on_piston} == names
        and all(abs(complex(*each["at"]) - pins[0][0]) < 1e-12 for each in on_piston)
        and [each["name"] for each in on_crank] == [*rods, "bearing on crank"]
        and abs(complex(*on_crank[-1]["at"])) < 1e-12
        and all(
            abs(abs(complex(*each["at"])) - gear.radius) < 1e-12
            for each, gear in zip(on_crank[:-1], scene.running_gear, strict=True)
        )
    )


def words_hold(said, scene, data, k):
    """The headline's numbers, the badge, and dead centres where the piston stands still."""
    numbers_said = {name: text.replace("\u2212", "-") for name, text in said["numbers"]}
    angle, time = data["crank_angle"].values, data["time"].values
    speed, outside = data["crank_speed"].values, data["external_torque"].values
    mean = (angle[-1] - angle[0]) / (time[-1] - time[0])
    close = {
        "mean speed": (mean * 30.0 / math.pi, "rpm", 0.051),
        "fluctuation": (100.0 * np.ptp(speed) / mean, "%", 0.02),
    }
    for name, peak in peaks(data).items():  # between samples it is up to half a percent more
        close[name] = (1e-3 * peak, "kN", 0.006 + 3e-6 * peak)
    done = np.trapezoid(outside, angle)
    drives = scene.motion is not None or done > 0.0
    close["drive torque" if drives else "load torque"] = (done / (angle[-1] - angle[0]), "N m", 0.2)
    if scene.gas is not None:
        travel, seconds = data["piston_displacement"].values, time[-1] - time[0]

        def done_by(force):
            pairs = zip(force.T, travel.T, strict=True)
            return sum(np.trapezoid(f, x) for f, x in pairs)

        work = done_by(data["gas_force"].values)
        close["indicated power"] = (1e-3 * work / seconds, "kW", 0.05)
        if scene.double_acting:
            head = done_by(area(scene) * data["gas_pressure"].values)
            close["of the head end"] = (1e-3 * head / seconds, "kW", 0.05)
            close["of the crank end"] = (1e-3 * (work - head) / seconds, "kW", 0.05)
    if scene.friction is not None:
        power = data["friction_force"].values * data["piston_velocity"].values
        rubbed = -np.trapezoid(power.reshape(len(time), -1).sum(axis=1), time)
        close["friction power"] = (1e-3 * rubbed / (time[-1] - time[0]), "kW", 0.01)
        left = work - rubbed
        efficiency = left / work if work > 0.0 else work / left
        close["mechanical efficiency"] = (100.0 * efficiency, "%", 0.1)
    if scene.force:
        power = data["applied_force"].values * data["piston_velocity"].values
        given = np.trapezoid(power.reshape(len(time), -1).sum(axis=1), time)
        close["power of applied forces"] = (1e-3 * given / (time[-1] - time[0]), "kW", 0.01)
    if numbers_said.get("cylinders", "1") != str(len(scene.cylinders)):
        return False
    for name, (value, unit, near) in close.items():
        text = numbers_said.get(name, "")
        number = text.removesuffix(f" {unit}")
        if (
            number == text
            or number in "–…"
            or not abs(float(number) - value)
            <= near + 2e-3 * abs(value) * (name not in ("mean speed", "fluctuation"))
        ):
            return False
    still = of_cylinder(data["piston_velocity"].values, k)
    degrees = np.degrees(said["angles"])
    for mark in said["marks"]:
        at_mark = np.interp(mark["degrees"], degrees, still)
        high = np.interp(
            mark["degrees"], degrees, of_cylinder(data["piston_displacement"].values, k)
        )
        if abs(at_mark) > 1e-3 * np.abs(still).max():
            return False
        if (high < 0.5 * scene.running_gear[k].radius) != (mark["name"] == "top"):
            return False
    gain = (speed[-1] - speed[0]) * 30.0 / math.pi
    badge = said["badge"]["text"]
    if abs(gain) > 1.0 and f"{'gains' if gain > 0 else 'loses'} {abs(gain):.0f} rpm" not in badge:
        return False
    drifts = scene.motion is None and abs(gain) > 1e-3
    kind = "prescribed" if scene.motion is not None else "not settled" if drifts else "settled"
    if scene.torque and scene.torque[-1].kind == "constant":
        kind = "settled under the constant torque that balances the cycle"
        kind += ": every speed" if scene.friction is None else " at the mean"
    turns_made = round((angle[-1] - angle[0]) / math.tau)
    return (
        badge.startswith(kind)
        and said["badge"]["good"] != drifts
        and len(said["marks"]) >= 2 * turns_made
    )


def peaks(data):
    """The largest forces of the samples [N], by their names in the headline."""
    bearing, pin = (
        np.hypot(*(data[f"{joint}_force_{axis}"].values for axis in "xy"))
        for joint in ("main_bearing", "crank_pin")
    )
    side = np.abs(data["side_force"].values)
    sizes = {"main bearing, peak": bearing, "side force, peak": side, "crank pin, peak": pin}
    return {name: size.max() for name, size in sizes.items()}
