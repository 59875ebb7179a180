"""One class is one load: whatever reads, solves, draws or writes a scene asks it alone."""

from dataclasses import replace
from functools import cached_property
from typing import Literal

import numpy as np
import pytest

from crankmbs import Result, SceneError, simulate
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.read import parse_scene
from crankmbs.scene.schema import Float, part
from crankmbs.scene.torque import Parts, Torque
from crankmbs.scene.windowed import registered
from crankmbs.scene.write import scene_files

TOY = """
[crank]
radius = "40 mm"
inertia = "0.12 kg m^2"
[rod]
length = "140 mm"
[piston]
mass = "0.42 kg"
[start]
angle = "0 deg"
speed = "300 rpm"
[[torque]]
kind = "spring_clutch"
slip = 20
most = 9
[run]
until = "2 rev"
every = "10 deg"
"""


@pytest.fixture
def clutch(monkeypatch):
    """A load of no kind that there is: it pulls the crank towards a speed, up to a torque."""
    monkeypatch.setattr(Torque, "kinds", dict(Torque.kinds))

    @registered
    @part
    class SpringClutch(Torque):
        """Towards the speed ``slip`` [rad/s], by at most ``most`` [N m]."""

        kind: Literal["spring_clutch"] = "spring_clutch"
        slip: Float
        most: Float

        @cached_property
        def parts(self):
            knots = (self.slip - 1.0, self.slip + 1.0)
            between = (self.most * self.slip, -self.most, 0.0)
            pieces = ((self.most, 0.0, 0.0), between, (-self.most, 0.0, 0.0))
            return Parts(over_speed=Piecewise(knots, pieces))

        @property
        def words(self):
            return f"towards {self.slip:g} rad/s"

        def _scaled(self, share, faster):
            return {"most": self.most * share, "slip": self.slip * faster}

    return SpringClutch


def toy(tmp_path):
    return parse_scene(TOY, tmp_path / "toy.toml")


def test_a_load_is_one_class(clutch, tmp_path):
    scene = toy(tmp_path)
    runs = [simulate(scene, formulation=name) for name in ("crank_angle", "minimal")]
    for run in runs:
        torque, omega = run.data["external_torque"], run.data["crank_speed"]
        np.testing.assert_allclose(torque, -9.0 * np.clip(omega - 20.0, -1.0, 1.0), atol=1e-6)
    speeds = [run.data["crank_speed"].values for run in runs]
    assert np.min(speeds[0]) < 20.0
    np.testing.assert_allclose(*speeds, rtol=1e-7)


def test_multibody_takes_it_alike(clutch, tmp_path):
    scene = toy(tmp_path)
    answer, check = simulate(scene), simulate(scene, formulation="multibody")
    allowed = answer.data["crank_speed"].error_estimate + check.data["crank_speed"].error_estimate
    apart = np.abs(answer.data["crank_speed"].values - check.data["crank_speed"].values)
    assert np.max(apart) <= allowed < 1e-3


@pytest.mark.slow
def test_it_is_written_and_saved_with_its_class(clutch, tmp_path):
    scene = toy(tmp_path)
    text = scene_files(scene, "again")["again.toml"]
    assert parse_scene(text, tmp_path / "again.toml") == scene
    simulate(replace(scene, run=replace(scene.run, until="10 deg"))).save(tmp_path / "out")
    assert Result.load(tmp_path / "out").scene.torque == scene.torque


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("", r"torque\[1\].most: this key is missing; it has no default"),
        ("most = true", r"torque\[1\].most: must be a number; true came"),
        ("mots = 9", r'torque\[1\].mots: unknown key; did you mean "most"'),
    ],
)
def test_its_errors_name_its_place(clutch, tmp_path, written, said):
    with pytest.raises(SceneError, match=said):
        parse_scene(TOY.replace("most = 9", written), tmp_path / "toy.toml")


def test_an_unregistered_kind_is_refused(tmp_path):
    with pytest.raises(SceneError, match=r'kind must be one of constant, .*"spring_clutch" came'):
        toy(tmp_path)
