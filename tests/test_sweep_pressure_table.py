"""What a pressure table's dead centre, gain and zero are worth, against rows moved by hand, the
work of the rows over the volume, and the piston's area."""

import math
import re

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from crankmbs import CylinderTable, Gas, InputError, Table, load_scene, sensitivity, simulate
from crankmbs.cli.app import main
from crankmbs.sweep.knobs import knob_of, number_at
from crankmbs.sweep.pressure_table import step_from_zero
from crankmbs.sweep.scenes import scene_of

pytestmark = pytest.mark.slow

ENGINE = load_scene("yi_diesel").with_(run__until="1 cycles")
TABLE = ENGINE.gas.pressure
TWO = ENGINE.with_(layout__cylinders=load_scene("v_twin").layout.cylinders)


def by_hand(change):
    """The scene with the rows (angles [rad], pressures [Pa]) that `change` makes of its own."""
    return ENGINE.with_(gas__pressure=Table(*change(np.array(TABLE.x), np.array(TABLE.y))))


@pytest.mark.parametrize(
    ("name", "step", "change"),
    [
        ("gas.shift", 2e-3, lambda d: lambda angle, pressure: (angle + d, pressure)),
        ("gas.scale", 2e-3, lambda d: lambda angle, pressure: (angle, pressure * (1.0 + d))),
        ("gas.offset", 1e4, lambda d: lambda angle, pressure: (angle, pressure + d)),
    ],
    ids=["shift", "scale", "offset"],
)
@pytest.mark.parametrize("measure", ["mean main bearing force", "peak side force"])
def test_a_derivative_is_the_difference_of_runs_with_rows_moved_by_hand(
    name, step, change, measure
):
    found = sensitivity(ENGINE, name, measure)
    joint, of = (0, "mean") if measure.startswith("mean") else (3, "peak")
    less, same, more = (
        getattr(simulate(by_hand(change(d))).measures().joints[joint], of)
        for d in (-step, 0.0, step)
    )
    slope = (more.value - less.value) / (2.0 * step)
    bend = abs(more.value - 2.0 * same.value + less.value) / step
    error = found.derivative.error + (more.error + less.error) / step + bend
    assert found.reached.value == pytest.approx(same.value, rel=1e-12)
    assert abs(found.derivative.value - slope) <= error
    assert error < 0.05 * abs(slope)


def test_the_work_of_a_table_is_that_of_its_rows_over_the_volume():
    """The imep is in proportion to the gain, does not know the zero, and changes with the dead
    centre by the integral of p (dV/da)' over the swept volume."""
    radius, length = ENGINE.crank.radius, ENGINE.rod.length
    scene = ENGINE.with_(piston__offset=0.0)
    imep, scale, offset, shift = (
        sensitivity(scene, name, "imep")
        for name in ("gas.scale", "gas.scale", "gas.offset", "gas.shift")
    )
    assert scale.derivative.value == pytest.approx(imep.reached.value, rel=1e-9)
    assert scale.elasticity == pytest.approx(1.0, rel=1e-9)
    assert abs(offset.derivative.value) <= offset.derivative.error < 1e-9
    angle = np.linspace(0.0, 4.0 * math.pi, 72_001)
    pressure = CubicSpline(TABLE.x, TABLE.y, bc_type="periodic")(angle)
    sine = radius / length * np.sin(angle)
    rate = np.sin(angle) + sine * np.cos(angle) / np.sqrt(1.0 - sine**2)  # of travel, over radius
    work = np.trapezoid(pressure * np.gradient(rate, angle), angle) / 2.0
    assert shift.derivative.value == pytest.approx(work, rel=1e-5)


def test_at_a_dead_centre_an_offset_pushes_with_the_pistons_area():
    found = sensitivity(ENGINE.with_(piston__offset=0.0), "gas.offset", "peak piston pin force")
    assert found.derivative.value == pytest.approx(ENGINE.piston.area, rel=0.02)
    assert math.isnan(found.elasticity)


def test_every_column_of_a_table_is_corrected_before_it_is_carried_over():
    columns = CylinderTable(TABLE.x, (TABLE.y, TABLE.y[::-1]))
    scene = TWO.with_(gas__pressure=columns)
    names, values = ["gas.shift", "gas.scale", "gas.offset"], (0.1, 1.01, 2e3)
    moved = scene_of(scene, names, values).gas.pressure
    assert np.allclose(np.subtract(moved.x, TABLE.x), 0.1, rtol=0.0, atol=1e-14)
    assert np.allclose(moved.y, 1.01 * np.array(columns.y) + 2e3, rtol=1e-14)
    assert step_from_zero(scene, "gas.offset") == pytest.approx(2e-3 * max(TABLE.y))
    longer = scene_of(ENGINE, ["gas.shift", "rod.length"], (0.1, 0.3)).gas.pressure
    first = scene_of(scene_of(ENGINE, ["gas.shift"], (0.1,)), ["rod.length"], (0.3,)).gas.pressure
    assert longer == first


def test_a_table_is_varied_over_ranges_with_units():
    assert knob_of(ENGINE, "gas.offset", "-0.1..0.1 bar:3").values.tolist() == [-1e4, 0.0, 1e4]
    assert knob_of(ENGINE, "gas__shift", "-1..1 deg:3").values[2] == pytest.approx(math.pi / 180)
    assert number_at(ENGINE, "gas.scale").values == 1.0


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (ENGINE.with_(gas=None), "the scene has no [gas]"),
        (load_scene("v_twin"), "an indicator came"),
        (ENGINE.with_(gas=Gas(pressure=2e5, ambient=1e5)), "a constant came"),
        (ENGINE.with_(gas__motored=TABLE), "pressure and motored came"),
        (ENGINE.with_(gas__crank_end=TABLE), "pressure and crank_end came"),
        (TWO.with_(gas__pressure=(TABLE, TABLE)), "a list of 2 came, each with errors of its own"),
    ],
)
def test_a_knob_of_no_single_table_is_refused(scene, said):
    sentence = f"gas.shift: belongs to a single pressure table in [gas]; {said}"
    with pytest.raises(InputError, match=f"^{re.escape(sentence)}$"):
        sensitivity(scene, "gas.shift", "peak side force")


def test_a_scale_of_zero_is_refused():
    with pytest.raises(InputError, match=r"^gas\.scale: must be above 0; 0 came$"):
        scene_of(ENGINE, ["gas.scale"], (0.0,))


def test_the_command_speaks_of_degrees_and_bar(capsys, monkeypatch):
    words = "crankmbs sensitivity yi_diesel --vary gas.shift --vary gas.offset --of imep"
    monkeypatch.setattr("sys.argv", words.split())
    with pytest.raises(SystemExit):
        main()
    printed = capsys.readouterr().out
    assert re.search(r"gas\.shift \[deg\] .* -$", printed, re.MULTILINE)
    assert re.search(r"gas\.offset \[bar\] +0 .* -$", printed, re.MULTILINE)
