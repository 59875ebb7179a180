"""One free rotation with time as the variable: (theta, omega), also at rest and backwards.

    alpha = (T_gas + T_gravity + T_outside - J_1 omega^2 / 2) / J

SciPy's DOP853 integrates piece by piece: between two knots of the pressure each cylinder keeps its
polynomial, continued beyond the knot, and the piece is cut exactly at the knot; likewise at a
bound of the loads' branch and at a reversal. Where a load damps the speed far faster than the crank
turns, Radau takes its place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import DOP853, DenseOutput, Radau
from scipy.optimize import brentq

from crankmbs.formulations.base import NOWHERE, Array, Samples, State
from crankmbs.inertia import reduce
from crankmbs.reduced import Between, Reduced
from crankmbs.roots import invert_monotone
from crankmbs.sampling import Plan
from crankmbs.schema import DEGREE
from crankmbs.torque import Branch, branch_at, branch_of

__all__ = ["Equation", "Step", "advance"]

if TYPE_CHECKING:
    Solver = DOP853[np.float64] | Radau
    Dense = Callable[[float | Array], Array]  # (theta, omega, work) at times, shape (3, ...)

_MOST_EVALUATIONS = 2_000_000
_BALANCED = 1e-13  # of the largest torque: what the rounding of an angle leaves at a dead centre


@dataclass(frozen=True)
class Equation:
    """The equation of motion on one piece: between two knots and on one branch of the loads."""

    reduced: Reduced
    between: Between
    branch: Branch

    def __call__(self, t: float, y: Array) -> Array:
        """Slopes of (theta, omega, work) in time."""
        theta, omega = float(y[0]), float(y[1])
        if not math.isfinite(theta * omega):  # a trial step far too long: it is refused
            return np.full(3, math.nan)
        inertia, slope, torque = self.reduced(theta, self.between.pieces)
        torque += self.outside(float(t), omega)
        alpha, power = (torque - 0.5 * slope * omega * omega) / inertia, torque * omega
        return (
            np.array([omega, alpha, power])
            if math.isfinite(alpha * power)
            else np.full(3, math.nan)
        )

    def outside(self, t: float, omega: float) -> float:
        """Torque from outside [N m]."""
        b = self.branch
        return b.c0 + b.ct * t + (b.c1 + b.c2 * omega) * omega

    def is_stiff(self, state: State, inertia: float) -> bool:
        """Whether the loads damp the speed a thousand times while the crank turns 5 degrees, and
        what they had to damp is gone: while it still dies away small steps are needed anyway."""
        damping = abs(self.branch.c1 + 2.0 * self.branch.c2 * state.omega) / inertia
        strong = damping * 5.0 * DEGREE > 1e3 * abs(state.omega)
        return strong and abs(self.pull(state)) < 0.01 * inertia * damping * abs(state.omega)

    def is_balanced(self, state: State, scale: float) -> bool:
        """Whether no torque acts on a crank at rest here, now or later."""
        changes = self.branch.ct != 0.0 or math.isfinite(self.branch.t_end)
        return not changes and abs(self.pull(state)) <= _BALANCED * scale

    def pull(self, state: State) -> float:
        """Torque of gas, gravity and loads at a state [N m]."""
        torque = self.reduced(state.theta, self.between.pieces)[2]
        return torque + self.outside(state.time, state.omega)

    def kinetic(self, theta: float, omega: float) -> float:
        """Kinetic energy [J]."""
        return 0.5 * self.reduced(theta, self.between.pieces)[0] * omega * omega


@dataclass(frozen=True)
class Step:
    """One accepted step of the integrator, cut where the motion leaves its piece."""

    equation: Equation
    dense: Dense
    begin: State
    end: State
    evaluations: int
    steps: int = 1

    def sample(self, plan: Plan) -> Samples:
        """The samples of the plan after the beginning, up to the end and with it."""
        if plan.in_time:
            t = plan.between(self.begin.time, self.end.time)
            return self._samples(t, self.dense(t)[0])
        theta = plan.between(self.begin.theta, self.end.theta)
        low, high = (np.full_like(theta, q) for q in (self.begin.time, self.end.time))

        def angle(t: Array) -> tuple[Array, Array]:
            y = self.dense(t)
            return y[0], y[1]

        return self._samples(invert_monotone(angle, theta, low, high), theta)

    def last(self) -> Samples:
        """The one sample at the end."""
        at = self._samples(np.array([self.end.time]), np.array([self.end.theta]))
        return replace(at, omega=np.array([self.end.omega]))

    def _samples(self, t: Array, theta: Array) -> Samples:
        _, omega, work = self.dense(t)
        equation, branch = self.equation, self.equation.branch
        # on a step of the pressure the value after it counts, here as in the joint forces
        scene, pressure = equation.reduced.scene, equation.reduced.pressure
        inertia, slope, torque = reduce(scene, pressure, theta)
        outside = branch(t, omega)
        alpha = (torque + outside - 0.5 * slope * omega**2) / inertia
        start = equation.kinetic(self.begin.theta, self.begin.omega)
        work = work - float(self.dense(np.array([self.begin.time]))[2, 0])
        residual = self.begin.residual + 0.5 * inertia * omega**2 - start - work
        return Samples(t, theta, omega, alpha, residual, {"external_torque": outside})


def advance(
    reduced: Reduced,
    state: State,
    plan: Plan,
    tolerance: float,
    is_fast: Callable[[State, Branch], bool],
) -> Generator[Step, None, str]:
    """Carry the motion on, step by step.

    tolerance : relative, of each step; is_fast : whether the crank angle can take over again

    Returns
    -------
    "end" of the plan; "fast"; "stuck" at rest in an equilibrium; "held" by a jump of a speed
    table; "rest" when the motion has died away; "costly" when it takes too many evaluations,
    "failed" when no step is short enough
    """
    scale = reduced.torque_scale
    evaluations, most, h = 0, 0.0, math.inf
    while evaluations < _MOST_EVALUATIONS:
        equation = _enter(reduced, state, scale)
        if isinstance(equation, str):
            return equation
        bound = min(plan.time_bound, equation.branch.t_end)
        inertia = reduced(state.theta, equation.between.pieces)[0]
        speed = max(abs(state.omega), math.sqrt(2.0 * scale / inertia))
        # the work takes no part in the error: DOP853 divides by a third-order estimate that is
        # summed over all components, and the one of the work would hide the error of the speed
        atol = np.array([tolerance, tolerance * speed, math.inf])
        integrator = _Integrator(
            equation, bound, tolerance, atol, equation.is_stiff(state, inertia)
        )
        y = np.array([state.theta, state.omega, 0.0])
        solver = integrator.start(state.time, y, h)
        leaves = False
        while not leaves:
            before = solver.nfev
            solver.step()
            if solver.status == "failed":
                return "failed"
            step, leaves = _cut(integrator, solver, state, plan, solver.nfev - before)
            yield step
            state, h = step.end, solver.h_abs
            evaluations += step.evaluations
            kinetic = equation.kinetic(state.theta, state.omega)
            most = max(most, kinetic)
            if state.time >= plan.time_bound or state.theta in plan.angle_bounds:
                return "end"
            if kinetic <= tolerance**2 * most and equation.is_balanced(state, scale):
                return "rest"
            if is_fast(state, equation.branch):
                return "fast"
            leaves = leaves or solver.status == "finished" or evaluations > _MOST_EVALUATIONS
            leaves = leaves or integrator.stiff != equation.is_stiff(state, inertia)
    return "costly"


@dataclass(frozen=True)
class _Integrator:
    """DOP853 on one piece, with its tolerances."""

    equation: Equation
    bound: float
    rtol: float
    atol: Array
    stiff: bool

    def start(self, t: float, y: Array, h: float) -> Solver:
        """A solver at (t, y) with the first step h [s]; infinite lets it choose."""
        halved = self.equation.reduced.halved
        most = 0.505 * (self.bound - t) if halved and math.isfinite(self.bound) else math.inf
        return self._solver(t, y, self.bound, min(h, most), most, self.atol)

    def again(self, solver: Solver, t: float) -> Dense:
        """The last step again, up to t only: its end is more exact than its inside."""
        begin = float(solver.t_old or 0.0)
        # shorter than a step that was accepted: DOP853 has nothing to refuse
        atol = self.atol if self.stiff else np.full(3, math.inf)
        first = (t - begin) * (0.5 if self.equation.reduced.halved else 1.0)
        y = np.asarray(solver.y_old)
        most = 1.01 * first  # no sliver is left at the end, where its polynomial means nothing
        shorter = self._solver(begin, y, t, first, most, atol)
        parts: list[DenseOutput[np.float64]] = []
        while shorter.status == "running":
            shorter.step()
            parts.append(shorter.dense_output())
        return _joined(parts)

    def _solver(
        self, t: float, y: Array, bound: float, first: float, most: float, atol: Array
    ) -> Solver:
        method: Any = Radau if self.stiff else DOP853
        first_step = min(first, bound - t) if math.isfinite(first) else None
        options = {"rtol": self.rtol, "atol": atol, "max_step": most, "first_step": first_step}
        solver: Solver = method(self.equation, t, y, bound, **options)
        return solver


def _enter(reduced: Reduced, state: State, scale: float) -> Equation | str:
    """The piece that the motion enters, or why it enters none."""
    torques = reduced.scene.torque
    if state.omega != 0.0:
        between = reduced.around(state.theta, math.copysign(1.0, state.omega))
        _, slope, torque = reduced(state.theta, between.pieces)
        rest = torque - 0.5 * slope * state.omega**2
        branch = branch_at(torques, state.time, state.omega, rest)
        return "held" if branch is None else Equation(reduced, between, branch)
    resisted = False
    for sense in (1.0, -1.0):
        branch = branch_of(torques, state.time, 0.0, rising=sense > 0.0)
        equation = Equation(reduced, reduced.around(state.theta, sense), branch)
        pull = equation.pull(state)
        if pull * sense > _BALANCED * scale:
            return equation
        resisted = resisted or pull * sense < -_BALANCED * scale
        if not resisted and not equation.is_balanced(state, scale):  # a load that begins later
            return equation
    return "held" if resisted else "stuck"


def _cut(
    integrator: _Integrator, solver: Solver, begin: State, plan: Plan, evaluations: int
) -> tuple[Step, bool]:
    """The step up to where the motion first leaves its piece, and whether it does."""
    equation = integrator.equation
    dense: Dense = solver.dense_output()
    theta, omega, _ = (float(q) for q in solver.y)
    sense = math.copysign(1.0, begin.omega or theta - begin.theta)
    exits: list[tuple[float, State]] = []
    low, high = plan.angle_bounds
    exits += [
        (_root(solver, dense, 0, limit), NOWHERE._replace(theta=limit))
        for limit in {equation.between.low, equation.between.high, low, high}
        if (theta - limit) * (begin.theta - limit) < 0.0 or theta == limit != begin.theta
    ]
    for limit in {0.0, equation.branch.omega_low, equation.branch.omega_high}:
        inside = (begin.omega - limit) or (sense if limit == 0.0 else 0.0)
        if (omega - limit) * inside < 0.0:
            exits.append((_root(solver, dense, 1, limit), NOWHERE._replace(omega=limit)))
    t, landed = min(exits, key=lambda item: item[0], default=(float(solver.t), NOWHERE))
    if exits and t > begin.time:
        dense, evaluations = integrator.again(solver, t), evaluations + 12
    theta, omega, work = (float(q) for q in dense(t))
    alpha = equation(t, np.array([theta, omega]))[1]
    if not math.isnan(landed.theta):
        late = (landed.theta - theta) / omega
        t, theta, omega = t + late, landed.theta, omega + alpha * late
    elif not math.isnan(landed.omega):
        late = (landed.omega - omega) / alpha
        t, theta, omega = t + late, theta + omega * late, landed.omega
    gained = equation.kinetic(theta, omega) - equation.kinetic(begin.theta, begin.omega)
    worked = work - float(dense(begin.time)[2])
    end = State(t, theta, omega, begin.residual + gained - worked)
    return Step(equation, dense, begin, end, evaluations), bool(exits)


def _joined(parts: list[DenseOutput[np.float64]]) -> Dense:
    """The motion over steps that follow one another."""
    begins = np.array([part.t_min for part in parts])

    def dense(t: float | Array) -> Array:
        step = np.maximum(np.searchsorted(begins, t, side="left") - 1, 0)
        every = np.stack([part(np.asarray(t)) for part in parts])
        return np.asarray(np.choose(step, every))

    return parts[0] if len(parts) == 1 else dense


def _root(solver: Solver, dense: Dense, index: int, limit: float) -> float:
    """Time in the last step at which a component reaches a limit that it crosses there."""

    def distance(t: float) -> float:
        return float(dense(t)[index]) - limit

    begin, end = float(solver.t_old or 0.0), float(solver.t)
    beyond = math.copysign(1.0, distance(end))
    if distance(begin) * beyond >= 0.0:  # it starts on the limit and comes back to it
        inside = [float(t) for t in np.linspace(begin, end, 34)[1:-1]]
        far = min(inside, key=lambda t: distance(t) * beyond)
        if distance(far) * beyond >= 0.0:  # it leaves at once, but for rounding
            return begin
        begin = far
    return float(brentq(distance, begin, end, xtol=1e-300, rtol=8.9e-16))
