"""Run contenders in turns, so that what else the machine does falls on all of them alike."""

from __future__ import annotations

import statistics
import time as clock
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from crankmbs.digits import error_digits
from crankmbs.work_precision.contender import Answer, Contender, ContenderFailed
from crankmbs.work_precision.trace import differences

__all__ = ["Row", "play"]

_ROUNDS = 5  # the median of so many
_PATIENCE = 2.0  # s: a setting is not repeated beyond this
_RESOLVED = 5e-3  # s: what is shorter is repeated within a round


@dataclass(frozen=True)
class Row:
    """One contender at one setting.

    errors : relative to the reference, by name; stated : what the contender states itself
    times : wall time of one run in every round [s]
    """

    contender: str
    is_peer: bool
    knob: str
    setting: float
    errors: dict[str, float]
    stated: float | None
    evaluations: int
    times: tuple[float, ...]

    @property
    def time(self) -> float:
        """Median wall time [s]."""
        return statistics.median(self.times)


def play(
    contenders: Sequence[Contender], start: float, longest: float = 10.0
) -> tuple[tuple[Row, ...], tuple[str, ...]]:
    """Rows of everything that ran, and a sentence for everything that did not.

    start [rad] : where the motion starts; longest [s] : what takes longer is the last setting of
        its contender
    """
    entries: list[_Entry] = []
    notes: list[str] = []
    for contender in contenders:
        first, why = _first_round(contender, longest)
        entries += first
        notes += why
    for _ in range(_ROUNDS - 1):
        for entry in entries:
            if sum(entry.times) + entry.times[0] < _PATIENCE:
                entry.times.append(_timed(entry.contender, entry.setting)[1])
    return tuple(entry.row(start) for entry in entries), tuple(notes)


@dataclass(frozen=True)
class _Entry:
    """A contender at a setting, its answer, and the wall times so far [s]."""

    contender: Contender
    setting: float
    answer: Answer
    times: list[float]

    def row(self, start: float) -> Row:
        contender, answer = self.contender, self.answer
        return Row(
            contender=contender.name,
            is_peer=contender.is_peer,
            knob=contender.knob,
            setting=self.setting,
            errors=differences(answer.trace, contender.reference, start),
            stated=answer.stated,
            evaluations=answer.evaluations,
            times=tuple(self.times),
        )


def _first_round(contender: Contender, longest: float) -> tuple[list[_Entry], list[str]]:
    """Every setting once, after a run that is not counted: it imports and compiles."""
    with suppress(ContenderFailed):
        contender.run(contender.settings[0])
    entries: list[_Entry] = []
    failures: dict[str, list[str]] = {}
    for setting in contender.settings:
        try:
            answer, spent = _timed(contender, setting)
        except ContenderFailed as failure:
            failures.setdefault(str(failure), []).append(f"{setting:g}")
            continue
        entries.append(_Entry(contender, setting, answer, [spent]))
        why = _last(answer, setting, spent, longest)
        if why and setting != contender.settings[-1]:
            failures[f"{why}; nothing finer was run"] = [f"{setting:g}"]
            break
    notes = [
        f"{contender.name}, {contender.knob} {', '.join(settings)}: {why}"
        for why, settings in failures.items()
    ]
    return entries, notes


def _last(answer: Answer, setting: float, spent: float, longest: float) -> str:
    """Why a finer setting is of no use; empty when it is."""
    if spent > longest:
        return f"took {spent:.0f} s"
    if answer.stated is not None and answer.stated > setting:
        return f"states {error_digits(answer.stated)}, no less"
    return ""


def _timed(contender: Contender, setting: float) -> tuple[Answer, float]:
    """The answer and the wall time of one run [s], the mean of several where it is short."""
    begin, runs = clock.perf_counter(), 0
    while True:
        answer = contender.run(setting)
        runs += 1
        spent = clock.perf_counter() - begin
        if spent >= _RESOLVED:
            return answer, spent / runs
