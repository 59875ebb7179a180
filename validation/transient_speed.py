"""What a free run costs among others of its machine, for `python -m validation.batch_speed`.

Two ratios within one run: a case of a block, whose start and crank inertia differ, over the same
scene alone with its measures, where runs end at an angle and at a time; and carrying energies and
time through many periods over a limit in C (`speed/transient.c`) at equal steps, which makes no
measure: where only starts differ, and where inertia and load do.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crankmbs import Scene, simulate
from crankmbs.batch.machine import Pass, machine_of
from crankmbs.batch.motion import Cases, Setup, run
from crankmbs.batch.rows import rows_of
from crankmbs.scene.loads import Quadratic
from crankmbs.sweep.columns import row_of
from crankmbs.sweep.scenes import scene_of
from validation.speed import limit
from validation.speed.job import NotServed

__all__ = ["measure"]

_BLOCK, _ALONE = 256, 3
_UNTIL = ("20 cycles", "0.75 s")
_PERIODS = (20, 100)
_LIMIT = Path(__file__).parent / "speed" / "transient.c"
_HAIR = 1e-9  # of a time: so much earlier the last period is still to be passed

Array = NDArray[np.float64]
Seconds = Callable[[Callable[[], object]], float]


def measure(scene: Scene, seconds: Seconds) -> None:
    """Measure and print; ``seconds`` tells what work takes."""
    for until in _UNTIL:
        _one_block(scene.with_(run__until=until, run__every="none"), until, seconds)
    for periods in _PERIODS:
        for alike in (True, False):
            _over_limit(scene.with_(run__until="1 cycle"), periods, alike, seconds)


def _one_block(scene: Scene, until: str, seconds: Seconds) -> None:
    """A case among others over the same scene alone."""
    assert scene.start is not None
    own = np.array([scene.start.speed, scene.crank.moment_of_inertia])
    values = own * np.random.default_rng(1).uniform(1.0, 1.5, (_BLOCK, 2))
    names = "start.speed", "crank.inertia"
    scenes = [scene_of(scene, names, tuple(each)) for each in values.tolist()]
    found = rows_of(scenes)
    among = seconds(lambda: rows_of(scenes)) / _BLOCK
    alone = seconds(lambda: [row_of(simulate(one), None) for one in scenes[:_ALONE]]) / _ALONE
    error = max(float(rows.columns["relative_error"].max()) for rows in found)
    count = sum(len(rows.which) for rows in found)
    print(
        f"  {until}: a case among {count} takes {1e3 * among:.3f} ms, alone {1e3 * alone:.1f} ms, "
        f"{alone / among:.0f} times as long; error {error:.1e}"
    )


def _over_limit(scene: Scene, periods: int, alike: bool, seconds: Seconds) -> None:
    """Energy and time carried through so many periods, over the limit in C."""
    machine, load = machine_of(scene), scene.torque[0]
    assert scene.start is not None
    assert isinstance(load, Quadratic)
    tables, by = machine.answer, np.linspace(1.0, 1.5, _BLOCK)
    factor = np.ones_like(by) if alike else by
    inertias, squares = scene.crank.moment_of_inertia * factor, -load.coefficient * factor
    speeds, none = scene.start.speed * by, 0.0 * by
    starts = 0.5 * (inertias + tables.at_begin) * speeds**2
    given = np.stack([inertias, none, squares], axis=1)
    try:
        solve, answer = _in_c(tables, (given, starts), periods, alike)
    except NotServed as absent:
        print(f"  no limit in C: {absent}")
        return
    least = seconds(solve)
    ends = answer[:, 1] * (1.0 - _HAIR)
    cases = Cases(inertias, none, none, squares, speeds, ends, none)
    setup = Setup(machine.sense, in_time=True)
    own = seconds(lambda: run(tables, cases, setup, starts))
    found = run(tables, cases, setup, starts)
    apart = np.max(np.abs(found.ends[:, -1] / answer[:, 0] - 1.0))
    each, what = 1e6 / (len(by) * periods), "starts" if alike else "inertia and load"
    print(
        f"  {periods} cycles, {what} differ: {own * each:.2f} us a cycle, in C "
        f"{least * each:.2f} us: {least / own:.2f} of the limit's speed; energies {apart:.0e} apart"
    )


def _in_c(
    tables: Pass, cases: tuple[Array, Array], periods: int, alike: bool
) -> tuple[Callable[[], object], Array]:
    """A call of transient.c for cases (inertia, c0, c2) and their energies at the start, and its
    answer: energy at the end, and duration."""
    (_, m, s), rule = tables.inertia.shape, tables.rule
    answer, room = np.empty((len(cases[1]), 2)), np.empty((3 * m * s + 2 * m) * limit.LANES)
    constants = np.concatenate([rule.matrix.ravel(), rule.weights])
    given = constants, tables.width, tables.inertia, tables.torque, *cases, room, answer
    arrays = [np.ascontiguousarray(array) for array in given]
    sizes = (ctypes.c_int(size) for size in (len(answer), m, s, periods))
    held = [*sizes, *(array.ctypes.data_as(ctypes.c_void_p) for array in arrays)]
    library = limit.library(_LIMIT)
    function = library.carry_alike if alike else library.carry_each
    return lambda: (function(*held), arrays), arrays[-1]
