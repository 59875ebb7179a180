"""Numbers with which calculating would overflow or underflow are refused where they are written."""

import pytest
from scene_texts import FREE, INDICATED, edited, refusal

from crankmbs import Crank, InputError, Table


def out_of_range(unit, came):
    return (
        f"must be 0, or from 1e-50 to 1e+15 {unit} in size, or calculating with it overflows; "
        f"{came} came"
    )


@pytest.mark.parametrize(
    ("old", "came", "key", "unit"),
    [
        ('"46 mm"', '"1e-320 m"', "crank.radius", "m"),
        ('"46 mm"', '"1e300 m"', "crank.radius", "m"),
        ('"46 mm"', "1e-320", "crank.radius", "m"),
        ('"3200 rpm"', '"1e300 rpm"', "start.speed", "rad/s"),
        ('"3200 rpm"', '"-1e-320 rpm"', "start.speed", "rad/s"),
        ('"0 deg"', '"1e300 deg"', "start.angle", "rad"),
        ('"9.5e-5 N m s^2"', '"9.5e300 N m s^2"', "torque[1].coefficient", "N m s^2"),
    ],
)
def test_a_quantity_beyond_all_machines(read, old, came, key, unit):
    assert refusal(read, edited(FREE, old, came)) == f"{key}: {out_of_range(unit, came)}"


def test_python_callers_are_refused_alike():
    with pytest.raises(InputError) as caught:
        Crank(radius=1e-320, inertia=0.1)
    assert str(caught.value) == f"radius: {out_of_range('m', '1e-320')}"
    assert Crank(radius=1e-49, inertia=1e15, mass=0.0).mass == 0.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("compression_ratio = 10", "compression_ratio = 1e300", "must be at most 10000"),
        ("n_compression = 1.3", "n_compression = 1e300", "must be at most 10"),
    ],
)
def test_a_diagram_beyond_all_machines(read, old, new, message):
    assert message in refusal(read, edited(INDICATED, old, new))


def test_a_table_beyond_all_machines():
    with pytest.raises(InputError) as caught:
        Table([0.0, 1.0], [1.0, -1e300])
    assert str(caught.value) == (
        "table: every value must be at most 1e+15 in size, in SI units, or calculating with it "
        "overflows; 1e+300 came"
    )
