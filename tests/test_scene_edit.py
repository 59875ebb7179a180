"""A scene file copied with values of its crank set: everything else stays as it is written."""

from pathlib import Path

import pytest

from crankmbs import load_scene
from crankmbs.errors import InputError
from crankmbs.scene.edit import edited_files
from crankmbs.scene.shipped import shipped_scenes

SHIPPED = shipped_scenes()
PRESSURE = "crank_angle_deg,pressure_bar\n0,1\n360,9\n720,1\n"


@pytest.mark.parametrize("name", SHIPPED)
def test_a_copy_elsewhere_has_the_same_text_but_the_names_of_its_tables(name, tmp_path):
    source = SHIPPED[name].read_text(encoding="utf-8")
    files = edited_files(SHIPPED[name], tmp_path / "mine.toml", {})
    text = files["mine.toml"].decode()
    changed = [
        (old, new)
        for old, new in zip(source.splitlines(), text.splitlines(), strict=True)
        if old != new
    ]
    assert all(".csv" in old and "mine_" in new for old, new in changed)
    for file, content in files.items():
        (tmp_path / file).write_bytes(content)
    copy = load_scene(tmp_path / "mine.toml")
    of = load_scene(name)
    assert (copy.crank, copy.rod, copy.piston, copy.run) == (of.crank, of.rod, of.piston, of.run)


def test_a_value_stands_in_place_with_its_unit_and_reason(tmp_path):
    path, target = SHIPPED["turning_moment"], tmp_path / "mine.toml"
    values = {"crank__inertia": "0.3 kg m^2", "crank__mass": "2 kg"}
    lines = edited_files(path, target, values, "for 1 %")["mine.toml"].decode().splitlines()
    source = path.read_text(encoding="utf-8").splitlines()
    assert 'inertia = "0.3 kg m^2"    # for 1 %' in lines
    assert 'mass = "2 kg"    # for 1 %' in lines
    assert 'torque = "-67.5 N m"             # the machine that is driven takes the mean' in lines
    assert len(lines) == len(source) + 1


def test_in_the_same_folder_tables_are_shared(tmp_path):
    scene = tmp_path / "a.toml"
    (tmp_path / "p.csv").write_text(PRESSURE)
    text = (
        SHIPPED["yi_diesel"].read_text(encoding="utf-8").replace("pressure/yi_diesel.csv", "p.csv")
    )
    scene.write_text(text)
    assert list(edited_files(scene, tmp_path / "b.toml", {"crank__inertia": "1 kg m^2"})) == [
        "b.toml"
    ]


def test_a_crank_that_stands_on_one_line_is_written_anew(tmp_path):
    scene = tmp_path / "a.toml"
    source = SHIPPED["coasting"].read_text(encoding="utf-8")
    before, _, rest = source.partition("[crank]\n")
    _, _, after = rest.partition("\n[")
    crank = 'crank = { radius = "46 mm", inertia = "0.1 kg m^2" }\n'
    scene.write_text(f"{before}{crank}\n[{after}")
    files = edited_files(scene, Path(tmp_path / "b.toml"), {"crank__inertia": "0.2 kg m^2"})
    (tmp_path / "b.toml").write_bytes(files["b.toml"])
    assert load_scene(tmp_path / "b.toml").crank.inertia == 0.2


START = {"angle": "0 deg", "speed": "3200 rpm"}


def test_a_prescribed_speed_is_set_free_in_place(tmp_path):
    path, crank = SHIPPED["grega_lecture"], {"crank__inertia": "0.2 kg m^2"}
    target = tmp_path / "b.toml"
    files = edited_files(path, target, crank, "", start=START, torque="-90 N m")
    text = files["b.toml"].decode()
    (tmp_path / "b.toml").write_text(text)
    free, prescribed = load_scene(tmp_path / "b.toml"), load_scene(path)
    assert (free.motion, len(free.torque), free.torque[0].torque) == (None, 1, -90.0)
    assert (free.gas, free.run, free.rod) == (prescribed.gas, prescribed.run, prescribed.rod)
    source = path.read_text(encoding="utf-8").splitlines()
    gone = [line for line in source if line not in text.splitlines()]
    assert all(line.startswith(("inertia", "[motion]", "speed", "angle")) for line in gone)
    start = text.splitlines().index("[start]")
    assert text.splitlines()[start + 1 : start + 3] == ['angle = "0 deg"', 'speed = "3200 rpm"']


def test_a_speed_on_one_line_is_written_anew(tmp_path):
    scene = tmp_path / "a.toml"
    source = SHIPPED["grega_lecture"].read_text(encoding="utf-8")
    before, _, rest = source.partition("[motion]\n")
    scene.write_text(f'motion = {{ speed = "3000 rpm" }}\n{before}{rest.partition("[")[1]}run]\n')
    scene.write_text(scene.read_text() + 'until = "1 cycle"\n')
    files = edited_files(scene, tmp_path / "b.toml", {}, start=START)
    (tmp_path / "b.toml").write_bytes(files["b.toml"])
    free = load_scene(tmp_path / "b.toml")
    assert (free.motion, free.torque) == (None, ())


def test_values_that_no_crank_has_are_refused(tmp_path):
    with pytest.raises(InputError, match="crank__inertia"):
        edited_files(SHIPPED["coasting"], tmp_path / "b.toml", {"crank__inertia": "-1 kg m^2"})
