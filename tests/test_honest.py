"""On every shipped free scene the stated errors are honest and not idle caution."""

from dataclasses import replace
from functools import cache

import pytest
from references import reference_at_angles, true_errors

from crankmbs import Run, load_scene, shipped_scenes, simulate
from crankmbs.mechanics.indicator import INDICATOR_RTOL
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.motion.plan import plan_of

RUNS = {
    "coasting": Run(until="2 rev", every="15 deg"),
    "propeller": Run(until="2 cycles", every="15 deg"),
    "indicated": Run(until="1 rev", every="15 deg"),
    "torque_driven": Run(until="2 rev", every="15 deg"),
    "v_twin": Run(until="1 rev", every="15 deg"),
    "yi_diesel_free": Run(until="1 rev", every="15 deg"),
}
IDLE = 100.0
TINY = 1e-12  # of the peak: so small a stated error needs no reason


def test_every_free_scene_is_here():
    free = {
        name
        for name, scene in {name: load_scene(name) for name in shipped_scenes()}.items()
        if scene.start is not None and scene.fuel is None and scene.friction is None
    }
    # fuel and friction have oracles of their own in validation; a wheel alone has no forces
    assert free - {"turning_moment"} == RUNS.keys()


@cache
def exact(name):
    """The oracle's motion at every angle of a run; it does not depend on the run."""
    scene = replace(load_scene(name), run=RUNS[name])
    plan = plan_of(scene)
    return reference_at_angles(scene, plan.between(plan.start - 1e-9, plan.start + plan.until))


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
@pytest.mark.parametrize("name", RUNS)
def test_stated_errors(name, rtol, formulation):
    scene = replace(load_scene(name), run=RUNS[name])
    result = simulate(scene, formulation=formulation, rtol=rtol)
    assert result.status == 0
    shared = INDICATOR_RTOL if scene.gas and scene.gas.indicator else 0.0
    assert result.error.estimated <= rtol + 5.0 * shared
    errors = true_errors(result, exact(name))
    largest = {EVERY[n].units: e.peak for n, e in sorted(errors.items(), key=lambda e: e[1].peak)}
    for variable, error in errors.items():
        assert error.true <= 2.0 * error.stated + TINY * error.peak, (variable, error)
        # the oracle has the indicator's own pieces; what they miss of the diagram is stated, too
        unseen = error.true + shared * error.peak
        # what cancels in a sum is rounded all the same
        rounded = largest[EVERY[variable].units] if variable in SUMS else error.peak
        assert error.stated <= IDLE * unseen + TINY * rounded, (variable, error)
