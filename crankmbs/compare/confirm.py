"""A run beside exudyn's rigid bodies: how far they differ, and what both state of their error."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import dropwhile, takewhile

import numpy as np

from crankmbs.errors import FormulationError, InputError
from crankmbs.measures.interpolate import read_with_errors
from crankmbs.mechanics.knots import apart, repeat
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.pressure import PeriodicPressure
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.mechanics.variables import EVERY
from crankmbs.motion.cells import Cells
from crankmbs.motion.motion import Motion
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["Confirmation", "Difference", "confirm"]


_RTOL = 7e-6  # of each variable over the last period: two components then err by 1e-5 at most
_STEPS = 200_000  # of one cylinder, for it
_PLACES = 360  # at which it is compared: between samples, beside jumps at whole degrees
_STATES = 60  # of the whole run
_LATE = 1e-3  # of a stretch that begins at rest: where friction lets go, rounding decides
_NOTHING = 1e-9  # of the largest of the same unit: what is smaller is compared with that
_MOTION = (
    "crank angle",
    "crank speed",
    "crank acceleration",
    "piston displacement",
    "piston velocity",
    "piston acceleration",
)
_FORCES = ("main bearing", "crank pin", "piston pin", "side force", "external torque")


@dataclass(frozen=True)
class Difference:
    """One quantity of two runs.

    size : shape (n, 1) or (n, cylinders) [units], length of the difference at the samples
    crank_angle : shape (n,) [rad]
    peak [units] : largest value of the quantity
    errors [units] : what each of the two runs states; formulations : their names
    """

    quantity: str
    units: str
    crank_angle: Array
    size: Array
    peak: float
    errors: tuple[float, float]
    formulations: tuple[str, str]

    @property
    def largest(self) -> tuple[float, int, int]:
        """Largest difference [units], its sample and its column."""
        sample, column = np.unravel_index(int(np.argmax(self.size)), self.size.shape)
        return float(self.size[sample, column]), int(sample), int(column)

    @property
    def share(self) -> float:
        """Largest difference over the sum of the stated errors; at most 1 where both hold."""
        allowed, largest = sum(self.errors), self.largest[0]
        if allowed == 0.0:
            return 0.0 if largest == 0.0 else math.inf
        return largest / allowed


@dataclass(frozen=True)
class Confirmation:
    """What exudyn's rigid bodies say of a run.

    period : differences over the last period, which exudyn integrates from the motion's state at
        its begin; of a prescribed speed its equations alone. Empty where nothing moves
    states : differences of its accelerations and joint forces at states all over the run, under the
        run's load torque and forces from outside on the pistons
    window [s] : begin and end of that period; whole : whether the crank turns through all of it
    missing : what could not be compared, in sentences
    """

    period: tuple[Difference, ...]
    states: tuple[Difference, ...]
    window: tuple[float, float]
    missing: tuple[str, ...] = ()
    whole: bool = True

    def __repr__(self) -> str:
        return f"<Confirmation: {self.sentence}>"

    @property
    def difference(self) -> float:
        """The largest difference over the last period, relative to the peak of its quantity."""
        return _most(self.period)

    @property
    def error(self) -> float:
        """The largest error that both together state over it, relative to the peak."""
        return max((sum(row.errors) / row.peak for row in self.period), default=math.nan)

    @property
    def at_states(self) -> float:
        """The largest difference at the states, relative to the peak."""
        return _most(self.states)

    @property
    def holds(self) -> bool:
        """Whether the difference lies within the error that both state."""
        return not self.difference > self.error

    @property
    def sentence(self) -> str:
        """The answer."""
        if not self.period:
            return (
                f"exudyn's rigid bodies agree to {self.at_states:.0e} of the peak in acceleration "
                f"and every joint force at states of the run; nothing was integrated"
            )
        begin, end = self.window
        part = "over the last cycle" if self.whole else f"from {begin:.4g} to {end:.4g} s"
        return (
            f"exudyn's rigid bodies {'agree' if self.holds else 'differ'} "
            f"{'to' if self.holds else 'by'} {self.difference:.0e} of the peak in motion and every "
            f"joint force {part}, with a stated error of {self.error:.0e}"
        )


def _most(rows: tuple[Difference, ...]) -> float:
    return max((row.largest[0] / row.peak for row in rows), default=math.nan)


def confirm(result: Result) -> Confirmation:
    """Hold a run against the rigid multibody model, integrated in time by exudyn.

    The last period, as far as the crank moves in it, is integrated from the motion's state at its
    begin; and at 60 samples all over the run accelerations and joint forces are solved for.
    Errors that build up over a whole run are for the formulation "minimal" to show.

    Raises
    ------
    InputError : the run is one of multibody itself

    >>> confirm(simulate(load_scene("coasting"))).difference < 1e-5
    True
    """
    if result.formulation == "multibody":
        raise InputError(
            "a run of multibody is not confirmed by itself; choose another formulation"
        )
    train, missing = crank_train(result.scene), []
    period: tuple[Difference, ...] = ()
    window = math.nan, math.nan
    part = _moving(result)
    turned = abs(part.turned) if part is not None else 0.0
    whole = turned >= (1.0 - _NOTHING) * result.scene.period
    if part is None:
        missing.append("nothing moves at the end of the run: only states of rest were compared")
    else:
        try:
            period, window = _last_period(result, train, part)
        except FormulationError as error:
            what = "last cycle" if whole else "end of the run"
            missing.append(f"the {what} could not be integrated: {error}")
    if result.scene.motion is not None and result.scene.force:
        missing.append(
            "the forces from outside on the pistons are the run's, as the speed is prescribed: "
            "what they do to every joint was compared, not they themselves"
        )
    if result.scene.friction is not None and np.any(result.sampled("crank_speed") == 0.0):
        missing.append(
            "what friction gives while it holds the crank at rest is the run's: a rigid body at "
            "rest does not determine it"
        )
    return Confirmation(period, _at_states(result, train), window, tuple(missing), whole)


def _moving(result: Result) -> Motion | None:
    """The end of the motion, of a period at most, in which the crank neither rests nor is held.

    A crank that turns back passes angles again with the fuel that was decided beyond them: there it
    is what comes after the last decision.
    """
    motion = result.passes.answer
    part = motion.last(result.scene.period) or motion
    backwards = takewhile(_turns, dropwhile(lambda cells: not _turns(cells), part.cells[::-1]))
    pieces = list(backwards)[::-1]
    if len({cells.acting.sense for cells in pieces}) > 1:
        last = pieces[-1].shares[-1]
        before = [cells.time[(cells.shares != last).any(axis=1), -1] for cells in pieces]
        return Motion(part.train, pieces).after(np.concatenate(before).max(initial=0.0))
    return Motion(part.train, pieces) if pieces else None


def _turns(cells: Cells) -> bool:
    acting = cells.acting
    return not acting.holds and acting.sense != 0.0 and cells.time[-1, -1] != cells.time[0, 0]


def _last_period(
    result: Result, train: CrankTrain, part: Motion
) -> tuple[tuple[Difference, ...], tuple[float, float]]:
    from crankmbs.motion.multibody import beside  # exudyn is imported only when it is used

    begin, end = part.begin, part.end
    if part.at(np.array([begin]), in_time=True).omega[0] == 0.0:
        begin += _LATE * (end - begin)
    times = begin + (end - begin) * (np.arange(_PLACES) + 0.5) / _PLACES
    ours, stated = read_with_errors(result, result.passes, times, in_time=True)
    if result.scene.motion is not None:
        theirs = beside.consistent(train, ours, driven=True) | {"time": times}
        errors = dict.fromkeys(theirs, 0.0)
    else:
        start = part.at(np.array([begin]), in_time=True)
        state = begin, float(start.theta[0]), float(start.omega[0])
        if train.combustion is not None:
            train = _fired(train, state[1], ours["crank_angle"], ours["fuel"])
        phases, steps = part.cells[0].acting.phases, _STEPS // len(result.scene.cylinders)
        theirs, errors = beside.integrated(train, state, phases, times, _RTOL, steps)
    quantities = (*_MOTION, *_forces(result.scene))
    rows = _differences(quantities, (ours, theirs), (stated, errors), abs(part.turned))
    return rows, (begin, end)


def _fired(train: CrankTrain, start: float, theta: Array, fuel: Array) -> CrankTrain:
    """The train with the pressures of the firings that were, over the crank angles of one period:
    those from where it starts [rad], and at places close together with their shares.

    In a period each cylinder decides once, where its compression begins.
    """
    period, pressures = train.scene.period, []
    low = 0.5 * (min(start, theta.min()) + max(start, theta.max()) - period)  # beyond both ends
    gases = zip(train.scene.cylinders, train.pressure or (), train.combustion or (), strict=True)
    ends = zip(fuel[theta.argmin()], fuel[theta.argmax()], strict=True)
    for (cylinder, without, more), (below, above) in zip(gases, ends, strict=True):
        first = low + cylinder.phase
        decided, last = first + (math.pi - first) % period, first + without.period
        inner = repeat(without.knots[:-1], without.period, first, last)
        knots = apart(np.concatenate([[first, decided, last], inner]))
        share = np.where(0.5 * (knots[1:] + knots[:-1]) < decided, below, above)
        cubics = without.on(knots).coefficients + share * more.on(knots).coefficients
        pressures.append(PeriodicPressure(knots, cubics))
    return replace(train, pressure=tuple(pressures), combustion=None, law=None)


def _at_states(result: Result, train: CrankTrain) -> tuple[Difference, ...]:
    from crankmbs.motion.multibody import beside

    count = result.data.sizes["time"]
    chosen = np.unique(np.linspace(0, count - 1, _STATES).astype(int))
    of_time = {name: each for name, each in result.variables.items() if each[0][0] == "time"}
    ours = {name: values[chosen] for name, (_, values, _) in of_time.items()}
    stated = {name: about.get("error_estimate", 0.0) for name, (_, _, about) in of_time.items()}
    theirs = beside.consistent(train, ours, driven=result.scene.motion is not None)
    quantities = ("crank acceleration", "piston acceleration", *_forces(result.scene))
    return _differences(quantities, (ours, theirs), (stated, dict.fromkeys(theirs, 0.0)), math.inf)


def _differences(
    quantities: tuple[str, ...],
    runs: tuple[Mapping[str, Array], Mapping[str, Array]],
    errors: tuple[Mapping[str, float], Mapping[str, float]],
    turned: float,
) -> tuple[Difference, ...]:
    """Of two runs that state these errors; of the crank angle relative to the angle turned through,
    of what is nothing beside others of its unit relative to those."""
    ours, theirs = runs
    parts = {quantity: _parts(quantity) for quantity in quantities}
    units = {quantity: EVERY[names[0]].units for quantity, names in parts.items()}
    peaks = {
        quantity: peak(np.linalg.norm([ours[name] for name in names], axis=0))
        for quantity, names in parts.items()
    } | {"crank angle": turned}
    differences = []
    for quantity, names in parts.items():
        alike = [peaks[other] for other in quantities if units[other] == units[quantity]]
        largest, most = peaks[quantity], max(alike)
        size = np.linalg.norm([ours[name] - theirs[name] for name in names], axis=0)
        first, second = (math.hypot(*(each[name] for name in names)) for each in errors)
        differences.append(
            Difference(
                quantity=quantity,
                units=units[quantity],
                crank_angle=ours["crank_angle"],
                size=size.reshape(len(size), -1),
                peak=largest if largest > _NOTHING * most else most or 1.0,
                errors=(first, second),
                formulations=("the run", "exudyn"),
            )
        )
    return tuple(differences)


def _parts(quantity: str) -> tuple[str, ...]:
    """The variable that a quantity is, or the components of a joint's force."""
    name = quantity.replace(" ", "_")
    return (name,) if name in EVERY else (f"{name}_force_x", f"{name}_force_y")


def _forces(scene: Scene) -> tuple[str, ...]:
    """The forces and the torque that are compared."""
    return _FORCES if scene.throws is None else (*_FORCES, "main journal")
