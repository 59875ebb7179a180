"""All that the page shows of one outcome: columns for its sources, and words."""

from __future__ import annotations

import html
import itertools
from collections.abc import Callable, Iterable
from typing import Any

from crankmbs.demo import columns
from crankmbs.demo.outcome import Outcome
from crankmbs.demo.views import STORES
from crankmbs.errors import InputError
from crankmbs.measures import fluctuation, mean_speed
from crankmbs.scene.units import RPM

__all__ = ["ALL", "Data", "state_of"]

Data = dict[str, dict[str, Any]]

ALL = range(len(STORES))
_SERIAL = itertools.count()


def state_of(outcome: Outcome, force: float, tabs: Iterable[int] = ALL) -> Data:
    """Columns of every source; of the tabs' sources those asked for, by their number.

    force [N] : divisor of the forces
    """
    columns_of: dict[str, Callable[[], dict[str, Any]]] = {
        "speed": lambda: columns.speeds(outcome),
        "motion": lambda: columns.moves(outcome),
        "thrust": lambda: columns.thrusts(outcome, force),
        "budget": lambda: columns.budgets(outcome, force),
        "bearing": lambda: columns.bearings(outcome, force),
    }
    marks = outcome.view.dead_centre_labels()
    state: Data = {
        "frames": columns.frames(outcome, force),
        "shapes": columns.shapes(outcome),
        "chosen": {"cylinder": [outcome.cylinder], "serial": [next(_SERIAL)]},  # never unchanged
        "dead": {"x": list(marks), "label": [text.replace("\n", ": ") for text in marks.values()]},
        "numbers": {"text": [_numbers(outcome)]},
    }
    state |= {STORES[tab]: columns_of[STORES[tab]]() for tab in tabs}
    if "budget" in state:
        state["words"] = _sentences(outcome)
    return state


def _numbers(outcome: Outcome) -> str:
    """How it was run and how far it can be trusted, in one line of HTML."""
    result = outcome.result
    window = outcome.view.window
    swing = fluctuation(result, window)
    speed = mean_speed(result, window)
    cells = (
        ("mean speed", f"{speed.value / RPM:.1f} rpm"),
        ("fluctuation", f"{100.0 * swing.value:.3f} %"),
        ("formulation", result.formulation),
        ("relative error", f"{result.error.estimated:.0e}, asked {result.error.asked:.0e}"),
    )
    return " &nbsp; ".join(f"{name} <b>{html.escape(value)}</b>" for name, value in cells)


def _sentences(outcome: Outcome) -> dict[str, list[str]]:
    """What each cause is worth, in words, for every quantity of the budget."""
    words = {}
    for name in columns.BUDGETED:
        try:
            split = outcome.budget.split(name)
        except InputError:
            words[name] = ["It is zero but for rounding."]
            continue
        words[name] = [html.escape(split.sentence().removeprefix(f"{name}: ")) + "."]
    return words
