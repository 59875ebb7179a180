"""The table that a scene uses, its source and what was done in the header."""

from __future__ import annotations

import io
import textwrap
from pathlib import Path

import numpy as np

from crankmbs.errors import InputError
from crankmbs.indicated.findings import Indicated
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import BAR
from crankmbs.storage.files import text_in_one_move

__all__ = ["gas_lines", "write_table"]

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
    if indicated.absolute:
        _refuse_negative(table, path)
    columns = [np.degrees(table.x)]
    if isinstance(table, CylinderTable):
        names = [f"pressure_bar_{k}" for k in range(1, len(table.y) + 1)]
        columns += [np.array(each) / BAR for each in table.y]
    else:
        names = ["pressure_bar"]
        columns.append(np.array(table.y) / BAR)
    head = [*_wrapped(indicated), "as [gas] of a scene:", *gas_lines(indicated, path.name)]
    stream = io.StringIO()
    stream.writelines(f"# {line}\n" for line in head)
    stream.write(",".join(["crank_angle_deg", *names]) + "\n")
    np.savetxt(stream, np.column_stack(columns), fmt="%.10g", delimiter=",")
    text = stream.getvalue()
    if len(text) > _MOST:
        raise InputError(
            f"{path}: the table of {len(text) / 1e6:.0f} MB is larger than the {_MOST / 1e6:g} MB "
            'that a scene reads; take cycles="mean" or fewer cycles, such as cycles="1-20"'
        )
    text_in_one_move(path, text)
    return path


def _refuse_negative(table: Table | CylinderTable, path: Path) -> None:
    values = np.atleast_2d(table.y)
    cylinder, row = np.unravel_index(np.argmin(values), values.shape)
    lowest = values[cylinder, row]
    if lowest >= 0.0:
        return
    raise InputError(
        f"{path.name}: the absolute pressure of the table's column {cylinder + 1} falls to "
        f"{lowest / BAR:.3g} bar at a crank angle of {np.degrees(table.x[row]):.6g} degrees, and "
        'none is below zero; where the signal has spikes take cycles="mean", other cycles or '
        'smooth="3 deg", where its zero is off another reference, such as '
        'reference="inlet 1.0 bar"'
    )


def _wrapped(indicated: Indicated) -> list[str]:
    lines = [f"cylinder pressure from {indicated.source}"]
    for sentence in indicated.sentences:
        lines += textwrap.wrap(" ".join(sentence.split()), 96)
    return lines
