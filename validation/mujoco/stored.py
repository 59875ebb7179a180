"""What MuJoCo gave, as it is kept, so that it can be compared where MuJoCo is not installed."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["FOLDER", "OF_CRANK", "OF_CYLINDERS", "Stored", "read_stored", "write_stored"]

FOLDER = Path(__file__).parent
OF_CRANK = (
    "crank_angle",
    "crank_speed",
    "crank_acceleration",
    "external_torque",
    "main_bearing_force_x",
    "main_bearing_force_y",
)
OF_CYLINDERS = (
    "piston_position",
    "piston_velocity",
    "piston_acceleration",
    "rod_angular_acceleration",
    "applied_force",
    "side_force",
    "crank_pin_force_x",
    "crank_pin_force_y",
    "piston_pin_force_x",
    "piston_pin_force_y",
)
_SOURCE = """\
# Crank trains as bodies of MuJoCo, integrated by SciPy's DOP853 (validation/mujoco/motion.py).
# SI units; names and signs are those of a result. Rewritten by: python -m validation.mujoco
"""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Stored:
    """Of one scene, by MuJoCo.

    version : of MuJoCo; samples : their numbers in a run of the scene, from 0
    numbers : by the names of a result, shape (samples,), of the cylinders (samples, cylinders)
    errors : by the same names, the largest difference of two divisions of the integrator's steps
    """

    version: str
    samples: tuple[int, ...]
    numbers: Mapping[str, Floats]
    errors: Mapping[str, float]


def read_stored(folder: Path = FOLDER) -> dict[str, Stored]:
    """What is kept, by the name of the scene; nothing where nothing is."""
    if not (folder / "scenes.csv").is_file():
        return {}
    crank, cylinders = (_by_scene(_rows(folder / f"{name}.csv")) for name in ("crank", "cylinders"))
    return {
        row["scene"]: _of_rows(row, crank[row["scene"]], cylinders[row["scene"]])
        for row in _rows(folder / "scenes.csv")
    }


def write_stored(found: Mapping[str, Stored], folder: Path = FOLDER) -> None:
    """Keep it, twelve digits of each number."""
    heads: list[list[Any]] = []
    of_crank: list[list[Any]] = []
    of_cylinders: list[list[Any]] = []
    for name, one in sorted(found.items(), key=_order):
        errors = [f"{one.errors[v]:.1e}" for v in (*OF_CRANK, *OF_CYLINDERS)]
        heads.append([name, one.version, *errors])
        for n, sample in enumerate(one.samples):
            of_crank.append([name, sample, *(_digits(one.numbers[v][n]) for v in OF_CRANK)])
            of_each = zip(*(one.numbers[v][n] for v in OF_CYLINDERS), strict=True)
            for k, values in enumerate(of_each):
                of_cylinders.append([name, sample, k + 1, *map(_digits, values)])
    _write(folder / "scenes.csv", ["scene", "mujoco", *OF_CRANK, *OF_CYLINDERS], heads)
    _write(folder / "crank.csv", ["scene", "sample", *OF_CRANK], of_crank)
    _write(folder / "cylinders.csv", ["scene", "sample", "cylinder", *OF_CYLINDERS], of_cylinders)


def _of_rows(
    head: Mapping[str, str], crank: list[dict[str, str]], cylinders: list[dict[str, str]]
) -> Stored:
    samples = tuple(int(row["sample"]) for row in crank)
    numbers = {name: np.array([float(row[name]) for row in crank]) for name in OF_CRANK}
    for name in OF_CYLINDERS:
        column = np.array([float(row[name]) for row in cylinders])
        numbers[name] = column.reshape(len(samples), -1)
    return Stored(head["mujoco"], samples, numbers, {name: float(head[name]) for name in numbers})


def _order(item: tuple[str, Stored]) -> tuple[str, int]:
    kind, _, seed = item[0].partition(" ")
    return kind, int(seed or 0)


def _by_scene(rows: Iterable[dict[str, str]]) -> dict[str, list[dict[str, str]]]:
    found: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        found.setdefault(row["scene"], []).append(row)
    return found


def _rows(path: Path) -> Iterator[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        yield from csv.DictReader(line for line in file if not line.startswith("#"))


def _write(path: Path, header: list[str], rows: list[list[Any]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(_SOURCE)
        csv.writer(file, lineterminator="\n").writerows([header, *rows])


def _digits(value: float) -> str:
    return f"{value:.12g}"
