"""A prescribed speed set free: the constant load that balances it, at the mean speed it had."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq, root

from crankmbs.errors import InputError, shown
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.mechanics.speed import speed_law
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.crank_angle.grid import grid_of
from crankmbs.motion.crank_angle.periods import period_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import gauss
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import Constant
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["NEAR_REST", "UNEVEN", "balanced", "freed", "mean_prescribed"]

NEAR_REST = (
    "crank.inertia: set free under the constant load that balances it the crank comes near rest in "
    "every cycle; give it a heavier flywheel; {came:.6g} kg m^2 came"
)
UNEVEN = (
    "fuel: with shares of the combustion cycles differ, and no one load balances them; leave "
    "[fuel] out, or give [start] and loads"
)

_STAGES = 10  # of Gauss in a cell, more than a run takes
_LEAST = 1e-9  # of the greatest energy: no less is ever left over
_SLOW = math.pi / 360.0  # rad: where the energy would be gone within this angle, the crank rests
_RTOL = 1e-13  # of the runs that tell what viscous friction takes
_CLOSE = 1e-12  # relative: so near gain and duration must come
_LATE, _ROUGH = 4.0, 1e-3  # of its duration and rtol: a first guess not through by then will rest


def freed(scene: Scene) -> Scene:
    """The scene of a prescribed speed with its crank free, in the motion that repeats itself.

    One constant load balances what gas, gravity and friction do in a period, T = -W / angle. The
    motion is the one whose mean speed, angle over time, is `mean_prescribed`; it starts at
    motion.angle and lasts one period. Everything else stays.

    Raises
    ------
    InputError : a free crank; fuel, whose cycles differ; a crank without inertia, or with so little
        that it comes near rest; what `mean_prescribed` refuses

    >>> free = freed(load_scene("yi_diesel"))
    >>> print(f"{free.torque[0].torque:.4f} N m, from {free.start.speed:.2f} rad/s")
    -21.8274 N m, from 412.70 rad/s
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a Scene, such as load_scene reads; {shown(scene)} came")
    if scene.motion is None:
        raise InputError("start: the crank is free already; give a scene with [motion]")
    if scene.fuel is not None:
        raise InputError(UNEVEN)
    start = Start(angle=scene.motion.angle, speed=mean_prescribed(scene))
    crank = replace(scene.crank, inertia=scene.crank.moment_of_inertia)
    run = replace(scene.run, until=Extent(value=scene.settled_period, unit="rad"))
    if run.formulation == "kinetostatic":
        run = replace(run, formulation="auto")
    settled, rests = balanced(replace(scene, crank=crank, motion=None, start=start, run=run))
    if rests:
        raise InputError(NEAR_REST.format(came=crank.inertia))
    return settled


def mean_prescribed(scene: Scene) -> float:
    """Mean of a prescribed speed [rad/s], angle over time, over the run's last whole cycle, without
    one its last revolution, or else all of it.

    Raises
    ------
    InputError : it comes to rest or turns back

    >>> print(round(mean_prescribed(load_scene("compressor")) * 30.0 / math.pi, 3))
    1449.69
    """
    assert scene.motion is not None
    law, begin = speed_law(scene.motion), scene.motion.angle
    speed, (until, in_time) = float(law.at_time(0.0)[1]), scene.end
    sense = math.copysign(1.0, speed)

    turns = law.turning_times[0]

    def time_at(theta: float) -> float:
        return float(law.time_at(np.array([theta]), 0.0, turns)[0])

    rests = speed == 0.0 or (in_time and turns < until)
    if not rests and not in_time:
        rests = turns < math.inf and abs(float(law.at_time(turns)[0]) - begin) < until
    if rests:
        raise InputError(
            "motion.speed: comes to rest or turns back within the run, which leaves a free crank "
            'no mean speed to keep; give one that does not, such as "3200 rpm"'
        )
    last = until if in_time else time_at(begin + sense * until)
    turned = abs(float(law.at_time(last)[0]) - begin)
    lengths = (scene.period, 2.0 * math.pi)
    angle = next((each for each in lengths if turned >= each - 1e-9), turned)
    return sense * angle / (last - time_at(begin + sense * (turned - angle)))


def balanced(scene: Scene) -> tuple[Scene, bool]:
    """A free scene with one more constant load, that which makes it repeat itself at a mean speed,
    start.speed; none of its other loads depends on the speed. It starts in that motion.

    Besides, whether it comes near rest on the way, where its energy would be gone within half a
    degree, or there is no such motion: then the mean speed may not be reached.

    Over the angle E = E_0 + (E - E_0)(theta), the same at every speed: E_0 is the one with which a
    period takes as long as at the mean speed. What viscous friction and dampers take depends on the
    motion, as a force of Python may: load and E_0 are then sought together, run by run.
    """
    settled, rests = _at_any_speed(scene)
    train = crank_train(scene)
    depends = train.drags or any(push.parts.function is not None for push in train.pushes)
    return _with_drag(scene, settled) if depends else (settled, rests)


def _at_any_speed(scene: Scene) -> tuple[Scene, bool]:
    """The same, but for what depends on the motion, which is as at a constant speed."""
    assert scene.start is not None
    start, period = scene.start, scene.settled_period
    sense = math.copysign(1.0, start.speed)
    grid = grid_of(crank_train(scene), gauss(_STAGES))
    terms = grid.terms(start.angle, sense, len(grid.edges) + 1, start.angle + sense * period)
    if terms.drags:
        terms = replace(terms, torque=terms.torque - start.speed * terms.drag)
    for push in crank_train(scene).pushes:
        if push.parts.function is not None:
            at = terms.angles(start.angle, sense, grid.rule)
            more = push.parts.function(np.zeros_like(at), at, np.full_like(at, start.speed))
            terms = replace(terms, torque=terms.torque + more)
    mean = float(terms.width @ (terms.torque @ grid.rule.weights)) / period
    over_time = sum(
        float(load.parts.over_time(0.0)) for load in scene.torque if load.parts.over_time
    )
    loads = (*scene.torque, Constant(torque=-mean - over_time))
    cycle = period_of(grid, terms, branch_of(loads, 0.0, 0.0, rising=True), sense)
    least, duration = -float(cycle.shift.min()), period / abs(start.speed)

    def late(above: float) -> float:
        return float((1.0 / np.sqrt(least + above + cycle.shift)) @ cycle.weight) - duration

    most = 0.5 * float(terms.inertia.max()) * start.speed**2 + float(np.ptp(cycle.shift))
    above = _LEAST * most
    if late(above) > 0.0:
        above = float(brentq(late, above, 2.0 * most, xtol=1e-300, rtol=1e-15))
    largest = float(np.abs(terms.torque).max()) + abs(mean)
    return _from(scene, -mean - over_time, least + above), above <= _SLOW * largest


def _with_drag(scene: Scene, guess: Scene) -> tuple[Scene, bool]:
    """Load and start such that a run of a period gains nothing and takes the time that it must."""
    assert scene.start is not None
    assert guess.start is not None
    period, mean = scene.settled_period, abs(scene.start.speed)
    energy = 0.5 * float(inertia_alone(guess, guess.start.angle)) * guess.start.speed**2
    whole = Extent(value=period, unit="rad")
    run = replace(scene.run, until=whole, every=whole, formulation="crank_angle")
    constant = guess.torque[-1](0.0, 0.0, 0.0)

    def trial(x: Array) -> Scene:
        return _from(scene, constant + x[0] * energy / period, math.exp(x[1]) * energy)

    def off(x: Array) -> list[float]:
        result = simulate(replace(trial(x), run=run), rtol=_RTOL)
        if result.status != 0:
            return [1.0, 1.0]  # it comes to rest: as wrong as can be
        kinetic, time = (result.data[name].values for name in ("kinetic_energy", "time"))
        return [kinetic[-1] / kinetic[0] - 1.0, time[-1] * mean / period - 1.0]

    late = Extent(value=_LATE * period / mean, unit="s")
    soon = simulate(replace(guess, run=replace(run, until=late, every=late)), rtol=_ROUGH)
    if abs(soon.data.crank_angle.values[-1] - guess.start.angle) < period:
        return guess, True  # before it swings there for long
    solved = root(off, [0.0, 0.0], tol=_CLOSE)
    return trial(solved.x), not np.abs(solved.fun).max() <= _CLOSE


def _from(scene: Scene, torque: float, energy: float) -> Scene:
    """The scene with a constant load more [N m], from a kinetic energy [J]."""
    assert scene.start is not None
    start = scene.start
    squared = 2.0 * energy / float(inertia_alone(scene, start.angle))
    moved = Start(angle=start.angle, speed=math.copysign(math.sqrt(squared), start.speed))
    return replace(scene, start=moved, torque=(*scene.torque, Constant(torque=torque)))
