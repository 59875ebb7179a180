"""The peers: each solves a machine with everything that can be asymmetric; the absent are named."""

import dataclasses
import importlib.util
import shutil
import sys

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Cylinder,
    Layout,
    Motion,
    Quadratic,
    Run,
    Table,
    TimeTable,
    Viscous,
    load_scene,
)
from crankmbs.work_precision import END, MOTION
from crankmbs.work_precision.contender import Contender, ContenderFailed
from crankmbs.work_precision.reference import reference_of
from crankmbs.work_precision.trace import Trace, differences
from validation.speed import limit
from validation.speed.peers import _guarded, peers_of

pytestmark = pytest.mark.slow

FIRED = load_scene("propeller")
LOPSIDED = dataclasses.replace(
    FIRED,
    crank=dataclasses.replace(FIRED.crank, center_of_mass=-0.02),
    piston=dataclasses.replace(FIRED.piston, offset=0.006),
    gravity=dataclasses.replace(FIRED.gravity, acceleration=300.0, angle=0.7),
    start=dataclasses.replace(FIRED.start, angle=0.4),
    torque=(Constant(torque=12.0), Quadratic(coefficient=3e-4)),
    run=Run(until="50 ms", every="5 deg"),
)
REACTIONS = ("main bearing", "crank pin", "piston pin", "side force")

# contender -> what it needs, a setting, and how far its end and its reactions may be off there
SERVED = {
    "C, Gauss over theta": ("", 6.0, 1e-12, None),
    "C, DOP853 in time": ("", 512.0, 1e-10, None),
    "SciPy LSODA": ("", 1e-12, 1e-10, None),
    "SciPy DOP853": ("", 1e-12, 1e-9, None),
    "SymPy mechanics, LSODA": ("sympy", 1e-12, 1e-10, None),
    "MuJoCo, RK4": ("mujoco", 2000.0, 5e-8, 3e-4),
    "exudyn script, defaults": ("", 2000.0, 4e-7, 6e-5),
    "exudyn script, best settings": ("", 2000.0, 4e-7, 2e-5),
}


@pytest.fixture(scope="module")
def lopsided():
    reference = reference_of(LOPSIDED)
    contenders, notes = peers_of(LOPSIDED, reference)
    return reference, {contender.name: contender for contender in contenders}, notes


@pytest.mark.parametrize("name", SERVED)
def test_a_peer_solves_the_same_machine_by_its_own_equations(lopsided, name):
    needs, setting, end, reaction = SERVED[name]
    if needs and importlib.util.find_spec(needs) is None:
        pytest.skip(f"{needs} is not installed")
    if name.startswith("C,") and shutil.which("cc") is None:
        pytest.skip("no C compiler")
    reference, peers, _ = lopsided
    answer = peers[name].run(setting)
    found = differences(answer.trace, peers[name].reference, reference.start)
    assert found[END] <= end
    assert (reaction is None) == (tuple(found) == (END,))
    if reaction is not None:
        assert max(found[force] for force in REACTIONS) <= reaction
        assert found[MOTION] <= 10.0 * end
    assert answer.stated is None
    assert answer.evaluations > 0
    assert peers[name].is_peer


def test_where_everything_is_installed_nobody_is_missing(lopsided):
    _, peers, notes = lopsided
    if not all(map(importlib.util.find_spec, ("sympy", "mujoco"))) or shutil.which("cc") is None:
        pytest.skip("sympy, mujoco or a C compiler is missing")
    assert list(peers) == list(SERVED)
    assert notes == []


@pytest.mark.parametrize(
    ("module", "name"),
    [("sympy", "SymPy mechanics"), ("mujoco", "MuJoCo")],
)
def test_a_peer_that_is_not_installed_is_named_with_the_way_to_it(
    lopsided, monkeypatch, module, name
):
    monkeypatch.setitem(sys.modules, module, None)
    _, notes = peers_of(LOPSIDED, lopsided[0])
    assert f'{name}: {module} is not installed; pip install ".[bench]"' in notes


def test_without_a_compiler_the_limit_is_named(lopsided, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    limit.library.cache_clear()
    try:
        contenders, notes = peers_of(LOPSIDED, lopsided[0])
    finally:
        limit.library.cache_clear()
    why = "no C compiler found; set CC, or install cc, gcc or clang"
    assert f"C, Gauss over theta: {why}" in notes
    assert f"C, DOP853 in time: {why}" in notes
    assert "exudyn script, defaults" in [contender.name for contender in contenders]


def test_a_compiler_that_fails_is_named(lopsided, monkeypatch):
    monkeypatch.setenv("CC", shutil.which("false") or "false")
    limit.library.cache_clear()
    try:
        _, notes = peers_of(LOPSIDED, lopsided[0])
    finally:
        limit.library.cache_clear()
    assert [note for note in notes if "cannot compile" in note and note.startswith("C, Gauss")]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"start": None, "torque": (), "motion": Motion(speed="900 rpm")}, "a prescribed speed"),
        ({"torque": (TimeTable(file=Table([0.0, 1.0], [1.0, 1.0])),)}, "not a time table"),
    ],
)
def test_a_scene_that_the_peers_cannot_serve_is_said_once(changes, why):
    scene = dataclasses.replace(LOPSIDED, **changes)
    contenders, notes = peers_of(scene, reference_of(scene))
    assert contenders == []
    assert len(notes) == 1
    assert notes[0].startswith("no peers: ")
    assert why in notes[0]


@pytest.mark.parametrize(
    "layout",
    [
        Layout(firing_order=(1, 3, 2)),
        Layout(cylinders=(Cylinder(bank="30 deg"), Cylinder(phase="300 deg", bank="-30 deg"))),
    ],
)
def test_of_several_cylinders_and_of_a_bank_the_exudyn_script_serves_a_machine(layout):
    scene = dataclasses.replace(LOPSIDED, layout=layout)
    reference = reference_of(scene)
    contenders, notes = peers_of(scene, reference)
    assert [one.name for one in contenders] == list(SERVED)[-2:]
    assert "SciPy LSODA and DOP853: written for one cylinder of phase 0 and bank 0" in notes
    found = differences(contenders[-1].run(2000.0).trace, contenders[-1].reference, reference.start)
    assert found[MOTION] <= 4e-6
    assert max(found[force] for force in REACTIONS) <= 2e-5


def test_a_load_that_one_peer_does_not_know_is_its_own_sentence():
    scene = dataclasses.replace(LOPSIDED, torque=(Viscous(coefficient=0.05),))
    reference = reference_of(scene)
    contenders, notes = peers_of(scene, reference)
    (note,) = (note for note in notes if note.startswith("C, Gauss over theta: "))
    assert note.endswith("written for a crank that turns forwards, without a viscous torque")
    (other,) = (one for one in contenders if one.name == "C, DOP853 in time")
    found = differences(other.run(512.0).trace, other.reference, reference.start)
    assert found[END] < 1e-10


def test_whatever_a_peer_raises_becomes_one_line():
    def run(setting):
        raise ZeroDivisionError("first line\nsecond line")

    trace = Trace(*[np.zeros(1)] * 3)
    contender = _guarded(Contender("peer", "rtol", (1.0,), run, trace))
    with pytest.raises(ContenderFailed, match=r"^failed: first line$"):
        contender.run(1.0)
