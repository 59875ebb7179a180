"""The figure of bearing loads: which curves it draws, and what they and their peaks are called."""

import dataclasses

import numpy as np
import pytest

from crankmbs import Bearings, Cylinder, Layout, Motion, Shell, load_scene, simulate
from crankmbs.measures import measure

FOUR = load_scene("yi_diesel_free").with_(run__until="1 cycle", layout__spacing="100 mm")
DIESEL = FOUR.with_(
    bearings=Bearings(
        crank_pin=Shell(diameter="56 mm", width="31 mm"),
        main_journal=Shell(diameter="65 mm", width="32 mm"),
    )
)


def test_journals_of_one_curve_are_drawn_once_and_every_panel_names_its_own():
    """Throws 1 and 4 of an inline four fire one turn apart, and so do 2 and 3."""
    figure = simulate(DIESEL).plot("bearings")
    names = [[text.get_text() for text in ax.get_legend().texts] for ax in figure.axes]
    journals = ["main journals 1, 5", "main journals 2, 4", "main journal 3"]
    pins = ["cylinders 1, 2, 3, 4"]
    assert names == [journals, journals, pins, pins]
    assert not figure.legends
    assert "crank angle [deg], along main journal 1" in figure.get_supxlabel().replace("\n", " ")


def test_angles_and_names_in_the_figure_are_those_of_the_table():
    """Of a V6 whose three pins peak at one cycle angle of their own, and at three crank angles."""
    given = ((0, -30, 0), (300, 30, 32), (480, -30, 108), (60, 30, 140), (240, -30, 216))
    places = [*given, (540, 30, 248)]
    cylinders = tuple(
        Cylinder(phase=f"{p} deg", bank=f"{b} deg", position=f"{z} mm", throw=k // 2 + 1)
        for k, (p, b, z) in enumerate(places)
    )
    scene = FOUR.with_(layout=Layout(cylinders=cylinders), bearings=Bearings())
    scene = dataclasses.replace(
        scene, start=None, torque=(), motion=Motion(speed=300.0), gravity=None
    )
    result = simulate(scene)
    peaks = {(j.joint, j.number): j for j in measure(result).joints}
    shell, journal, _, pin = result.plot("bearings").axes
    for ax in (shell, journal):
        names = [text.get_text() for text in ax.get_legend().texts]
        assert names == [f"main journal {k}" for k in range(1, 5)]
        (label,) = [t.get_text().strip() for t in ax.texts if "peak" in t.get_text()]
        number, angle = label.split(": peak ")
        largest = max(
            (j for (joint, _), j in peaks.items() if joint == "main journal"),
            key=lambda j: j.peak.value,
        )
        assert peaks["main journal", int(number)].peak.value == pytest.approx(
            largest.peak.value, rel=1e-6
        )
        at = np.degrees(peaks["main journal", int(number)].crank_angle) % 720.0
        assert float(angle) == pytest.approx(at, abs=1.0)
    assert [text.get_text() for text in pin.get_legend().texts] == ["shared pins 1, 2, 3"]
    (label,) = [t.get_text().strip() for t in pin.texts if "peak" in t.get_text()]
    at = np.degrees(peaks["shared pin", 1].crank_angle) % 720.0
    assert float(label.removeprefix("peak ")) == pytest.approx(at, abs=1.0)


def test_legends_of_four_journals_are_no_wider_than_their_panels():
    figure = simulate(DIESEL.with_(layout=Layout(firing_order=(1, 3, 2), spacing=0.1))).plot(
        "bearings"
    )
    assert len(figure.axes[0].get_legend().texts) == 4
    figure.canvas.draw()
    left, right = (ax.get_legend().get_window_extent() for ax in figure.axes[:2])
    assert 0.0 <= left.x0 < left.x1 < right.x0 < right.x1 <= figure.bbox.x1
