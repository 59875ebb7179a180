"""The inertia of the crank that gives a wanted fluctuation of speed, on the settled cycle."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import NamedTuple

import numpy as np

from crankmbs.design.freed import balanced, mean_prescribed
from crankmbs.errors import InputError, shown
from crankmbs.measures import Estimate, Measures, measure
from crankmbs.measures.estimate import Number, estimates
from crankmbs.mechanics.train import CrankTrain, crank_train, knots_over_angle
from crankmbs.motion.motion import Motion as Solved
from crankmbs.motion.states import balances_of, inner_samples
from crankmbs.numerics.collocation import gauss
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.numerics.magnitudes import tops
from crankmbs.result import Result
from crankmbs.scene.drives import Motion, Start
from crankmbs.scene.run import SETTLED, Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE
from crankmbs.simulate import simulate

__all__ = ["Flywheel", "excess", "excess_at", "fluctuations", "flywheel"]

_CLOSE = 1e-7  # of the fluctuation: as near the target is on it,
_LEFT = 0.1  # or within so much of its error, which hardly grows by that
_MOST = 40  # runs
_WIDE = 1e4  # times the lecture's inertia: the search goes no farther
_NARROW = 1e-6  # of the lecture's inertia: a crank so light is none


@dataclass(frozen=True)
class Flywheel:
    """What a fluctuation of speed takes.

    inertia [kg m2] : of the crank and all that turns with it, as ``crank.inertia``; its error is
        what the fluctuation's is worth
    added [kg m2] : of that beyond the scene's
    fluctuation, mean_speed [1, rad/s] : of the settled cycle with it
    work [J] : W, greatest excess of work in a cycle at that constant speed
    lecture [kg m2] : inertia of the whole engine by the lecture's J = W / (fluctuation omega^2)
    moving [kg m2] : the mean of rods and pistons over the angle, which is in it
    result : the settled cycle with the inertia, or the last one tried
    status, message : 0 found; 1 or -1 out of reach; and a sentence
    """

    inertia: Estimate
    added: float
    fluctuation: Estimate
    mean_speed: Estimate
    work: Estimate
    lecture: Estimate
    moving: float
    result: Result
    status: int
    message: str

    @property
    def lecture_crank(self) -> Estimate:
        """Inertia of the crank by the lecture's formula [kg m2], without rods and pistons."""
        return Estimate(self.lecture.value - self.moving, self.lecture.error)

    @property
    def lecture_error(self) -> Estimate:
        """Relative error of the crank's inertia by the lecture's formula."""
        value, error = self.lecture_crank
        ratio = value / self.inertia.value
        spread = error + abs(ratio) * self.inertia.error
        return Estimate(ratio - 1.0, spread / self.inertia.value)


def flywheel(scene: Scene, fluctuation: float = 0.01) -> Flywheel:
    """Find the crank inertia with which the settled speed fluctuates by so much.

    The coefficient of fluctuation is (max - min) / mean speed over the settled cycle of the very
    scene (`crankmbs.measures.measure`), met within 1e-7 of itself. Under loads the mean speed is
    the one they settle at; a scene without a load that depends on the speed, as one of Python is
    taken to do, is balanced with a constant one, and takes the motion whose mean speed is
    start.speed or that of the motion prescribed (`crankmbs.freed`).

    Parameters
    ----------
    fluctuation : [1], above 0 and below 2

    Returns
    -------
    Flywheel : status 0; 1 or -1 with a sentence where no inertia gives it

    Raises
    ------
    InputError : no scene, no such fluctuation, a load under which nothing settles, a prescribed
        speed that comes to rest or turns back, a crank whose speed nothing makes fluctuate

    >>> wheel = flywheel(load_scene("yi_diesel_free"), 0.01)
    >>> print(round(wheel.inertia.value, 3))
    0.44
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a Scene, such as load_scene reads; {shown(scene)} came")
    if (
        isinstance(fluctuation, bool)
        or not isinstance(fluctuation, Real)
        or not 0.0 < fluctuation < 2.0
    ):
        raise InputError(
            "fluctuation must be a number above 0 and below 2, such as 0.01 for 1 %; "
            f"{shown(fluctuation)} came"
        )
    return _search(scene, float(fluctuation)).solved(scene.crank.moment_of_inertia)


def fluctuations(scene: Scene, inertias: Sequence[float]) -> list[Measures | None]:
    """Measures of the settled cycle with each crank inertia [kg m2], as `flywheel` has it; None
    where there is none.

    >>> light, heavy = fluctuations(load_scene("turning_moment"), [0.1, 0.3])
    >>> light.fluctuation.value > heavy.fluctuation.value
    True
    """
    search = _search(scene, math.nan)
    return [search.tried(inertia).measures for inertia in inertias]


def _search(scene: Scene, fluctuation: float) -> _Search:
    freed = _freed(scene)
    over_speed = any(load.parts.over_speed or load.parts.function for load in freed.torque)
    return _Search(freed, fluctuation, simulate if over_speed else _balanced)


def excess_at(scene: Scene, speed: float) -> tuple[Estimate, float]:
    """What `excess` gives of a scene over a period at a constant speed [rad/s].

    >>> excess_at(load_scene("propeller"), 300.0)[0].value > 0.0
    True
    """
    drive = scene.start or scene.motion
    assert drive is not None
    until = Extent(value=scene.settled_period, unit="rad")
    run = Run(until=until, every=Extent(value=DEGREE, unit="rad"), rtol=scene.run.rtol)
    motion = Motion(speed=speed, angle=drive.angle)
    return excess(simulate(replace(scene, start=None, torque=(), motion=motion, run=run)), scene)


def excess(even: Result, free: Scene | None = None) -> tuple[Estimate, float]:
    """(W [J], J omega^2 [J]) of the lecture's formula, from a run of whole cycles at constant
    speed: the range of the work that rods, the crank's own weight, and loads over the angle or of
    Python of the ``free`` scene do beyond its mean, with its error; twice the mean kinetic energy.

    >>> excess(simulate(load_scene("yi_diesel")))[0].value > 0.0
    True
    """
    loads = crank_train(free) if free else None
    ((work,),) = estimates(even.passes, lambda one: {"work": _excess(one, loads)}).values()
    energy = even.sampled("kinetic_energy")[:-1]  # the last sample is the first of the next period
    return work, 2.0 * float(energy.mean())


def _excess(even: Solved, loads: CrankTrain | None) -> Number:
    """W [J] of a motion at constant speed: the work over the angle turned is a polynomial in each
    of its cells, cut where loads bend or jump."""
    knots, period = (knots_over_angle(loads), loads.period) if loads else (np.empty(0), 0.0)
    cells, *more = (each.cut_at(knots, period) for each in even.cells)
    for each in more:
        cells = cells.joined(each)
    points, shape = inner_samples(cells, even.train), cells.time.shape
    torque = -balances_of(even.train, points).row("external_torque")
    for load in loads.scene.torque if loads else ():
        if load.parts.over_angle is not None:
            torque = torque + load.parts.over_angle(points.theta)
        elif load.parts.function is not None:
            torque = torque + load(0.0, points.theta, points.omega)
    inside, rule = torque.reshape(shape)[:, 1:-1], gauss(shape[1] - 2)
    width = np.abs(cells.angle[:, -1:] - cells.angle[:, :1])
    to_places = np.vstack([0.0 * rule.weights, rule.matrix, rule.weights])
    gained = width * (inside @ to_places.T)
    mean = gained[:, -1].sum() / width.sum()
    surplus = gained - mean * width * cells.places
    surplus[1:] += np.cumsum(surplus[:-1, -1])[:, None]
    size = float(np.abs(surplus).max())
    lines = np.stack([surplus + 2.0 * size, 2.0 * size - surplus]).reshape(-1, shape[1]).T
    through, starts = ends_and_nodes(shape[1] - 2), np.array([0, len(width)])
    highest, lowest = tops(through, lines[:, None], starts).size
    return Number(np.array(highest + lowest - 4.0 * size), np.array(size))


def _freed(scene: Scene) -> Scene:
    """The scene with a free crank, for one settled cycle at 1 degree."""
    run = Run(until=SETTLED, rtol=scene.run.rtol)
    if scene.motion is None:
        return replace(scene, run=run)
    start = Start(angle=scene.motion.angle, speed=mean_prescribed(scene))
    crank = replace(scene.crank, inertia=scene.crank.moment_of_inertia or 1.0)  # any will do
    return replace(scene, crank=crank, motion=None, start=start, run=run)


def _balanced(scene: Scene) -> Result:
    """The periodic motion under the constant load that balances the rest."""
    run = replace(scene.run, until=Extent(value=scene.settled_period, unit="rad"))
    return simulate(balanced(replace(scene, run=run))[0])


class _Trial(NamedTuple):
    """A settled cycle with a crank inertia [kg m2]; its measures, None where it does not settle."""

    inertia: float
    result: Result
    measures: Measures | None


class _Search:
    """The inertia with which a machine's settled speed has a given fluctuation."""

    def __init__(self, scene: Scene, wanted: float, settle: Callable[[Scene], Result]) -> None:
        self._scene, self._wanted, self._settle = scene, wanted, settle

    def solved(self, present: float) -> Flywheel:
        """The answer for a scene whose crank has the inertia `present` [kg m2]."""
        assert self._scene.start is not None
        work, rest = self._lecture(self._scene.start.speed)
        if not work.value > 0.0:
            raise InputError(
                "the speed does not fluctuate, whatever the crank's inertia: no gas, weight, load "
                "over the angle or moving mass does work on the crank and takes it back; add what "
                "does"
            )
        whole = work.value / (self._wanted * self._scene.start.speed**2)
        floor = max(self._scene.crank.mass * self._scene.crank.center_of_mass**2, _NARROW * whole)
        low, high = floor, _WIDE * whole
        trial, before = self.tried(max(whole - rest, floor)), None
        for _ in range(_MOST):
            if trial.measures is None:
                low, step = trial.inertia, math.inf
            else:
                fluctuation = trial.measures.fluctuation
                off = fluctuation.value / self._wanted - 1.0
                if abs(off) <= max(_CLOSE, _LEFT * fluctuation.error / fluctuation.value):
                    return self._answer(trial, present, rest, off)
                low, high = (trial.inertia, high) if off > 0.0 else (low, trial.inertia)
                step = self._step(trial, before, rest)
            if high <= floor or low >= _WIDE * whole:
                break
            after = trial.inertia + step
            inside = low < after < high
            near_floor = high < 4.0 * floor or after <= floor
            other = after if inside else floor if near_floor else math.sqrt(low * high)
            before, trial = trial if trial.measures else before, self.tried(other)
        return self._answer(trial, present, rest, math.nan)

    def tried(self, inertia: float) -> _Trial:
        """The settled cycle with a crank inertia [kg m2]."""
        crank = replace(self._scene.crank, inertia=inertia)
        result = self._settle(replace(self._scene, crank=crank))
        return _Trial(inertia, result, measure(result) if result.status == 0 else None)

    def _step(self, trial: _Trial, before: _Trial | None, rest: float) -> float:
        """To the inertia with that fluctuation: 1 / fluctuation is nearly linear in it."""
        assert trial.measures is not None
        fluctuation = trial.measures.fluctuation.value
        missing = 1.0 / self._wanted - 1.0 / fluctuation
        if before is None or before.measures is None:
            return missing * fluctuation * (trial.inertia + rest)
        rise = 1.0 / fluctuation - 1.0 / before.measures.fluctuation.value
        apart = trial.inertia - before.inertia
        return missing * apart / rise if rise * apart > 0.0 else math.inf

    def _lecture(self, speed: float) -> tuple[Estimate, float]:
        """W [J] at a constant speed [rad/s], and the mean inertia of rods and pistons [kg m2]."""
        work, doubled = excess_at(self._scene, speed)
        return work, doubled / speed**2 - self._scene.crank.moment_of_inertia

    def _answer(self, trial: _Trial, present: float, rest: float, off: float) -> Flywheel:
        """The answer from the last trial; ``off`` its relative error, NaN where it is none."""
        inertia, result, measures = trial
        none = Estimate(math.nan, math.nan)
        fluctuation = measures.fluctuation if measures else none
        mean = measures.mean_speed if measures else none
        error = (abs(off) + fluctuation.error / fluctuation.value) * (inertia + rest)
        assert self._scene.start is not None
        speed = mean.value if measures else self._scene.start.speed
        work, rest = self._lecture(speed)
        whole = Estimate(*(part / (self._wanted * speed**2) for part in work))
        status, message = 0, f"the speed fluctuates by {100.0 * self._wanted:.6g} % of its mean"
        if math.isnan(off):
            status = result.status or 1
            message = (
                f"out of reach: with {inertia:.4g} kg m^2 {result.message}"
                if measures is None
                else f"out of reach: even with {inertia:.4g} kg m^2, near the least that the crank "
                "can have, the speed fluctuates by "
                f"{100.0 * fluctuation.value:.4g} % of its mean only"
            )
            inertia = math.nan
        return Flywheel(
            inertia=Estimate(inertia, error),
            added=inertia - present,
            fluctuation=fluctuation,
            mean_speed=mean,
            work=work,
            lecture=whole,
            moving=rest,
            result=result,
            status=status,
            message=message,
        )
