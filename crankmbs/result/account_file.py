"""The account of a run in files: variables of the netCDF beside the samples, and CSV."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import Variable
from crankmbs.motion.account import Account, Kind, Rows
from crankmbs.motion.cycles import Cycles
from crankmbs.motion.labels import CYCLES, EVENTS, Table, dims_of
from crankmbs.numerics.arrays import Array, Labelled
from crankmbs.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["DIMS", "account_in", "with_account", "write_rows"]


@dataclass(frozen=True)
class _Stored:
    """How rows are stored: each column by its name behind the one of the rows."""

    rows: str
    about: dict[str, Variable]
    dims: Callable[[str], tuple[str, ...]]

    def variables(self, rows: Rows) -> Labelled:
        """The columns as variables of a file."""
        return {
            f"{self.rows}_{name}": self.about[name].labelled(
                values, rows.errors[name], self.dims(name)
            )
            for name, values in rows.columns.items()
        }

    def read(self, data: xr.Dataset, empty: Mapping[str, Array], left_out: int) -> Rows:
        """The rows that a file holds, with the columns of empty ones; these where it has none."""
        if self.rows not in data.dims:
            return Rows(empty, dict.fromkeys(empty, 0.0), left_out)
        stored = {name: data[f"{self.rows}_{name}"] for name in empty}
        columns = {name: column.values for name, column in stored.items()}
        errors = {name: float(column.attrs["error_estimate"]) for name, column in stored.items()}
        return Rows(columns, errors, left_out)


_NUMBERED = {"number": Variable("1", "number, from 1 at the start"), **CYCLES}
_EVENTS = _Stored("event", EVENTS, lambda _: ("event",))
_CYCLES = _Stored("cycle", _NUMBERED, lambda name: dims_of(name) if name in CYCLES else ("cycle",))
DIMS = {f"event_{name}": _EVENTS.dims(name) for name in EVENTS}
DIMS |= {f"cycle_{name}": _CYCLES.dims(name) for name in _NUMBERED}
"""The dimensions of what an account adds to a file, by its name there."""


_LOADS = ("load", "force")
"""The dimensions of what acts from outside."""


def with_account(variables: Labelled, account: Account) -> Labelled:
    """The variables with the rows of an account beside them."""
    data = dict(variables)
    for stored, rows in ((_EVENTS, account.events), (_CYCLES, account.cycles)):
        if rows.count:
            data |= stored.variables(rows)
            data[stored.rows] = ((stored.rows,), np.arange(1, rows.count + 1), {})
    for of in _LOADS:
        if f"cycle_{of}_work" in data:
            count = data[f"cycle_{of}_work"][1].shape[1]
            data[of] = ((of,), np.arange(1, count + 1), {})
    return data


def account_in(
    data: xr.Dataset, scene: Scene, left_out: tuple[int, int]
) -> tuple[Account, xr.Dataset]:
    """The account that `with_account` has put beside the data of a scene, and these alone.

    left_out : events and cycles

    Raises
    ------
    ValueError, KeyError : it is no account of this scene
    """
    none = dict.fromkeys(EVENTS, np.empty(0)), Cycles(crank_train(scene), 0.0).rows(0).columns
    counts = dict(zip(_LOADS, (len(scene.torque), len(scene.force)), strict=True))
    if any(data.sizes.get(of, count) != count for of, count in counts.items()):
        raise ValueError("loads of another scene")
    account = Account(
        _EVENTS.read(data, none[0], left_out[0]), _CYCLES.read(data, none[1], left_out[1])
    )
    of_loads = (Kind.LOAD_ON, Kind.LOAD_OFF)
    most = {Kind.FUEL: len(scene.cylinders), **dict.fromkeys(of_loads, sum(counts.values()))}
    codes, numbers = (account.events.columns[name].tolist() for name in ("kind", "number"))
    for code, number in zip(codes, numbers, strict=True):
        if Kind(code) in most and number not in range(1, most[Kind(code)] + 1):
            raise ValueError(f"an event of number {number}")
    return account, data.drop_dims(["event", "cycle", *_LOADS], errors="ignore")


def write_rows(table: Table, file: Path) -> None:
    """Write a table as CSV, a line for each of its rows; what has a value for each cylinder or
    load in as many columns."""
    columns: dict[str, list[str]] = {}
    rows = table.coordinates[0]
    for name, (dims, values, attrs) in table.variables.items():
        if dims[0] != rows or name == "event":
            continue
        unit = f" [{attrs['units']}]" if "units" in attrs else ""
        if values.ndim == 1:
            columns[f"{name}{unit}"] = _cells(values.tolist())
        else:
            for k, column in enumerate(values.T.tolist(), start=1):
                columns[f"{name} {k}{unit}"] = _cells(column)
    with file.open("w", newline="", encoding="utf-8") as stream:
        lines = csv.writer(stream, lineterminator="\n")
        lines.writerows([list(columns), *zip(*columns.values(), strict=True)])


def _cells(values: Sequence[object]) -> list[str]:
    return [f"{value:.12g}" if isinstance(value, float) else str(value) for value in values]
