"""What the figures say: their data, marks and labels; that nothing global is touched."""

import dataclasses
import math
import re
from collections import Counter

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from PIL import Image
from two_runs import differences

from crankmbs import (
    Cylinder,
    Fuel,
    Layout,
    Misfire,
    Motion,
    Oscillation,
    Ramp,
    Run,
    load_scene,
    simulate,
)
from crankmbs.errors import OutputError
from crankmbs.figures import (
    crank_pin_figure,
    difference_figure,
    forces_figure,
    indicator_figure,
    last_view,
    main_bearing_figure,
    piston_motion_figure,
    piston_pin_figure,
    save_figures,
    speed_figure,
    torque_figure,
)
from crankmbs.figures.polar import draw_polar
from crankmbs.figures.style import caption, panels

pytestmark = pytest.mark.slow

FIRED = load_scene("propeller")
FOUR = Layout(firing_order=(1, 3, 4, 2))
FIGURES = [
    speed_figure,
    piston_motion_figure,
    forces_figure,
    main_bearing_figure,
    crank_pin_figure,
    piston_pin_figure,
    torque_figure,
    indicator_figure,
]


def driven(speed="3200 rpm", *, base=FIRED, until="2 cycles", every="1 deg", **parts):
    run, motion = Run(until=until, every=every), Motion(speed=speed)
    return dataclasses.replace(base, start=None, torque=(), motion=motion, run=run, **parts)


@pytest.fixture(scope="module")
def one():
    return last_view(simulate(driven()))


@pytest.fixture(scope="module")
def four():
    return last_view(
        simulate(driven(Oscillation(mean=300.0, amplitude=12.0, order=2.0), layout=FOUR))
    )


def texts(ax):
    return [text.get_text().strip() for text in ax.texts]


def legend_of(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize("draw", FIGURES)
def test_every_axis_names_its_quantity_and_unit(draw, four):
    figure = draw(four)
    for ax in figure.axes:
        assert "[" in ax.get_ylabel()
        assert ax.get_ylabel().endswith("]")
    bottom = figure.axes[-1].get_xlabel()
    assert "[" in bottom
    assert "]" in bottom


@pytest.mark.parametrize(
    ("draw", "entries"),
    [
        (torque_figure, [f"cylinder {k}" for k in range(1, 5)]),
        (forces_figure, [f"cylinder {k}" for k in range(1, 5)]),
        (piston_motion_figure, ["cylinders 1, 4", "cylinders 2, 3"]),  # half a period apart
        (crank_pin_figure, ["cylinders 1, 2, 3, 4"]),  # the speed repeats with every firing
    ],
)
def test_cylinders_are_told_apart_and_those_that_coincide_are_one_curve(draw, entries, four):
    figure = draw(four)
    assert legend_of(figure)[: len(entries)] == entries
    for ax in figure.axes:
        lines = [line for line in ax.lines if line.get_label().startswith("cylinder")]
        assert [line.get_label() for line in lines] == entries
        assert len({(line.get_color(), str(line._dash_pattern)) for line in lines}) == len(entries)


def test_forces_that_differ_by_more_than_a_pixel_are_curves_of_their_own():
    swing = Oscillation(mean=300.0, amplitude=0.6, order=1.0)  # 0.2 %: cylinders 2 and 3 lag
    view = last_view(simulate(driven(swing, layout=FOUR)))
    assert legend_of(crank_pin_figure(view)) == ["cylinders 1, 4", "cylinders 2, 3"]


def test_only_the_last_cycle_is_shown_and_from_a_whole_number_of_periods(one):
    (ax,) = torque_figure(one).axes
    assert ax.get_xlim() == pytest.approx((0.0, 720.0))
    assert ax.lines[0].get_xdata()[[0, -1]] == pytest.approx([0.0, 720.0])


def test_speed_shows_the_whole_run_as_well(four):
    whole, last = speed_figure(four).axes
    assert whole.lines[0].get_xdata()[[0, -1]] == pytest.approx([0.0, 4.0])
    assert whole.lines[0].get_ydata()[0] == pytest.approx(312.0 * 30.0 / math.pi)
    assert last.get_xlim() == pytest.approx((0.0, 720.0))


def test_constant_speed_is_drawn_flat(one):
    for ax in speed_figure(one).axes:
        low, high = ax.get_ylim()
        assert (low, high) == pytest.approx((3168.0, 3232.0))


def test_dead_centres_of_one_cylinder_are_the_true_ones():
    piston = dataclasses.replace(FIRED.piston, offset=0.02)
    view = last_view(simulate(driven(piston=piston, until="725 deg")))
    marked = view.dead_centre_labels()
    displacement = view.values("piston_displacement")[:, 0]
    for at, label in marked.items():
        here = np.interp(at, view.degrees, displacement, period=720.0)
        extreme = displacement.max() if label == "BDC" else 0.0
        assert here == pytest.approx(extreme, abs=2e-6)
    assert sorted(marked.values()) == ["BDC", "BDC", "TDC", "firing TDC"]
    (fires,) = [at for at, label in marked.items() if label == "firing TDC"]
    assert 360.0 < fires < 370.0


def test_dead_centres_of_several_cylinders_carry_their_numbers_and_which_fires(four):
    assert list(four.dead_centre_labels().values()) == [
        "TDC 1, 4\n4 fires",
        "TDC 2, 3\n2 fires",
        "TDC 1, 4\n1 fires",
        "TDC 2, 3\n3 fires",
        "TDC 1, 4\n4 fires",
    ]


def test_polar_diagrams_have_equal_axes_with_counter_clockwise_as_in_the_engine(one):
    for draw in (main_bearing_figure, crank_pin_figure, piston_pin_figure):
        for ax in draw(one).axes:
            left, right = ax.get_xlim()
            low, high = ax.get_ylim()
            assert ax.get_aspect() == 1.0
            assert left - right == pytest.approx(high - low)
            assert left > right


def test_polar_diagram_marks_the_peak_and_angles_that_lie_apart_on_the_curve(one):
    (ax,) = main_bearing_figure(one).axes
    curve = ax.lines[0].get_xydata()
    dots = np.concatenate([line.get_xydata() for line in ax.lines if line.get_marker() == "o"])
    marked = dict(zip(texts(ax), dots, strict=True))
    (peak,) = (label for label in marked if label.startswith("peak"))
    largest = int(np.argmax(np.hypot(*curve.T)))
    assert float(peak.removeprefix("peak ")) == pytest.approx(
        one.degrees[largest] % 720.0, abs=0.05
    )
    assert np.array_equal(marked.pop(peak), curve[largest])
    assert {"0", "90"} & set(marked)
    for label, dot in marked.items():
        assert int(label) % 30 == 0
        nearest = np.argmin(np.abs((one.degrees - int(label) + 1.0) % 720.0 - 1.0))
        assert np.hypot(*(curve[nearest] - dot)) == pytest.approx(0.0, abs=1e-6)
    size = np.ptp(curve, axis=0).max()
    between = np.hypot(*(dots[:, None] - dots[None]).T)
    assert np.min(between[~np.eye(len(dots), dtype=bool)]) > 0.08 * size
    assert len(dots) >= 6


def test_labels_of_a_polar_diagram_do_not_overlap(one):
    figure = piston_pin_figure(one)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    area = figure.axes[0].get_window_extent()
    for k, box in enumerate(boxes):
        assert area.x0 <= box.x0
        assert box.x1 <= area.x1
        assert not any(box.overlaps(other) for other in boxes[k + 1 :])


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_force_of_some_degrees_is_marked_there_and_not_on_the_origin(sense):
    """A press: its force is there for some degrees in a turn, so most angles lie on the origin."""
    degrees = np.arange(0.0, 721.0)
    force = 60e3 * np.exp(-(((degrees % 360.0 - 180.0) / 40.0) ** 2))
    figure, (ax,) = panels(1, 1, 8.0, 8.0)
    draw_polar(ax, (1.0 + 0.5j * sense) * force[:, None], degrees, {0: ""}, ("up", "left"))
    figure.draw_without_rendering()
    low, high = ax.get_ylim()
    assert high - low < 120.0  # kN
    assert {text.get_text().strip() for text in ax.texts} == {"peak 180", "0", "120", "150"}
    area = ax.get_window_extent()
    boxes = [text.get_window_extent() for text in ax.texts]
    for k, box in enumerate(boxes):
        assert area.x0 <= box.x0 < box.x1 <= area.x1
        assert area.y0 <= box.y0
        assert not any(box.overlaps(other) for other in boxes[k + 1 :])


def test_crank_pin_turning_with_the_crank_is_the_fixed_one_turned(one):
    fixed, turning = crank_pin_figure(one).axes
    y, x = fixed.lines[0].get_xydata().T
    tangential, radial = turning.lines[0].get_xydata().T
    turned = (radial + 1j * tangential) * np.exp(1j * np.radians(one.degrees))
    assert turned == pytest.approx(x + 1j * y, abs=1e-9)


def test_without_gas_only_the_side_force_is_drawn():
    view = last_view(simulate(driven(base=load_scene("coasting"))))
    assert len(forces_figure(view).axes) == 1


@pytest.mark.parametrize(
    ("speed", "until", "parts"),
    [
        (Ramp(start=80.0, to=-300.0, over=0.2), "0.2 s", {}),  # reverses
        (80.0, "3 deg", {}),
        (-300.0, "2 cycles", {"layout": FOUR}),
        (0.0, "1 s", {}),  # stands still: two samples on one angle
        (
            300.0,
            "1 rev",
            {"layout": Layout(cylinders=(Cylinder(bank=-0.5), Cylinder(phase=5.0, bank=0.5)))},
        ),
    ],
)
@pytest.mark.parametrize("draw", FIGURES)
def test_unusual_runs_are_drawn_without_a_warning(draw, speed, until, parts):
    view = last_view(simulate(driven(speed, until=until, **parts)))
    draw(view).draw_without_rendering()


@pytest.mark.always
def test_figures_are_saved_as_png_and_no_global_state_is_touched(tmp_path, one):
    before = dict(mpl.rcParams)
    files = save_figures(one.result, tmp_path / "new")
    assert dict(mpl.rcParams) == before
    assert sorted(file.name for file in files) == sorted(
        file.name for file in (tmp_path / "new").iterdir()
    )
    assert len(files) == len(FIGURES)
    for file in files:
        with Image.open(file) as image:
            assert image.format == "PNG"
            assert min(image.size) >= 700


def test_a_figure_is_laid_out_and_drawn_once(one, tmp_path, monkeypatch):
    counted = []

    def count(owner, name):
        whole = getattr(owner, name)

        def counting(self, *values, **options):
            counted.append(name)
            return whole(self, *values, **options)

        monkeypatch.setattr(owner, name, counting)

    count(ConstrainedLayoutEngine, "execute")
    count(Figure, "draw")
    files = save_figures(one.result, tmp_path)
    assert Counter(counted) == {"draw": len(files), "execute": len(files)}


def test_figures_that_cannot_be_saved_are_an_output_error(tmp_path, one):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        save_figures(one.result, tmp_path / "file")


def shifted(result, name, amount):
    data = result.data.copy(deep=True)
    data[name].values[5] += amount
    return dataclasses.replace(result, data=data)


def test_difference_finds_where_two_runs_part(four):
    result = four.result
    rows = differences(result, shifted(result, "crank_pin_force_y", [0.0, 0.0, 3.0, 0.0]))
    by_name = {row.quantity: row for row in rows}
    size, *place = by_name["crank pin"].largest
    assert size == pytest.approx(3.0, rel=1e-9)
    assert place == [5, 2]
    stated = result.data["crank_pin_force_x"].attrs["error_estimate"]
    stated = math.hypot(stated, result.data["crank_pin_force_y"].attrs["error_estimate"])
    assert by_name["crank pin"].errors == pytest.approx((stated, stated))
    assert by_name["crank pin"].share == pytest.approx(3.0 / (2.0 * stated))
    assert [row.share for row in rows if row.quantity != "crank pin"] == [0.0] * (len(rows) - 1)


def test_difference_figure_shows_every_quantity_beside_both_errors(four):
    other = shifted(four.result, "crank_speed", 1e-3)
    rows = differences(four.result, other)
    figure = difference_figure(four.result, rows)
    shown = [ax.get_title(loc="left") for ax in figure.axes if ax.get_visible()]
    assert shown == [row.quantity for row in rows]
    for ax, row in zip(figure.axes, rows, strict=False):
        levels = [
            line.get_ydata()[0]
            for line in ax.lines
            if line.get_label().startswith("numerical error of")
        ]
        assert ax.get_yscale() == "log"
        assert levels == pytest.approx([error / row.peak for error in row.errors])
    figure.draw_without_rendering()


@pytest.mark.parametrize(
    ("parts", "labels"),
    [
        ([1.0, 2.0, 2.0, 1.0], ["cylinders 1, 4", "cylinders 2, 3"]),
        ([1.0, 2.0, 2.0, 1.01], ["cylinder 1", "cylinders 2, 3", "cylinder 4"]),
    ],
)
def test_differences_of_cylinders_that_coincide_in_every_panel_are_one_curve(four, parts, labels):
    other = shifted(four.result, "side_force", parts)
    rows = differences(four.result, shifted(other, "piston_velocity", [3.0, 5.0, 5.0, 3.0]))
    figure = difference_figure(four.result, rows)
    for ax, row in zip(figure.axes, rows, strict=False):
        lines = [line for line in ax.lines if not line.get_label().startswith("numerical error of")]
        several = row.size.shape[1] > 1
        assert [line.get_label() for line in lines] == (labels if several else ["difference"])
        if row.quantity == "side force":
            first = [parts[int(label.split()[1].rstrip(",")) - 1] for label in labels]
            assert [line.get_ydata()[5] for line in lines] == pytest.approx(
                [part / row.peak for part in first], rel=1e-9
            )
    assert [text.get_text() for text in figure.legends[0].texts][: len(labels)] == labels


def test_a_firing_without_combustion_is_not_said_to_fire():
    gas = dataclasses.replace(FIRED.gas, motored=2e5)
    for misfires, labels in (("1", {"BDC", "TDC"}), ("2", {"BDC", "TDC", "firing TDC"})):
        fuel = Fuel(misfire=[Misfire(cylinder=1, cycles=misfires)])
        result = simulate(driven(gas=gas, fuel=fuel, until="725 deg"))
        assert set(last_view(result).dead_centre_labels().values()) == labels


def test_a_caption_breaks_no_line_before_a_unit_or_an_error():
    said = (
        "torque [N m] 43 N m, side force [N] 0.3 +- 3e-6 kN, 0.2 kg m^2 at 20 deg, over 1 rev of 5"
    )
    for width in np.arange(2.0, 5.0, 0.1):
        figure, _ = panels(1, 1, width, 3.0)
        caption(figure, [said])
        lines = figure.get_supxlabel().split("\n")
        assert len(lines) > 1
        for line in lines:
            assert not re.match(r"\[|\+-|3e-6|m\b|m\^2|(N|kN|kg|deg|rev)\b", line), lines
    assert " ".join(lines) == said
