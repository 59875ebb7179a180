"""What the moving parts do to the frame, against their momenta and against exudyn's bodies."""

from __future__ import annotations

import numpy as np

from crankmbs.design import balance
from crankmbs.measures import engine_orders
from crankmbs.mechanics.harmonics import closed_orders
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import SUMS
from crankmbs.numerics.arrays import Array
from validation.adapter import at_jumps, machine_of, reference_motion, reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.momentum import FrameLoads, frame_by_momentum
from validation.runs import run

__all__ = ["by_bodies", "by_momentum", "closed_form_orders", "one_cylinder_balanced"]

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


def closed_form_orders(case: Case) -> Outcome:
    """Of a simulated run by quadrature, against the series of the machine at its speed."""
    found, closed = engine_orders(run(case.ours())), closed_orders(case.theirs())
    assert closed is not None
    errors = {}
    names = ("torque", "frame_force_x", "frame_force_y")
    for row, name in zip(found.rows[1:], names, strict=True):
        split = row.orders
        expected = np.zeros(len(split.order), dtype=np.complex128)
        expected[split.order % 1.0 == 0.0] = getattr(closed, name) * found.speed.value**2
        apart = np.abs(split.amplitude * np.exp(1j * split.phase) - expected)
        errors[row.quantity] = float(np.max(apart) / np.max(np.abs(expected)))
    return Outcome(
        max(errors.values()), ", ".join(f"{name} {error:.1e}" for name, error in errors.items())
    )


def one_cylinder_balanced(case: Case) -> Outcome:
    """Without offset cos(beta) has even orders alone, so the first is that of r cos(phi)."""
    theirs = case.theirs()
    rod, speed = theirs.rod, run(theirs).data["crank_speed"].values[0]
    moving = theirs.piston.mass + rod.mass * rod.center_of_mass / rod.length
    unit = moving * theirs.crank.radius * speed**2
    worst = 0.0
    for share in (0.0, 0.3, 0.5, 1.0):
        found = balance(case.ours(), share).remaining[:2]
        for one, part in zip(found, (1.0 - share, share), strict=True):
            worst = max(worst, abs(one.after.value / unit - part))
    return Outcome(worst, f"m_A r omega^2 = {unit:.6g} N")
