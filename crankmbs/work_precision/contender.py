"""What enters a comparison of speed and error: a name, its settings, and a way to run each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from crankmbs.work_precision.trace import Trace

__all__ = ["Answer", "Contender", "ContenderFailed"]


class ContenderFailed(Exception):
    """A contender could not give an answer; the text says why."""


class Answer(NamedTuple):
    """What one run gives.

    evaluations : of the equation of motion, or what the contender counts
    stated : the relative error it states itself; None when it states none
    """

    trace: Trace
    evaluations: int
    stated: float | None = None


@dataclass(frozen=True)
class Contender:
    """One way to solve a scene.

    settings : coarse to fine; knob : what a setting is
    run : setting -> answer; raises ContenderFailed
    reference : what its samples are compared with
    """

    name: str
    knob: str
    settings: tuple[float, ...]
    run: Callable[[float], Answer]
    reference: Trace
    is_peer: bool = False
