"""Store the oracles' motion of random scenes: PYTHONPATH=. python tests/make_random_references.py

A scene is taken where `validation.random_scenes` draws one that a crank-angle run of rtol 1e-11
carries through with few evaluations, so that the tests stay quick. That run only says when to look;
the motion at these instants is the oracles', in 80-bit floats. About ten minutes.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
from references import Reference, reference_of

from crankmbs import Result, simulate
from validation.random_scenes import random_scene

PATH = Path(__file__).parent / "data" / "random_references.csv"
SCENES = 300
MOST_EVALUATIONS = 15_000
MOST_SAMPLES = 60
ENDLESS = {300}  # seeds of a swing that the loads pump up over hundreds of reversals
HEADER = """\
# Free motions of random scenes (validation/random_scenes.py) by seed, in rad and s; see the recipe.
# Source: Taylor series of the absolute-coordinate equations, validation/oracles/free_motion.py.
# Rewritten by: PYTHONPATH=. python tests/make_random_references.py
# status: 0 the run reaches its end; 1 it does not, and its last sample is left out.
seed,status,time,theta,omega,alpha
"""


def stored() -> dict[int, tuple[int, Reference]]:
    """Status and motion by seed."""
    table = np.loadtxt(PATH, delimiter=",", skiprows=HEADER.count("\n"))
    return {
        int(seed): (int(rows[0, 1]), Reference(*rows[:, 2:].T))
        for seed in np.unique(table[:, 0])
        for rows in [table[table[:, 0] == seed]]
    }


def references() -> Iterator[tuple[int, int, Reference]]:
    """Seed, status and exact motion of one scene after the other."""
    for seed in (k for k in count() if k not in ENDLESS):
        result = simulate(random_scene(seed), formulation="crank_angle", rtol=1e-11)
        kept = result.data.sizes["time"] - (result.status == 1)
        quick = result.cost.evaluations <= MOST_EVALUATIONS
        if quick and result.status >= 0 and 2 <= kept <= MOST_SAMPLES:
            yield seed, result.status, reference_of(_first(result, kept))


def _first(result: Result, kept: int) -> Result:
    return replace(result, data=result.data.isel(time=slice(kept)))


def rewrite() -> None:
    """Compute and store all of them."""
    lines = [HEADER]
    for _, (seed, status, reference) in zip(range(SCENES), references(), strict=False):
        rows = np.transpose(reference).tolist()
        lines += [f"{seed},{status}," + ",".join(map(repr, row)) + "\n" for row in rows]
    PATH.write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    rewrite()
