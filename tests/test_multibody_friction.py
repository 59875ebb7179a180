"""Friction of the pistons in the multibody model: its own forces, from the pistons' own velocities,
confirm the reduced equations."""

import dataclasses

import pytest

from crankmbs import FormulationError, load_scene, simulate
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import TimeTable
from crankmbs.scene.parts import Friction
from crankmbs.scene.run import Run
from crankmbs.scene.tables import Table

pytestmark = pytest.mark.slow

ALL = Friction(ring_force=40.0, ring_pressure=0.02, viscous=30.0)
DRY = Friction(ring_force=40.0, viscous=30.0)


@pytest.mark.parametrize("name", ["yi_diesel", "coasting", "v_twin", "propeller"])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_it_confirms_the_reduced_equations(name, sense):
    scene = load_scene(name)
    friction = ALL if scene.gas else DRY
    run = Run(until="1 rev", every="7.5 deg")
    scene = dataclasses.replace(scene, friction=friction, run=run)
    if scene.start is not None:
        start = Start(angle=scene.start.angle, speed=sense * scene.start.speed)
        scene = dataclasses.replace(scene, start=start)
    elif sense < 0.0:
        scene = dataclasses.replace(
            scene, motion=dataclasses.replace(scene.motion, speed=-scene.motion.speed)
        )
    ours = simulate(scene, formulation="multibody", cost_cap=20.0)
    exact = simulate(scene, rtol=1e-10)
    assert ours.status == exact.status == 0
    assert "friction_force" in ours.data
    for variable in exact.data:
        apart = float(abs(ours.data[variable] - exact.data[variable].values).max())
        stated = sum(r.data[variable].attrs["error_estimate"] for r in (ours, exact))
        assert apart <= 2.0 * stated, variable


def test_a_crank_that_friction_stops_ends_there():
    start = Start(angle=0.3, speed=9.0)
    scene = dataclasses.replace(
        load_scene("coasting"),
        gravity=None,
        start=start,
        friction=Friction(ring_force=60.0),
        run=Run(until="5 s", every="5 deg"),
    )
    ours, exact = (simulate(scene, formulation=f) for f in ("multibody", "crank_angle"))
    assert ours.status == exact.status == 1
    assert "holds the crank there" in ours.message
    assert "holds the crank there" in exact.message
    apart = abs(float(ours.data.crank_angle[-1] - exact.data.crank_angle[-1]))
    assert apart <= 2.0 * ours.data.crank_angle.attrs["error_estimate"] + 1e-9


def test_it_does_not_wait_at_rest():
    scene = dataclasses.replace(load_scene("coasting"), friction=DRY)
    at_rest = dataclasses.replace(scene, start=Start(angle=0.3, speed=0.0))
    rows = TimeTable(file=Table([0.0, 1.0], [0.0, 1.0]))
    for one in (at_rest, dataclasses.replace(scene, torque=(rows,))):
        with pytest.raises(FormulationError, match="holds a crank at rest and lets it go"):
            simulate(one, formulation="multibody")
