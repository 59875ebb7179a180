"""A random scene judged: the worst true over stated error of a run in each formulation."""

from __future__ import annotations

import math
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import FrameType

import numpy as np

from crankmbs.errors import InputError
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import machine_of, reference_motion
from validation.checks.honest import scales, true_errors
from validation.oracles.arithmetic import LONG
from validation.oracles.free_motion import Motion, series_path
from validation.oracles.path import Path
from validation.random_scenes import random_scene

__all__ = ["Judgement", "judge", "judge_seed"]

_FLOOR = 2e-11  # of the peak of what has the same unit: there no statement is asked for
# of the squared speed: the points of the bodies accelerate by multiples of it and of the crank's
# acceleration, which the oracle that solves for all of them at once knows to their rounding only
_ROUNDED = 4.0 * float(LONG.epsilon)


@dataclass(frozen=True)
class Judgement:
    """Of one run: its worst true over stated error, None where it could not be judged."""

    seed: int
    formulation: str
    ratio: float | None
    said: str


class _TooLongError(Exception):
    pass


def judge_seed(seed: int, formulations: Sequence[str], patience: float) -> list[Judgement]:
    """Judge the scene of a seed; with more than ``patience`` [s] of wall time it is given up."""
    found: list[Judgement] = []
    scene = random_scene(seed)
    paths = _paths(scene)
    try:
        with _limited(patience):
            for name in formulations:
                ratio, said = judge(scene, name, paths)
                found.append(Judgement(seed, name, ratio, said))
    except _TooLongError:
        said = f"skipped, takes longer than {patience:g} s"
        found += [Judgement(seed, left, None, said) for left in formulations[len(found) :]]
    return found


def judge(scene: Scene, formulation: str, paths: list[Path]) -> tuple[float | None, str]:
    """The ratio of a run, and in words where it comes from."""
    try:
        result = simulate(scene, formulation=formulation)
    except _TooLongError:
        raise
    except InputError as refused:  # what only the motion shows: too many samples, a short table
        return None, f"skipped, refused: {refused}"
    except Exception as raised:  # whatever it is: a valid scene must run
        return math.inf, f"raises {type(raised).__name__}: {raised}"
    kept = result.data.sizes["time"] - (result.status != 0)  # the oracles do not see why it ends
    if kept < 2:
        return None, f"skipped, nothing to judge; {result.message}"
    result = replace(result, data=result.data.isel(time=slice(kept)))
    motion = _motion(result, paths)
    if motion is None:
        return None, f"skipped, the oracles refuse; {result.message}"
    true, peaks = true_errors(result, scene, motion)
    floors = {name: _FLOOR * scale for name, scale in scales(peaks).items()}
    rounded = _ROUNDED * float(np.max(motion.omega**2))
    floors["crank_acceleration"] = max(floors["crank_acceleration"], rounded)
    turned = scene.crank.moment_of_inertia * rounded
    floors["frame_moment"] = max(floors["frame_moment"], turned)
    worst, said = 0.0, "every error is zero"
    for name, error in true.items():
        stated = float(result.data[name].attrs["error_estimate"])
        ratio = error / max(stated, floors[name]) if error != 0.0 else 0.0
        if not ratio <= worst:  # nor if it is not a number
            worst = math.inf if math.isnan(ratio) else ratio
            said = f"{name} errs by {error:.2e}, {stated:.2e} stated"
    return worst, f"{said}; status {result.status}, {result.message}"


def _paths(scene: Scene) -> list[Path]:
    """The oracles for a scene: the fast one where it is installed, the other for its sake."""
    assert scene.start is not None
    machine, start = machine_of(scene), scene.start
    slow = series_path(machine, start.angle, start.speed)
    try:
        from validation.oracles.heyoka_path import heyoka_path
    except ImportError:
        return [slow]
    return [heyoka_path(machine, start.angle, start.speed), slow]


def _motion(result: Result, paths: list[Path]) -> Motion | None:
    for path in paths:
        try:
            return reference_motion(result, path=path)
        except ArithmeticError:
            continue
    return None


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Raise _TooLongError after so much wall time; only in a main thread."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise _TooLongError

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
