"""The motion at places in cells, and every variable of a result there.

Algebra with the polynomials of a cell and what acts in it: the one text by which samples, readings
between them and measures are read from a solved motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from crankmbs.mechanics.forces import OnCrank
from crankmbs.mechanics.friction import friction_forces, friction_torque, held_share
from crankmbs.mechanics.inertia import Reduction, fired_torque, reduce
from crankmbs.mechanics.reactions import Balances, Table, balances
from crankmbs.mechanics.torque import Branch, branch_at, branch_of, over_angle, pushing
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples, State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.periodic import period_of

__all__ = [
    "MOTION",
    "applied_forces",
    "balances_of",
    "entered",
    "first_sample",
    "inner_samples",
    "motion_rows",
    "samples_at",
    "samples_in",
    "table_of",
    "variables_at",
]

MOTION = ("time", "crank_angle", "crank_speed", "crank_acceleration", "energy_residual")
"""The variables of a result that are the motion's own."""

_GIVEN = ("fuel", "friction_force", "applied_force")  # what reactions take from samples


def samples_at(cells: Cells, train: CrankTrain, values: Array, *, in_time: bool) -> Samples:
    """The motion at times [s], or else at crank angles [rad], shape (p,) in any order; where cells
    meet it is that before, beyond an end that at the end."""
    k, x = cells.located(values, in_time=in_time)
    known = {"time" if in_time else "angle": values}
    return _samples(cells, train, k, lambda row: cells.values(row, k, x), known)


def samples_in(cells: Cells, train: CrankTrain, k: Index, x: Array) -> Samples:
    """The motion at places x in the cells k, shape (p,) each."""
    return _samples(cells, train, k, lambda row: cells.values(row, k, x), {})


def inner_samples(cells: Cells, train: CrankTrain) -> Samples:
    """The motion at the nodes of all cells, and a hair inside their ends, cell after cell."""
    k = np.repeat(np.arange(len(cells.time)), cells.time.shape[1])
    return _samples(cells, train, k, cells.inner_reader(), {})


def _samples(
    cells: Cells,
    train: CrankTrain,
    k: Index,
    read: Callable[[Array], Array],
    known: dict[str, Array],
) -> Samples:
    """The motion at points in the cells k, shape (p,), at which rows are read, but for those that
    are known there."""
    faster = cells.speed if cells.energy is None else cells.energy
    rows = {"time": cells.time, "angle": cells.angle, "speed": faster}
    wanted = [name for name in rows if name not in known]
    known |= zip(wanted, read(np.array([rows[name] for name in wanted])), strict=True)
    time, angle, speed = (known[name] for name in rows)
    sense = cells.acting.sense
    computed = {"fuel": cells.shares[k]} if cells.shares.shape[1] else {}
    phases = cells.acting.phases
    inertia, slope, torque = _reduced(train, angle, computed.get("fuel"))
    if cells.energy is not None:
        speed = sense * np.sqrt(2.0 * np.maximum(speed, 0.0) / inertia)
    slides, rate = np.full_like(speed, sense), None
    outside = _outside(cells, train, read, (time, angle, speed))
    pushes = pushing(train, phases)
    if outside is not None:
        if cells.acting.holds and train.rubs:
            slides = _holding(cells, train, torque + outside)
        if train.rubs:
            fuel = computed.get("fuel")
            torque = torque + friction_torque(train, angle, speed, slides, fuel, phases)
        rest = torque - 0.5 * slope * speed**2
        outside = -rest if cells.acting.holds else outside
        rate = (rest + outside) / inertia
        on_pistons = sum(push.parts(time, angle, speed) for push in pushes)
        computed["external_torque"] = outside - on_pistons
    if cells.acceleration is not None:
        rate = read(cells.acceleration)
    assert rate is not None
    if train.scene.friction is not None:
        computed["friction_force"] = friction_forces(
            train, angle, speed, computed.get("fuel"), slides
        )
    if train.pushes:
        computed["applied_force"] = applied_forces(train, pushes, (time, angle, speed), slides)
    residual = np.zeros_like(time) if cells.residual is None else cells.residual[k]
    return Samples(time, angle, speed, rate, residual, computed)


def applied_forces(
    train: CrankTrain,
    pushes: Sequence[OnCrank],
    motion: tuple[Array, Array, Array],
    share: Array | None = None,
) -> Array:
    """Forces from outside on the pistons [N], shape (p, cylinders), at times, crank angles and
    speeds; share : of what jumps with the sense of sliding, by default the speed's sign."""
    share = np.sign(motion[2]) if share is None else share
    none = np.zeros((len(share), len(train.scene.cylinders)))
    return sum((push.forces(*motion, share) for push in pushes), none)


def _reduced(train: CrankTrain, angle: Array, shares: Array | None) -> tuple[Array, Array, Array]:
    """J, dJ/dtheta and the torque of gas and weights, shape (p,), once for angles that come
    again."""
    once, which = period_of(angle, train.repeats)[:2]
    inertia, slope, torque = (part[which] for part in reduce(train, once))
    if shares is not None:
        torque = torque + (fired_torque(train, once)[which] * shares).sum(axis=1)
    return inertia, slope, torque


def _outside(
    cells: Cells,
    train: CrankTrain,
    read: Callable[[Array], Array],
    motion: tuple[Array, Array, Array],
) -> Array | None:
    """Torque of all loads that act [N m] at times, angles and speeds, but for what resists as
    friction does; None where it is what the acceleration takes."""
    loads, (time, angle, speed) = cells.acting.loads, motion
    if cells.outside is not None:
        pushes = pushing(train, cells.acting.phases)
        return read(cells.outside) + sum((push.parts(*motion) for push in pushes), 0.0 * time)
    if loads is None:
        return None
    outside, of_angle = loads(time, speed), over_angle(train, cells.acting.phases)
    if of_angle is not None:
        outside = outside + of_angle(angle)
    for function in loads.functions:
        outside = outside + function(time, angle, speed)
    return outside


def _holding(cells: Cells, train: CrankTrain, torque: Array) -> Array:
    """The share of its friction that a crank at rest needs to be held, with its sign."""
    shares = tuple(cells.shares[0].tolist())
    at, phases = float(cells.angle[0, 0]), cells.acting.phases
    return np.clip(held_share(train, at, torque, shares, phases), -1.0, 1.0)


def table_of(train: CrankTrain, samples: Samples) -> Table:
    """Every variable at the samples: the motion, what follows from it, and in place of that, or
    beside it, what the samples have of their own."""
    balanced, computed = balances_of(train, samples), samples.computed
    more = {name: one.shape[1] for name, one in computed.items() if name not in balanced.rows}
    rows = dict.fromkeys(MOTION, 1) | balanced.rows | more
    # one piece of memory, so large that the system is not asked for every run's anew
    table = Table(rows, np.empty((sum(rows.values()), len(samples.time))))
    table.values[: len(MOTION)] = motion_rows(samples)
    balanced.fill(table.values[len(MOTION) :][: sum(balanced.rows.values())])
    places = table.places
    for name, values in computed.items():
        table.values[places[name]] = values.T
    return table


def variables_at(train: CrankTrain, samples: Samples) -> dict[str, Array]:
    """Every variable by name but the energy residual, shape (p,) or (p, cylinders)."""
    values = table_of(train, samples).variables
    del values["energy_residual"]
    return values


def balances_of(train: CrankTrain, samples: Samples) -> Balances:
    """What follows from the motion at samples, not yet put together."""
    known = {name: samples.computed[name] for name in _GIVEN if name in samples.computed}
    return balances(train, samples.theta, samples.omega, samples.alpha, known)


def motion_rows(samples: Samples) -> Array:
    """The rows of `MOTION`."""
    of_time = samples.time, samples.theta, samples.omega, samples.alpha
    return np.array([*of_time, samples.energy_residual])


def entered(train: CrankTrain, state: State) -> tuple[Branch | None, Reduction, float]:
    """The branch of the loads that a motion enters at a state, as `branch_at` says; the crank train
    there; and the torque [N m] that loads of time and speed add to."""
    (time, theta, omega, _, mode), shares = state, state.mode.shares
    reduction, sense = reduce(train, theta, shares), math.copysign(1.0, omega) if omega else 0.0
    rest = float(reduction.rest(omega)) + mode.held
    if train.rubs:
        rest += float(friction_torque(train, theta, omega, sense, shares or None, mode.loads))
    of_angle = over_angle(train, mode.loads)
    rest += 0.0 if of_angle is None else float(of_angle(theta))
    branch = branch_at(train.loads, (time, theta, omega), rest, mode.loads)
    return branch and branch.plus(mode.held), reduction, rest


def first_sample(train: CrankTrain, state: State) -> Samples:
    """The sample at a state. A crank at rest has the acceleration with which it sets out, and the
    friction that resists it; where friction or loads hold it, none, and the friction that it
    takes."""
    (time, theta, omega, residual, mode), sense = state, float(np.sign(state.omega))
    branch, _, rest = entered(train, state)
    holds = branch is None and omega == 0.0
    if branch is None:
        branch = branch_of(train.loads, time, omega, rising=True, phases=mode.loads)
        branch = branch.plus(mode.held)
    if train.rubs and omega == 0.0 and not holds:
        pull = rest + float(branch(time, omega)) - mode.held
        pull += sum(f.number(time, theta, omega) for f in branch.functions)
        share = float(held_share(train, theta, pull, mode.shares, mode.loads))
        holds, sense = abs(share) <= 1.0, float(np.sign(share))
    at, speed, angle = (np.full((1, 3), value) for value in (time, omega, theta))
    acting, shares = Acting(sense, holds, mode.loads, branch), np.array([mode.shares])
    cell = Cells(at, angle, speed, acting, shares, residual=np.array([residual]))
    return samples_in(cell, train, np.zeros(1, np.intp), np.zeros(1))
