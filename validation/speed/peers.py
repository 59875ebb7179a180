"""Peers: what else one would write today, each with its own equations and only the scene's numbers.

A peer that is not installed, cannot serve the scene or fails is named with the reason.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import NamedTuple

from crankmbs.scene.scene import Scene
from crankmbs.work_precision.contender import Answer, Contender, ContenderFailed
from crankmbs.work_precision.reference import Reference
from crankmbs.work_precision.trace import Trace
from validation.speed.job import Job, NotServed, job_of

__all__ = ["peers_of"]

_Make = Callable[[Job, Trace], tuple[Contender, ...]]


class _Peer(NamedTuple):
    """What a note calls it, and the module and function that make its contenders."""

    name: str
    module: str
    function: str


_PEERS = (
    _Peer("C, Gauss over theta", "limit", "gauss_contenders"),
    _Peer("C, DOP853 in time", "limit", "dop853_contenders"),
    _Peer("SciPy LSODA and DOP853", "reduced", "scipy_contenders"),
    _Peer("SymPy mechanics", "sympy_mechanics", "sympy_contenders"),
    _Peer("MuJoCo", "mujoco_model", "mujoco_contenders"),
    _Peer("exudyn script", "exudyn_script", "exudyn_contenders"),
)


def peers_of(scene: Scene, reference: Reference) -> tuple[list[Contender], list[str]]:
    """The peers that can serve a scene here, and a sentence for every other."""
    if reference.result.status != 0:
        return [], [f"no peers: the run does not reach its end ({reference.result.message})"]
    try:
        trace = reference.at_times()
        job = job_of(scene, trace.time)
    except NotServed as why:
        return [], [f"no peers: {why}"]
    contenders: list[Contender] = []
    notes: list[str] = []
    for name, module, function in _PEERS:
        try:
            make: _Make = getattr(import_module(f"{__package__}.{module}"), function)
            contenders += [_guarded(contender) for contender in make(job, trace)]
        except ImportError as error:
            missing = error.name or str(error)
            notes.append(f'{name}: {missing} is not installed; pip install ".[bench]"')
        except NotServed as why:
            notes.append(f"{name}: {why}")
        except Exception as error:  # others' code may fail in any way
            notes.append(f"{name}: {_said(error)}")
    return contenders, notes


def _guarded(contender: Contender) -> Contender:
    def run(setting: float) -> Answer:
        try:
            return contender.run(setting)
        except Exception as error:  # others' code may fail in any way
            raise ContenderFailed(_said(error)) from error

    return replace(contender, run=run, is_peer=True)


def _said(error: Exception) -> str:
    """The first line of what an error says."""
    return f"failed: {(str(error).strip() or type(error).__name__).splitlines()[0]}"
