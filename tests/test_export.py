"""What other programs are given: a scene that reads back, arrays with their units and errors, and a
script for exudyn that quotes the multibody model."""

import ast
import inspect
import math
import re
import runpy
import subprocess
import sys
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from command_line import crankmbs_, names, refused
from scipy.io import loadmat

import crankmbs
from crankmbs import Constant, Force, InputError, Load, OutputError, export, load_scene, simulate
from crankmbs.export.exudyn import exudyn_script
from crankmbs.motion.multibody.mechanism import build, mechanism_of
from crankmbs.scene.forces import ConstantForce, Damper, ForceAngleTable, Spring, TravelTable
from crankmbs.scene.read import parse_scene
from crankmbs.scene.tables import Table
from crankmbs.scene.template import template

TURN = 2.0 * math.pi
TORQUE_DRIVEN = load_scene("torque_driven").with_(run__until="0.3 s")
SCENES = {
    "torque_driven": TORQUE_DRIVEN,
    "propeller": load_scene("propeller").with_(run__until="0.7 cycles"),
    "coasting": load_scene("coasting").with_(run__until="0.03 s"),
    "yi_diesel": load_scene("yi_diesel").with_(run__until="0.5 rev"),
    "steam_engine": load_scene("steam_engine").with_(run__until="0.5 rev"),
    "four cylinders": load_scene("yi_diesel_free").with_(run__until="0.2 rev"),
    "forces": load_scene("torque_driven").with_(
        run__until="0.1 s",
        layout=crankmbs.Layout(
            cylinders=(
                crankmbs.Cylinder(),
                crankmbs.Cylinder(bank="60 deg", phase="100 deg", radius="30 mm"),
            )
        ),
        force=(
            Spring(stiffness=2e4, relaxed_at=0.02, cylinder=1),
            Damper(coefficient=40.0, cylinder=2),
            ConstantForce(force=-300.0),
            ForceAngleTable(
                file=Table((0.0, 2.0, 4.0, TURN), (0.0, 500.0, -200.0, 0.0)), interpolation="cubic"
            ),
        ),
    ),
    "template": parse_scene(template("mine"), Path("mine.toml")).with_(run__until="2 cycles"),
    "v_twin": load_scene("v_twin").with_(run__until="1 cycle"),
    "grega_lecture": load_scene("grega_lecture").with_(run__until="1 rev"),
    "jumps at dead centres": load_scene("validation/scenes/hard_pressure_jumps.toml"),
    "jumps in mid-stroke": load_scene("torque_driven").with_(
        run__until="0.2 s",
        start__speed=-10.0,
        force=(
            ForceAngleTable(
                file=Table((0.0, 1.2, 1.2, 4.0, 4.0, TURN), (0.0, 0.0, 200.0, 200.0, 0.0, 0.0))
            ),
        ),
    ),
    "banks": load_scene("torque_driven").with_(
        run__until="0.1 s",
        layout=crankmbs.Layout(
            cylinders=(
                crankmbs.Cylinder(bank="-30 deg"),
                crankmbs.Cylinder(bank="30 deg", phase="200 deg"),
            )
        ),
    ),
}


@cache
def text_of(name):
    """The script of one of the scenes."""
    return exudyn_script(SCENES[name], "mine")


def made(scene):
    """The names of a script, which has not run."""
    names = {"__name__": "script"}
    exec(exudyn_script(scene, "mine"), names)
    return names


def script(scene, folder):
    (file,) = export(scene, "exudyn", folder / "mine.py")
    return runpy.run_path(str(file))["run"]()


def from_jumps(scene, theta):
    """How far from the nearest jump of a force crank angles [rad] are."""
    gas = [each.pressure for each in (scene.gas,) if each and isinstance(each.pressure, Table)]
    forces = [force.file for force in scene.force if isinstance(force, ForceAngleTable)]
    jumps = [x for one in (*gas, *forces) for x, after in pairwise(one.x) if x == after]
    if scene.gas and scene.gas.indicator:
        jumps += list(np.arange(4) * math.pi)  # no offset: the dead centres
    angles = [jump - each.phase for jump in jumps for each in scene.cylinders]
    half = TURN if scene.gas else 0.5 * TURN
    away = (np.subtract.outer(theta, angles) + half) % (2.0 * half) - half
    return np.abs(away).min(axis=1, initial=math.inf)


def of_cylinder(rows, heading):
    """The same column of a run's rows."""
    name, _, number = heading.split(" [")[0].partition(" ")
    values = rows[name]
    return values[:, int(number) - 1] if number else values


def stated_in(text):
    """The errors in the head of a script, by the first words of what they are of."""
    rows = re.findall(r"^#     (\S+) +(.*) \[", text, re.MULTILINE)
    return {words.replace(", ", " ").replace(" ", "_"): float(error) for error, words in rows}


@pytest.mark.parametrize("name", SCENES)
def test_the_script_gives_the_motion_within_the_error_that_it_states(name, tmp_path):
    (file,) = export(SCENES[name], "exudyn", tmp_path / "mine.py")
    made = runpy.run_path(str(file))
    found, stated = made["run"](), stated_in(file.read_text(encoding="utf-8"))
    other = "minimal" if SCENES[name].start else "auto"  # not that which the head is held against
    result = simulate(SCENES[name].with_(run__every=f"{made['STEP']!r} s"), formulation=other)
    rows = {name: one.values[1:] for name, one in result.data.variables.items()}
    count = (
        min(len(rows["time"]), len(found["time [s]"])) - 1
    )  # the last lies at the end of the run
    clear = from_jumps(SCENES[name], rows["crank_angle"][:count]) > stated.get("crank_angle", 0.0)
    assert len(stated) >= 5
    errors = dict.fromkeys(stated, 0.0)
    for heading, values in found.items():
        true = of_cylinder(rows, heading)
        missed = np.max(np.abs(values[:count] - true[:count])[clear])
        assert missed <= 1e-3 * np.max(np.abs(true)) + 1e-2, heading
        of = heading.split("[")[0].split(" ")[0]
        if of in errors:
            errors[of] = max(errors[of], missed)
    for of, error in errors.items():
        assert 0.5 * stated[of] < error < stated[of], of


def test_the_head_says_that_steps_pass_over_jumps():
    said = "Forces jump at some crank angles, and the steps pass over the jumps"
    saying = {name for name in SCENES if said in text_of(name)}
    assert saying == {"template", "v_twin", "jumps at dead centres", "jumps in mid-stroke"}


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_start_on_a_jump_has_the_forces_of_the_side_to_which_the_crank_moves(sense):
    at = {"start__angle": 1.2, "start__speed": 10.0 * sense}  # where the force of the table sets in
    scene = SCENES["jumps in mid-stroke"].with_(**at)
    beside = simulate(scene.with_(start__angle=1.2 + 1e-6 * sense))
    began = made(scene)["START_ACCELERATION"][2]
    assert began == pytest.approx(beside.sampled("crank_acceleration")[0], abs=1.0)


@pytest.mark.parametrize("name", SCENES)
def test_a_script_has_no_name_that_it_does_not_use(name):
    tree = ast.parse(text_of(name))
    stored = [
        target.id
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    ]
    loaded = {
        each.id
        for each in ast.walk(tree)
        if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load)
    }
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    imported = {
        (alias.asname or alias.name).split(".")[0]
        for node in tree.body
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
    }
    assert {*stored, *functions, *imported} - loaded == {"annotations"}
    assert ("PRESCRIBED_SPEED" in loaded) == (SCENES[name].motion is not None)
    assert ("TORQUE_CONSTANT" in loaded) == bool(SCENES[name].torque)


def test_the_script_quotes_the_model():
    text = text_of("torque_driven")
    assert inspect.getsource(build) in text
    assert repr(mechanism_of(TORQUE_DRIVEN).hinges[1]) in text


def test_the_script_says_its_error_and_needs_no_crankmbs(tmp_path):
    (file,) = export(TORQUE_DRIVEN, "exudyn", tmp_path / "mine.py")
    text = file.read_text(encoding="utf-8")
    assert 1e-6 < stated_in(text)["crank_angle"] < 1e-4
    code = (
        "import sys, runpy; sys.modules.update(crankmbs=None, scipy=None);"
        f"runpy.run_path({str(file)!r}, run_name='__main__')"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    assert run.stdout.endswith("wrote mine_exudyn.csv\n")
    rows = np.loadtxt(tmp_path / "mine_exudyn.csv", delimiter=",", skiprows=1)
    assert rows[-1, 0] == pytest.approx(0.3)
    with (tmp_path / "mine_exudyn.csv").open() as lines:
        assert next(lines).startswith("time [s],crank_angle [rad],crank_speed [rad/s],")


def test_a_hostile_title_stays_a_comment(tmp_path):
    titled = TORQUE_DRIVEN.with_(title='x\n"""\nraise SystemExit(1)\r\u2028import os \N{SNOWMAN}')
    assert len(script(titled, tmp_path)["time [s]"]) > 10


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (load_scene("misfire"), "cannot express [fuel], whose shares are decided on the way"),
        (load_scene("friction"), "cannot express [friction], which jumps where a piston turns"),
        (
            load_scene("turning_moment"),
            'torque[1], kind = "angle_table"; give constant, viscous or',
        ),
        (
            TORQUE_DRIVEN.with_(torque=(Load(lambda t, theta, omega: 1.0),)),
            "torque[1], a function of Python; give constant",
        ),
        (
            TORQUE_DRIVEN.with_(torque=(Constant(torque=1.0, after=0.1),)),
            "the window of torque[1]; leave out when it sets in",
        ),
        (load_scene("yi_diesel_free").with_(run__until="settled"), 'until = "settled", which is'),
        (
            load_scene("yi_diesel").with_(
                motion__speed=crankmbs.Oscillation(mean=300.0, amplitude=3.0, order=2.0)
            ),
            "a prescribed speed that changes; give one constant speed",
        ),
        (
            TORQUE_DRIVEN.with_(
                force=(TravelTable(file=Table((0.0, 0.05, 0.2), (0.0, 0.0, 5.0))),)
            ),
            'force[1], kind = "travel_table"; give springs, dampers, constants or a table over',
        ),
        (
            TORQUE_DRIVEN.with_(force=(Force(lambda t, phi, s, v: 1.0),)),
            "force[1], a function of Python; give springs",
        ),
        (
            TORQUE_DRIVEN.with_(force=(ConstantForce(force=1.0, until=0.1),)),
            "the window of force[1]; leave out when it sets in",
        ),
        (
            TORQUE_DRIVEN.with_(torque=(), start__angle=0.0),
            "at rest at 0 degrees: no torque moves the crank from here; give a run",
        ),
    ],
)
def test_what_a_script_cannot_express_is_refused(scene, said, tmp_path):
    with pytest.raises(InputError) as caught:
        export(scene, "exudyn", tmp_path / "mine.py")
    assert said in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_mat_file_has_names_units_and_errors(tmp_path):
    result = simulate(load_scene("v_twin").with_(run__until="1 rev"))
    (file,) = export(result, "matlab", tmp_path / "mine.mat")
    found = loadmat(file, simplify_cells=True)
    for name in ("time", "crank_angle", *result.data.data_vars):
        np.testing.assert_array_equal(found[name], result.data[name].values)
        assert found["units"][name] == result.data[name].attrs["units"]
        assert found["error_estimate"][name] == result.data[name].attrs["error_estimate"]
        assert found["long_name"][name] == result.data[name].attrs["long_name"]
    assert found["about"]["status"] == 0


def test_toml_is_the_same_scene_and_overwrites_nothing(tmp_path):
    scene = load_scene("yi_diesel_free").with_(crank__inertia=0.2)
    first, *tables = export(scene, "toml", tmp_path / "mine.toml")
    assert tables
    again = load_scene(first)
    assert again.crank == scene.crank
    np.testing.assert_array_equal(again.gas.pressure.y, scene.gas.pressure.y)
    with pytest.raises(OutputError, match=r"mine\.toml: exists already and is not overwritten"):
        export(scene, "toml", first)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((TORQUE_DRIVEN, "matlap", "x.mat"), 'or "exudyn" (a script); "matlap" came; did you mean'),
        ((TORQUE_DRIVEN, "matlab", "x.py"), 'a file for "matlab" ends in .mat; .py came'),
        ((TORQUE_DRIVEN, "toml", "x"), "ends in .toml; no ending came"),
        (("propeller", "toml", "x.toml"), 'takes a Scene or a Result; "propeller" came'),
    ],
)
def test_what_cannot_be_written_is_refused(arguments, said):
    with pytest.raises(InputError) as caught:
        export(*arguments)
    assert said in str(caught.value)


def test_the_command_writes_what_it_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for to, file in (("toml", "torque_driven.toml"), ("matlab", "x.mat"), ("exudyn", "x.py")):
        out = () if to == "toml" else ("-o", file)
        said = crankmbs_("export", "torque_driven", "--to", to, *out)
        assert said.exit_code == 0
        assert said.stdout == f"wrote {file}\n"
    assert names(".") == {"torque_driven.toml", "x.mat", "x.py"}
    assert "exists already" in refused("export", "torque_driven.toml", "--to", "toml")
    assert "--to: must be" in refused("export", "torque_driven", "--to", "fmu")
