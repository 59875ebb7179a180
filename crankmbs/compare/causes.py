"""The error budget: what a lecture's answer is wrong by, split into causes that add up to it."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from crankmbs import lecture
from crankmbs.compare.excerpt import Answer, Excerpt, LeftOut, excerpt_of, vanishing
from crankmbs.compare.lectured import S1, UNTRUNCATED
from crankmbs.compare.size import Size, percent
from crankmbs.digits import digits
from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["CAUSES", "Budget", "Cause", "Split", "budget"]


CAUSES = {
    "series": "the truncated series",
    "datum": "the datum",
    "constant speed": "the constant speed",
    "two-mass rod": "the two-mass rod",
    "gravity": "gravity",
    "friction": "friction",
    "solver": "the solver",
}
"""The causes in their order, and how a sentence names them."""

_NOTHING = 1e-12  # of the larger of lecture and run: rounding, and no cause
_ABSENT = 1e-9  # of the lecture: a run's peak so small has no percent


@dataclass(frozen=True)
class Cause:
    """curve : shape (n,) [unit], what the cause adds to the lecture's answer; size : of it."""

    name: str
    curve: Array
    size: Size


@dataclass(frozen=True)
class Split:
    """The error of one quantity, cause by cause.

    lecture, simulated : shape (n,) [unit]; their difference is `total`, the sum of the causes
    peak [unit] : largest magnitude in the run
    """

    quantity: str
    lecture: Array
    simulated: Array
    causes: tuple[Cause, ...]
    total: Cause
    peak: float

    def cause(self, name: str) -> Cause:
        """One of the causes.

        Raises
        ------
        InputError : there is none of this name
        """
        for cause in self.causes:
            if cause.name == name:
                return cause
        raise InputError(
            f"no cause {name!r} here: {', '.join(cause.name for cause in self.causes)}"
        )

    def share(self, cause: Cause) -> float:
        """The peak of a cause in percent of the run's; 0 where it is but rounding, not a number
        where the run's is, beside the lecture's."""
        answered = float(np.max(np.abs(self.lecture)))
        if cause.size.largest <= _NOTHING * max(answered, self.peak):
            return 0.0
        return percent(cause.size.largest, self.peak if self.peak > _ABSENT * answered else 0.0)

    def sentence(self) -> str:
        """How far the lecture is off, and what its causes are worth, the largest first.

        The peaks of causes lie at different angles: they do not add up to that of the error.
        """
        total = self.share(self.total)
        if math.isnan(total):
            return f"{self.quantity}: the run has none, the lecture has"
        worth = [cause for cause in self.causes if self.share(cause) > 0.0]
        worth.sort(key=self.share, reverse=True)
        parts: list[str] = []
        for cause in worth:
            up_to = "" if parts else "is worth up to "
            parts.append(
                f"{CAUSES[cause.name]} {up_to}{_readable(self.share(cause))} %, {_where(cause)}"
            )
        if len(worth) < len(self.causes):
            nothing = [CAUSES[c.name] for c in self.causes if self.share(c) == 0.0]
            parts.append(f"nothing comes from {_listed(nothing)}")
        off = f"off by up to {_readable(total)} % of the peak, {_where(self.total)}"
        return f"{self.quantity}: {off if total else 'right but for rounding'}: {'; '.join(parts)}"


@dataclass(frozen=True)
class Budget:
    """The error of every quantity; left_out : quantity, missing cause (or all) and reason."""

    excerpt: Excerpt
    splits: tuple[Split, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def ranked(self) -> tuple[Split, ...]:
        """The splits, the largest error in percent of its quantity's peak first."""
        return tuple(sorted(self.splits, key=lambda split: -(split.share(split.total) or 0.0)))

    def split(self, quantity: str) -> Split:
        """The split of one quantity.

        Raises
        ------
        InputError : there is none
        """
        for split in self.splits:
            if split.quantity == quantity:
                return split
        raise InputError(
            f"no {quantity!r} here; quantities: {', '.join(s.quantity for s in self.splits)}"
        )


def budget(result: Result, cylinder: int = 1) -> Budget:
    """Split the error of the lectures' truncated formulas (S1's) into named causes.

    At every sample of the run's last whole cycle, each cause is the difference of two neighbours:

        truncated formula
            series          exact closed form, lecture's datum, mean speed, two-mass rod
            datum           the same, displacement from the true top dead centre
            constant speed  the same, at the run's own omega and alpha
            two-mass rod    with the rigid rod, whose couple (m a b - I) beta'' two masses lack
            gravity         with gravity
            friction        with the pistons' friction, where the scene has any
            solver          the run

    so that they add up to formula minus run, to rounding. The mean speed is the time mean.

    Parameters
    ----------
    result : any formulation; cylinder : number of the one looked at, the main bearing carries all

    Returns
    -------
    Budget : in SI units, shares in percent of the run's peak, as in `compare`; with a rod ratio of
        1 it starts from the closed form, without "series"

    Raises
    ------
    InputError : no such cylinder

    >>> split = budget(simulate(load_scene("yi_diesel"))).split("side thrust")
    >>> f"{split.share(split.cause('two-mass rod')):.1f} % of the peak"
    '17.7 % of the peak'
    """
    excerpt = excerpt_of(result, cylinder)
    answers: dict[str, Answer] = {}
    left_out = [LeftOut(name, "", reason) for name, reason in excerpt.left_out().items()]
    simulated = excerpt.simulated()
    try:
        answers["series"] = excerpt.lecture(S1, constant_speed=True)
    except InputError as error:
        left_out += [LeftOut(name, "series", str(error)) for name in simulated]
    scene = result.scene
    answers["datum"] = excerpt.lecture(UNTRUNCATED, constant_speed=True)
    answers["constant speed"] = _from_top(excerpt, answers["datum"])
    own_motion = excerpt.lecture(UNTRUNCATED, constant_speed=False)
    answers["two-mass rod"] = _from_top(excerpt, own_motion)
    smooth = dataclasses.replace(scene, friction=None)
    answers["gravity"] = excerpt.newton_euler(dataclasses.replace(smooth, gravity=None))
    if scene.friction is not None:
        answers["friction"] = excerpt.newton_euler(smooth)
    answers["solver"] = excerpt.newton_euler(scene)
    nothing = vanishing([*answers.values(), simulated])
    left_out += [LeftOut(name, "", reason) for name, reason in nothing.items()]
    splits = tuple(
        _split(excerpt, name, {cause: answers[cause][name] for cause in answers}, simulated[name])
        for name in simulated
        if name not in nothing
    )
    return Budget(excerpt, splits, tuple(left_out))


def _from_top(excerpt: Excerpt, answer: Answer) -> Answer:
    """The answer with its displacement counted from the true top dead centre."""
    scene = excerpt.result.scene
    shift = lecture.datum_shift(
        crank_radius=scene.crank.radius, rod_length=scene.rod.length, offset=scene.piston.offset
    )
    return {**answer, "piston displacement": answer["piston displacement"] - shift}


def _split(excerpt: Excerpt, quantity: str, before: Answer, simulated: Array) -> Split:
    """``before`` holds, by cause, the answer that the cause still spoils."""
    chain = [*before.values(), simulated]
    curves = [a - b for a, b in pairwise(chain)]
    return Split(
        quantity=quantity,
        lecture=chain[0],
        simulated=simulated,
        causes=tuple(
            Cause(name, curve, excerpt.size(quantity, curve))
            for name, curve in zip(before, curves, strict=True)
        ),
        total=Cause("total", chain[0] - simulated, excerpt.size(quantity, chain[0] - simulated)),
        peak=float(np.max(np.abs(simulated))),
    )


def _where(cause: Cause) -> str:
    return f"at {round(math.degrees(cause.size.angle), 1):g} degrees"


def _readable(share: float) -> str:
    return digits(share, most=3) if share >= 1e-3 else f"{share:.0e}"


def _listed(words: list[str]) -> str:
    *most, last = words
    return f"{', '.join(most)} or {last}" if most else last
