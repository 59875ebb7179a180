"""The limit: the same machine written out in C, compiled when it is measured."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

from crankmbs.numerics.collocation import gauss
from crankmbs.scene.units import DEGREE
from crankmbs.work_precision.contender import Answer, Contender
from crankmbs.work_precision.trace import Trace
from validation.speed.job import Job, NotServed
from validation.speed.reduced import parameters

__all__ = ["LANES", "dop853_contenders", "gauss_contenders", "library"]

Array = NDArray[np.float64]

LANES = 32
"""Cases beside one another, as in cell.h."""

_SOURCE = Path(__file__).parent / "limit.c"
_FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-shared", "-fPIC")
_STAGES = 4  # as in limit.c
_WIDEST = (90.0, 45.0, 22.5, 12.0, 6.0, 3.0)  # deg
_STEPS_PER_TURN = (8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0)


def gauss_contenders(job: Job, reference: Trace) -> tuple[Contender, ...]:
    """Gauss collocation over the crank angle.

    Raises
    ------
    NotServed : no C compiler; a viscous torque; a start at rest or backwards
    """
    if job.viscous != 0.0 or not job.omega > 0.0:
        raise NotServed("written for a crank that turns forwards, without a viscous torque")
    rule = gauss(_STAGES)
    call = _function("theta_gauss", job, [rule.nodes, rule.matrix, rule.weights])
    return (
        Contender(
            name="C, Gauss over theta",
            knob="deg",
            settings=_WIDEST,
            run=lambda widest: call(widest * DEGREE),
            reference=reference,
        ),
    )


def dop853_contenders(job: Job, reference: Trace) -> tuple[Contender, ...]:
    """DOP853 in time, with a fixed step and SciPy's coefficients.

    Raises
    ------
    NotServed : no C compiler
    """
    call = _function("dop853", job, [DOP853.A[:12, :12], DOP853.B])
    return (
        Contender(
            name="C, DOP853 in time",
            knob="steps/rev",
            settings=_STEPS_PER_TURN,
            run=lambda steps: call(round(steps * job.turns)),
            reference=reference,
        ),
    )


def _function(name: str, job: Job, method: Sequence[Array]) -> Callable[[float], Answer]:
    """A function of limit.c with everything but its setting filled in."""
    function = getattr(library(), name)
    machine = [parameters(job), job.alone.knots, job.alone.force]
    held = [np.ascontiguousarray(array, dtype=np.float64) for array in (*machine, *method)]
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in held]  # they keep the arrays
    pieces, end = ctypes.c_int(len(job.alone.knots) - 1), ctypes.c_double(job.end)
    before, after = [*pointers[:3], pieces], pointers[3:]

    def call(setting: float) -> Answer:
        state = np.array([job.theta, job.omega])
        evaluations = function(
            *before, *after, ctypes.c_double(setting), end, state.ctypes.data_as(ctypes.c_void_p)
        )
        if evaluations < 0:
            raise RuntimeError("the energy is used up before the end")
        return Answer(Trace(job.times[-1:], state[:1], state[1:]), evaluations)

    return call


@cache
def library(source: Path = _SOURCE) -> ctypes.CDLL:
    """limit.c, or another file in C, compiled and loaded.

    Raises
    ------
    NotServed : no C compiler, or it cannot compile it
    """
    names = (os.environ.get("CC", ""), "cc", "gcc", "clang")
    compiler = next((path for name in names if name and (path := shutil.which(name))), None)
    if compiler is None:
        raise NotServed("no C compiler found; set CC, or install cc, gcc or clang")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "limit.so"
        command = [compiler, *_FLAGS, "-o", str(target), str(source), "-lm"]
        made = subprocess.run(command, capture_output=True, text=True, check=False)
        if made.returncode != 0:
            raise NotServed(f"{compiler} cannot compile it: {made.stderr.strip()}")
        return ctypes.CDLL(str(target))
