"""A result, a scene and a comparison as HTML, for a notebook: tables and a figure. Text is never
markup."""

from __future__ import annotations

import base64
from collections.abc import Sequence

from markupsafe import Markup

from crankmbs.choose import choose
from crankmbs.compare import AtAngle, Budget, Comparison, Excerpt, short_name
from crankmbs.errors import CrankmbsError
from crankmbs.figures import last_view, machine_figure, png, speed_figure
from crankmbs.measures import Measures, measure
from crankmbs.measures.plausible import warnings
from crankmbs.report.compared import (
    advice,
    angle_words,
    budget_table,
    comparison_table,
    left_out_lines,
    number_table,
)
from crankmbs.report.machine import machine_rows
from crankmbs.report.readings import passed_at, reading_tables
from crankmbs.report.rows import cycle_remark, measure_tables, not_periodic, tables, unsteady
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = [
    "at_html",
    "budget_html",
    "comparison_html",
    "measures_html",
    "result_html",
    "scene_html",
]

_LEFT, _RIGHT = (Markup(f' style="text-align: {side}"') for side in ("left", "right"))
_DPI = 100  # enough on a screen, and a notebook that is saved stays small


def result_html(result: Result) -> str:
    """How a run ended, its measures and joint forces with their errors, and its speed drawn.

    >>> result_html(simulate(load_scene("propeller"))).count("<table>")
    4
    """
    measures = measure(result)
    error = result.error
    about = [
        ("formulation", result.formulation),
        *(("", reason) for reason in result.reasons),
        ("end", result.message),
        *([("cycle", text)] if (text := cycle_remark(result.scene)) else []),
        *([("speed", text)] if (text := unsteady(result, measures)) else []),
        ("num. error", f"{error.estimated:.1e} relative, {error.asked:.0e} asked for"),
        *(("warning", text) for text in warnings(result.scene)),
    ]
    parts = [
        _table([], about),
        *(_table(*rows) for rows in tables(result, measures)),
        _picture(png(speed_figure(last_view(result)), _DPI), "crank speed over the crank angle"),
    ]
    return _whole(result.scene, f"status {result.status}", parts)


def measures_html(measures: Measures) -> str:
    """The measures over their window with their errors, and peaks with where they are.

    >>> measures_html(simulate(load_scene("propeller")).measures()).count("<table>")
    2
    """
    parts = [_table(*rows) for rows in measure_tables(measures)]
    return _whole(measures.scene, not_periodic(measures) or "measures", parts)


def at_html(state: AtAngle) -> str:
    """Every quantity at one crank angle with its error.

    >>> at_html(simulate(load_scene("propeller")).at("60 deg")).count("<table>")
    2
    """
    return _whole(state.scene, passed_at(state), [_table(*rows) for rows in reading_tables(state)])


def scene_html(scene: Scene) -> str:
    """The machine as understood, how it would be run, and the machine drawn to scale.

    >>> scene_html(load_scene("propeller")).count("<img")
    1
    """
    try:
        choice = choose(scene, scene.run.formulation)
        how = [choice.formulation, *choice.reasons]
    except CrankmbsError as error:
        how = [str(error)]
    rows = [
        *(row for row in machine_rows(scene) if row[0] != "title"),
        *(("formulation" if k == 0 else "", text) for k, text in enumerate(how)),
        *(("warning", sentence) for sentence in warnings(scene)),
    ]
    picture = _picture(png(machine_figure(scene), _DPI), "the machine, to scale")
    return _whole(scene, "scene", [_table([], rows), picture])


def comparison_html(comparison: Comparison) -> str:
    """The largest difference of each reference from the run, in percent of its peak; the single
    numbers of formulas beside the run's.

    >>> comparison_html(compare(simulate(load_scene("propeller")))).count("<table>")
    1
    """
    text = (
        "largest difference from the run, in % of its peak; at: where that of the last reference "
        f"is, {angle_words(comparison.simulated)}"
    )
    lines = [Markup("<p>{}</p>").format(line) for line in left_out_lines(comparison.left_out)]
    numbers = [_table(*number_table(comparison))] if comparison.numbers else []
    parts = [_table(*comparison_table(comparison)), *numbers, *lines]
    return _whole(comparison.excerpt.result.scene, f"{_stretch(comparison.excerpt)}: {text}", parts)


def budget_html(budget: Budget) -> str:
    """The largest error of each formula and the causes that add up to it, in percent of the peak.

    >>> budget_html(budget(simulate(load_scene("propeller")))).count("<table>")
    1
    """
    text = (
        "formula minus run, in % of its peak, where it is largest; the causes add up to it there; "
        f"at: {angle_words(split.quantity for split in budget.splits)}"
    )
    parts: list[Markup] = []
    for reference in dict.fromkeys(split.reference for split in budget.ranked):
        splits = [split for split in budget.ranked if split.reference == reference]
        parts += [Markup("<p>{}</p>").format(short_name(reference)), _table(*budget_table(splits))]
    lines = [*([advice(budget)] if budget.splits else []), *left_out_lines(budget.left_out)]
    parts += [Markup("<p>{}</p>").format(line) for line in lines]
    return _whole(budget.excerpt.result.scene, f"{_stretch(budget.excerpt)}: {text}", parts)


def _stretch(excerpt: Excerpt) -> str:
    count = len(excerpt.result.scene.cylinders)
    return f"{excerpt.window.kind}, cylinder {excerpt.cylinder} of {count}"


def _whole(scene: Scene, kind: str, parts: Sequence[Markup]) -> str:
    """All parts below the title of the scene and what they are of it."""
    title = scene.title or "a scene without a title"
    head = Markup("<p><b>{}</b>, {}</p>").format(title, kind)
    return str(Markup("<div>{}</div>").format(Markup("\n").join([head, *parts])))


def _table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Markup:
    lines = [_line("th", headings)] if headings else []
    lines += [_line("td", row, words=not headings) for row in rows]
    return Markup("<table>{}</table>").format(Markup("\n").join(lines))


def _line(tag: str, cells: Sequence[str], words: bool = False) -> Markup:
    """A row: its first cell flush left, the others too where they are words."""
    made = [
        Markup("<{}{}>{}</{}>").format(tag, _LEFT if words or k == 0 else _RIGHT, cell, tag)
        for k, cell in enumerate(cells)
    ]
    return Markup("<tr>{}</tr>").format(Markup("").join(made))


def _picture(image: bytes, words: str) -> Markup:
    """A picture that stands in the text itself and needs no file."""
    data = base64.b64encode(image).decode("ascii")
    return Markup('<img style="max-width: 100%; width: 48em" alt="{}" src="{}">').format(
        words, f"data:image/png;base64,{data}"
    )
