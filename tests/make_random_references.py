"""Store the oracles' motion of random scenes: PYTHONPATH=. python tests/make_random_references.py

Every scene that `validation.random_scenes` draws from the seeds 0 to 348 is taken but for four.
A crank-angle run of rtol 1e-11 only says when to look; the motion at these instants is that of the
oracles, in 80-bit floats. About twenty minutes.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from references import Reference, reference_of

from crankmbs import Result, simulate
from validation.random_scenes import random_scene

PATH = Path(__file__).parent / "data" / "random_references.csv"
SEEDS = range(349)
MOST_SAMPLES = 60
LEFT_OUT = {
    300: "a swing that the loads pump up over hundreds of reversals: no run ends in a minute",
    181: "it comes to rest on a sample's angle: a rounding decides whether it is one sample or two",
    317: "the same",
    238: "it swings back to its start, a sample's angle: a rounding decides whether it gets there",
}
HEADER = """\
# Free motions of random scenes (validation/random_scenes.py) by seed, in rad and s; see the recipe.
# Source: Taylor series of the absolute-coordinate equations, validation/oracles/free_motion.py.
# Rewritten by: PYTHONPATH=. python tests/make_random_references.py
# status: 0 the run reaches its end; 1 it does not, and its last samples are left out.
# sample: its number in the run; of more than 60 some are taken, evenly.
seed,status,sample,time,theta,omega,alpha
"""


class Stored(NamedTuple):
    """How the run of a scene ends, and its exact motion at these of its samples."""

    status: int
    samples: NDArray[np.intp]
    motion: Reference


def stored() -> dict[int, Stored]:
    """What is stored, by seed."""
    table = np.loadtxt(PATH, delimiter=",", skiprows=HEADER.count("\n"))
    return {
        int(seed): Stored(int(rows[0, 1]), rows[:, 2].astype(np.intp), Reference(*rows[:, 3:].T))
        for seed in np.unique(table[:, 0])
        for rows in [table[table[:, 0] == seed]]
    }


def references(seeds: Iterable[int]) -> Iterator[tuple[int, Stored]]:
    """Seed, status, samples and exact motion of one scene after the other."""
    for seed in seeds:
        result = simulate(random_scene(seed), formulation="crank_angle", rtol=1e-11)
        samples = _judged(result)
        motion = reference_of(replace(result, data=result.data.isel(time=samples)))
        yield seed, Stored(result.status, samples, motion)


def _judged(result: Result) -> NDArray[np.intp]:
    """The numbers of the samples that are looked at. A run of another tolerance may stop a little
    earlier; one that does not move at all is looked at where it stands."""
    count = result.data.sizes["time"]
    stops = result.status == 1 and count > 1
    count -= stops
    last = (MOST_SAMPLES - 1) * count // MOST_SAMPLES if stops else count - 1
    return np.linspace(0, last, min(count, MOST_SAMPLES)).round().astype(np.intp)


def rewrite() -> None:
    """Compute and store all of them."""
    lines = [HEADER]
    for seed, one in references(seed for seed in SEEDS if seed not in LEFT_OUT):
        motion = np.transpose(one.motion).tolist()
        lines += [
            f"{seed},{one.status},{sample}," + ",".join(map(repr, row)) + "\n"
            for sample, row in zip(one.samples.tolist(), motion, strict=True)
        ]
    PATH.write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    rewrite()
