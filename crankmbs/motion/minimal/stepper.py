"""Steps over time of one free rotation, compiled by numba (`crankmbs.numerics.kernels`).

All that is evaluated step by step: the crank train reduced to one rotation, and the methods of
Dormand and Prince of order 8 and 5; in scalars, so that they and `mechanics.inertia` check each
other. Kernels of one file call none of another, so that they stand together here, over 300 lines.
"""

from __future__ import annotations

import math

import numpy as np

from crankmbs.motion.minimal.dop853 import D4, E3, E4, E5, A, C, D
from crankmbs.motion.minimal.system import Machine, System
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["NEAR", "enter", "first_exit", "land", "reduced", "slopes", "travel"]

Asked = tuple[float, float, float, int]  # as in `travel`
Steps = tuple[Array, Array, Array]  # beginnings and lengths [s], and rows as in `first_exit`
Room = tuple[Array, Array, Array, Array]  # slopes of the stages, and of the steps what comes next

_PASSED = 1e-9  # rad: a knot this close ahead has been passed
_MANY, _FAR = 4.0, 0.5  # knots apart; rad: longer steps roam across knots, none so long
NEAR = 0.01  # of a step: a landing is as close to its limit
_BISECTIONS, _SCAN = 60, 16
_OWN = 16  # the first stage of order 5 that is not of order 8
_LONGER = 1.2  # a step of order 5 is tried again, that was too long before
_HARD = 1e3 / math.radians(5.0)  # 1/rad: damped a thousand times while the crank turns 5 degrees


@kernel
def enter(theta: float, sense: float, machine: Machine, pieces: Array) -> tuple[float, float]:
    """The knots next to theta in the sense of rotation; fills ``pieces``.

    pieces : shape (cylinders, 9), of every cylinder's pressure between the two: the crank angle
        [rad] where its cubic begins, its coefficients [Pa], highest power first, and the width
        after which `reduced` takes the next one; 0, where it is continued; given, the share of the
        combustion; and the signs that friction keeps there, of the sense of rotation times that of
        dx/dtheta, and of the gas force. With loads over the crank angle one row more [N m]
    """
    base, low, high = _beside(machine[13], theta + sense * _PASSED, machine[14])
    for j in range(0 if len(machine[16]) > 0 else len(machine[12]), len(pieces)):
        _fill(j, base, 0.5 * (low + high), machine, pieces)
        pieces[j, 5] = 0.0
    if machine[23] > 0.0 or machine[24] > 0.0:
        for j in range(len(machine[12])):
            _rub(j, base + 0.5 * (low + high), sense, machine, pieces)
    return base + low, base + high


@kernel
def _rub(j: int, theta: float, sense: float, machine: Machine, pieces: Array) -> None:
    """Put the signs that friction keeps, as they are at an angle, into row j of ``pieces``."""
    r, l, e, phi = machine[0], machine[1], machine[3], theta + float(machine[12][j, 0])
    sin_b = (r * math.sin(phi) - e) / l
    rise = -math.sin(phi) * math.sqrt(1.0 - sin_b * sin_b) - math.cos(phi) * sin_b
    pieces[j, 7] = math.copysign(sense, sense * rise)
    d = theta - float(pieces[j, 0])
    cubic = (float(pieces[j, 1]) * d + float(pieces[j, 2])) * d + float(pieces[j, 3])
    pieces[j, 8] = math.copysign(1.0, cubic * d + float(pieces[j, 4]))


@kernel
def _beside(knots: Array, theta: float, period: float) -> tuple[float, float, float]:
    """Where the period at an angle begins, and from there the knots beside; infinite without
    any."""
    base = math.floor(theta / period) * period
    if len(knots) == 0:
        return base, -math.inf, math.inf
    k = _passed(knots, theta - base)
    low = knots[k - 1] if k > 0 else knots[-1] - period
    high = knots[k] if k < len(knots) else knots[0] + period
    return base, float(low), float(high)


@kernel
def _fill(j: int, base: float, local: float, machine: Machine, pieces: Array) -> None:
    """Put the cubic of row j at the crank angle base + local into ``pieces``, to its end."""
    cylinders, _, _, places, all_starts, coefficients = machine[12:18]
    combustion, fires = machine[19], j < len(cylinders) and machine[19].shape[1] > 0
    if j < len(cylinders):
        begin, end = places[j, 0], places[j, 1]
        starts = all_starts[begin:end]
        within = (local + cylinders[j, 0] - cylinders[j, 3]) % starts[-1]
    else:
        begin = 0
        first, starts, coefficients = machine[20:23]
        within = (local - first) % starts[-1]
    i = min(_passed(starts, within), len(starts) - 1) - 1
    pieces[j, 0] = base + local - (within - starts[i])
    for power in range(4):
        pieces[j, 1 + power] = coefficients[power, begin + i]
        if fires:
            pieces[j, 1 + power] += pieces[j, 6] * combustion[power, begin + i]
    pieces[j, 5] = starts[i + 1] - starts[i]


@kernel
def _roam(y: Array, h: float, machine: Machine, pieces: Array, limits: Array, roams: bool) -> bool:
    """Whether a step is so long that it roams across knots; ``limits`` are then only those where a
    pressure bends, and ``pieces`` end with their knots."""
    theta, sense = float(y[0]), math.copysign(1.0, y[1])
    if roams:
        limits[0], limits[1] = enter(theta, sense, machine, pieces)
    if abs(y[1]) * h <= _MANY * (limits[1] - limits[0]):
        return False
    for j in range(len(pieces)):
        _fill(j, 0.0, theta, machine, pieces)
    base, low, high = _beside(machine[18], theta + sense * _PASSED, machine[14])
    limits[0], limits[1] = base + low, base + high
    return True


@kernel
def _passed(knots: Array, value: float) -> int:
    """How many of the increasing knots are not above a value."""
    low, high = -1, len(knots)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if knots[middle] <= value else (low, middle)
    return high


@kernel
def reduced(theta: float, machine: Machine, pieces: Array) -> tuple[float, float, float, float]:
    """J [kg m2], dJ/dtheta [kg m2/rad], torque of gas, gravity, loads over the angle and friction
    without the viscous [N m], of which the last is the torque per speed [N m s/rad]."""
    r, l, a, e, i_crank, i_rod, m_rod, m_piston, area, unbalance, gx, gy, cylinders = machine[:13]
    spare, far = max(l - r - abs(e), 0.0), abs(e)
    (ring_force, pressed, viscous), drag = machine[23:26], 0.0
    inertia, slope = i_crank, 0.0
    torque = unbalance * (gy * math.cos(theta) - gx * math.sin(theta))
    for j in range(len(cylinders)):
        phi = theta + float(cylinders[j, 0])
        gx, gy = float(cylinders[j, 1]), float(cylinders[j, 2])
        sin_p, cos_p = math.sin(phi), math.cos(phi)
        sin_b = (r * sin_p - e) / l
        wide = 1.0 + abs(sin_p)
        narrow = cos_p * cos_p / wide
        above, below = (narrow, wide) if sin_p > 0.0 else (wide, narrow)  # 1 - sin_p, 1 + sin_p
        cos_b = math.sqrt((spare + far + e + r * above) * (spare + far - e + r * below)) / l
        b1 = r * cos_p / (l * cos_b)
        towards = (below if e >= 0.0 else above) / l
        bend = sin_p * (spare / l) * (1.0 + (r + far) / l) + e * r * towards * towards
        b2 = -r * bend / (l * cos_b * cos_b * cos_b)
        x1 = -r * sin_p - l * sin_b * b1
        x2 = -r * cos_p - l * (cos_b * b1 * b1 + sin_b * b2)
        gx1, gy1 = -r * sin_p - a * sin_b * b1, r * cos_p - a * cos_b * b1
        gx2 = -r * cos_p - a * (cos_b * b1 * b1 + sin_b * b2)
        gy2 = -r * sin_p - a * (cos_b * b2 - sin_b * b1 * b1)
        inertia += m_piston * x1 * x1 + m_rod * (gx1 * gx1 + gy1 * gy1) + i_rod * b1 * b1
        slope += 2.0 * (m_piston * x1 * x2 + m_rod * (gx1 * gx2 + gy1 * gy2) + i_rod * b1 * b2)
        if pieces[j, 5] > 0.0 and not 0.0 <= theta - pieces[j, 0] <= pieces[j, 5]:
            _fill(j, 0.0, theta, machine, pieces)
        d = theta - float(pieces[j, 0])
        cubic = (float(pieces[j, 1]) * d + float(pieces[j, 2])) * d + float(pieces[j, 3])
        gas = area * (cubic * d + float(pieces[j, 4]))
        torque += (m_piston * gx - gas) * x1 + m_rod * (gx * gx1 + gy * gy1)
        if ring_force > 0.0 or pressed > 0.0:
            limit = ring_force + pressed * float(pieces[j, 8]) * gas
            torque -= float(pieces[j, 7]) * x1 * limit
        drag += viscous * x1 * x1
    for j in range(len(cylinders), len(pieces)):
        if pieces[j, 5] > 0.0 and not 0.0 <= theta - pieces[j, 0] <= pieces[j, 5]:
            _fill(j, 0.0, theta, machine, pieces)
        d = theta - float(pieces[j, 0])
        cubic = (float(pieces[j, 1]) * d + float(pieces[j, 2])) * d + float(pieces[j, 3])
        torque += cubic * d + float(pieces[j, 4])
    return inertia, slope, torque, drag


@kernel
def slopes(t: float, y: Array, system: System, out: Array) -> None:
    """Slopes of (theta, omega, work) in time; no numbers where a trial step went far too far."""
    theta, (machine, pieces, load) = float(y[0]), system
    out[0] = out[1] = out[2] = math.nan
    if math.isfinite(theta * y[1]):
        _slopes(t, float(y[1]), load, reduced(theta, machine, pieces), out)


@kernel
def _slopes(
    t: float,
    omega: float,
    load: tuple[float, float, float, float],
    of_angle: tuple[float, float, float, float],
    out: Array,
) -> None:
    """The same where the train has been reduced."""
    inertia, slope, torque, drag = of_angle
    torque += load[0] + load[1] * t + (load[2] + load[3] * omega) * omega
    torque -= drag * omega
    alpha, power = (torque - 0.5 * slope * omega * omega) / inertia, torque * omega
    if math.isfinite(alpha * power):
        out[0], out[1], out[2] = omega, alpha, power


@kernel
def _stages(
    which: range, t: float, h: float, y: Array, system: System, k: Array, at: Array
) -> None:
    """The slopes k of some stages of a step from y; leaves the state of the last one in ``at``."""
    for s in which:
        for q in range(3):
            rise = float(A[s, 0]) * float(k[0, q])
            for i in range(_OWN if s >= _OWN else 1, s):
                rise += float(A[s, i]) * float(k[i, q])
            at[q] = float(y[q]) + h * rise
        slopes(t + h * float(C[s]), at, system, k[s])


@kernel
def _error(h: float, k: Array, allowed: tuple[float, float]) -> float:
    """A step's error over what is allowed of angle and speed, from estimates of order 5 and 3.

    The work takes no part: its order 3 estimate, in the same sum, would hide that of the speed.
    """
    five = three = 0.0
    for q in range(2):
        by_five = by_three = 0.0
        for i in range(13):
            by_five += float(E5[i]) * float(k[i, q])
            by_three += float(E3[i]) * float(k[i, q])
        five, three = five + (by_five / allowed[q]) ** 2, three + (by_three / allowed[q]) ** 2
    return h * five / math.sqrt(2.0 * (five + 0.01 * three)) if five != 0.0 else 0.0


@kernel
def _interpolate(
    t: float, h: float, y: Array, new: Array, system: System, k: Array, row: Array
) -> None:
    """The interpolant of order 7 of a step from y to ``new``, as `first_exit` takes it."""
    _stages(range(13, 16), t, h, y, system, k, row[0])
    for q in range(3):
        rise, first, last = new[q] - y[q], h * k[0, q], h * k[12, q]
        row[0, q], row[1, q], row[2, q] = y[q], rise, first - rise
        row[3, q] = 2.0 * rise - first - last
        for p in range(4):
            total = 0.0
            for i in range(16):
                total += float(D[p, i]) * float(k[i, q])
            row[4 + p, q] = h * total


@kernel
def _value(row: Array, q: int, x: float) -> float:
    """Component q of an interpolant at the fraction x of its step."""
    y = 0.0
    for i in range(7):
        y = (y + float(row[7 - i, q])) * (x if i % 2 == 0 else 1.0 - x)
    return float(row[0, q]) + y


@kernel
def first_exit(row: Array, new: Array, limits: Array) -> tuple[float, int]:
    """Fraction of a step where the motion first leaves a limit, and its number; or (1, -1).

    row : shape (8, 3), of (theta, omega, work): the value y at the beginning, then f with
        y + x (f1 + (1 - x) (f2 + x (f3 + (1 - x) (...)))) at the fraction x of the step
    new : shape (3,), the values at the end
    limits : shape (7,), four crank angles [rad], then three speeds [rad/s], of which one is 0
    """
    first, which = 1.0, -1
    push = float(row[1, 1] + row[2, 1])  # the acceleration gives the sense of a start on a speed
    for i in (4, 5, 6, 0, 1, 2, 3):  # the angle is monotone up to the reversal
        limit, q = float(limits[i]), 0 if i < 4 else 1
        begin = float(row[0, q]) - limit
        sense = push if i >= 4 and begin == 0.0 else begin
        if sense == 0.0 or math.isinf(limit):
            continue
        low, high, near, least, most = 0.0, -1.0, 0.0, math.inf, 0.0
        scan, left = 1 if i < 4 else _SCAN, begin != 0.0  # a speed may come back within the step
        for j in range(1, scan + 1):
            x = first * j / scan
            inside = sense * ((float(new[q]) if x == 1.0 else _value(row, q, x)) - limit)
            if inside < 0.0 and not left:  # before, it must have left to the side it is pushed
                low = _lowest(row, q, -sense, low, x)
                left = sense * (_value(row, q, low) - limit) > 0.0
            if (inside < 0.0 and left) or (i < 4 and inside == 0.0):
                high = x
                break
            low, left = (x, True) if inside > 0.0 else (low, left)
            near, least, most = x if inside < least else near, min(inside, least), max(inside, most)
        if high < 0.0 and left and scan * least < most:  # it may have left between two of them
            low = max(near - first / scan, 0.0)
            x = _lowest(row, q, sense, low, min(near + first / scan, first))
            high = x if sense * (_value(row, q, x) - limit) < 0.0 else high
        for _ in range(_BISECTIONS if high >= 0.0 else 0):
            middle = 0.5 * (low + high)
            outside = sense * (_value(row, q, middle) - limit) < 0.0
            low, high = (low, middle) if outside else (middle, high)
        if high >= 0.0 and (high < first or which < 0):
            first, which = high, i
    return first, which


@kernel
def _lowest(row: Array, q: int, sign: float, low: float, high: float) -> float:
    """Where component q of an interpolant, times a sign, is lowest between two fractions."""
    for _ in range(_BISECTIONS):
        third = (high - low) / 3.0
        falls = sign * _value(row, q, low + third) > sign * _value(row, q, high - third)
        low, high = (low + third, high) if falls else (low, high - third)
    return low


@kernel
def land(t: float, y: Array, slope: Array, q: int, limit: float, within: float) -> float:
    """Put component q of a state on a limit close to it; the time of that, if it is ``within``."""
    late = (limit - y[q]) / slope[q] if abs(limit - y[q]) < within * abs(slope[q]) else 0.0
    speed = y[1] + slope[1] * late
    y[2] += slope[2] * late
    y[0], y[1] = y[0] + slope[0] * late, speed if speed * y[1] > 0.0 else 0.0  # it turns there
    y[q] = limit
    return t + late


@kernel
def _reach(y: Array, slope: Array, limits: Array) -> tuple[float, int]:
    """In what time the motion comes to the next angle of ``limits``, at a constant acceleration,
    and the number of that; infinite and -1 where it does not."""
    nearest, which = math.inf, -1
    for i in range(4):
        ahead = abs(float(limits[i] - y[0]))
        if (limits[i] - y[0]) * y[1] > 0.0 and ahead < nearest:
            nearest, which = ahead, i
    square = y[1] * y[1] + 2.0 * slope[1] * math.copysign(nearest, y[1]) if which >= 0 else -1.0
    if not square > 0.0:
        return math.inf, -1
    return 2.0 * nearest / (abs(y[1]) + math.sqrt(square)), which


@kernel
def _short(
    t: float, y: Array, system: System, asked: Asked, limits: Array, room: Room
) -> tuple[float, float, int]:
    """As many steps of order 5 as one is divided into, to the knot ahead, where it is so close.

    Returns
    -------
    the time at the knot, NaN where y and k[0] are left as they were; the largest error of a step
    over what is allowed; evaluations
    """
    (tolerance, speed, _, parts), (k, begins, widths, rows) = asked, room
    begin, slope, new = y.copy(), k[0].copy(), np.empty(3)
    which, worst, evaluations = _reach(y, slope, limits)[1], 0.0, 0
    for j in range(parts):
        width, late, lands = _reach(y, k[0], limits)[0] / (parts - j), 0.0, False
        for _ in range(2):
            width += late
            _stages(range(_OWN, 22), t, width, y, system, k, new)
            evaluations += 6
            fastest = speed + max(abs(float(y[1])), abs(float(new[1])))
            late = (float(limits[which]) - new[0]) / new[1] if j + 1 == parts else 0.0
            bent = max(abs(k[21, 1]), abs(k[21, 1] - k[0, 1]) / (width * fastest)) * late * late
            lands = bent <= tolerance
            if lands:
                break
        wrong = 0.0
        for q in range(2):
            total = float(E4[0]) * float(k[0, q])
            for i in range(_OWN, 22):
                total += float(E4[i]) * float(k[i, q])
            wrong += (width * total / (tolerance * (1.0 if q == 0 else fastest))) ** 2
        worst = max(worst, math.sqrt(0.5 * wrong))
        for q in range(3):
            rise, first, last = new[q] - y[q], width * k[0, q], width * k[21, q]
            total = float(D4[0]) * float(k[0, q])
            for i in range(_OWN, 22):
                total += float(D4[i]) * float(k[i, q])
            rows[j, 0, q], rows[j, 1, q], rows[j, 2, q] = y[q], rise, first - rise
            rows[j, 3, q], rows[j, 4, q] = 2.0 * rise - first - last, width * total
            rows[j, 5, q] = rows[j, 6, q] = rows[j, 7, q] = 0.0
        swing, inside = abs(float(new[1] - y[1])), True
        for i in (4, 5, 6):
            inside = inside and (new[1] - limits[i]) * (y[1] - limits[i]) > 0.0
            inside = inside and abs(float(y[1] - limits[i])) > 2.0 * swing
        if not (lands and worst < 1.0 and inside):
            y[:], k[0] = begin, slope
            return math.nan, worst, evaluations
        begins[j], widths[j] = t, width
        t = t + width
        y[:], k[0] = new, k[21]
    return t, worst, evaluations


@kernel
def travel(
    system: System, control: Asked, start: tuple[float, ...], y: Array, limits: Array, steps: Steps
) -> tuple[int, float, float, float, int]:
    """Step from knot to knot while the loads keep their branch; fill ``steps``, and return their
    number, time, next step, largest kinetic energy, and evaluations.

    Every piece keeps its own cubics beyond the knot, and is cut at the knot: there the step is
    taken again, as its end is more exact than its inside; where it is close, steps of order 5 go
    there at once. A step much longer than knots are apart roams across those where no pressure
    bends. It ends where all room is used, at any other limit, at the end in time, where no step is
    short enough, and where the motion dies away or is damped hard.

    control : tolerance of a step, speed [rad/s] to which it is relative, end in time [s], and into
        how many every step is divided: of a second answer none is as long as of the first
    start : time [s], next step [s], largest kinetic energy so far [J]
    y : shape (3,), theta, omega, work; limits : as in `first_exit`; carried on, as the pieces are
    """
    (tolerance, speed, t_bound, parts), (t, h, most), (begins, widths, rows) = control, start, steps
    k, new, (machine, pieces, load) = np.empty((22, 3)), np.empty(3), system
    n, evaluations, roams, short = 0, 1, False, math.inf
    slopes(t, y, system, k[0])
    while n + parts <= len(widths):
        least, refused = 2e-15 * t, False
        h = max(h, least)
        if len(machine[18]) < len(machine[13]):
            roams = _roam(y, h, machine, pieces, limits, roams)
            h = min(h, _FAR / abs(y[1])) if roams else h
        ahead, i = _reach(y, k[0], limits)
        late = math.nan
        if ahead <= min(h, short) and t + ahead < t_bound:
            room = (k, begins[n:], widths[n:], rows[n:])
            asked = (tolerance * ahead / h, speed, t_bound, parts)  # in a long step there are many
            late, error, more = _short(t, y, system, asked, limits, room)
            short = ahead / parts * (0.9 * error**-0.25 if error > 0.0 else 10.0)
            evaluations += more
        else:
            short = _LONGER * short
        if late > t:
            n, t, width = n + parts, late, ahead
            h = max(h, min(_LONGER * h, 2.0 * _MANY * ahead))
        else:
            while True:
                width = min(h, t_bound - t)
                _stages(range(1, 13), t, width, y, system, k, new)
                fastest = speed + max(abs(float(y[1])), abs(float(new[1])))
                error = _error(width, k, (tolerance, tolerance * fastest))
                evaluations += 12
                if error < 1.0:
                    break
                shrunk, refused = 0.9 * error**-0.125, True
                h = width * (shrunk if shrunk > 0.2 else 0.2)
                if h <= least:
                    return n, t, h, most, evaluations
            grown = min(10.0, 0.9 * error**-0.125) if error > 0.0 else 10.0
            h = width * (min(grown, 1.0) if refused else grown)
            _interpolate(t, width, y, new, system, k, rows[n])
            evaluations += 3
            x, i = first_exit(rows[n], new, limits)
            end, cut = t_bound if width == t_bound - t else t + width, i >= 0 and x > 0.0
            again = cut or (i < 0 and parts > 1)
            width = (x if cut else 1.0) * width / (parts if again else 1)
            for j in range(parts if again else 1):
                if again:
                    _stages(range(1, 13), t, width, y, system, k, new)
                    _interpolate(t, width, y, new, system, k, rows[n])
                    evaluations += 15
                begins[n], widths[n] = t, width
                n += 1
                if again or i < 0:  # and not where the motion leaves at once
                    t = t + width if cut or j + 1 < parts else end
                    for q in range(3):
                        y[q], k[0, q] = new[q], k[12, q]
            if again and not cut:  # the better end may be beyond a limit that the first was before
                i = first_exit(rows[n - 1], new, limits)[1]
        if i >= 0:
            t = land(t, y, k[0], 0 if i < 4 else 1, float(limits[i]), NEAR * width)
            ends = i > 1 or y[0] == limits[2] or y[0] == limits[3]
            if ends or y[1] == 0.0 or not limits[5] < y[1] < limits[6]:
                break
            sense = math.copysign(1.0, y[1])
            limits[0], limits[1] = enter(float(y[0]), sense, machine, pieces)
            roams = False
        of_angle, omega = reduced(float(y[0]), machine, pieces), float(y[1])
        if i >= 0:
            _slopes(t, omega, load, of_angle, k[0])
            evaluations += 1
        inertia = of_angle[0]
        kinetic, damping = 0.5 * inertia * omega * omega, load[2] + 2.0 * load[3] * omega
        damping -= of_angle[3]
        most, hard = max(most, kinetic), abs(damping) > _HARD * inertia * abs(omega)
        if hard or kinetic <= tolerance * tolerance * most or t >= t_bound:
            break
    return n, t, h, most, evaluations
