"""`python -m validation.batch_speed`: what a settled case costs among others of its machine.

Three ratios within one run, medians of several rounds: a case of a block over the same scene alone
with its measures; the periodic motion alone over a limit in C (`settled.c`), which makes no
measure; and 10,000 cases with all measures on so many processes. Inertia and load differ from case
to case; beside each speed stands the largest error.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crankmbs import Sample, Scene, load_scene, simulate, sweep
from crankmbs.batch.machine import Pass
from crankmbs.batch.motion import Cases, Setup, settled
from crankmbs.batch.rows import rows_of
from crankmbs.batch.solve import solved_together
from crankmbs.scene.loads import Quadratic
from crankmbs.sweep.columns import row_of
from crankmbs.sweep.scenes import scene_of
from validation import transient_speed
from validation.speed import limit
from validation.speed.job import NotServed

__all__ = ["main"]

_SCENES = ("propeller", "yi_diesel_free")
_NAMES = ("crank.inertia", "torque[1].coefficient")
_BLOCK, _ALONE, _ROUNDS = 256, 5, 7
_LIMIT = Path(__file__).parent / "speed" / "settled.c"
_LEAST = 2.0  # J, of the shipped scene's inertia and load up to so many times

Array = NDArray[np.float64]


def main(arguments: list[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m validation.batch_speed", description=__doc__)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    asked = parser.parse_args(arguments)
    print(f"load of the machine: {os.getloadavg()[0]:.1f}")
    for name in _SCENES:
        scene = load_scene(name).with_(run__until="settled", run__every="none")
        _one_block(scene)
        _motion_alone(scene)
        _whole(scene, asked.cases, asked.processes)
        transient_speed.measure(load_scene(name), _seconds)
    return 0


def _own(scene: Scene) -> tuple[float, float]:
    """What is varied, as the scene has it."""
    load = scene.torque[0]
    assert isinstance(load, Quadratic)
    return scene.crank.moment_of_inertia, load.coefficient


def _one_block(scene: Scene) -> None:
    """A case among others over the same scene alone."""
    points = np.random.default_rng(1).uniform(1.0, _LEAST, (_BLOCK, 2))
    own = _own(scene)
    values = [tuple(x * by for x, by in zip(own, point, strict=True)) for point in points]
    scenes = [scene_of(scene, _NAMES, each) for each in values]
    error = max(float(rows.columns["relative_error"].max()) for rows in rows_of(scenes))
    among = _seconds(lambda: rows_of(scenes)) / _BLOCK
    made = _seconds(lambda: [scene_of(scene, _NAMES, each) for each in values]) / _BLOCK
    alone = _seconds(lambda: [row_of(simulate(each), None) for each in scenes[:_ALONE]]) / _ALONE
    print(
        f"{scene.title}: a case among {_BLOCK} takes {1e3 * among:.3f} ms and {1e3 * made:.3f} ms "
        f"for its scene, alone {1e3 * alone:.1f} ms, {alone / (among + made):.0f} times as long; "
        f"error {error:.1e}"
    )


def _motion_alone(scene: Scene) -> None:
    """The periodic motion without measures over the limit in C."""
    (group,) = solved_together([scene])
    tables, setup = group.machine.answer, Setup(group.machine.sense)
    by = np.linspace(1.0, _LEAST, _BLOCK)
    of_crank, load = _own(scene)
    inertias, squares, none = of_crank * by, -load * by[::-1], np.zeros_like(by)
    assert scene.start is not None
    speeds = np.full_like(by, scene.start.speed)
    cases = Cases(inertias, none, none, squares, speeds, none, none)
    try:
        solve, answer = _in_c(tables, np.stack([inertias, none, squares], axis=1))
    except NotServed as absent:
        print(f"  no limit in C: {absent}")
        return
    own = _seconds(lambda: settled(tables, cases, setup))
    least = _seconds(solve)
    apart = np.max(np.abs(settled(tables, cases, setup).begin / answer - 1.0))
    print(
        f"  its periodic motion {1e6 * own / len(by):.1f} us, in C {1e6 * least / len(by):.1f} us: "
        f"{least / own:.2f} of the limit's speed; energies {apart:.0e} apart"
    )


def _in_c(tables: Pass, given: Array) -> tuple[Callable[[], object], Array]:
    """A call of settled.c for cases (inertia, c0, c2), and its answer: energies [J]."""
    (_, m, s), rule = tables.inertia.shape, tables.rule
    answer = np.empty(len(given))
    room = np.empty(2 * m * (s + 1) * limit.LANES)
    constants = np.concatenate([rule.matrix.ravel(), rule.weights])
    every = constants, tables.width, tables.inertia, tables.torque, given, room, answer
    arrays = [np.ascontiguousarray(a) for a in every]
    sizes = (ctypes.c_int(size) for size in (len(given), m, s))
    held = [*sizes, *(array.ctypes.data_as(ctypes.c_void_p) for array in arrays)]
    function = limit.library(_LIMIT).settle
    return lambda: (function(*held), arrays), arrays[-1]


def _whole(scene: Scene, cases: int, processes: int) -> None:
    """So many cases with all measures, in processes that have been started before."""
    own = _own(scene)
    units = "kg m^2", "N m s^2"
    ranges = {
        name: f"{value:.6g}..{_LEAST * value:.6g} {unit}"
        for name, value, unit in zip(_NAMES, own, units, strict=True)
    }
    spent = {}
    for count in (cases // 10, cases):
        begin = time.perf_counter()
        found = sweep(scene, Sample(ranges, count), executor=processes)
        spent[count] = time.perf_counter() - begin
    (few, short), (many, long) = spent.items()
    print(
        f"  {many} cases on {processes} processes, from their start: {long:.2f} s; each further "
        f"thousand {1e3 * (long - short) / (many - few):.3f} s; "
        f"{int((found['status'] != 0).sum())} without a motion"
    )


def _seconds(work: Callable[[], object]) -> float:
    work()
    spent = []
    for _ in range(_ROUNDS):
        begin = time.process_time()
        work()
        spent.append(time.process_time() - begin)
    return statistics.median(spent)


if __name__ == "__main__":
    sys.exit(main())
