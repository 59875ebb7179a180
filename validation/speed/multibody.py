"""`python -m validation.speed.multibody`: exudyn's rigid bodies by crankmbs and by a script.

What the formulation "multibody" takes for an error, with that error stated, beside the best
settings of a script that is written by hand for the same bodies, on four machines. Writes
`validation/figures/multibody_speed.csv` and `.png`.
"""

from __future__ import annotations

import argparse
import csv
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from crankmbs import load_scene, simulate
from crankmbs.figures.style import STYLE, caption, logarithmic
from crankmbs.scene.scene import Scene
from crankmbs.storage.files import write_in_one_move
from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.machine import about_machine
from crankmbs.work_precision.reference import reference_of
from crankmbs.work_precision.rounds import Row, play
from crankmbs.work_precision.trace import END, trace_of
from validation.speed.exudyn_script import exudyn_contenders
from validation.speed.job import job_of

__all__ = ["FILE", "SCENES", "Point", "drawn", "main", "measured"]

SCENES: dict[str, dict[str, Any]] = {
    "coasting": {},
    "propeller": {"run__until": "4 cycles"},
    "yi_diesel_free": {"run__until": "2 cycles"},
    # begun beside the jump of its pressure at top dead centre: on it a force has two values
    "v_twin": {"run__until": "2 cycles", "start__angle": "5 deg"},
}
FILE = Path(__file__).parents[1] / "figures" / "multibody_speed.csv"
_RTOL = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
_NO_CAP = 1e4  # s
_LONGEST = 30.0  # s: what takes longer is the last setting
_STYLES: dict[str, dict[str, Any]] = {
    "multibody": {"color": "#009E73", "marker": "o", "linewidth": 2.5},
    "script": {"color": "black", "marker": "^", "linewidth": 1.2},
}
_STATED = {**_STYLES["multibody"], "linestyle": ":", "linewidth": 1.2, "markerfacecolor": "white"}


@dataclass(frozen=True)
class Point:
    """One setting on one machine.

    by : "multibody", by rtol, or "script", by steps a turn
    error : the worst of motion and joint forces, relative to the peak; stated : as it states itself
    seconds : wall time, median of so many rounds
    """

    scene: str
    by: str
    setting: float
    error: float
    stated: float | None
    seconds: float
    rounds: int


def measured(name: str, scene: Scene, rtol: tuple[float, ...] = _RTOL) -> list[Point]:
    """Both on a scene, in turns."""
    reference = reference_of(scene)
    trace = reference.at_times()

    def run(setting: float) -> Answer:
        result = simulate(scene, formulation="multibody", rtol=setting, cost_cap=_NO_CAP)
        return Answer(trace_of(result), result.cost.evaluations, result.error.estimated)

    ours = Contender("multibody", "rtol", rtol, run, reference.trace)
    _, best = exudyn_contenders(job_of(scene, trace.time), trace)
    rows, _ = play((ours, best), reference.start, _LONGEST)
    return [_point(name, row) for row in rows]


def _point(name: str, row: Row) -> Point:
    by = "multibody" if row.contender == "multibody" else "script"
    error = max(error for what, error in row.errors.items() if what != END)
    return Point(name, by, row.setting, error, row.stated, row.time, len(row.times))


@mpl.rc_context(STYLE)
def drawn(points: list[Point], machine: tuple[str, ...] = ()) -> Figure:
    """Wall time over error, a panel for every machine."""
    figure = Figure(figsize=(11.0, 9.0), layout="constrained")
    FigureCanvasAgg(figure)
    names = list(dict.fromkeys(point.scene for point in points))
    axes = figure.subplots(-(-len(names) // 2), 2, squeeze=False).ravel()
    for ax in axes[len(names) :]:
        ax.set_visible(False)
    by_all = {"multibody": "multibody", "script": "a script by hand, best settings"}
    for ax, name in zip(axes, names, strict=False):
        for by, label in by_all.items():
            rows = [p for p in points if (p.scene, p.by) == (name, by)]
            time = [p.seconds for p in rows]
            ax.loglog([p.error for p in rows], time, label=label, **_STYLES[by])
            if by == "multibody":
                ax.loglog([p.stated or 0.0 for p in rows], time, label="it states", **_STATED)
        ends = SCENES.get(name, {}).get("run__until")
        ax.set_title(name + (f", {ends}" if ends else ""), loc="left")
        ax.set_xlabel("relative error [1]")
        logarithmic(ax.yaxis)
        ax.set_ylabel("wall time [s]")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    if machine:
        about = "error: the worst of motion and joint forces, over their peaks"
        caption(figure, [about, *machine])
    return figure


def main(arguments: list[str] | None = None) -> int:
    """Measure, write and draw."""
    parser = argparse.ArgumentParser(
        prog="python -m validation.speed.multibody", description=__doc__
    )
    parser.parse_args(arguments)
    points = []
    for name, changes in SCENES.items():
        points += measured(name, load_scene(name).with_(**changes))
        print(*points[-11:], sep="\n", flush=True)
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(asdict(points[0])), lineterminator="\n")
        writer.writeheader()
        writer.writerows(map(asdict, points))
    figure = drawn(points, about_machine())
    write_in_one_move(FILE.with_suffix(".png"), lambda part: figure.savefig(part, format="png"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
