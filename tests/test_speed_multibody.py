"""exudyn by crankmbs and by a script of one's own: measured in turns, drawn, and as committed."""

import csv

import pytest

from crankmbs import load_scene
from validation.speed.multibody import FILE, SCENES, drawn, measured

pytestmark = pytest.mark.slow


def test_both_are_measured_and_drawn():
    scene = load_scene("coasting").with_(run__until="2 rev")
    points = measured("coasting", scene, rtol=(1e-5,))
    (ours,) = (point for point in points if point.by == "multibody")
    assert ours.error <= ours.stated <= 1e-5
    errors = [point.error for point in points if point.by == "script"]
    assert 1e-6 < errors[-1] < errors[2] < errors[0]
    figure = drawn(points, ("a machine",))
    assert figure.axes[0].get_title(loc="left") == "coasting"
    assert [len(line.get_xdata()) for line in figure.axes[0].lines] == [1, 1, len(errors)]


@pytest.mark.always
def test_what_is_committed_has_five_points_each_and_errors_within_those_stated():
    with FILE.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(dict.fromkeys(row["scene"] for row in rows)) == list(SCENES)
    for name in SCENES:
        ours, script = (
            [row for row in rows if (row["scene"], row["by"]) == (name, by)]
            for by in ("multibody", "script")
        )
        assert min(len(ours), len(script)) >= 5
        assert all(float(row["error"]) <= float(row["stated"]) for row in ours)
        # at the script's finest step multibody errs less in less time
        finest = script[-1]
        better = [row for row in ours if float(row["error"]) <= float(finest["error"])]
        assert min(float(row["seconds"]) for row in better) < float(finest["seconds"])
