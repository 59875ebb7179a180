"""The table of joint forces that `run` prints: which angle stands in which column."""

import math

import pytest

from crankmbs import (
    Crank,
    Gas,
    Layout,
    Motion,
    Piston,
    Rod,
    Run,
    Scene,
    Table,
    simulate,
)
from crankmbs.report.rows import FORCE_HEADINGS, force_rows

PEAK = 370.0  # deg, of the pressure, in the cycle of each cylinder
ORDER = (1, 3, 4, 2)


@pytest.fixture(scope="module")
def rows():
    """Pistons without mass: a pin carries what the gas puts on its piston over cos(beta), and the
    pressure has one corner, so steep that its force peaks there."""
    angles = tuple(math.radians(a) for a in (0.0, PEAK - 20.0, PEAK, PEAK + 20.0))
    scene = Scene(
        crank=Crank(radius=0.04, inertia=0.05),
        rod=Rod(length=0.13),
        piston=Piston(mass=0.0, area=5e-3),
        gas=Gas(
            pressure=Table(angles, (1e5, 1e5, 5e6, 1e5)),
            absolute=False,
            stroke=4,
            interpolation="linear",
        ),
        layout=Layout(firing_order=ORDER),
        motion=Motion(speed=100.0),
        run=Run(until="2 cycles"),
    )
    table = force_rows(simulate(scene).measures(), scene.period)
    return {name: dict(zip(FORCE_HEADINGS[1:], cells, strict=True)) for name, *cells in table}


@pytest.mark.parametrize("joint", ["crank pin", "piston pin"])
@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_peak_has_its_crank_angle_and_its_own_cycle_angle(rows, joint, number):
    """Cylinder k of the order fires 180 degrees after the one before it."""
    row = rows[f"{joint} {number}"]
    assert float(row["cycle angle [deg]"]) == pytest.approx(PEAK, abs=2e-3)
    at_crank = (PEAK + 180.0 * ORDER.index(number)) % 720.0
    assert float(row["at crank angle [deg]"]) == pytest.approx(at_crank, abs=2e-3)


def test_the_main_bearing_has_no_cycle_angle(rows):
    assert rows["main bearing"]["cycle angle [deg]"] == ""
