"""Findings of a measured file: its cylinders, the table for a scene, and what was done."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crankmbs.indicated.dead_centre import DeadCentre
from crankmbs.indicated.shape import Shape
from crankmbs.indicated.speed import MeasuredSpeed
from crankmbs.indicated.write import write_table
from crankmbs.numerics.arrays import Array
from crankmbs.scene.tables import CylinderTable, Table

__all__ = ["CylinderPressure", "Indicated", "Level"]


class Level(NamedTuple):
    """What pressures are measured from: whether they are absolute; pegged : whether that rests on
    a polytrope through their compression."""

    absolute: bool
    pegged: bool

    @property
    def shows_dead_centre(self) -> bool:
        """Whether a compression shows its dead centre: p + c = C V^-n fits one that is degrees off
        as well as the true one, with another c."""
        return self.absolute and not self.pegged


@dataclass(frozen=True, eq=False)
class CylinderPressure:
    """The cycles of one cylinder, referenced.

    angle : shape (n,) [deg] from its firing dead centre, over one period
    pressure : shape (cycles, n) [Pa]; offset : shape (cycles,) [Pa] that was added
    firing : the file's angle [deg] of its firing dead centre; lag [deg]: behind the first cylinder,
        measured between the flanks of their compression
    imep : shape (cycles,) [Pa]; None without a geometry; imep_within [Pa] : least and largest of
        its mean with the dead centre where it may lie, None where nothing tells that;
        imep_a_degree [Pa] : what it changes by with a dead centre one degree later
    fired : whether it burns; None where that cannot be told
    dead_centre : where the true dead centre lies from that used; None where nothing tells
    noise [Pa] : standard deviation of a row; closure [Pa] : the median step from a cycle to the
        next; moved : what smoothing did to peak [Pa], its angle [deg] and imep [Pa], None without
    """

    number: int
    name: str
    angle: Array
    pressure: Array
    offset: Array
    firing: float
    lag: float
    imep: Array | None
    fired: bool | None
    dead_centre: DeadCentre | None
    noise: float
    closure: float
    moved: tuple[float, float, float] | None = None
    imep_within: tuple[float, float] | None = None
    imep_a_degree: float | None = None

    @property
    def mean(self) -> Array:
        """The mean cycle, shape (n,) [Pa]."""
        return np.asarray(np.mean(self.pressure, axis=0))

    @property
    def peaks(self) -> Array:
        """The highest pressure of each cycle, shape (cycles,) [Pa]."""
        return np.asarray(np.max(self.pressure, axis=1))

    @property
    def lowered(self) -> float:
        """By how much [Pa] the mean cycle's peak is below the mean of the peaks."""
        return float(np.mean(self.peaks) - np.max(self.mean))


@dataclass(frozen=True, eq=False)
class Indicated:
    """What `read_pressure` returns.

    source : the file; stroke : 2 or 4; absolute : whether the pressures are, else gauge
    aligned : whether each column of the table runs over the cycle angle of its cylinder
    table : crank angle [rad] and pressure [Pa], as `Gas.pressure` takes it
    cycles : what it holds, "mean" or "sequence"
    speed : over the crank angle, of a record over time; None otherwise
    sentences : all that was read and done; those that need a look begin with "warning:"
    """

    source: str
    stroke: int
    absolute: bool
    aligned: bool
    cycles: str
    cylinders: tuple[CylinderPressure, ...]
    shape: Shape | None
    table: Table | CylinderTable
    sentences: tuple[str, ...]
    speed: MeasuredSpeed | None = None

    def __str__(self) -> str:
        return "\n".join(self.sentences)

    def __repr__(self) -> str:
        count = len(self.cylinders[0].pressure)
        return f"<Indicated {self.source}: {len(self.cylinders)} cylinders, {count} cycles>"

    @property
    def warnings(self) -> tuple[str, ...]:
        """The sentences that need a look."""
        return tuple(each for each in self.sentences if each.startswith("warning:"))

    def save(self, path: str | Path) -> Path:
        """Write the table that a scene uses, with its source and what was done in its header.

        Raises
        ------
        InputError : a table larger than a scene reads; OutputError : the file cannot be written
        """
        return write_table(self, Path(path))
