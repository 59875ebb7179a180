"""Exports as indicating systems write them, made from cycles that are known."""

import numpy as np

from validation.oracles.measured import Engine, pressure_of

MOTORED = Engine()
FIRED = Engine(heat=15.0)
HEADER = "Bore;85,25;mm\nStroke;92;mm\nConrod length;153,3333;mm\nCompression ratio;18\n"


def cycles(engine, angle, count, *, noise=0.0, offset=0.0, dead_centre=0.0, seed=1):
    """Cycles [bar], shape (count, n): the file's dead centre lies so many degrees before the
    true one; the offset grows by a tenth from one cycle to the next."""
    rng = np.random.default_rng(seed)
    clean = pressure_of(engine, angle - dead_centre)
    added = offset * (1.0 + 0.1 * np.arange(count))[:, None]
    return clean + added + noise * rng.standard_normal((count, len(angle)))


def text(columns, names, units=None, *, head="", separator=";", comma=True, digits=4):
    """Rows of columns under names and units."""
    lines = [separator.join(names)]
    lines += [separator.join(units)] if units else []
    for row in np.column_stack(columns):
        cells = [f"{value:.{digits}f}" for value in row]
        lines.append(separator.join(cells))
    body = "\n".join(lines[1 + bool(units) :])
    body = body.replace(".", ",") if comma else body
    return head + "\n".join(lines[: 1 + bool(units)]) + "\n" + body + "\n"


def columns_of_cycles(angle, values, *, head=HEADER, reference=""):
    """Cycles in columns of one cylinder."""
    names = ["Crank Angle", *(f"PCYL1 cycle {k + 1}" for k in range(len(values)))]
    return text([angle, *values], names, ["deg", *[f"bar{reference}"] * len(values)], head=head)
