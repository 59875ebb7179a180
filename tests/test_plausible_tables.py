"""Tables that are unlikely to be meant as they are read: each rule speaks, and is silent where it
should be."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from crankmbs import (
    AngleTable,
    CylinderTable,
    ForceAngleTable,
    Motion,
    Run,
    SpeedFile,
    Table,
    load_scene,
    simulate,
)
from crankmbs.cli.report import report
from crankmbs.measures.plausible import warnings

FOUR, V_TWIN = (load_scene(name) for name in ("yi_diesel_free", "v_twin"))
DEGREE = pi / 180.0


def diesel(degrees, **keys):
    """The four-cylinder engine with the rows at some degrees only."""
    table = FOUR.gas.pressure
    of = dict(zip([round(x / DEGREE) for x in table.x], table.y, strict=True))
    rows = Table([k * DEGREE for k in degrees], [of[k] for k in degrees])
    return replace(FOUR, gas=replace(FOUR.gas, pressure=rows, **keys))


def gaps(scene):
    return [said for said in warnings(scene) if " has no row between " in said]


CUT = {
    "half a cycle": (diesel(range(180, 541)), "540 and 900", 1, 360),
    "as far as the peak": (diesel(range(0, 381, 20)), "380 and 720", 20, 340),
    "the last 30 degrees": (diesel(range(691)), "690 and 720", 1, 30),
    "a hole": (diesel([*range(0, 400, 5), *range(600, 721, 5)]), "395 and 600", 5, 205),
}


@pytest.mark.parametrize("name", CUT)
def test_rows_that_are_missing_are_said(name):
    scene, between, usual, wide = CUT[name]
    table = scene.gas.pressure
    degrees = [round(x / DEGREE) for x in table.x]
    begin, end = (int(word) for word in between.split(" and "))
    before, after = (table.y[degrees.index(k if k < 720 else k - 720)] for k in (begin, end))
    assert gaps(scene) == [
        f"gas.pressure: table has no row between {between} degrees, and elsewhere one every "
        f"{usual} degrees or less: cubic draws {wide} degrees there, from {before / 1e5:.4g} to "
        f"{after / 1e5:.4g} bar; add the rows that are missing, or, where the pressure is meant "
        "so, one or two between"
    ]


SPARED = {
    "coarse away from the peak": diesel([*range(0, 300, 60), *range(300, 420, 20), 480, 540, 660]),
    "the last 29 degrees": diesel(range(692)),
    "four rows for one elsewhere": diesel([*range(0, 601, 40), *range(700, 721, 20)]),
    "a step holds": diesel([*range(0, 381, 20)], interpolation="step"),
    "four quarters": diesel([0, 180, 360, 540]),
}


@pytest.mark.parametrize("name", SPARED)
def test_a_coarse_table_is_none_with_missing_rows(name):
    assert gaps(SPARED[name]) == []


def test_a_pressure_that_stays_is_meant():
    """1 bar over half the gas exchange, in two rows; not from a last row to the first."""
    degrees = 0, 340, 350, 360, 380, 400, 460, 520, 580, 640, 720
    for first, among in ((1.0, []), (1.2, ["between 0 and 340 degrees"])):
        bars = (first, 1.0, 20.0, 40.0, 20.0, 9.0, 5.0, 3.0, 2.0, 1.5, first)
        table = Table([k * DEGREE for k in degrees], [1e5 * bar for bar in bars])
        said = gaps(replace(FOUR, gas=replace(FOUR.gas, pressure=table)))
        assert [words in each for words, each in zip(among, said, strict=True)] == [True] * len(
            among
        )
    short = range(0, 381, 20)
    levels = [1e5 + 20e5 * (k == 360) for k in short]
    table = Table([k * DEGREE for k in short], levels)
    (said,) = gaps(replace(FOUR, gas=replace(FOUR.gas, pressure=table)))
    assert "between 380 and 720 degrees" in said
    assert "from 1 to 1 bar" in said


@pytest.mark.parametrize("cycles", ["mean", "sequence"])
def test_a_gap_in_every_cycle_is_found(cycles):
    rows = diesel(range(0, 400, 5)).gas.pressure
    angle = [x + turn * 4.0 * pi for turn in range(3) for x in rows.x] + [12.0 * pi]
    table = Table(angle, rows.y * 3 + rows.y[:1])
    scene = replace(FOUR, gas=replace(FOUR.gas, pressure=table, cycles=cycles))
    (said,) = gaps(scene)
    assert "between 395 and 720 degrees" in said


def test_each_key_and_each_file_is_looked_at_once():
    cut = diesel(range(600)).gas.pressure
    whole = FOUR.gas.pressure
    columns = CylinderTable(cut.x, [cut.y] * 4, "four.csv")
    for keys in ({"pressure": columns}, {"pressure": (cut, whole, cut, whole)}):
        (said,) = gaps(replace(FOUR, gas=replace(FOUR.gas, **keys)))
        assert said.startswith("gas.pressure: ")
    (said,) = gaps(replace(FOUR, gas=replace(FOUR.gas, motored=cut)))
    assert said.startswith("gas.motored: table has no row between 599 and 720 degrees")


LOADED = {
    "cut": ([*range(0, 361, 15)], 720.0, "torque[1]: press.csv", "between 360 and 720"),
    "a hole": (
        [*range(0, 91, 10), *range(270, 361, 10)],
        None,
        "torque[1]: press.csv",
        "90 and 270",
    ),
    "whole": ([*range(0, 361, 15)], None, None, None),
    "typed by hand": ([0, 90, 180, 200, 300], None, None, None),
}


@pytest.mark.parametrize(
    ("name", "key"),
    [
        (name, key)
        for name in LOADED
        for key in ("torque", "force")
        if (name, key) != ("cut", "force")
    ],
)
def test_a_load_over_the_angle_is_looked_at_too(name, key):
    degrees, period, where, between = LOADED[name]
    table = Table([k * DEGREE for k in degrees], [-20.0 - k / 9.0 for k in degrees], "press.csv")
    of = {"file": table} if period is None else {"file": table, "period": period * DEGREE}
    load = {"torque": AngleTable, "force": ForceAngleTable}[key](**of)
    said = gaps(replace(FOUR, **{key: (load,)}))
    assert len(said) == (where is not None)
    for sentence in said:
        assert sentence.startswith(where.replace("torque", key))
        assert between in sentence
        assert sentence.endswith(f"where the {key} is meant so, one or two between")
        assert (" N m;" in sentence) == (key == "torque")


def turning(rows, *, noise, kind="time_table", waves=4.0):
    """The engine at a measured speed of 1500 rpm with errors of some rpm."""
    x = np.linspace(0.0, 0.08 if kind == "time_table" else 4.0 * pi, rows)
    rpm = 1500.0 + 30.0 * np.cos(2.0 * pi * waves * x / x[-1])
    rpm += noise * np.random.default_rng(5).standard_normal(rows)
    rpm[-1] = rpm[0]
    table = Table(x, rpm * pi / 30.0, "speed.csv")
    run = Run(until="1 rev" if kind == "time_table" else "2 cycles")
    moved = Motion(speed=SpeedFile(file=table, kind=kind))
    return replace(FOUR, start=None, torque=(), motion=moved, run=run)


@pytest.mark.parametrize("kind", ["time_table", "angle_table"])
@pytest.mark.parametrize(("rows", "noise"), [(400, 3.0), (400, 1.0), (100, 3.0)])
def test_a_speed_that_scatters_is_said(rows, noise, kind):
    (said,) = warnings(turning(rows, noise=noise, kind=kind))
    step = 0.08 / (rows - 1)
    usual = 0.6745 * 5.0**0.5 * noise * pi / 30.0 / step  # median of a normal deviation
    assert float(said.split("some ")[1].split()[0]) == pytest.approx(usual, rel=0.2)
    torque = float(said.split("rad/s^2, ")[1].split()[0])
    assert torque == pytest.approx(usual * FOUR.crank.moment_of_inertia, rel=0.2)
    assert said.startswith("motion.speed: the rows of speed.csv scatter: the acceleration ")


def cornered():
    """Straight between five rows, read at two hundred."""
    x = np.linspace(0.0, 1.0, 200)
    rpm = np.interp(x, [0.0, 0.2, 0.4, 0.7, 1.0], [900.0, 1500.0, 1450.0, 700.0, 800.0])
    table = Table(x, rpm * pi / 30.0)
    return replace(
        FOUR,
        start=None,
        torque=(),
        motion=Motion(speed=SpeedFile(file=table)),
        run=Run(until="1 rev"),
    )


COURSES = {
    "smooth": turning(400, noise=0.0),
    "smooth over the angle": turning(400, noise=0.0, kind="angle_table"),
    "six rows a wave": turning(25, noise=0.0),
    "three digits": turning(400, noise=1e-3, waves=0.0),
    "few rows": turning(19, noise=20.0),
    "corners": cornered(),
}


@pytest.mark.parametrize("name", COURSES)
def test_a_course_is_no_scatter(name):
    assert warnings(COURSES[name]) == ()


@pytest.mark.parametrize(
    ("motion", "given"),
    [
        (turning(50, noise=0.0).motion, "pressures and speed"),
        (Motion(speed="3000 rpm"), "pressures"),
    ],
)
def test_the_numerical_error_holds_none_of_what_is_given(motion, given):
    result = simulate(replace(turning(50, noise=0.0), motion=motion))
    said = report("four", result, result.measures())
    assert f"asked for; errors of the given {given} are not in it\n" in said
