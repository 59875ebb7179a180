"""Speed against error on one scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from crankmbs.scene.scene import Scene
from crankmbs.work_precision.contender import Contender
from crankmbs.work_precision.formulations import formulations_of
from crankmbs.work_precision.machine import about_machine
from crankmbs.work_precision.reference import Reference, reference_of
from crankmbs.work_precision.rounds import Row, play
from crankmbs.work_precision.trace import END

__all__ = ["TARGETS", "Beside", "WorkPrecision", "work_precision"]

TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)

Beside = Callable[[Scene, Reference], tuple[Sequence[Contender], Sequence[str]]]
"""What else runs on a scene: contenders, and a sentence for each that cannot."""


@dataclass(frozen=True)
class WorkPrecision:
    """What a comparison of speed and error gives.

    rows : every contender at every setting; notes : what did not run, and why
    machine : processor and system; versions
    """

    reference: Reference
    rows: tuple[Row, ...]
    notes: tuple[str, ...]
    machine: tuple[str, ...]

    @property
    def quantities(self) -> tuple[str, ...]:
        """The names of the errors: the state at the end, the motion, every reaction."""
        return tuple(self.reference.floors)

    @property
    def contenders(self) -> dict[str, tuple[Row, ...]]:
        """The rows of every contender, coarse to fine."""
        names = dict.fromkeys(row.contender for row in self.rows)
        return {name: tuple(r for r in self.rows if r.contender == name) for name in names}

    def time_to(self, contender: str, target: float) -> float | None:
        """Least wall time [s] of a setting whose state at the end errs at most ``target``."""
        rows = self.contenders[contender]
        return min((row.time for row in rows if row.errors[END] <= target), default=None)


def work_precision(scene: Scene, beside: Beside | None = None) -> WorkPrecision:
    """Run everything that can serve a scene over its settings, in turns, against a reference.

    Errors are relative, as in `differences`; wall times are medians over rounds in which all take
    their turns. What takes longer than two seconds runs once or twice only.

    beside : what else takes its turns, made for the scene and its reference

    Raises
    ------
    CrankmbsError : the scene cannot be run

    >>> work_precision(load_scene("yi_diesel").with_(run__until="60 deg")).quantities[:2]
    ('end', 'motion')
    """
    reference = reference_of(scene)
    further, absent = beside(scene, reference) if beside else ((), ())
    rows, failed = play((*formulations_of(scene, reference), *further), reference.start)
    return WorkPrecision(reference, rows, (*absent, *failed), about_machine())
