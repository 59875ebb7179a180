"""Scene files: what is read, and files that are no scene."""

import copy
import math
import tomllib

import pytest
from scene_texts import DRIVEN, FREE, GAS, INDICATED, edited

from crankmbs.errors import SceneError
from crankmbs.scene.read import load_scene, parse_scene, scene_path
from crankmbs.scene.run import Extent
from crankmbs.scene.shipped import shipped_scenes


def test_a_scene_is_read_in_si_units(read):
    scene = read(FREE)
    assert scene.title == "one cylinder"
    assert scene.crank.radius == 0.046
    assert scene.rod.length == 0.15
    assert scene.start.speed == pytest.approx(3200.0 * math.pi / 30.0)
    assert scene.torque[0].coefficient == 9.5e-5
    assert scene.gas.pressure.y == (1e5, 2e5, 3e5)
    assert scene.run.until == Extent(value=0.75, unit="s")
    assert scene.run.every == Extent(value=math.pi / 180.0, unit="rad")
    assert [cylinder.phase for cylinder in scene.cylinders] == [0.0]


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ('"46 mm"', "46e-3", '"46 mm"'),
        ('"1.14 kg"', "1.14", '"1.14 kg"'),
        ('"150 mm"', "0.15", '"150 mm"'),
        ('"0.75 s"', '"750 ms"', '"0.75 s"'),
        ('"57 cm^2"', "57e-4", '"57 cm^2"'),
    ],
)
def test_bare_numbers_are_si(read, old, new, same):
    assert read(edited(FREE, old, new)) == read(edited(FREE, old, same))


@pytest.mark.parametrize(
    ("speed", "kind"),
    [
        ('"3200 rpm"', "float"),
        ('{ mean = "3200 rpm", amplitude = "40 rpm", order = 2 }', "Oscillation"),
        ('{ from = "800 rpm", to = "3200 rpm", over = "2 s" }', "Ramp"),
    ],
)
def test_speeds(read, speed, kind):
    motion = read(edited(DRIVEN, '"3200 rpm"', speed)).motion
    assert type(motion.speed).__name__ == kind


def test_speeds_of_tables_are_in_revolutions_per_minute(read, tmp_path):
    (tmp_path / "speed.csv").write_text("time_s,speed_rpm\n0,300\n1,600\n2,900\n")
    (tmp_path / "load.csv").write_text("speed_rpm,torque_Nm\n0,-1\n3000,-5\n")
    driven = edited(DRIVEN, '"3200 rpm"', '{ file = "speed.csv" }')
    assert read(driven).motion.speed.file.y == pytest.approx([31.4159265, 62.831853, 94.2477796])
    old = 'kind = "quadratic"\ncoefficient = "9.5e-5 N m s^2"'
    (load,) = read(edited(FREE, old, 'kind = "speed_table"\nfile = "load.csv"')).torque
    assert load.file.x == pytest.approx([0.0, 314.159265])


def test_a_byte_order_mark_and_crlf_are_read(tmp_path):
    (tmp_path / "gas.csv").write_text(GAS)
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + FREE.replace("\n", "\r\n").encode())
    assert load_scene(path) == parse_scene(FREE, path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\x00\xff\xfe", ": no UTF-8 text (byte 1 is wrong); a scene is a TOML text file"),
        (FREE.encode("utf-16"), ": no UTF-8 text (byte 0 is wrong); a scene is a TOML text file"),
        (b"", None),
        (b"\x00", None),
    ],
)
def test_a_file_that_is_no_scene(tmp_path, content, message):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    assert message is None or said == f"{path}{message}"


def test_a_folder_is_no_scene(tmp_path):
    with pytest.raises(SceneError, match=r": a folder came; give the scene file in it$"):
        load_scene(tmp_path)


def test_a_name_that_nobody_knows():
    with pytest.raises(SceneError) as caught:
        load_scene("nothing-like-it")
    assert str(caught.value) == (
        "nothing-like-it: no such scene file and no shipped scene; shipped are "
        + ", ".join(shipped_scenes())
    )


@pytest.mark.parametrize("name", [3, None])
def test_what_is_no_name(name):
    with pytest.raises(SceneError, match=r"a scene is named by its file or as shipped, .* came$"):
        load_scene(name)


@pytest.mark.parametrize("name", ["propellor", "models/propellor.toml"])
def test_a_misspelt_name(name):
    with pytest.raises(SceneError, match=r'no shipped scene; did you mean "propeller"\?$'):
        load_scene(name)


def test_a_shipped_name_wins_over_a_folder_of_that_name(tmp_path, monkeypatch):
    (tmp_path / "propeller").mkdir()
    monkeypatch.chdir(tmp_path)
    assert scene_path("propeller") == shipped_scenes()["propeller"]


def test_paths_are_relative_to_the_scene_file(tmp_path, monkeypatch):
    folder = tmp_path / "sub"
    folder.mkdir()
    (folder / "gas.csv").write_text(GAS)
    (folder / "scene.toml").write_text(FREE)
    monkeypatch.chdir(tmp_path)
    assert load_scene("sub/scene.toml").gas.pressure.source == "sub/gas.csv"


NASTY = [
    "",
    "x",
    "1",
    "1 m",
    "-1 s",
    0,
    -1,
    1.5,
    math.nan,
    -math.inf,
    True,
    [],
    {},
    [[]],
    [{}],
    10**400,
]


def places(tree, path=()):
    """Every (path, value) below a table."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


@pytest.mark.parametrize("text", [FREE, DRIVEN, INDICATED], ids=["free", "driven", "indicator"])
def test_anything_anywhere_is_a_scene_or_one_sentence(read, text, monkeypatch):
    """Every value in turn becomes something else, or goes; nothing but a SceneError comes out."""
    base = tomllib.loads(text)
    refusals = []
    for path in places(base):
        for nasty in [*NASTY, None]:
            tree = copy.deepcopy(base)
            holder = tree
            for key in path[:-1]:
                holder = holder[key]
            if nasty is None:
                del holder[path[-1]]
            else:
                holder[path[-1]] = nasty
            monkeypatch.setattr(tomllib, "loads", lambda _, tree=tree: tree)
            try:
                read(text)
            except SceneError as error:
                refusals.append(str(error))
    assert len(refusals) > 200
    assert not [said for said in refusals if "\n" in said or len(said) > 300]
