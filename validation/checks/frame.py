"""What the moving parts do to the frame, against their momenta and against exudyn's bodies."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import SUMS
from crankmbs.numerics.arrays import Array
from validation.adapter import at_jumps, machine_of, reference_motion, reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.momentum import FrameLoads, frame_by_momentum
from validation.runs import run

__all__ = ["by_bodies", "by_momentum"]

_VECTORS = {"force": FrameLoads._fields[:2], "moment": FrameLoads._fields[2:3]}
_VECTORS["rocking moment"] = FrameLoads._fields[3:]


def by_momentum(case: Case) -> Outcome:
    """Force and moments at random states of motion, over the largest of their kind."""
    rng = np.random.default_rng(14)
    states = rng.uniform([-13.0, 50.0, -2e4], [13.0, 400.0, 2e4], (8, 3))
    ours = reactions(crank_train(case.ours()), *states.T)
    theirs = reactions(crank_train(case.theirs()), *states.T)["gas_force"]
    machine = machine_of(case.theirs())
    exact = np.array(
        [
            frame_by_momentum(machine, tuple(state), tuple(gas))
            for state, gas in zip(states.tolist(), theirs.tolist(), strict=True)
        ]
    )
    columns = dict(zip(FrameLoads._fields, exact.T, strict=True))
    return _worst({name: ours[name] for name in columns}, columns)


def by_bodies(case: Case) -> Outcome:
    """Of a multibody run, and the torques in the crank, over the largest of their kind."""
    result, scene = run(case.ours(), "multibody"), case.theirs()
    motion = reference_motion(result, scene)
    exact = reference_variables(scene, motion.theta, motion.omega, motion.alpha)
    clear = ~at_jumps(scene, motion.theta)
    ours = {name: result.data[name].values[clear] for name in sorted(SUMS)}
    return _worst(ours, {name: exact[name][clear] for name in ours})


def _worst(ours: dict[str, Array], exact: dict[str, Array]) -> Outcome:
    kinds = {**_VECTORS, **{name: (name,) for name in exact if name.endswith("torque")}}
    errors = {}
    for kind, names in kinds.items():
        scale = max(float(np.max(np.abs(exact[name]))) for name in names)
        apart = max(float(np.max(np.abs(ours[name] - exact[name]))) for name in names)
        errors[kind] = apart / scale
    return Outcome(
        max(errors.values()), ", ".join(f"{kind} {error:.1e}" for kind, error in errors.items())
    )
