"""The cases of a sweep against runs of their scenes alone, and the store of two workers against
that of one."""

from __future__ import annotations

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from crankmbs import Sample, load_sweep, simulate, sweep
from crankmbs.measures import Estimate, measure
from crankmbs.sweep.scenes import scene_of
from validation.case import Case
from validation.judge import Outcome

__all__ = ["one_by_one", "two_workers"]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_FLOOR = 1e-12  # of the value: the reference's own
_NUMBERS = ("mean_speed", "fluctuation", "crank_torque", "external_torque", "indicated_power")
_JOINTS = ("main_bearing", "crank_pin", "piston_pin", "side_force")


def one_by_one(case: Case) -> Outcome:
    """Each measure and peak of each case, off a run of its scene alone at rtol 1e-12, over twice
    its stated error."""
    ours, theirs = case.ours(), case.theirs()
    vary = Sample(dict(case.parameters["vary"]), int(case.parameters["count"]))
    found = sweep(ours, vary, executor=1)
    names = tuple(vary.vary)
    worst, said = 0.0, ""
    for k in range(found.sizes["case"]):
        one = found.isel(case=k)
        assert int(one["status"]) == 0
        scene = scene_of(theirs, names, [float(one[name]) for name in names])
        exact = measure(simulate(scene.with_(run__rtol=1e-12)))
        pairs: dict[str, Estimate] = {name: getattr(exact, name) for name in _NUMBERS}
        for joint in exact.joints:
            words = joint.joint.replace(" ", "_")
            pairs |= {f"{words}_peak": joint.peak, f"{words}_mean": joint.mean}
        for name, reference in pairs.items():
            value = float(np.ravel(one[name].values)[0])
            stated = float(np.ravel(one[f"{name}_error"].values)[0])
            allowed = _TOO_SMALL * stated + reference.error + _FLOOR * abs(reference.value)
            ratio = abs(value - reference.value) / allowed
            if not ratio <= worst:
                worst, said = (
                    ratio,
                    f"{name} of case {k}: {value:.12g}, alone {reference.value:.12g}",
                )
    return Outcome(worst, f"{said}; {found.sizes['case']} cases over {', '.join(names)}")


def two_workers(case: Case) -> Outcome:
    """How many files of a store that two threads computed are not those of a store by one."""
    vary = Sample(dict(case.parameters["vary"]), int(case.parameters["count"]))
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as two:
        stores = [Path(folder, name) for name in ("one", "two")]
        sweep(case.theirs(), vary, out=stores[0], executor=1)
        sweep(case.ours(), vary, out=stores[1], executor=two)
        one, other = (_files(store) for store in stores)
        count = load_sweep(stores[0]).sizes["case"]
    apart = [name for name in one.keys() | other.keys() if one.get(name) != other.get(name)]
    return Outcome(float(len(apart)), f"{len(one)} files of {count} cases, {len(apart)} others")


def _files(store: Path) -> dict[str, bytes]:
    found = (file for file in store.rglob("*") if file.is_file())
    return {str(file.relative_to(store)): file.read_bytes() for file in found}
