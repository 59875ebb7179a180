"""What is found in measured pressures against what was put into them."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from crankmbs.indicated import CylinderPressure, read_pressure
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.measured import (
    Array,
    Engine,
    loss_angle,
    mean_effective_pressure,
    pressure_of,
)

__all__ = ["dead_centre", "imep", "offsets"]

_DEAD_CENTRES = (-1.1, -0.35, 0.0, 0.2, 0.9)  # degrees
_ANGLE = np.arange(-360.0, 360.0, 0.5)
_CYCLES = 50
_HEAD = (
    "Stroke;{stroke};mm\nConrod length;{rod};mm\nCompression ratio;{ratio}\n"
    "Crank Angle;{names}\ndeg;{units}\n"
)


def dead_centre(case: Case) -> Outcome:
    """Largest error of a motored dead centre [deg], its loss angle known, over several of them."""
    engine = Engine()
    given = case.number("loss_angle")
    errors = []
    for at in _DEAD_CENTRES:
        found = _read(
            engine,
            _cycles(engine, at, noise=0.2),
            reference="absolute",
            loss_angle=math.radians(given),
        )
        assert found.dead_centre is not None
        errors.append(abs(found.dead_centre.middle - at))
    return Outcome(
        max(errors),
        f"{_CYCLES} cycles with noise of 0.2 bar, the loss angle {loss_angle(engine):.4f} degrees",
    )


def offsets(case: Case) -> Outcome:
    """Largest error [bar] of the offsets that the inlet takes off, cycle by cycle."""
    engine = Engine(heat=15.0)
    put_in = 3.0 + 0.05 * np.arange(_CYCLES)
    cycles = _cycles(engine, 0.0, noise=0.02) - put_in[:, None]
    found = _read(engine, cycles, reference=f"inlet {case.number('inlet'):.9g} bar")
    errors = np.abs(found.offset / 1e5 - put_in)
    return Outcome(float(np.max(errors)), f"{_CYCLES} cycles, offsets from 3 to {put_in[-1]:g} bar")


def imep(case: Case) -> Outcome:
    """Largest error [bar] of the imep, motored and fired, with the dead centre put right."""
    at, errors = 0.5, []
    tdc = math.radians(case.number("firing_tdc"))
    for engine in (Engine(), Engine(heat=15.0), Engine(heat=8.0, burns=3.0)):
        found = _read(engine, _cycles(engine, at, noise=0.0), reference="absolute", firing_tdc=tdc)
        assert found.imep is not None
        exact = mean_effective_pressure(engine)
        errors.append(float(np.max(np.abs(found.imep / 1e5 - exact))))
    return Outcome(max(errors), "a motored and two fired cycles, their dead centre off by 0.5")


def _cycles(engine: Engine, at: float, noise: float) -> Array:
    """Cycles [bar] of a file whose dead centre lies so many degrees before the true one."""
    rng = np.random.default_rng(7)
    clean = pressure_of(engine, _ANGLE - at)
    return np.asarray(clean + noise * rng.standard_normal((_CYCLES, len(_ANGLE))))


def _read(engine: Engine, cycles: Array, **options: Any) -> CylinderPressure:
    """What is read of a file with these cycles."""
    count = len(cycles)
    head = _HEAD.format(
        stroke=2.0 * engine.radius,
        rod=engine.rod_length,
        ratio=engine.ratio,
        names=";".join(f"PCYL1 cycle {k + 1}" for k in range(count)),
        units=";".join(["bar"] * count),
    )
    rows = np.column_stack([_ANGLE, *cycles])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "export.csv")
        with path.open("w", encoding="utf-8") as file:
            file.write(head)
            np.savetxt(file, rows, fmt="%.5f", delimiter=";")
        (cylinder,) = read_pressure(path, **options).cylinders
    return cylinder
