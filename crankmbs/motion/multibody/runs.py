"""A free run at steps h, h/2, h/4, ...: one motion, and others that are as far off as it may be.

How fine the steps become follows from the error and from a number of steps, never from a clock.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.errors import FormulationError
from crankmbs.motion.base import State
from crankmbs.motion.cells import Acting, Cells, cell_of
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode
from crankmbs.motion.multibody.cost import STEPS_A_TURN
from crankmbs.motion.multibody.forces import Forces, Limits
from crankmbs.motion.multibody.integrate import Path, enter, integrate
from crankmbs.motion.multibody.model import Model
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["Motion", "Piece", "Runs", "motion_of"]

_RETRIES = 4  # with a quarter of the step each time, where exudyn fails
_UNTOUCHED = 0.98  # of the time to where it fails: before it goes wrong
_EPS = float(np.finfo(float).eps)
_SHAKEN = 1e-12  # of the crank angle: how far off a run begins that shows what rounding grows to
_SAME = 1e-11  # relative: times nearer than this are one
_STEPS = 4  # in a cell
_STAGES = 4  # of Gauss in it: polynomials of degree 5, where those of the steps are of degree 3
_HELD = "a jump of the loads drives the speed back from both sides"
_NO_STEP = "exudyn's Newton iteration does not converge"


class Piece(NamedTuple):
    """A part of a motion in which the crank turns one way and nothing jumps."""

    begin: State
    end: State
    cells: Cells
    decisions: tuple[State, ...] = ()


class Motion(NamedTuple):
    """A motion as it was integrated, from cut to cut."""

    pieces: tuple[Piece, ...]

    @property
    def ends(self) -> Array:
        """When its pieces end [s]."""
        return np.array([piece.end.time for piece in self.pieces])

    @property
    def modes(self) -> list[Mode]:
        """What acts in its pieces."""
        return [piece.begin.mode for piece in self.pieces]

    def at(self, k: Index, values: Array, *, in_time: bool) -> Array:
        """Time, crank angle and speed in the pieces k at times [s], or else at crank angles [rad],
        shape (3, p); at the end of a piece that does not come so far."""
        read = np.empty((3, len(values)))
        for number in np.unique(k):
            which = np.flatnonzero(k == number)
            cells = self.pieces[number].cells
            rows = np.array([cells.time, cells.angle, cells.speed])
            read[:, which] = cells.values(rows, *cells.located(values[which], in_time=in_time))
        return read

    def after(self, time: Array) -> Index:
        """In which of its pieces times lie, where two meet in the later one."""
        return np.searchsorted(self.ends[:-1], time * (1.0 + _SAME), side="right")

    def at_times(self, time: Array) -> Array:
        """The same at times, where two pieces meet that of the earlier one."""
        return self.at(cell_of(self.ends, time), time, in_time=True)


def motion_of(
    forces: Forces, path: Path, table: Array | None = None, places: list[Array] | None = None
) -> Motion:
    """The motion of a run; or with its decisions that of a table as `_table` gives it."""
    places = _places(path) if places is None else places
    table = _table(path, places) if table is None else table
    parts = np.split(table, np.cumsum([len(each) for each in places[:-1]]), axis=1)
    begin, pieces = path.stretches[0].begin, list[Piece]()
    after = [*(stretch.begin for stretch in path.stretches[1:]), path.end]
    for stretch, (time, angle, speed), last in zip(path.stretches, parts, after, strict=True):
        mode, sense = stretch.begin.mode, float(np.sign(angle[-1, -1] - angle[0, 0]))
        shares = np.array([mode.shares]).repeat(len(time), axis=0)
        cells = Cells(time, angle, speed, Acting(sense, phases=mode.loads), shares)
        inside = cells.inner_reader()  # at its ends loads may jump
        at = np.array([inside(time), inside(angle), inside(speed)])
        outside = forces.outside(mode, at, at[2])[0].reshape(time.shape)
        end = last._replace(time=time.item(-1), theta=angle.item(-1), omega=speed.item(-1))
        pieces.append(Piece(begin, end, replace(cells, outside=outside)))
        begin = end
    return Motion(tuple(pieces))


def _places(path: Path) -> list[Array]:
    """Where in the stretches of a run its cells of a few steps have their nodes, as shares of each,
    shape (cells, nodes)."""
    nodes, places = ends_and_nodes(_STAGES).places, []
    for _, rows in path.stretches:
        edges = np.append(rows[:-1:_STEPS, 0] - rows[0, 0], rows[-1, 0] - rows[0, 0])
        shares = edges / edges[-1]
        places.append(shares[:-1, None] + np.diff(shares)[:, None] * nodes)
        places[-1][:, -1] = shares[1:]
    return places


def _table(path: Path, places: list[Array]) -> Array:
    """Time, crank angle and speed of a run at places in each of its stretches, shape (3, cells,
    nodes).

    Cuts fall at other times in each run. At the same share of a stretch all runs are smooth in the
    step, so that their differences are there what they err by.
    """
    pairs = zip(path.stretches, places, strict=True)
    return np.concatenate([stretch.at(each) for stretch, each in pairs], axis=1)


class Runs:
    """Runs of one problem at halved steps, coarsest first.

    moves : False where the crank stays at rest; ending : of the runs
    shaken : the coarsest run again, from a start that is hardly off
    motions : the answer, and motions as far off as it may be; of one run none
    rounded : whether rounding has grown beyond what the steps err by
    """

    shaken: Path
    ending: Ending
    moves: bool
    motions: tuple[Motion, ...] = ()
    rounded = False

    def __init__(self, model: Model, start: State, limits: Limits) -> None:
        self.model, self.start = model, start
        self._limits, self._stiff = limits, False
        self.paths = list[Path]()
        self._step = self._coarsest()

    @property
    def steps(self) -> int:
        """Steps of all runs."""
        return sum(path.steps for path in self.paths)

    def first(self) -> bool:
        """Four runs, shorter than asked for where the steps do not reach or exudyn fails there;
        False where the crank stays at rest, or a finer run ends otherwise.

        Raises
        ------
        FormulationError : exudyn cannot take a single step
        """
        path = self._coarse()
        self.ending, reached = path.ending, path.end
        self.moves = bool(path.stretches)
        rests = path.ending in (Ending.UNMOVED, Ending.HELD) and self.start.omega == 0.0
        if not self.moves and not rests:
            why = _HELD if path.ending is Ending.HELD else _NO_STEP
            raise FormulationError(
                f"formulation 'multibody' cannot serve this scene: {why} at its start; choose auto"
            )
        share = {Ending.DIVERGED: _UNTOUCHED, Ending.CALLED_OFF: 1.0}.get(path.ending)
        if share is not None:
            begin = self.start.time
            self._limits = self._limits._replace(time=begin + share * (reached.time - begin))
            path = self._run()
        self.paths, there = [path], self.start.theta
        if not self.moves:
            return False
        off = math.copysign(_SHAKEN * (1.0 + abs(there)), reached.theta - there)
        self.shaken = self._run(start=self.start._replace(theta=there + off))
        return self.halve(times=3)

    def _coarse(self) -> Path:
        """A run at the coarsest step at which exudyn comes as far as at a quarter of it."""
        most = self._limits.steps // 15
        path = self._run(most)
        for _ in range(_RETRIES):
            if path.ending is not Ending.DIVERGED:
                break
            before = path, self._stiff, self._step
            self._stiff, self._step = True, 0.25 * self._step
            path = self._run(most)
            lasted, longer = (p.end.time - self.start.time for p in (before[0], path))
            further = _UNTOUCHED * longer > lasted
            if path.ending is Ending.DIVERGED and not further:
                path, self._stiff, self._step = before
                break
        return path

    def halve(self, times: int = 1) -> bool:
        """So many more runs, each at half the step; False where exudyn fails there."""
        finer = all(self._halved() for _ in range(times))
        self.motions = self.solved()
        return finer

    def _halved(self) -> bool:
        path = self._run(halvings=len(self.paths))
        if alike := path.ending is self.paths[-1].ending:
            self.paths.append(path)
        return alike

    def _run(self, most: int | None = None, start: State | None = None, halvings: int = 0) -> Path:
        limits = self._limits if most is None else self._limits._replace(steps=most)
        begin, stiff = start or self.start, self._stiff
        return integrate(self.model, begin, limits, self._step, halvings, stiff=stiff)

    @property
    def affords_another(self) -> bool:
        """Whether the steps suffice for one more."""
        return self.steps + 2 * self.paths[-1].steps <= self._limits.steps

    def solved(self) -> tuple[Motion, ...]:
        """The answer, and its checks.

        With f, f', ... the runs, coarse to fine, the answers E are (4 f' - f)/3, which err by h^3,
        of four runs or more of which the last three differ as errors of h^2 do, and else f' alone.
        The last answer is checked by the one before, and by motions that are off by what those
        before that were off by, the next over 8 or, where the order may be 1, two over 2 and 4: as
        the error of an answer may change its sign between two steps, two of them may agree by
        chance. All are off, besides, by what the rounding of all steps grows to, as they do at
        random. A run that is cut another number of times than the finest is compared as it is.
        """
        forces, fine = self.model.forces, self.paths[-1]
        alike = [path for path in self.paths if len(path.stretches) == len(fine.stretches)]
        if len(self.paths) == 1:
            return (motion_of(forces, fine),)
        if self.paths[-2] is not alike[-2:][0]:
            return motion_of(forces, fine), motion_of(forces, self.paths[-2])
        places, share, earlier = _places(fine), 2.0, 3
        tables = answers = [_table(path, places) for path in alike]
        if len(alike) > 3 and _is_clean(*tables[-3:]):
            answers, share, earlier = [(4.0 * f - c) / 3.0 for c, f in pairwise(tables)], 8.0, 2
        answer, before = answers[-1], answers[-2 : -2 - earlier : -1]
        offs = [(each - answer) / share**k for k, each in enumerate(before)]
        if self.paths[0] is alike[0] and len(self.shaken.stretches) == len(fine.stretches):
            grown = math.sqrt(fine.steps) * _EPS / _SHAKEN
            rounding = grown * (_table(self.shaken, places) - tables[0])
            most = max(_largest(off, answer)[0] for off in offs)
            self.rounded = bool(_largest(rounding, answer)[0] > most)
            offs = [off + rounding for off in offs]
        if len(forces.angles) or forces.times:  # what lies beside a jump may lie on either side
            offs += [-off for off in offs]
        checks = ((self.paths[-2], answer + off) for off in offs)  # with its decisions
        pairs = [(fine, answer), *checks]
        return tuple(motion_of(forces, path, each, places) for path, each in pairs)

    def _coarsest(self) -> float:
        """A step [s] to begin with.

        It resolves a turn at the speed at the start, or from rest at that after one turn at the
        first acceleration.
        """
        speed, end = abs(self.start.omega), self._limits.time
        if speed == 0.0:
            entered = enter(self.model, self.start, 0.0, self._limits)
            alpha = abs(entered[1]) if entered else 0.0
            speed = min(math.sqrt(4.0 * math.pi * alpha), alpha * end)
        turn = 2.0 * math.pi / speed if speed > 0.0 else math.inf
        longest = 1.0 if math.isinf(end) else end - self.start.time
        return min(turn, longest) / STEPS_A_TURN


def _largest(off: Array, motion: Array) -> Array:
    """By how much a motion is off at most in the crank angle at equal times, and in the speed."""
    late = off[1] - motion[2] * off[0]
    return np.array([np.abs(late).max(), np.abs(off[2]).max()])


def _is_clean(coarse: Array, middle: Array, fine: Array) -> bool:
    """Whether three runs differ as errors of h^2 do, at the ends of cells: on steps of each."""
    change, before, fine = (x[..., [0, -1]] for x in (fine - middle, middle - coarse, fine))
    allowed = _largest(change, fine) + 4.0 * _EPS * np.abs(fine[1:]).max(axis=(1, 2))
    return bool(np.all(_largest(before - 4.0 * change, fine) <= allowed))
