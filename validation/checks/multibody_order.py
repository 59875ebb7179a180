"""The order of one multibody run: its errors against the oracles, over the size of its step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import closing
from itertools import pairwise
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from crankmbs.figures.style import STYLE, line_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.cells import cell_of
from crankmbs.motion.mode import begun
from crankmbs.motion.multibody.answer import free
from crankmbs.motion.multibody.forces import EVERYWHERE, Limits
from crankmbs.motion.multibody.integrate import integrate
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.runs import motion_of
from crankmbs.scene.scene import Scene
from validation.adapter import reference_motion, reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import Array as Exact
from validation.plots import Array
from validation.runs import run

__all__ = ["observed_order", "order_of"]

_ORDER = 2.0  # of generalized alpha
_STEPS_PER_TURN = 125  # of the coarsest run, as the formulation takes
_MOST = 10_000_000  # steps
_AGREE = 0.2  # so near must the last two local slopes be to be an order
_FLOOR = 1e-12  # errors below it are rounding
_BEARING = ("main_bearing_force_x", "main_bearing_force_y")


class _Errors(NamedTuple):
    """steps [s], and by quantity the relative error at each of them; shape (n,)."""

    steps: Array
    by_quantity: dict[str, Array]


def observed_order(case: Case) -> Outcome:
    """How far the order of single runs, without extrapolation, is from 2.

    The error of the motion is that of the crank angle at equal times per radian turned; that of the
    bearing force is relative to its peak. The parameter `runs` says how many step sizes, each half
    the one before, begin with the coarsest that the formulation takes. Infinite where no quantity
    shows an order.
    """
    found = _errors(case.ours(), case.theirs(), round(case.number("runs")))
    orders = {name: order_of(errors) for name, errors in found.by_quantity.items()}
    shown = {name: order for name, order in orders.items() if order is not None}
    words = [
        f"{name}: " + ("no order" if order is None else f"order {order:.2f}")
        for name, order in orders.items()
    ]
    steps = f"steps of {found.steps[0]:.3g} to {found.steps[-1]:.3g} s"
    return Outcome(
        max((abs(order - _ORDER) for order in shown.values()), default=math.inf),
        f"{steps}; {'; '.join(words)}",
        _table(found),
        {case.name: _figure(case, found, shown)},
    )


def order_of(errors: Array) -> float | None:
    """The mean of the last two local slopes of errors at steps halved again and again, shape (n,).

    None where the two differ by more than 0.2, or an error in them is rounding.
    """
    last = errors[-3:]
    if len(last) < 3 or not np.all(last > _FLOOR):
        return None
    before, after = (math.log2(coarse / fine) for coarse, fine in pairwise(last))
    return 0.5 * (before + after) if abs(after - before) <= _AGREE else None


def _errors(ours: Scene, theirs: Scene, count: int) -> _Errors:
    reference = run(theirs, "crank_angle")  # only its samples' crank angles are used
    motion = reference_motion(reference, theirs)
    exact = reference_variables(theirs, motion.theta, motion.omega, motion.alpha)
    train, time = crank_train(ours), motion.time.astype(np.float64)
    assert ours.start is not None
    start = State(0.0, ours.start.angle, ours.start.speed, 0.0, begun(train))
    limits = Limits(float(time[-1]), EVERYWHERE, _MOST)
    steps = 2.0 * math.pi / abs(ours.start.speed) / _STEPS_PER_TURN / 2.0 ** np.arange(count)
    with closing(Model(train)) as model:
        paths = [integrate(model, start, limits, float(step)) for step in steps]
        angles, runs = motion.theta.astype(np.float64), []
        for passed in (motion_of(model.forces, path) for path in paths):
            k = cell_of(np.array([piece.end.theta for piece in passed.pieces]), angles)
            runs.append(free(model, passed.modes, k, k, passed.at(k, angles, in_time=False)))
    turned, peak = float(np.ptp(motion.theta)), _length(exact)
    late = [(own["time"] - motion.time) * motion.omega / turned for own in runs]
    missed = [{name: own[name] - exact[name] for name in _BEARING} for own in runs]
    return _Errors(
        np.asarray(steps, dtype=np.float64),
        {
            "motion": np.array([float(np.max(np.abs(values))) for values in late]),
            "main bearing": np.array([_length(force) / peak for force in missed]),
        },
    )


def _length(force: Mapping[str, Exact]) -> float:
    """The largest magnitude of the main bearing's force."""
    x, y = (force[name].astype(np.float64) for name in _BEARING)
    return float(np.max(np.hypot(x, y)))


def _table(found: _Errors) -> tuple[str, ...]:
    heads = [f"{name} | its local slope" for name in found.by_quantity]
    lines = [f"| step [s] | {' | '.join(heads)} |", "|---" * (2 * len(heads) + 1) + "|"]
    for k, step in enumerate(found.steps):
        cells = [f"{step:.4g}"]
        for errors in found.by_quantity.values():
            slope = f"{math.log2(errors[k - 1] / errors[k]):.2f}" if k else ""
            cells += [f"{errors[k]:.2e}", slope]
        lines.append(f"| {' | '.join(cells)} |")
    return tuple(lines)


def _figure(case: Case, found: _Errors, orders: Mapping[str, float]) -> Figure:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.5, 5.5), layout="constrained")
        FigureCanvasAgg(figure)
        ax = figure.subplots()
        for k, (name, errors) in enumerate(found.by_quantity.items()):
            order = f"order {orders[name]:.2f}" if name in orders else "no order"
            ax.loglog(found.steps, errors, **line_of(k) | {"marker": "o"}, label=f"{name}: {order}")
            guide = errors[0] * (found.steps / found.steps[0]) ** _ORDER
            ax.loglog(found.steps, guide, color="0.6", linewidth=1.0, zorder=0)
        ax.lines[-1].set_label("order 2")
        ax.set_xlabel("step [s]")
        ax.set_ylabel("relative error [1]")
        ax.set_title(f"{case.scene.replace('_', ' ')}: one multibody run", loc="left")
        ax.legend()
    return figure
