"""The table that a scene uses, its source and what was done in the header."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.scene.tables import CylinderTable
from crankmbs.scene.units import BAR
from crankmbs.storage.files import text_in_one_move

if TYPE_CHECKING:
    from crankmbs.indicated.findings import Indicated

__all__ = ["gas_lines", "table_text", "write_table"]

_MOST = 32_000_000  # bytes that a scene reads


def gas_lines(indicated: Indicated, name: str) -> list[str]:
    """What [gas] of a scene says of the table."""
    lines = [f'pressure = "{name}"']
    lines += ['ambient = "1 bar"'] if indicated.absolute else ["absolute = false"]
    lines += ["stroke = 2"] if indicated.stroke == 2 else []
    lines += ["aligned = true"] if indicated.aligned else []
    return lines + (['cycles = "sequence"'] if indicated.cycles == "sequence" else [])


def write_table(indicated: Indicated, path: Path) -> Path:
    """Write the table as CSV, in degrees and bar.

    Raises
    ------
    InputError : larger than a scene reads, or an absolute pressure below zero
    OutputError : the file cannot be written
    """
    table = indicated.table
    rows = np.atleast_2d(table.y)
    if indicated.absolute:
        _refuse_negative(rows, np.degrees(table.x), path, mean=indicated.cycles == "mean")
    names = ["pressure_bar"]
    if isinstance(table, CylinderTable):
        names = [f"pressure_bar_{k}" for k in range(1, len(rows) + 1)]
    columns = {"crank_angle_deg": np.degrees(table.x), **dict(zip(names, rows / BAR, strict=True))}
    source = f"cylinder pressure from {indicated.source}"
    usage = ["as [gas] of a scene:", *gas_lines(indicated, path.name)]
    text = table_text(source, indicated.sentences, usage, columns)
    if len(text) > _MOST:
        raise InputError(
            f"{path}: the table of {len(text) / 1e6:.0f} MB is larger than the {_MOST / 1e6:g} MB "
            'that a scene reads; take cycles="mean" or fewer cycles, such as cycles="1-20"'
        )
    text_in_one_move(path, text)
    return path


def table_text(
    source: str, sentences: Sequence[str], usage: Sequence[str], columns: dict[str, Array]
) -> str:
    """A table as CSV, its columns by their names, below its source, what was done and the lines
    with which a scene uses it."""
    wrapped = [line for sentence in sentences for line in textwrap.wrap(sentence, 96)]
    stream = io.StringIO()
    stream.writelines(f"# {line}\n" for line in (source, *wrapped, *usage))
    stream.write(",".join(columns) + "\n")
    np.savetxt(stream, np.column_stack(list(columns.values())), fmt="%.10g", delimiter=",")
    return stream.getvalue()


def _refuse_negative(rows: Array, degrees: Array, path: Path, *, mean: bool) -> None:
    cylinder, row = np.unravel_index(np.argmin(rows), rows.shape)
    lowest = rows[cylinder, row]
    if lowest >= 0.0:
        return
    others = "" if mean else 'cycles="mean", '
    raise InputError(
        f"{path.name}: the absolute pressure of the table's column {cylinder + 1} falls to "
        f"{lowest / BAR:.3g} bar at a crank angle of {degrees[row]:.6g} degrees, and "
        f"none is below zero; where the signal has spikes take {others}other cycles or "
        'smooth="3 deg", where its zero is off another reference, such as '
        'reference="inlet 1.0 bar"'
    )
