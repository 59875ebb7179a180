"""The answer of the server to a turn of a knob: one message, one block of numbers."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from crankmbs.demo.state import Data

__all__ = ["packed", "unpacked"]


def packed(number: int, error: str, state: Data) -> dict[str, list[Any]]:
    """Columns of the source that carries an answer: "json" says where in "block" a column lies.

    Thousands of numbers in one block reach the browser several times sooner than column by column.

    Parameters
    ----------
    number : of the request; error : empty, or why the state is still the last good one
    """
    plan: dict[str, dict[str, Any]] = {}
    parts = [np.empty(0)]
    at = 0
    for name, columns in state.items():
        plan[name] = {}
        for key, column in columns.items():
            if isinstance(column, np.ndarray):
                parts.append(column)
                plan[name][key] = {"from": at, "to": at + len(column)}
                at += len(column)
            else:
                plan[name][key] = column
    about = {"number": number, "error": error, "state": plan}
    return {"json": [json.dumps(about)], "block": [np.concatenate(parts)]}


def unpacked(answer: dict[str, list[Any]]) -> tuple[int, str, Data]:
    """What was `packed`, as the page's script reads it."""
    about, block = json.loads(answer["json"][0]), answer["block"][0]
    state = {
        name: {
            key: block[column["from"] : column["to"]] if isinstance(column, dict) else column
            for key, column in columns.items()
        }
        for name, columns in about["state"].items()
    }
    return about["number"], about["error"], state
