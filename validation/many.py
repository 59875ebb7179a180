"""Random scenes by the thousand: hardly any true error is over twice the stated one."""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from statistics import median

from validation.judge_scene import Judgement, judge_seed

__all__ = ["FORMULATIONS", "run_many"]

FORMULATIONS = ("crank_angle", "minimal")
_USUAL, _SHARE = 2.0, 0.99  # the true error over the stated one is so small for so many
_ALLOWED = 10.0  # and so small for all
_IDLE = 0.01  # the median is above it
_PATIENCE = 10.0  # s for a scene: a few swing or creep for very long


def run_many(
    count: int,
    first: int = 0,
    processes: int | None = None,
    *,
    formulations: tuple[str, ...] = FORMULATIONS,
    patience: float = _PATIENCE,
) -> bool:
    """Judge ``count`` random scenes from the seed ``first`` on, and print all that stand out.

    processes : how many at a time; None takes as many as there are processors
    patience [s] : for a scene

    Returns
    -------
    whether the true errors over the stated ones are as they should be in every formulation
    """
    begin, found = time.perf_counter(), list[Judgement]()
    seeds, judge = range(first, first + count), partial(judge_seed, formulations=formulations)
    for judgement in _judgements(
        seeds, partial(judge, patience=patience), processes or os.cpu_count() or 1
    ):
        found.append(judgement)
        if judgement.ratio is None or judgement.ratio > _USUAL:
            print(f"seed {judgement.seed}, {judgement.formulation}: {judgement.said}", flush=True)
        if sys.stderr.isatty():
            print(f"\rseed {judgement.seed} ", end="", file=sys.stderr, flush=True)
    green = [_sum_up(formulation, found) for formulation in formulations]
    seconds = time.perf_counter() - begin
    red = green.count(False)
    print(f"{count} random scenes, {len(green)} formulations: {red} red, {seconds:.0f} s")
    return red == 0


def _judgements(
    seeds: range, judge: Callable[[int], list[Judgement]], processes: int
) -> Iterator[Judgement]:
    if min(processes, len(seeds)) == 1:
        for seed in seeds:
            yield from judge(seed)
        return
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for judgements in pool.imap(judge, seeds):
            yield from judgements


def _sum_up(formulation: str, found: list[Judgement]) -> bool:
    """Print what the judgements of a formulation come to; whether it is green."""
    own = [one.ratio for one in found if one.formulation == formulation]
    ratios = [ratio for ratio in own if ratio is not None]
    share = sum(ratio <= _USUAL for ratio in ratios) / max(len(ratios), 1)
    worst, middle = max(ratios, default=0.0), median(ratios or [0.0])
    print(
        f"{formulation}: {len(ratios)} judged, {len(own) - len(ratios)} skipped; true over stated "
        f"error at most {_USUAL:g} for {share:.2%}, largest {worst:.3g}, median {middle:.2g}"
    )
    return share >= _SHARE and worst <= _ALLOWED and middle > _IDLE
