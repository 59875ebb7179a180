"""The formulations that can serve a scene, as contenders."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from crankmbs.errors import CrankmbsError
from crankmbs.motion.formulations import Formulation, serving
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from crankmbs.work_precision.contender import Answer, Contender, ContenderFailed
from crankmbs.work_precision.reference import Reference
from crankmbs.work_precision.trace import END, stated, trace_of

__all__ = ["formulations_of"]

_LADDER = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-12, 1e-13)
_ALGEBRA = (1e-8,)  # nothing to set


def formulations_of(scene: Scene, reference: Reference) -> tuple[Contender, ...]:
    """Every formulation that can serve the scene, over its settings, with all it gives.

    Those whose steps are wider than samples come a second time, for the state at the end alone:
    that is what a bare integrator gives.
    """

    def contender(formulation: Formulation, *, end_only: bool = False) -> Contender:
        return Contender(
            name=f"{formulation.name}, end only" if end_only else formulation.name,
            knob="rtol",
            settings=_LADDER if formulation.integrates else _ALGEBRA,
            run=partial(_run, scene, formulation.name, end_only, reference),
            reference=reference.trace,
        )

    contenders = []
    for formulation in serving(scene):
        contenders.append(contender(formulation))
        if formulation.integrates and formulation.dense:
            contenders.append(contender(formulation, end_only=True))
    return tuple(contenders)


def _run(scene: Scene, name: str, end_only: bool, reference: Reference, rtol: float) -> Answer:
    until, until_time = scene.end
    whole = Extent(value=until, unit="s" if until_time else "rad")
    run = replace(scene.run, every=whole) if end_only else scene.run
    try:
        result = simulate(replace(scene, run=run), formulation=name, rtol=rtol)
    except CrankmbsError as error:
        raise ContenderFailed(str(error)) from None
    if result.status != reference.result.status:
        raise ContenderFailed(result.message)
    trace, evaluations = trace_of(result), result.cost.evaluations
    if not end_only:
        return Answer(trace, evaluations, result.error.estimated)
    of_end = stated(result, reference.trace, reference.start)  # one sample has no peaks of its own
    return Answer(trace.end(), evaluations, of_end[END])
