"""One line changes one number of a scene; what cannot be is refused in the caller's own names."""

import dataclasses
import math
import re

import numpy as np
import pytest

from crankmbs import Gravity, InputError, Motion, Ramp, Rod, load_scene
from crankmbs.scene.change import changed

SCENE = load_scene("yi_diesel_free")
TWIN = load_scene("v_twin")
RAMP = dataclasses.replace(
    SCENE, start=None, torque=(), motion=Motion(speed=Ramp(start="800 rpm", to=300.0, over=1.0))
)


def test_one_number_changes_and_nothing_else():
    scene = SCENE.with_(rod__length="160 mm")
    assert scene == dataclasses.replace(SCENE, rod=dataclasses.replace(SCENE.rod, length=0.16))
    assert SCENE.rod.length != 0.16


@pytest.mark.parametrize(
    ("base", "changes", "read", "value"),
    [
        (SCENE, {"crank__inertia": 0.3}, lambda s: s.crank.inertia, 0.3),
        (SCENE, {"start__speed": "60 rpm"}, lambda s: s.start.speed, 2.0 * math.pi),
        (SCENE, {"torque__1__coefficient": 2e-3}, lambda s: s.torque[0].coefficient, 2e-3),
        (
            TWIN,
            {"layout__cylinders__2__phase": "90 deg"},
            lambda s: s.cylinders[1].phase,
            math.pi / 2,
        ),
        (
            SCENE,
            {"layout__firing_order": [1, 2, 4, 3]},
            lambda s: s.layout.firing_order,
            (1, 2, 4, 3),
        ),
        (SCENE, {"run__until": "0.5 s"}, lambda s: s.end, (0.5, True)),
        (SCENE, {"gravity": Gravity(acceleration=1.0)}, lambda s: s.gravity.acceleration, 1.0),
        (SCENE, {"title": "mine"}, lambda s: s.title, "mine"),
        (RAMP, {"motion__speed__over": "3 s"}, lambda s: s.motion.speed.over, 3.0),
        (RAMP, {"motion__speed__from": 2.0}, lambda s: s.motion.speed.start, 2.0),
        (RAMP, {"motion__speed__start": 2.0}, lambda s: s.motion.speed.start, 2.0),
    ],
)
def test_any_value_is_named_by_where_it_stands(base, changes, read, value):
    assert read(base.with_(**changes)) == pytest.approx(value)
    dotted = {
        re.sub(r"__(\d+)", r"[\1]", name).replace("__", "."): v for name, v in changes.items()
    }
    assert changed(base, dotted) == base.with_(**changes)


def test_values_change_at_once_so_that_none_must_fit_the_old_ones():
    longer = SCENE.with_(crank__radius="300 mm", rod__length="1 m")
    assert (longer.crank.radius, longer.rod.length) == (0.3, 1.0)
    driven = SCENE.with_(start=None, torque=(), motion=Motion(speed="3200 rpm"))
    assert driven.start is None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"rod__length": "-1 mm"}, 'rod__length: must be above 0; "-1 mm" came'),
        ({"rod.length": "-1 mm"}, 'rod.length: must be above 0; "-1 mm" came'),
        ({"rod__lenght": 1.0}, 'rod__lenght: a Rod has no "lenght"; did you mean "length"?'),
        ({"zzz__angle": 1.0}, 'zzz__angle: a scene has no "zzz"; known are crank, rod, '),
        ({"start__speed": "3 mm"}, 'start__speed: "3 mm" is no angular speed here: use rpm, '),
        ({"rod__length": "10 mm"}, "rod__length: rod.length must be at least crank.radius + "),
        ({"torque__0__coefficient": 1.0}, '"0" is none of the numbers 1 to 1 of a list; its first'),
        ({"torque__coefficient": 1.0}, '"coefficient" is none of the numbers 1 to 1 of a list'),
        (
            {"friction__viscous": 1.0},
            "in this scene friction is not there; give friction as a whole",
        ),
        (
            {"layout__cylinders__1__bank": 1.0},
            "in this scene layout__cylinders is not there; give layout__cylinders as a whole",
        ),
        (
            {"crank__radius__mm": 46.0},
            "in this scene crank__radius is one value, 0.046; give crank__radius as a whole",
        ),
        ({"rod": Rod(length=1.0), "rod__length": 2.0}, "rod and rod__length change the same part"),
        ({"rod__length": 2.0, "rod": Rod(length=1.0)}, "rod__length and rod change the same part"),
        ({"rod length": 1.0}, '"rod length" names no value of a scene; write it as rod__length'),
        (
            {"rod__length": [0.15, 0.16]},
            "[0.15, 0.16] came; several values take a scene for each",
        ),
        (
            {"rod__length": np.linspace(0.1, 0.2, 3)},
            "an array of shape (3,) came; several values take a scene for each",
        ),
    ],
)
def test_what_cannot_be_is_refused_by_the_name_given(changes, said):
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        SCENE.with_(**changes)
    assert "\n" not in str(caught.value)


def test_a_value_without_a_name_is_refused():
    with pytest.raises(InputError, match=r'such as with_\(rod__length="160 mm"\); "160 mm" came'):
        SCENE.with_("160 mm")


def test_a_refusal_names_a_key_once():
    with pytest.raises(InputError, match=r"^run__until: beyond"):
        load_scene("coasting").with_(run__until="1e12 s")
    with pytest.raises(InputError, match=r"^piston__area: piston\.bore: with gas"):
        load_scene("yi_diesel").with_(piston__area=None)
