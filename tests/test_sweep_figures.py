"""Figures of a sweep: curves, contours, small multiples, samples."""

import re

import numpy as np
import pytest
from command_line import refused
from matplotlib.contour import QuadContourSet

from crankmbs import InputError, Sample, load_scene, sweep
from crankmbs.figures import png, sweep_figure

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller").with_(run__until="settled")


@pytest.fixture(scope="module")
def grid():
    vary = {"rod_ratio": "0.2..0.4:4", "crank.inertia": "0.1..1 kg m^2:3:log"}
    return sweep(SCENE, vary, executor=1)


def test_one_knob_is_a_curve(grid):
    one = grid.isel({"rod_ratio": [0]})
    figure = sweep_figure(one, "fluctuation", "1 %")
    curve, limit = figure.axes[0].lines
    np.testing.assert_allclose(curve.get_ydata(), 100.0 * one["fluctuation"][0])
    np.testing.assert_array_equal(limit.get_ydata(), [1.0, 1.0])
    assert figure.axes[0].get_xscale() == "log"
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["1 %"]


def test_what_each_cylinder_has_is_drawn_by_its_number(grid):
    figure = sweep_figure(grid.isel({"rod_ratio": [0]}), "crank pin 1")
    drawn = figure.axes[0].lines[0].get_ydata()
    np.testing.assert_allclose(drawn, 1e-3 * grid["crank_pin_peak"][0, :, 0])
    with pytest.raises(InputError, match="crank pin force, 2: there are 1; give a number from 1"):
        sweep_figure(grid, "crank pin 2")


def test_two_knobs_are_contours_with_the_line_of_the_limit(grid):
    figure = sweep_figure(grid, "side thrust by S1", "25 %")
    labels = [text.get_text() for text in figure.axes[0].texts]
    ticks = figure.axes[-1].get_yticks()
    assert labels
    assert {float(label) for label in labels} <= {float(f"{tick:.6g}") for tick in ticks}
    step = float(f"{np.diff(ticks)[0]:e}".partition("e")[0])
    assert step == pytest.approx(round(step))  # 1, 2 or 5 of a power of ten
    filled, _, line = (c for c in figure.axes[0].collections if isinstance(c, QuadContourSet))
    assert line.levels.tolist() == [25.0]
    assert filled.levels[0] <= 100.0 * float(
        grid["lecture_deviation"].sel(quantity="side thrust")[..., 2].min()
    )
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["25 %"]
    assert "by Yi et al., over its peak" in figure.get_suptitle()
    assert png(figure)


def test_a_measure_is_an_axis_in_place_of_the_last_knob(grid):
    figure = sweep_figure(grid, "torque by S1", "5 %", "fluctuation")
    ax, fluctuation = figure.axes[0], 100.0 * grid["fluctuation"].values
    assert ax.get_xlabel() == "coefficient of fluctuation, (max - min)/mean [%]"
    assert ax.get_ylabel() == "rod ratio"
    assert ax.get_xlim() == pytest.approx((fluctuation.min(), fluctuation.max()))
    (filled, *_) = (c for c in ax.collections if isinstance(c, QuadContourSet))
    corners = np.concatenate([path.vertices for path in filled.get_paths()])
    for k in (0, -1):  # along the edges each case is a corner
        row = corners[np.isclose(corners[:, 1], grid["rod_ratio"].values[k]), 0]
        assert np.abs(row[:, None] - fluctuation[k]).min(axis=0) == pytest.approx(0.0, abs=1e-12)
    one = grid.isel({"rod_ratio": [0]})
    curve = sweep_figure(one, "torque by S1", over="fluctuation").axes[0].lines[0]
    np.testing.assert_allclose(curve.get_xdata(), fluctuation[0])


def test_who_varies_a_measure_is_told_the_way(tmp_path):
    vary = ["--vary", "fluctuation=1..5 %:3"]
    text = refused("sweep", "propeller", *vary, "-o", str(tmp_path / "s.zarr"))
    assert "fluctuation: is a measure, which follows from a case; vary what it depends on" in text
    assert 'crankmbs plot SWEEP --over "fluctuation"' in text


def test_labels_of_contours_are_clear_of_the_edges_and_of_one_another(grid):
    for show in ("side thrust by S1", "fluctuation", "mean speed"):
        figure = sweep_figure(grid, show)
        figure.draw_without_rendering()
        ax = figure.axes[0]
        boxes = [text.get_window_extent() for text in ax.texts]
        assert len(boxes) > 2
        for number, box in enumerate(boxes):
            assert ax.bbox.count_contains(box.corners()) == 4
            assert not any(box.overlaps(other) for other in boxes[:number])


def test_three_knobs_are_small_multiples():
    vary = {"rod_ratio": "0.2..0.4:2", "piston.mass": "1..2 kg:2", "motion.speed": "1e3..3e3 rpm:3"}
    scene = load_scene("yi_diesel").with_(run__until="1 cycles")
    found = sweep(scene, vary, executor=1)
    figure = sweep_figure(found, "peak crank pin force")
    titles = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert titles == ["motion.speed 1000 rpm", "motion.speed 2000 rpm", "motion.speed 3000 rpm"]


def test_a_logarithmic_axis_has_plain_numbers_and_units_are_raised():
    vary = {"crank.inertia": "0.1..1 kg m^2:9:log"}
    figure = sweep_figure(sweep(SCENE, vary, executor=1), "fluctuation", "5 %")
    figure.draw_without_rendering()
    (ax,) = figure.axes
    words = [tick.label1.get_text() for tick in ax.xaxis.get_major_ticks() if tick.get_visible()]
    assert {"0.1", "0.2", "0.5", "1"} <= set(words)
    assert ax.get_xlabel() == "crank.inertia [kg m$^{2}$]"
    assert "all cases lie on one side of 5 %" in figure.get_supxlabel()


def test_a_sample_is_points_over_each_knob_and_failures_are_counted():
    vary = {"rod.length": "0.03..0.2 m", "piston.mass": "1..2 kg"}
    scene = load_scene("yi_diesel").with_(run__until="1 cycles")
    figure = sweep_figure(sweep(scene, Sample(vary, 8), executor=1), "peak crank pin force")
    assert len(figure.axes) == 2
    assert re.search(r"; without a value: [1-7]$", figure.get_supxlabel(), re.MULTILINE)


@pytest.mark.parametrize(
    ("show", "limit", "said"),
    [
        ("fluctuatoin", None, 'did you mean "coefficient of fluctuation"?'),
        ("fluctuation", "3 mm", "limit: must be a share"),
        ("peak crank pin force", "1 %", "is no force here"),
        ("friction power", None, "is no measure of these cases"),
    ],
)
def test_what_cannot_be_drawn_is_refused(grid, show, limit, said):
    with pytest.raises(InputError, match='over: "fluctation" is no measure of these cases; did'):
        sweep_figure(grid, "fluctuation", over="fluctation")
    with pytest.raises(InputError, match=re.escape(said)):
        sweep_figure(grid, show, limit)
