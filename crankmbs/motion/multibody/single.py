"""One run at one step size as a script can repeat it: where it starts, and what it gives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.errors import InputError
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.problem import jump_times, problem_of
from crankmbs.motion.multibody.run_up import RUN_UP
from crankmbs.motion.multibody.start import Start, coordinates
from crankmbs.motion.multibody.step_table import StepTable
from crankmbs.motion.multibody.stepped import Stepped, coarsest_step, model_of, solve
from crankmbs.numerics.arrays import Array

__all__ = ["Single", "single_run"]

_HALVINGS = (1, 2, 3)  # to 1000 steps a turn
_ORDERLY = 3.0  # of order 2 differences fall by 4 at a halving; where they fall less it is rounding
_CUT = "its multibody run is cut where forces or loads jump or bend, and begins anew there"
_SAFE = 1.5  # the largest difference of the rows is not quite that of the motion


class Single(NamedTuple):
    """A run in one stretch, whose first ``run_up`` steps come before the scene's start.

    start : where the run-up begins; reference : coordinates that exudyn counts from, as in `Start`
    step [s]; steps : with those of the run-up
    angles : shape (run_up,) [rad], of the crank in the run-up to a prescribed motion
    rows : of every variable at the steps from the scene's start on, shape (steps - run_up + 1,) or
        (..., cylinders)
    errors : largest error of each, in its unit, from runs of twice and four times the step: where
        order 2 is seen a third of what the nearer one differs by, else all of it; of the bearing
        under several cylinders at least that of their crank pins
    """

    start: Start
    reference: Array
    step: float
    steps: int
    run_up: int
    angles: tuple[float, ...]
    rows: dict[str, Array]
    errors: dict[str, float]


def single_run(train: CrankTrain) -> Single:
    """Run at 1000 steps a turn of the fastest speed.

    Raises
    ------
    InputError : the run is cut where something jumps, ends before its end, or has no smooth start

    >>> single_run(crank_train(load_scene("torque_driven"))).run_up
    6
    """
    problem = problem_of(train)
    if problem.gas.jumps or jump_times(problem):
        raise InputError(_CUT)
    model = model_of(problem)
    try:
        coarsest, moves = coarsest_step(problem, model)
        if not moves:
            raise InputError("nothing moves the crank, and a script of a crank at rest is none")
        *coarser, fine = (
            _one_stretch(solve(problem, model, coarsest, halvings, None)) for halvings in _HALVINGS
        )
        assert model.begun is not None
        start, step = model.begun
        angles = tuple(map(model.angle, range(RUN_UP)))
    finally:
        model.close()
    coarsest_rows, coarse, rows = (_rows(table) for table in (*coarser, fine))
    errors = {}
    for name, values in rows.items():
        change = _difference(values, coarse[name])
        orderly = _difference(coarse[name], coarsest_rows[name]) > _ORDERLY * change
        errors[name] = _SAFE * change / (3.0 if orderly else 1.0)
    if len(problem.scene.cylinders) > 1:  # whose differences may cancel where their errors do not
        pins = max(errors["crank_pin_force_x"], errors["crank_pin_force_y"])
        for name in ("main_bearing_force_x", "main_bearing_force_y"):
            errors[name] = max(errors[name], pins)
    reference = coordinates(problem.scene, problem.start[0], 0.0).position
    return Single(start, reference, step, len(fine.columns) - 1, RUN_UP, angles, rows, errors)


def _one_stretch(path: Stepped) -> StepTable:
    if path.ending is not Ending.COMPLETE:
        raise InputError("its multibody run stops before its end")
    table = path.tables[0]
    if len(path.tables) > 1 or round((table.after - table.begin) / table.step) != RUN_UP:
        raise InputError(_CUT)
    return table


def _rows(table: StepTable) -> dict[str, Array]:
    """The variables at the rows from the start of the run on."""
    return table.at(table.times[RUN_UP:])


def _difference(fine: Array, coarse: Array) -> float:
    """The largest between every second row and the rows of twice the step."""
    count = min(len(fine[::2]), len(coarse))
    return float(np.max(np.abs(fine[::2][:count] - coarse[:count])))
