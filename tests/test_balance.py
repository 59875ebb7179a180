"""Counterweights: closed forms of textbooks, at constant speed."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from command_line import crankmbs_, refused

from crankmbs import (
    Crank,
    Cylinder,
    Layout,
    Motion,
    Oscillation,
    Piston,
    Rod,
    Run,
    Scene,
    balance,
    load_scene,
    simulate,
)
from crankmbs.errors import InputError
from crankmbs.scene.parts import OwnPiston

SPEED = 200.0
RECIPROCATING = 0.5 + 0.8 * 0.05 / 0.2
ROTATING = 0.8 * 0.15 / 0.2


def engine(layout=None, **crank):
    return Scene(
        crank=Crank(radius=0.05, **crank),
        rod=Rod(length=0.2, mass=0.8, center_of_mass=0.05, inertia=0.004),
        piston=Piston(mass=0.5),
        layout=layout or Layout(cylinders=(Cylinder(),)),
        motion=Motion(speed=SPEED),
        run=Run(until="1 cycle", every="5 deg"),
    )


def left(found, quantity, order):
    """Before and after along x, along y and the longest."""
    rows = [r for r in found.remaining if (r.quantity, r.order) == (quantity, order)]
    assert [row.direction for row in rows] == ["x", "y", "largest"]
    return [row.before.value for row in rows], [row.after.value for row in rows]


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_one_cylinder_moves_its_first_order_across(share):
    """m_A r omega^2 (1 - share) is left along the cylinder and share comes across it."""
    found = balance(engine(), share)
    unit = 0.05 * SPEED**2
    before, after = left(found, "frame force", 1.0)
    both = (RECIPROCATING + ROTATING) * unit
    assert before == pytest.approx([both, ROTATING * unit, both], rel=1e-12)
    expected = [(1.0 - share) * RECIPROCATING * unit, share * RECIPROCATING * unit]
    assert after == pytest.approx([*expected, max(expected)], rel=1e-12, abs=1e-9)
    second = left(found, "frame force", 2.0)
    assert second[1] == pytest.approx(second[0], rel=1e-12, abs=1e-9)
    (weight,) = found.per_throw
    assert weight == pytest.approx(0.05 * (ROTATING + share * RECIPROCATING), rel=1e-14)


def test_a_90_degree_twin_on_one_pin_has_no_first_order_left():
    pair = (
        Cylinder(phase=math.pi / 4, bank=-math.pi / 4),
        Cylinder(phase=-math.pi / 4, bank=math.pi / 4),
    )
    before, after = left(balance(engine(Layout(cylinders=pair)), 0.5), "frame force", 1.0)
    assert min(before) > 1e3
    assert max(after) < 1e-9


def test_the_crank_s_own_mass_is_balanced_beside():
    found = balance(engine(mass=3.0, center_of_mass=-0.01), 1.0)
    plain = balance(engine(), 1.0)
    assert found.of_crank == pytest.approx(-0.03)
    after = left(found, "frame force", 1.0)[1]
    assert after == pytest.approx(left(plain, "frame force", 1.0)[1], abs=1e-9)


def test_rocking_of_three_in_line_and_its_counterweights():
    """Forces cancel; the first order of the moment is sqrt(3) spacing m r omega^2 for each mass."""
    found = balance(engine(Layout(firing_order=(1, 3, 2), spacing=0.1)), 0.5)
    unit = math.sqrt(3.0) * 0.1 * 0.05 * SPEED**2
    before, after = left(found, "rocking moment", 1.0)
    assert before[:2] == pytest.approx(
        [ROTATING * unit, (ROTATING + RECIPROCATING) * unit], rel=1e-11
    )
    assert after[:2] == pytest.approx([0.5 * RECIPROCATING * unit] * 2, rel=1e-11)
    assert max(left(found, "frame force", 1.0)[1]) < 1e-9


def test_unlike_cylinders_each_have_their_own():
    """Of two opposite throws of one cylinder each, in one plane, the first orders subtract."""
    small = Cylinder(phase=math.pi, radius=0.03, piston=OwnPiston(mass=0.2))
    found = balance(engine(Layout(cylinders=(Cylinder(), small))), 0.4)
    reciprocating = RECIPROCATING - 0.3
    own = (
        0.05 * (ROTATING + 0.4 * RECIPROCATING),
        0.03 * (ROTATING + 0.4 * reciprocating),
    )
    assert found.per_throw == pytest.approx(own, rel=1e-14)
    before, after = left(found, "frame force", 1.0)
    along = (0.05 * RECIPROCATING - 0.03 * reciprocating) * SPEED**2
    across = (0.05 - 0.03) * ROTATING * SPEED**2
    assert before[:2] == pytest.approx([along + across, across], rel=1e-12)
    assert after[:2] == pytest.approx([0.6 * along, 0.4 * along], rel=1e-12)
    assert found.crank["center_of_mass"] * found.crank["mass"] == pytest.approx(own[1] - own[0])


def shared_pin(small=None, **layout):
    """A 90 degree twin whose rods share a pin, 30 mm apart along the crank."""
    return Layout(
        cylinders=(
            Cylinder(phase=math.pi / 4, bank=-math.pi / 4, position=0.0, throw=1),
            Cylinder(phase=-math.pi / 4, bank=math.pi / 4, position=0.03, throw=1, piston=small),
        ),
        **layout,
    )


@pytest.mark.parametrize("small", [None, OwnPiston(mass=0.2)], ids=["like", "unlike"])
def test_two_rods_on_a_pin_have_one_counterweight_for_both(small):
    """r (2 m_B + share (m_A1 + m_A2)), in the middle of the pin; pasted, it is the crank's own."""
    scene = engine(shared_pin(small))
    found = balance(scene, 0.5)
    both = 2.0 * RECIPROCATING - (0.0 if small is None else 0.3)
    assert found.per_throw == pytest.approx((0.05 * (2.0 * ROTATING + 0.5 * both),), rel=1e-14)
    again = simulate(scene.with_(**{f"crank__{k}": v for k, v in found.crank.items()})).data
    for axis, force in zip("xy", found.after.T, strict=True):
        np.testing.assert_allclose(again[f"frame_force_{axis}"].values, force, rtol=0, atol=1e-8)
    rocking = left(found, "rocking moment", 1.0)
    assert rocking[1] == pytest.approx(rocking[0], rel=1e-9)  # none of a weight in the middle


@pytest.mark.parametrize(
    ("throws", "small", "rows"),
    [
        ("", "", ["every throw", "where cylinders 1 and 2 share a pin"]),
        (", throw = 1", "", ["the throw"]),
        (", throw = 1", "piston = { mass = '0.2 kg' }", ["the throw"]),
        (
            "",
            "piston = { mass = '0.2 kg' }",
            ["the throw of cylinder 1", "the throw of cylinder 2"],
        ),
    ],
)
def test_lines_are_those_of_throws(throws, small, rows, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    second = "{ phase = '-45 deg', bank = '45 deg'%s }"
    if small:
        second = second.replace(" }", f", {small} }}")
    (tmp_path / "twin.toml").write_text(
        "crank = { radius = '50 mm' }\n"
        "rod = { length = '200 mm', mass = '0.8 kg', center_of_mass = '50 mm', inertia = 0.004 }\n"
        "piston = { mass = '0.5 kg' }\nmotion = { speed = '200 rad/s' }\n"
        "run = { until = '2 rev' }\n"
        f"cylinder = [{{ phase = '45 deg', bank = '-45 deg'{throws} }}, {second % throws}]\n"
    )
    done = crankmbs_("balance", "twin.toml", "--no-figures")
    assert done.exit_code == 0, done.output
    found = re.findall(r"^  (?:opposite )?(\w.*\w|\w) {2,}(\S+) kg m$", done.stdout, re.MULTILINE)
    assert [name for name, _ in found][: len(rows)] == rows
    assert len(found) == len(rows) + (len(rows) == 2 and bool(small)) + 1


@pytest.mark.parametrize(
    "speed", [SPEED, Oscillation(mean=SPEED, amplitude=30.0, order=2)], ids=["even", "uneven"]
)
def test_a_crank_that_has_the_counterweight_is_what_is_left(speed):
    """Of one cylinder the counterweight can be put on the crank itself, and the scene run again."""
    scene = replace(load_scene("yi_diesel"), gravity=None, motion=Motion(speed=speed))
    plain = replace(scene, crank=replace(scene.crank, mass=0.0, center_of_mass=0.0))
    found = balance(plain, 0.4)
    crank = replace(plain.crank, inertia=1.0, mass=10.0, center_of_mass=-found.per_throw[0] / 10.0)
    data = simulate(replace(plain, crank=crank)).data
    again = np.stack([data["frame_force_x"].values, data["frame_force_y"].values], axis=1)
    np.testing.assert_allclose(found.after, again, rtol=0, atol=1e-12 * np.abs(again).max())


@pytest.mark.slow
def test_of_a_free_crank_errors_are_stated():
    scene = load_scene("v_twin")
    found = balance(scene, 0.5)
    close = balance(replace(scene, run=replace(scene.run, rtol=1e-12)), 0.5)
    for row, exact in zip(found.remaining, close.remaining, strict=True):
        for stated, true in ((row.before, exact.before), (row.after, exact.after)):
            assert abs(stated.value - true.value) <= stated.error + true.error
            assert 0.0 < stated.error < 1e-5 * found.remaining[0].before.value


@pytest.mark.parametrize("share", [-0.1, 1.5, math.nan])
def test_a_share_that_cannot_be(share):
    with pytest.raises(InputError, match="share must be from 0 to 1"):
        balance(engine(), share)


@pytest.mark.parametrize("name", ["propeller", "yi_diesel"])
def test_a_scene_with_its_counterweights_has_the_force_that_was_said(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = crankmbs_("balance", name, "--no-figures", "-o", "balanced.toml")
    assert done.exit_code == 0, done.output
    found, with_it = balance(load_scene(name), 0.5), simulate(load_scene("balanced.toml"))
    if with_it.scene.motion is not None:  # else their weight changes the motion
        force = with_it.data["frame_force_x"].values
        assert force == pytest.approx(found.after[:, 0], abs=1e-6 * abs(force).max())
    (peak,) = re.findall(r"^main bearing \[N\] +\S+ +\S+ +(\S+) ", done.output, re.MULTILINE)
    largest = max(j.peak.value for j in with_it.measures().joints if j.joint == "main bearing")
    assert float(peak) == pytest.approx(largest, rel=1e-5)


def test_counterweights_beside_the_reference_line_have_no_centre_of_mass(tmp_path, monkeypatch):
    scene = load_scene("v_twin").with_(run__until="2 cycles")
    beside = balance(scene)
    with pytest.raises(InputError, match=r"at 150 degrees, do not lie along.* add 30 degrees to"):
        _ = beside.crank
    driven = balance(scene.with_(start=None, torque=(), motion={"speed": "3000 rpm"}))
    for found, part in ((beside, "start"), (driven, "motion")):
        with pytest.raises(InputError, match=rf"from the angle of \[{part}\]; the centre"):
            _ = found.crank
    cylinders = [{"phase": f"{p} deg", "bank": f"{b} deg"} for p, b in ((30, -30), (330, 30))]
    turned = balance(scene.with_(layout__cylinders=cylinders, start__angle="-30 deg"))
    assert turned.crank["center_of_mass"] == pytest.approx(-0.0414144 / 9.0, rel=1e-5)
    for one, other in zip(beside.remaining, turned.remaining, strict=True):
        assert one.after.value == pytest.approx(other.after.value, rel=1e-9)
    monkeypatch.chdir(tmp_path)
    done = crankmbs_("balance", "v_twin", "--no-figures", "-o", "mine.toml")
    assert done.exit_code == 2
    assert "counterweight, mass times radius" in done.stdout
    assert "do not lie along the crank's reference line" in done.stderr
    assert list(tmp_path.iterdir()) == []


IN_LINE = """title = "four in line"  # as it comes
[crank]
radius = "40 mm"
mass = "12 kg"
[rod]
length = "160 mm"
mass = "0.6 kg"
center_of_mass = "45 mm"
inertia = "two-mass"
[piston]
mass = "0.5 kg"
[motion]
speed = "3000 rpm"
[run]
until = "2 rev"
[layout]
firing_order = [1, 3, 4, 2]
spacing = "90 mm"
"""
JOURNALS = '[bearings]\nmain_journal = { diameter = "60 mm", width = "28 mm" }\n'


def test_counterweights_on_throws_are_written_where_journals_hold_them(tmp_path, monkeypatch):
    """U omega^2 of each throw is halved by the journals beside it: in the middle those of throws 2
    and 3, at one angle, add up; beside it those of opposite throws cancel."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "four.toml").write_text(IN_LINE + JOURNALS)
    done = crankmbs_("balance", "four.toml", "--share", "0%", "-o", "mine.toml", "--no-figures")
    assert done.exit_code == 0, done.output
    weights = ", ".join(4 * ['"-17.25 kg mm"'])
    line = f"throw_unbalance = [{weights}]"
    assert f"[bearings]\n{line}\n" in done.stdout
    text = (tmp_path / "mine.toml").read_text()
    assert text.replace(
        f"{line}    # with counterweights for 0 % of the reciprocating mass\n", ""
    ) == (IN_LINE + JOURNALS)
    runs = [simulate(load_scene(name)).measures().joints for name in ("four.toml", "mine.toml")]
    peaks = [[j.peak.value for j in each if j.joint == "main journal"] for each in runs]
    pull = 0.01725 * (100.0 * math.pi) ** 2
    less = np.array([0.5, 0.0, 1.0, 0.0, 0.5]) * pull
    assert peaks[1] == pytest.approx(np.array(peaks[0]) - less, rel=1e-9)


def test_counterweights_that_cancel_on_a_crank_without_journals_are_not_claimed(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "four.toml").write_text(IN_LINE)
    done = crankmbs_("balance", "four.toml", "-o", "mine.toml", "--no-figures")
    assert "cancel on the crank as a whole" in done.stdout
    assert (tmp_path / "mine.toml").read_text() == IN_LINE


def test_on_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = crankmbs_("balance", "yi_diesel", "--share", "40 %", "--out", "here")
    assert done.exit_code == 0
    assert "40 % of the reciprocating mass" in done.stdout
    assert {file.name for file in (tmp_path / "here").iterdir()} == {"balance.csv", "balance.png"}
    lines = (tmp_path / "here" / "balance.csv").read_text().splitlines()
    assert len(lines) == 7
    assert 'center_of_mass = "' in done.stdout
    assert "moving parts on the frame, engine's X and Y\n" in done.stdout  # nothing rocks
    assert "--share: " in refused("balance", "yi_diesel", "--share", "150%")
