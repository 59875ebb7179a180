"""Lines of the page: short, but through every point."""

import re

import numpy as np
import pytest

from crankmbs.page import joined

_LINE = """((x, y) => svg.lineOf(
  { x, y: y.map((each) => each ?? NaN) }, { right: (v) => 3 * v + 7, up: (v) => 200 - 2 * v }))"""
ANGLES = np.linspace(0.0, 180.0, 361)
LINES = {
    "smooth": (ANGLES, 40.0 * np.sin(ANGLES / 20.0)),
    "straight": (ANGLES, 0.5 * ANGLES),
    "noise": (ANGLES, np.random.default_rng(1).normal(0.0, 0.2, 361)),
    "back": (40.0 * np.cos(ANGLES / 30.0), 30.0 * np.sin(ANGLES / 30.0)),
    "sticks": (np.repeat(np.arange(8.0), 3), np.tile([0.0, 30.0, 0.0], 8)),
    "gap": (ANGLES, np.where(np.abs(ANGLES - 90.0) < 10.0, np.nan, 5.0)),
}


def pieces(path):
    """The corners of each unbroken piece of a path, in pixels."""
    parts = [re.findall(r"-?[\d.]+", part) for part in path.split("M")[1:]]
    steps = [np.array(part, dtype=float).reshape(-1, 2) for part in parts]
    return [0.1 * each.cumsum(axis=0) for each in steps]


def distance(point, corners):
    """From a point to the nearest place of a line."""
    begin, along = corners[:-1], np.diff(corners, axis=0)
    long = np.maximum((along**2).sum(axis=1), 1e-12)
    part = np.clip(((point - begin) * along).sum(axis=1) / long, 0.0, 1.0)
    return np.hypot(*(begin + part[:, None] * along - point).T).min()


@pytest.mark.parametrize("name", LINES)
def test_a_line_passes_every_point_and_nothing_else(v8, name):
    x, y = LINES[name]
    text = [None if np.isnan(each) else each for each in y.tolist()]
    v8.eval(f"var svg = {joined('svg')};")
    found = pieces(v8.call(_LINE, x.tolist(), text))
    points = np.column_stack([3.0 * x + 7.0, 200.0 - 2.0 * y])
    given = points[np.isfinite(y)]
    for point in given:
        assert min(distance(point, corners) for corners in found) < 0.3
    for corner in np.concatenate(found):
        assert np.hypot(*(given - corner).T).min() < 0.1
    assert len(found) == (2 if name == "gap" else 1)
    assert sum(map(len, found)) <= {"straight": 3, "gap": 4}.get(name, len(given))
