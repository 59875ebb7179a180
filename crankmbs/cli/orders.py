"""What ``run`` prints and writes of orders, and of one crank angle."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path

import numpy as np

from crankmbs.cli.text import cells, table
from crankmbs.compare import AtAngle
from crankmbs.digits import digits
from crankmbs.measures import EngineOrder, EngineOrders
from crankmbs.report.readings import passed_at, reading_remarks, reading_tables
from crankmbs.scene.units import RPM

__all__ = ["orders_report", "reading_report", "save_orders"]

_SMALL = 1e-6  # of the largest amplitude: not printed, but written


def orders_report(orders: EngineOrders) -> str:
    """The orders as one table, those that are not rounding beside the largest."""
    rows = [line for row in orders.rows for line in _lines(row)]
    headings = [
        f"orders over the {orders.window.kind}",
        "order",
        "amplitude",
        "num. error",
        "phase [deg]",
    ]
    speed = digits(orders.speed.value / RPM, orders.speed.error / RPM, most=8)
    return "\n".join(
        [
            "",
            table([*headings, "closed form", "phase [deg]"], rows),
            "amplitude cos(order crank angle + phase); closed form: inertia alone, at a constant "
            f"{speed} rpm",
        ]
    )


def save_orders(orders: EngineOrders, folder: Path) -> Path:
    """Write orders.csv: every order of every quantity."""
    names, columns = ["order"], [orders.rows[0].orders.order]
    for row in orders.rows:
        split = row.orders
        names += [f"{row.quantity} [{row.units}]", f"{row.quantity} phase [deg]"]
        columns += [split.amplitude, np.degrees(split.phase)]
        names.append(f"{row.quantity} error [{row.units}]")
        columns.append(np.full_like(split.order, split.error))
        if row.closed is not None:
            names.append(f"{row.quantity} closed form [{row.units}]")
            names.append(f"{row.quantity} closed form phase [deg]")
            columns += [np.abs(row.closed), np.degrees(np.angle(row.closed))]
    file, numbers = folder / "orders.csv", np.column_stack(columns)
    np.savetxt(file, numbers, fmt="%.15g", delimiter=",", header=",".join(names), comments="")
    return file


def reading_report(state: AtAngle) -> str:
    """Every quantity at one crank angle."""
    tables = [f"\n{table(*each)}" for each in reading_tables(state)]
    remarks = [textwrap.fill(remark, 100) for remark in reading_remarks(state)]
    return "\n".join([*tables, passed_at(state), *remarks])


def _lines(row: EngineOrder) -> list[list[str]]:
    split, name = row.orders, f"{row.quantity} [{row.units}]"
    closed = np.zeros(len(split.order), dtype=complex) if row.closed is None else row.closed
    largest = max(float(split.amplitude.max()), float(np.abs(closed).max()))
    least = max(split.error, _SMALL * largest)
    lines = []
    for k in np.flatnonzero(np.maximum(split.amplitude, np.abs(closed)) > least):
        size, theirs = float(split.amplitude[k]), float(abs(closed[k]))
        there = [digits(theirs), _degrees(float(np.angle(closed[k])), theirs, least)]
        lines.append(
            [
                name,
                f"{split.order[k]:g}",
                *cells((size, split.error)),
                _degrees(float(split.phase[k]), size, split.error),
                *(there if row.closed is not None else ["", ""]),
            ]
        )
    return lines


def _degrees(phase: float, size: float, error: float) -> str:
    """A phase in degrees, to the digits that an error of this size in the wave leaves."""
    off = math.degrees(error / size) if size > 0.0 else math.inf
    return digits(math.degrees(phase), off) if off < 90.0 else "-"
