"""A run that no memory or no double precision could hold is refused before it starts."""

import dataclasses

import pytest

from crankmbs import InputError, Run, load_scene, simulate


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (Run(until="1e300 cycles"), "run.until: beyond 1.6e"),
        (Run(until="1 rev", every="1e-9 deg"), "run.every: 3.6e\\+11 samples came"),
        (Run(until="1 s", every="1e-9 s"), "run.every: 1e\\+09 samples came"),
    ],
)
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_an_impossible_size_is_refused(run, message, formulation):
    scene = dataclasses.replace(load_scene("coasting"), run=run)
    with pytest.raises(InputError, match=message):
        simulate(scene, formulation=formulation)
