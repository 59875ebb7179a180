"""The loop over cells alone converges to the same end; there is none where it is not the motion."""

import dataclasses

import numpy as np
import pytest

from crankmbs import Constant, Quadratic, Run, Start, Table, TimeTable, Viscous, load_scene
from crankmbs.work_precision import END
from crankmbs.work_precision.reference import reference_of
from crankmbs.work_precision.trace import differences
from validation.speed.kernel import kernels_of

SHORT = dataclasses.replace(load_scene("coasting"), run=Run(until="50 ms", every="5 deg"))


@pytest.mark.parametrize("run", [SHORT.run, Run(until="3.3 rev", every="5 deg")])
@pytest.mark.parametrize("speed", [1000.0, -1000.0])
def test_the_kernel_alone_converges_to_the_same_end(run, speed):
    start = dataclasses.replace(SHORT.start, speed=speed * np.pi / 30.0)
    scene = dataclasses.replace(SHORT, run=run, start=start, torque=(Quadratic(coefficient=1e-6),))
    reference = reference_of(scene)
    (kernel,) = kernels_of(scene, reference)
    first, *_, last = (
        differences(kernel.run(widest).trace, reference.trace.end(), reference.start)[END]
        for widest in kernel.settings
    )
    assert first < 1e-4
    assert last < max(1e-6 * first, 2e-12)


@pytest.mark.parametrize(
    "change",
    [
        {"torque": (Viscous(coefficient=1e-3),)},
        {"torque": (TimeTable(file=Table((0.0, 1.0), (0.0, 1e-3))),)},
        {"start": Start(angle=0.3, speed=0.0)},
        {"start": Start(angle=0.3, speed=40.0), "torque": (Constant(torque=-50.0),)},
    ],
    ids=["viscous", "in time", "from rest", "turns back"],
)
def test_there_is_no_kernel_where_one_loop_does_not_solve_the_scene(change):
    scene = dataclasses.replace(SHORT, **change)
    assert kernels_of(scene, reference_of(scene)) == ()
